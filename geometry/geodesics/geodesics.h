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

// Relaxes a line to the nearest local minimum of length on the triangles: the points slide on the sides that the line
// crosses (a convex problem for a given sequence of sides, Newton's method), and where it runs into a vertex the line
// is led around the other side of it if that is shorter, until nothing changes. `start`: a line in plan from vertex
// `from` to vertex `to`, near the wanted one; the surface must be a graph over the plan.
Path relaxed(const Triangulation& surface, Index from, Index to, const std::vector<base::Vec2>& start);

} // namespace pneuma::geometry::geodesics
