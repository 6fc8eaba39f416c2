// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/plan_region.h"
#include "solver/assembly/model.h"

namespace pneuma::solver::load {

using base::Index;
using base::Vec3;
using base::VecX;

// Adds the consistent nodal forces of a dead load `per_plan_area` (N/m2, any direction) on a region of a block at
// `positions`: snow, or a patch. force [3 node + component], N.
void add_plan_load(const geometry::Mesh& mesh, Index block, std::span<const Vec3> positions,
                   const geometry::RegionQuadrature& region, const Vec3& per_plan_area, VecX& force);

// A region of a block for a follower pressure along its positive normal, without its pressure yet.
assembly::PressureZone pressure_zone(const geometry::Mesh& mesh, Index block, const geometry::RegionQuadrature& region);

} // namespace pneuma::solver::load
