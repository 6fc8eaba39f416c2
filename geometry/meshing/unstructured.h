// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/meshing/corner_mesh.h"
#include "geometry/meshing/plan_mesh.h"

namespace pneuma::geometry::meshing {

// Free pattern inside an evenly divided rim. The points of a triangle or polygon run counterclockwise.
CornerMesh unstructured_mesh(const Plan& plan, const MeshOptions& options);

} // namespace pneuma::geometry::meshing
