// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/outline.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "geometry/base/place.h"
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

constexpr double nothing = 1e-9; // of the way around: what rounding in a drawing program leaves between equal points

// An edge that no mesh of the whole could follow.
std::string short_edge(const Plan& plan) {
  constexpr double least = 1e-3;
  const std::vector<Vec2> ring = corner_points(plan);
  double size = 0;
  for (const Vec2& point : ring) size = std::max(size, (point - ring.front()).norm());
  const std::vector<std::string> names = edge_names(plan);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2& next = ring[(k + 1) % ring.size()];
    const double length = (next - ring[k]).norm();
    if (length >= least * size) continue;
    return fmt::format("the edge {} from {} to {} is {:.3g} m long, less than a thousandth of the plan ({:.3g} m); "
                       "leave one of its ends out",
                       names[k], base::place_text(ring[k]), base::place_text(next), length, size);
  }
  return {};
}

} // namespace

std::string ring_fault(const std::vector<Vec2>& ring, const std::string& side) {
  const std::size_t n = ring.size();
  if (n < 3) return fmt::format("the outline needs three points at least, not {}", n);
  const double around = length_around(ring);
  if (!std::isfinite(around)) return "a point of the outline is not finite";
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    if ((ring[next] - ring[k]).norm() > nothing * around) continue;
    return fmt::format("the {} e{} has no length: the points {} and {} are the same, {}; leave one out", side, k + 1,
                       k + 1, next + 1, base::place_text(ring[k]));
  }
  if (const auto sides = crossing_sides(ring)) {
    const auto [a, b] = *sides;
    return fmt::format("the outline crosses or touches itself: its {0}s e{1} from {2} and e{3} from {4} meet", side,
                       a + 1, base::place_text(ring[a]), b + 1, base::place_text(ring[b]));
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

std::vector<Vec2> opened(std::vector<Vec2> ring) {
  if (ring.size() > 1 && (ring.back() - ring.front()).norm() <= nothing * length_around(ring)) ring.pop_back();
  return ring;
}

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
  if (const auto* circle = std::get_if<Circle>(&plan)) return length_fault("radius", circle->radius);
  std::string fault;
  if (const auto* rectangle = std::get_if<Rectangle>(&plan)) {
    fault = length_fault("length", rectangle->length);
    if (fault.empty()) fault = length_fault("width", rectangle->width);
  } else {
    fault = ring_fault(corner_points(plan), "edge");
  }
  return fault.empty() ? short_edge(plan) : fault;
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
