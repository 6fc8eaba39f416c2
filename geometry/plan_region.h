// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "geometry/outline.h"
#include "geometry/polygon.h"
#include "geometry/quadrature.h"

namespace pneuma::geometry {

// Part of a plan (x, y), m.
struct WholePlan {};
struct PlanRectangle {
  Vec2 low, high;
};
struct PlanPolygon {
  std::vector<Vec2> points; // simple, of either orientation, not necessarily convex
};
using PlanRegion = std::variant<WholePlan, PlanRectangle, PlanPolygon>;

// The smallest rectangle around a plan.
PlanRectangle extent(const Plan& plan);

// Area of the part of a region that lies in a plan, m2; the rim of a circle is taken 5e-6 of its radius too far out.
// Throws GeometryError as region_quadrature does.
double area_inside(const Plan& plan, const PlanRegion& region);

// Points for integrals over the part of a block that lies in a region. The weights are areas of the reference element:
// times the Jacobian of the plan or of the surface they give integrals over either.
struct RegionQuadrature {
  struct Part {
    Index element;
    std::size_t first, count; // its points
    bool whole;               // lies in the region entirely; its points are those of pressure_rule
  };
  std::vector<Part> parts; // of the elements that lie in the region or reach into it, in ascending order
  std::vector<QuadraturePoint> points;

  std::span<const QuadraturePoint> points_of(const Part& part) const {
    return std::span(points).subspan(part.first, part.count);
  }
};

// The region at the given positions of all nodes of the mesh (m). Exact where elements are affine in plan (straight
// triangles with mid-nodes in the middle, parallelograms) for integrands that pressure_rule integrates exactly;
// elsewhere the boundary of the region is followed by chords over an eighth of an element. Region and rest always sum
// to the whole. Throws GeometryError where a rectangle or polygon has no area or crosses itself.
RegionQuadrature region_quadrature(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                                   const PlanRegion& region);

// Area in plan of the region, m2: what is folded over counts negative.
double plan_area(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                 const RegionQuadrature& quadrature);

} // namespace pneuma::geometry
