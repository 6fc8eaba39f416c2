// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/triangulation.h"

namespace pneuma::geometry::flattening {

using base::Vec2;

// Plane coordinates of every vertex of a surface with one boundary by a least squares conformal map (Levy et al. 2002,
// CGAL's parameterisation), oriented as the surface, scaled to its area, centre of area at the origin. Every vertex
// belongs to a triangle. The start of the mechanical optimum: angles are kept, lengths only nearly.
// Throws GeometryError with the place where a triangle comes out turned over, or none is found.
std::vector<Vec2> conformal(const Triangulation& surface);

} // namespace pneuma::geometry::flattening
