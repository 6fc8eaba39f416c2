// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::solver::recovery {

using base::Index;
using base::Vec3;

// Force per length along the edges from the consistent nodal forces on them: the L2 projection on the edge's own shape
// functions, solved over the whole ring of edges. `forces` [3 node + component], N; result one vector a rim node in the
// order of `nodes`, N/m. The edges of the mesh follow each other and close.
struct LineLoad {
  std::vector<Index> nodes;
  std::vector<Vec3> load; // N/m
};
LineLoad line_load(const geometry::Mesh& mesh, std::span<const Vec3> positions, std::span<const double> forces);

} // namespace pneuma::solver::recovery
