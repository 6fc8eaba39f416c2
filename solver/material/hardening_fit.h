// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solver/material/hardening.h"

namespace pneuma::solver::material {

// A point of a uniaxial test without unloading, in the measures of the law that is fitted: logarithmic strain and
// Kirchhoff stress, or Green-Lagrange strain and second Piola-Kirchhoff stress: there the curve of J2 plasticity with
// piecewise-linear hardening is itself piecewise linear.
struct CurvePoint {
  double strain = 0; // -
  double stress = 0; // Pa
  double weight = 1; // of the squared stress difference
};

struct HardeningFit {
  double youngs_modulus = 0;             // Pa
  std::vector<HardeningBranch> branches; // plastic moduli; fewer than asked for where more fit noise
  double cost = 0;                       // sum of weight x squared difference, Pa2

  double stress_at(double strain) const; // Pa
};

// The polygon through the origin with `branches` free corners that is nearest to the points, least squares: slopes by
// non-negative least squares for given corners (Lawson and Hanson 1974), corners put in one by one where they help
// most, then moved by Gauss-Newton (Muggeo 2003, Statistics in Medicine 22) and, where that ends, one by one. The curve
// rises, less steeply than the elastic line; the last branch may be level, those before it, with `softening`, fall. A
// polygon that no move of a single corner betters; that none is better at all is not proved. Nothing where the points
// cannot carry as many unknowns: fewer than 2 branches + 1 different strains above 0, or no such polygon; and where
// they lie on one line: nothing yields.
std::optional<HardeningFit> fit_hardening(std::span<const CurvePoint> points, int branches, bool softening = false);

} // namespace pneuma::solver::material
