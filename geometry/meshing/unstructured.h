// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/meshing/corner_mesh.h"
#include "geometry/meshing/plan_mesh.h"

namespace pneuma::geometry::meshing {

// Free pattern inside an evenly divided rim. Triangles come from gmsh as they are, but for those held at all corners;
// quadrilaterals from a mesh of twice the size, whose elements are each divided into three or four: so that none is a
// triangle, whatever gmsh leaves over. The points of a triangle or polygon run counterclockwise.
CornerMesh unstructured_mesh(const Plan& plan, const MeshOptions& options);

} // namespace pneuma::geometry::meshing
