// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geometry/meshing/plan_mesh.h"

namespace pneuma::geometry::meshing {

// The divisions asked for, or those that make sides of elements at most `size` long. From a size, triangles get even
// numbers on grids, so that their pattern is symmetric, and quadrilaterals elsewhere, where they need them.
// Throws InputError for options that contradict each other or make no mesh.
std::array<int, 2> divisions_of(const Plan& plan, const MeshOptions& options);

} // namespace pneuma::geometry::meshing
