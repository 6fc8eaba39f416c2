// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/outline.h"

namespace pneuma::geometry {

using base::Vec2;

// The outline of a plan as a curve, counterclockwise from the first point of its first edge (a circle: from its point
// at +x); positions on it are arc lengths, m, in [0, perimeter).

Vec2 rim_point(const Plan& plan, double position);

// Position of the rim's point nearest to a place.
double rim_position(const Plan& plan, const Vec2& place);

// Positions of the corners, ascending, each the start of an edge; {0} for a circle.
std::vector<double> rim_corners(const Plan& plan);

// The edges that begin at these corners, by their places in edge_names(plan): a plan given clockwise has the first edge
// first, but the others the other way round.
std::vector<std::size_t> rim_edges(const Plan& plan);

// Where a line through `through` with direction `along` (any length) crosses the rim: positions in the order along the
// line. Touching a corner or running along an edge is no crossing; passing through a corner is one.
std::vector<double> rim_crossings(const Plan& plan, const Vec2& through, const Vec2& along);

// Whether a place lies inside, or on the rim within `tolerance`, m.
bool inside(const Plan& plan, const Vec2& place, double tolerance);

} // namespace pneuma::geometry
