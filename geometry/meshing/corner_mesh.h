// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/base/types.h"
#include "geometry/mesh.h"
#include "geometry/polygon.h"

namespace pneuma::geometry::meshing {

using base::Vec2;

// A mesh of a plan reduced to its corners: what the meshers make, and what mesh_plan completes with mid-side nodes.
struct CornerMesh {
  int corners = 3; // per cell: 3 or 4, counterclockwise
  std::vector<Vec2> points;
  std::vector<Index> cells; // [cell][corner]
  // points on each edge of the plan, counterclockwise, both ends included; a single edge is closed, without a repeated
  // end
  std::vector<std::vector<Index>> edges;

  std::size_t cell_count() const { return cells.size() / static_cast<std::size_t>(corners); }
};

// Which points lie on an edge of the plan.
std::vector<bool> on_rim(const CornerMesh& mesh);

// Removes interior edges of triangles that join two points of the rim, by swapping them or, where that would make a
// needle, by splitting them. Then no triangle is held at all its corners, and stacked foils share no interior edge.
void release_rim(CornerMesh& mesh);

} // namespace pneuma::geometry::meshing
