// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/triangulation.h"

namespace pneuma::geometry::flattening {

using base::Vec2;

// Plane coordinates of every vertex of a surface with one boundary (CGAL's parameterisations), same orientation,
// scaled to the surface's area, centre of area at the origin. Vertices that belong to no triangle are not allowed.
// Throws GeometryError where none is found or a triangle comes out turned over.

// Least squares conformal maps (Levy et al. 2002).
std::vector<Vec2> conformal(const Triangulation& surface);

// As rigid as possible (Liu et al. 2008): what most tools cut by, for comparison.
std::vector<Vec2> as_rigid_as_possible(const Triangulation& surface);

} // namespace pneuma::geometry::flattening
