// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/triangulation.h"

namespace pneuma::geometry::geodesics {

// A line on a surface from point to point, straight within each triangle it passes.
struct Path {
  std::vector<Vec3> points;
  double length = 0; // m
};

// The shortest path between two vertices, exact on the triangles (CGAL, Xin and Wang's variant of Chen and Han's
// algorithm; its time grows with the square of their number). Throws GeometryError where none leads from one to the
// other.
Path shortest_path(const Triangulation& surface, Index from, Index to);

// The locally shortest line near a given one, exact on the triangles: the shortest within the strip of triangles that
// the line passes (unfolded, funnel algorithm of Lee and Preparata 1984: the minimum of the convex length over the
// points on the sides crossed), which is led around the other side of every vertex it bends at where that is shorter,
// until it bends at none (Xin and Wang 2007). The time grows with the number of triangles. `start`: a line in plan from
// vertex `from` to vertex `to`, near the wanted one; the surface must be a graph over the plan. Throws GeometryError
// where the triangles below the start do not hang together.
Path relaxed(const Triangulation& surface, Index from, Index to, const std::vector<base::Vec2>& start);

} // namespace pneuma::geometry::geodesics
