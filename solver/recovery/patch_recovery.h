// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/quadrature.h"

namespace pneuma::solver::recovery {

using base::Index;
using base::Vec3;

// Values at the nodes from values at the stress points, [element][point][component], by superconvergent patch recovery
// (Zienkiewicz and Zhu 1992): around each inner corner node a polynomial of the element's degree is fitted in the
// tangent plane; nodes on sides, in centres and on the rim take the mean of the patches that reach them. Returns
// [node][component] for all nodes of the mesh; 0 where the block has no node.
std::vector<double> recover_at_nodes(const geometry::Mesh& mesh, const geometry::Block& block,
                                     geometry::StressRule rule, std::span<const Vec3> positions,
                                     std::span<const double> values, int components);

} // namespace pneuma::solver::recovery
