// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::solver::recovery {

using base::Index;
using base::Vec3;

// Force per length along the edges from the consistent nodal forces on them: the L2 projection on each edge's own shape
// functions. `forces` [3 node + component], N. Where two edges meet, the corner's force belongs to both in unknown
// parts: it is left out, and the load there goes on linearly from the edge's next two nodes. Edges of at least three
// nodes.
struct LineLoad {
  std::vector<Index> nodes; // edge after edge; a corner stands once for each of its edges
  std::vector<Vec3> load;   // N/m, of the same entry
};
LineLoad line_load(const geometry::Mesh& mesh, std::span<const Vec3> positions, std::span<const double> forces);

} // namespace pneuma::solver::recovery
