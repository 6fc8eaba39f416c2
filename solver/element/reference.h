// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/quadrature.h"

namespace pneuma::solver::element {

using base::Index;
using base::Vec3;
using geometry::ElementType;
using geometry::StressRule;

// The pivot of the mechanics: at each stress point the derivatives of the shape functions with respect to an
// orthonormal material frame, and the area that the point stands for. Where it came from (a form-found surface, flat
// strips, with or without predeformation) the kernels do not know.
struct Reference {
  ElementType element = ElementType::T3;
  StressRule rule = StressRule::full;
  Index points = 0;                // per element
  std::vector<double> derivatives; // [element][point][node][2], 1/m
  std::vector<double> area;        // [element][point], m2

  Index element_count() const { return points == 0 ? 0 : static_cast<Index>(area.size()) / points; }
};

// Reference from coordinates per element corner [element][node][3], m: the frame's first axis is `warp` projected on
// the surface, the second lies 90 degrees to its left seen against the normal. `predeformation` [element][point][3] =
// (G11, G22, G12) in that frame, or empty: the stress-free shape is the given one deformed by G^-1.
// Throws GeometryError with the place where an element is degenerate or `warp` is normal to the surface.
Reference make_reference(ElementType element, StressRule rule, std::span<const double> coordinates, const Vec3& warp,
                         std::span<const double> predeformation = {});

// Coordinates per element corner of a welded mesh: every element sees its nodes' positions.
std::vector<double> corner_coordinates(std::span<const Index> connectivity, std::span<const Vec3> positions);

} // namespace pneuma::solver::element
