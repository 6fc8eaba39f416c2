// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

// A surface of flat triangles, oriented alike.
struct Triangulation {
  std::vector<Vec3> points; // m
  std::vector<std::array<Index, 3>> triangles;
};

// A block's surface as triangles: the sides of every element in `parts` equal parts in its own coordinates, all points
// on the interpolated surface. Points that are nodes of corners come once. parts >= 1.
Triangulation triangulated(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, int parts);

} // namespace pneuma::geometry
