// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/meshing/corner_mesh.h"

namespace pneuma::geometry::meshing {

// The inside of a simple polygon, given counterclockwise, in elements with 3 or 4 corners; the ring's points come first
// and its sides are kept. `edges`: its points on edges of the plan; no side inside joins two of them, and no element is
// held at all its corners, if none of the ring's other sides joins two. Triangles come from gmsh, but for those held;
// quadrilaterals from a mesh of twice the size (every second point of the ring: an even number, corners among them),
// whose elements are each divided around their centre: so that none is a triangle, whatever gmsh leaves over.
// Throws GeometryError as `fill` does.
CornerMesh filled(std::span<const Vec2> ring, std::vector<std::vector<Index>> edges, int corners);

} // namespace pneuma::geometry::meshing
