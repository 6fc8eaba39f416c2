// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/mesh.h"

namespace pneuma::geometry {

// Measures of a block's surface at given positions of all nodes of its mesh (m), interpolated by the shape functions.

double surface_area(const Mesh& mesh, const Block& block, std::span<const Vec3> positions); // m2

// The place (xi, eta) of an element, and the outward normal there (of length one; zero where the element has no area).
Vec3 point_on(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, Index element, double xi,
              double eta);
Vec3 normal_at(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, Index element, double xi,
               double eta);

struct Plane {
  Vec3 point;
  Vec3 normal; // of length one
  double distance(const Vec3& x) const { return normal.dot(x - point); }
};

// The plane with the least sum of squared distances from the nodes of all edges, its normal towards the weather side
// (in which the edges run counterclockwise). Throws GeometryError where the edges lie on a line.
Plane edge_plane(const Mesh& mesh, std::span<const Vec3> positions);

struct DeepestPoint {
  double distance = 0; // m, from the plane, to whichever side it is larger; never negative
  Vec3 at = Vec3::Zero();
  Index element = 0;
  double xi = 0, eta = 0;
};

// The point of the interpolated surface, not only its nodes, that lies farthest from a plane: with edge_plane, the sag.
DeepestPoint deepest_point(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, const Plane& plane);

struct Box {
  Vec3 low, high;
};

Box bounding_box(std::span<const Vec3> positions);

// Longest side of the bounding box, m.
double span_of(std::span<const Vec3> positions);

} // namespace pneuma::geometry
