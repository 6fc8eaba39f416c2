// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/outline.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "geometry/polygon.h"

namespace pneuma::geometry {

namespace {

std::string length_fault(const char* name, double value) {
  if (std::isfinite(value) && value > 0) return {};
  return fmt::format("the {} must be positive, not {} m", name, value);
}

double length_around(const std::vector<Vec2>& ring) {
  double length = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) length += (ring[(k + 1) % ring.size()] - ring[k]).norm();
  return length;
}

std::string ring_fault(const std::vector<Vec2>& ring) {
  const std::size_t n = ring.size();
  if (n < 3) return fmt::format("a polygon needs three points at least, not {}", n);
  const double around = length_around(ring);
  if (!std::isfinite(around)) return "a point of the outline is not finite";
  const auto place = [&](std::size_t k) { return fmt::format("({:.6g}, {:.6g})", ring[k].x(), ring[k].y()); };
  constexpr double nothing = 1e-9; // what rounding in a drawing program leaves between equal points
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    if ((ring[next] - ring[k]).norm() > nothing * around) continue;
    return fmt::format("the points {} and {} of the outline are the same, {}; leave one out", k + 1, next + 1,
                       place(k));
  }
  if (const auto sides = crossing_sides(ring)) {
    const auto [a, b] = *sides;
    return fmt::format("the outline crosses or touches itself: its edges e{} from {} and e{} from {} meet", a + 1,
                       place(a), b + 1, place(b));
  }
  // an equilateral triangle has area / perimeter^2 = 0.048
  const double inside = std::abs(signed_area(ring));
  if (!(inside > 1e-4 * around * around)) {
    return fmt::format("the points of the outline lie on a line, or nearly so (area {:.3g} m2 with a perimeter of "
                       "{:.3g} m)",
                       inside, around);
  }
  return {};
}

} // namespace

Triangle equilateral(double side) {
  const double height = side * std::sqrt(3.0) / 2;
  return {{{-side / 2, -height / 3}, {side / 2, -height / 3}, {0, 2 * height / 3}}};
}

std::vector<std::string> edge_names(const Plan& plan) {
  if (std::holds_alternative<Rectangle>(plan)) return {"south", "east", "north", "west"};
  if (std::holds_alternative<Circle>(plan)) return {"rim"};
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= corner_points(plan).size(); ++k) names.push_back(fmt::format("e{}", k));
  return names;
}

std::vector<base::Vec2> corner_points(const Plan& plan) {
  if (std::holds_alternative<Circle>(plan)) return {};
  if (const auto* rectangle = std::get_if<Rectangle>(&plan)) {
    const double x = rectangle->length / 2;
    const double y = rectangle->width / 2;
    return {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  }
  if (const auto* polygon = std::get_if<Polygon>(&plan)) return polygon->points;
  const auto& points = std::get<Triangle>(plan).points;
  return {points[0], points[1], points[2]};
}

std::string plan_fault(const Plan& plan) {
  if (const auto* rectangle = std::get_if<Rectangle>(&plan)) {
    const std::string fault = length_fault("length", rectangle->length);
    return fault.empty() ? length_fault("width", rectangle->width) : fault;
  }
  if (const auto* circle = std::get_if<Circle>(&plan)) return length_fault("radius", circle->radius);
  return ring_fault(corner_points(plan));
}

LocalFrame::LocalFrame(const Plan& plan) {
  const std::vector<Vec2> corners = corner_points(plan);
  if (corners.empty()) return;
  Vec2 sum(0, 0);
  double size = 0;
  for (const Vec2& corner : corners) {
    sum += corner - corners.front();
    size = std::max(size, (corner - corners.front()).norm());
  }
  const Vec2 centre = sum / static_cast<double>(corners.size());
  if ((corners.front() + centre).norm() <= 1e-12 * size) return;
  corner_ = corners.front();
  centre_ = centre;
}

Plan to_local(const Plan& plan, const LocalFrame& frame) {
  Plan moved = plan;
  if (auto* triangle = std::get_if<Triangle>(&moved)) {
    for (Vec2& point : triangle->points) point = frame.to_local(point);
  } else if (auto* polygon = std::get_if<Polygon>(&moved)) {
    for (Vec2& point : polygon->points) point = frame.to_local(point);
  }
  return moved;
}

double area(const Plan& plan) {
  if (const auto* r = std::get_if<Rectangle>(&plan)) return r->length * r->width;
  if (const auto* c = std::get_if<Circle>(&plan)) return std::numbers::pi * c->radius * c->radius;
  return std::abs(signed_area(corner_points(plan)));
}

double perimeter(const Plan& plan) {
  if (const auto* r = std::get_if<Rectangle>(&plan)) return 2 * (r->length + r->width);
  if (const auto* c = std::get_if<Circle>(&plan)) return 2 * std::numbers::pi * c->radius;
  return length_around(corner_points(plan));
}

} // namespace pneuma::geometry
