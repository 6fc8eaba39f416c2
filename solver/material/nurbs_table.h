// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/nurbs/surface.h"
#include "solver/material/concept.h"
#include "solver/material/yield_table.h"

namespace pneuma::solver::material {

// Least and largest strain of a table, Green-Lagrange, -.
struct StrainRange {
  double min = 0;
  double max = 0;
};

// A border of where a table has data: a e1 + b e2 <= c.
struct TableBorder {
  double a = 0, b = 0, c = 0;
};

inline constexpr double table_rounding = 1e-8; // of strains at the end of a table: of a file's digits, too

// Where a table over two strains has data: a square, or a convex part of it.
struct TableDomain {
  StrainRange range;                // of both strains
  std::vector<TableBorder> borders; // none: all of the square

  bool holds(double e1, double e2) const {
    if (!(std::min(e1, e2) >= range.min - table_rounding && std::max(e1, e2) <= range.max + table_rounding))
      return false;
    return std::all_of(borders.begin(), borders.end(), [&](const TableBorder& border) {
      return border.a * e1 + border.b * e2 <= border.c + table_rounding;
    });
  }
};

// Table of an isotropic law over its principal strains: a potential that is the sum of the parts it has. Built once, by
// `fit_pd_nurbs`; any number of laws share it.
struct PdTable {
  std::optional<YieldTable> yield;                      // of a law that yields
  std::optional<geometry::nurbs::Surface<1>> potential; // W(E1, E2) = W(E2, E1), J/m3
  std::optional<geometry::nurbs::Surface<1>> stress;    // S1(E1, E2) = S2(E2, E1), Pa, where fitted apart
  TableDomain domain;                                   // of principal strains
  double near = 0; // (S1 - S2)/(E1 - E2) of strains closer than this is a mean of the surfaces' derivatives
};

// Table of an orthotropic law over the strains along its axes. Built once, by `fit_le_nurbs`.
struct LeTable {
  geometry::nurbs::Surface<1> potential;                    // W(E11, E22), J/m3
  std::optional<geometry::nurbs::Surface<1>> first, second; // S11, S22 (E11, E22), Pa, where fitted apart
  geometry::nurbs::Curve<1> shear;                          // w(2 E12) = w(-2 E12), J/m3, S12 its derivative
  TableDomain domain;                                       // of E11 and E22
};

// Thickness stretch J^(-nu / (1 - nu)) of an area ratio J: linear elasticity of small strains, and a constant volume
// for nu = 1/2.
inline double thickness_of_area(const Vec3& strain, double poissons_ratio) {
  const double area = std::sqrt((1 + 2 * strain[0]) * (1 + 2 * strain[1]) - strain[2] * strain[2]);
  return std::pow(area, -poissons_ratio / (1 - poissons_ratio));
}

} // namespace pneuma::solver::material
