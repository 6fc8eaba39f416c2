// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "geometry/nurbs/knots.h"

namespace pneuma::geometry::nurbs {

template <int D>
using Point = Eigen::Matrix<double, D, 1>;

// NURBS curve in D dimensions, sum N_i w_i P_i / sum N_i w_i; a B-spline where no weights are given. With D = 1 it is a
// function of its parameter.
template <int D>
struct Curve {
  Knots knots;
  std::vector<Point<D>> points; // [function]
  std::vector<double> weights;  // [function] > 0, or none
};

// Throws std::invalid_argument where knots, points and weights do not fit each other.
template <int D>
void check(const Curve<D>& curve);

template <int D>
struct CurveJet {
  Point<D> value, first, second; // with derivatives by the parameter
};

// Value and derivatives (Piegl and Tiller 1997, eq. 4.8). Beyond the ends the basis functions go on as parabolas.
template <int D>
CurveJet<D> evaluate(const Curve<D>& curve, double u) noexcept;

// The parameter at which a coordinate that rises or falls all along the curve has a value, to rounding: Newton in a
// bracket; with control points at the Greville abscissae the coordinate is the parameter and the first step hits. None
// if the value lies beyond the curve's ends.
template <int D>
std::optional<double> parameter_at(const Curve<D>& curve, int coordinate, double value);

} // namespace pneuma::geometry::nurbs
