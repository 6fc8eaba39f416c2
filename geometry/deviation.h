// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

// How far a block's surface lies from where it was meant to be.
struct Deviation {
  double max = 0;  // m, largest distance
  double mean = 0; // m, mean of the distances over the area
  Vec3 at = Vec3::Zero();
};

// Distances of the surface at `now` from the same mesh's surface at `target`, measured along the normal of the target:
// from nodes and pressure points to the foot on the target element they belong to, extended over its sides (the
// surface may slide along itself by less than an element). Positions of all nodes of the mesh, m.
Deviation normal_deviation(const Mesh& mesh, const Block& block, std::span<const Vec3> target,
                           std::span<const Vec3> now);

} // namespace pneuma::geometry
