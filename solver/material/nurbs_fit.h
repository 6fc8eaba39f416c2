// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solver/material/material.h"

namespace pneuma::solver::material {

// A measured or computed point of a table: Green-Lagrange strains, -, and second Piola-Kirchhoff stresses, Pa, in
// principal directions (PD-NURBS) or along the axes (LE-NURBS). A stress that is not a number was not measured.
struct StressPoint {
  double e1 = 0, e2 = 0;
  double s1 = 0, s2 = 0;
  double weight = 1; // of the squared residuals, >= 0
};

// A point of the shear curve of LE-NURBS: 2 E12, -, and S12, Pa; its mirror image is taken along.
struct ShearPoint {
  double gamma = 0;
  double s12 = 0;
  double weight = 1;
};

struct NurbsOptions {
  std::array<int, 2> net = {25, 25}; // control points of the stress surfaces, up to 200; PD-NURBS: the same twice
  int degree = 3;                    // of the stress surfaces, 2 to 6; a potential has one degree and one row more
  // Strains of the table, min <= 0 < max. Default: from the points, with a twentieth of the largest strain at least on
  // the side of compression; a law to fit needs it.
  std::optional<StrainRange> range;
  // Spans grow in proportion to the strain beyond this one and are equal below, in logarithmic strain. Default: the one
  // of several, or none, that follows the law or the points best.
  std::optional<double> knee;
  bool potential = true; // stresses from one potential
  // Of geometry::nurbs::FitSettings. Default: of a law 1e-10; through points 1e-7, of what they add to a law that
  // yields 1e-5, or ten times as much and again, to 1e-3, until the stress rises everywhere. The surface of a law that
  // yields itself always has 1e-10.
  std::optional<double> smoothing;
};

// How a table follows what it was fitted to.
struct FitReport {
  double rms = 0;            // of the stress, weighted, Pa
  double max = 0;            // largest difference of a stress of points that have a weight, Pa
  base::Vec2 where = {0, 0}; // strains (E1, E2) of it
  double largest_stress = 0; // of the same points, Pa
  double max_from_fill = 0;  // largest difference from the law that fills what points leave open, Pa
  double smoothing = 0;      // taken, of geometry::nurbs::FitSettings
  double uncovered = 0;      // part of the cells of the table that no point lies in
  // The Kirchhoff stress (1 + 2 E1) S1 rises with E1 in all of the data, so does 22; of small-strain plasticity S.
  bool monotone = true;
  base::Vec2 not_monotone = {0, 0}; // where it rises least
  // Largest |dS1/dE2 - dS2/dE1| over the largest entry of the tangent, in the data: what keeps stresses fitted apart
  // from having an energy. Zero of a potential.
  double integrability_defect = 0;
};

struct PdFit {
  std::shared_ptr<const PdTable> table;
  FitReport report;
};

struct LeFit {
  std::shared_ptr<const LeTable> table;
  FitReport report;       // of S11 and S22
  FitReport shear_report; // of S12, where[0] is 2 E12
};

// Stresses of a law at these strains (E1, E2), each reached in one step of `time` (s; 0: none passes) from the unloaded
// state: of plasticity this is the deformation (Hencky) law of monotonic loading, which has a potential. With
// equal weights, but w = (s / (s + |S|))^2 for the median s of the stresses |S|: where a law stiffens without bound its
// relative error counts. States that the law does not have are left out, its tension field too.
std::vector<StressPoint> sample(const Law& law, std::span<const base::Vec2> strains, double time = 0);

// Table through points; S1(a, b) = S2(b, a) is built in: a point stands for its mirror image. No stress without strain
// is built in, too. The data end at their convex hull, widened by a square about zero of a twentieth of the largest
// strain (within the range), in which the penalty of smoothing continues them linearly.
// Throws std::invalid_argument where the points do not determine it (all of them with equal strains, say).
PdFit fit_pd_nurbs(std::span<const StressPoint> points, const NurbsOptions& options);

// Table of an isotropic law in a range of strains, that of its material without tension field. Of a law that yields it
// is a YieldTable, unless the stresses are fitted apart. Points, where given, count more than the law, which fills what
// they leave open; beside a YieldTable a surface follows what the points add to it. The report is then of them alone.
PdFit fit_pd_nurbs(const Law& law, const NurbsOptions& options, double time = 0,
                   std::span<const StressPoint> points = {});

// Tables through points along material axes.
LeFit fit_le_nurbs(std::span<const StressPoint> points, std::span<const ShearPoint> shear, const NurbsOptions& options);

// Tables of a law along its axes: at E12 = 0, and in shear without other strain, up to the shear of both ends of the
// range of strains.
LeFit fit_le_nurbs(const Law& law, const NurbsOptions& options, double time = 0);

// Distinct knots of a table between two strains, `spans` + 1 of them: in logarithmic strain equal spans, which beyond
// `knee` grow in proportion to the strain.
std::vector<double> strain_breaks(StrainRange range, int spans, std::optional<double> knee);

} // namespace pneuma::solver::material
