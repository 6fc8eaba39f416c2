// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "geometry/nurbs/curve.h"

namespace pneuma::geometry::nurbs {

// NURBS surface in D dimensions over the parameters u and v; a tensor product of B-splines where no weights are given.
// With D = 1 it is a function of its parameters.
template <int D>
struct Surface {
  Knots u, v;
  std::vector<Point<D>> points; // [function of u][function of v]
  std::vector<double> weights;  // as points, > 0, or none
};

// Throws std::invalid_argument where knots, points and weights do not fit each other.
template <int D>
void check(const Surface<D>& surface);

template <int D>
struct SurfaceJet {
  Point<D> value, u, v, uu, uv, vv; // with derivatives by the parameters
};

// Value and derivatives (Piegl and Tiller 1997, eq. 4.20). Beyond the borders the basis functions go on as parabolas.
template <int D>
SurfaceJet<D> evaluate(const Surface<D>& surface, double u, double v) noexcept;

// The parameters at which the first two coordinates of a surface (D >= 2) are `place`, to rounding: Newton downhill on
// the distance, from the nearest of the control net's places and, where that ends elsewhere, from the others in turn;
// with control points at the Greville abscissae the coordinates are the parameters and the first step hits. None if no
// start leads there: the place lies beside the surface or the surface is folded.
template <int D>
std::optional<base::Vec2> parameters_at(const Surface<D>& surface, const base::Vec2& place);

} // namespace pneuma::geometry::nurbs
