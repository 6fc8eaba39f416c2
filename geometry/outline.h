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

// What keeps a ring of points from bounding a region (fewer than three points, two at one place, sides that cross or
// touch, points on a line), with the place; `side`: what a side is called ("edge" of e1, e2, ...). Empty: nothing.
std::string ring_fault(const std::vector<base::Vec2>& ring, const std::string& side);

// A ring whose last point may repeat the first, without it.
std::vector<base::Vec2> opened(std::vector<base::Vec2> ring);

// What keeps a plan from being a region (a length that is not positive, a ring at fault, an edge shorter than a
// thousandth of the plan), with the edge and its place; empty: nothing.
std::string plan_fault(const Plan& plan);

// Coordinates about a plan's own centre, the mean of its corners, so that no rounding depends on where it lies: plans
// that differ by an offset get the same bits where the differences of their corners are exact. A plan that is centred
// on the origin stays where it is.
class LocalFrame {
public:
  LocalFrame() = default; // the user's own coordinates
  explicit LocalFrame(const Plan& plan);
  base::Vec2 to_local(const base::Vec2& point) const { return (point - corner_) - centre_; }
  base::Vec2 to_user(const base::Vec2& point) const { return (point + centre_) + corner_; }
  base::Vec2 origin() const { return corner_ + centre_; } // in the user's coordinates, m

private:
  base::Vec2 corner_{0, 0}; // the plan's first
  base::Vec2 centre_{0, 0}; // seen from there
};
Plan to_local(const Plan& plan, const LocalFrame& frame);

double area(const Plan& plan);      // m2
double perimeter(const Plan& plan); // m

} // namespace pneuma::geometry
