// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry::meshing {

using base::Index;
using base::Vec2;

// The inside of a polygon, filled with triangles, or with quadrilaterals and the triangles that are left over.
struct Filling {
  std::vector<Vec2> points; // those of the ring first, in its order
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<Index, 4>> quadrilaterals;
};

// Fills a simple polygon given counterclockwise; the ring's points and sides are kept as they are, and elements grow
// from the sides' lengths. Frontal-Delaunay triangles (gmsh's algorithm 6), joined in pairs for quadrilaterals (by
// Blossom up to 10 000, then greedily). The same input gives the same mesh. One call at a time works, others wait.
// Throws GeometryError where the ring runs clockwise or crosses itself, or gmsh finds no mesh.
Filling fill(std::span<const Vec2> ring, bool quadrilaterals);

} // namespace pneuma::geometry::meshing
