// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "geometry/meshing/plan_mesh.h"

namespace pneuma::geometry::meshing {

// The divisions asked for, or those that make sides of elements at most `size` long. A size gives even numbers: on
// grids for a symmetric pattern with a node in the middle, and elsewhere for quadrilaterals, which need them.
// Throws InputError for options that contradict each other or make no mesh.
std::array<int, 2> divisions_of(const Plan& plan, const MeshOptions& options);

// Length of the longest side of a polygon, m.
double longest_side(std::span<const base::Vec2> ring);

} // namespace pneuma::geometry::meshing
