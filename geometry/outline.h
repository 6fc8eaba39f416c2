// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry {

// Plans of a cushion, in the plane z = 0. Rectangle and circle are centred on the origin, x along the length.

struct Rectangle {
  double length, width; // m; edges south (y-), east (x+), north (y+), west (x-)
};

struct Circle {
  double radius; // m; edge rim
};

struct Triangle {
  base::Vec2 points[3]; // m, any orientation; edges e1 (points 0-1), e2 (1-2), e3 (2-0)
};

struct Polygon {
  std::vector<base::Vec2> points; // m, any orientation; edges e1 (points 0-1) ... en (last point-0); simple
};

using Plan = std::variant<Rectangle, Circle, Triangle, Polygon>;

// An equilateral triangle centred on the origin, its first side parallel to x at negative y.
Triangle equilateral(double side);

// Edge names in the order of the outline.
std::vector<std::string> edge_names(const Plan& plan);

// Corners in the order of the edges, each the start of one, m; a circle has none.
std::vector<base::Vec2> corner_points(const Plan& plan);

// What keeps a plan from being a region (a length that is not positive, points on a line, sides that cross), with the
// place; empty: nothing.
std::string plan_fault(const Plan& plan);

double area(const Plan& plan);      // m2
double perimeter(const Plan& plan); // m

} // namespace pneuma::geometry
