// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/chart.h"
#include "geometry/outline.h"
#include "geometry/triangulation.h"

namespace pneuma::geometry::strips {

// A line along which a foil is cut, from rim to rim.
struct CuttingLine {
  double from = 0, to = 0; // positions on the rim, m
  std::vector<Vec2> plan;  // in plan, from one end to the other; ends on the rim
  double length = 0;       // on the surface, m
};

// A form-found foil, made ready for finding lines on it.
struct Surface {
  Plan plan;
  Chart chart;
  Triangulation fine;   // the mesh itself, quadratic elements divided in two a side
  Triangulation coarse; // at most some thousand triangles, all on the surface: for the exact search
  double size = 0;      // mean side of its elements in plan, m
};

// Throws GeometryError where the surface is no graph over the plan.
Surface prepare(const Plan& plan, const Mesh& mesh, const Block& block, std::span<const Vec3> positions);

// The shortest line on the surface between two positions on the rim: exact on the coarse copy (CGAL), relaxed on the
// fine one from both sides, and their middle: at most 1e-5 longer than the shortest line on the triangles, and
// symmetric where the surface is. Throws GeometryError with the place where the line runs along the rim or cannot be
// found.
CuttingLine geodesic_line(const Surface& surface, double from, double to);

// The line that is straight in plan. Throws GeometryError with the place where it leaves the plan.
CuttingLine straight_line(const Surface& surface, double from, double to);

// A line through given points in plan; its ends must lie on the rim within a tenth of an element's size (they are put
// there), the rest inside. Throws GeometryError with the place, and what would work.
CuttingLine given_line(const Surface& surface, std::span<const Vec2> points);

// Lines that cross or touch each other, with the place; empty if none do.
std::string crossing(std::span<const CuttingLine> lines);

} // namespace pneuma::geometry::strips
