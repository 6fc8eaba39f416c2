// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/triangulation.h"

namespace pneuma::geometry::strips {

// One strip as triangles between its nodes (mid-side nodes too), for a parameterisation.
struct StripSurface {
  Triangulation surface;
  std::vector<Index> nodes; // number of each vertex in the given connectivity
};

StripSurface strip_surface(ElementType element, std::span<const Index> connectivity,
                           std::span<const Index> strip_of_element, Index strip, std::span<const Vec3> positions);

} // namespace pneuma::geometry::strips
