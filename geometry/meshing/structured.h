// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/meshing/corner_mesh.h"
#include "geometry/meshing/plan_mesh.h"

namespace pneuma::geometry::meshing {

// Regular pattern, the same on both sides of each axis for even divisions. Rectangle: a grid. Circle: a core block with
// rings around it. Triangle: similar triangles, or three blocks of quadrilaterals around the centroid (points
// counterclockwise).
CornerMesh structured_mesh(const Plan& plan, const MeshOptions& options);

} // namespace pneuma::geometry::meshing
