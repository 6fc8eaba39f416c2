// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/outline.h"

#include <cmath>
#include <numbers>

namespace pneuma::geometry {

Triangle equilateral(double side) {
  const double height = side * std::sqrt(3.0) / 2;
  return {{{-side / 2, -height / 3}, {side / 2, -height / 3}, {0, 2 * height / 3}}};
}

std::vector<std::string> edge_names(const Plan& plan) {
  if (std::holds_alternative<Rectangle>(plan)) return {"south", "east", "north", "west"};
  if (std::holds_alternative<Circle>(plan)) return {"rim"};
  return {"e1", "e2", "e3"};
}

double area(const Plan& plan) {
  if (const auto* r = std::get_if<Rectangle>(&plan)) return r->length * r->width;
  if (const auto* c = std::get_if<Circle>(&plan)) return std::numbers::pi * c->radius * c->radius;
  const auto& p = std::get<Triangle>(plan).points;
  const base::Vec2 a = p[1] - p[0];
  const base::Vec2 b = p[2] - p[0];
  return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
}

double perimeter(const Plan& plan) {
  if (const auto* r = std::get_if<Rectangle>(&plan)) return 2 * (r->length + r->width);
  if (const auto* c = std::get_if<Circle>(&plan)) return 2 * std::numbers::pi * c->radius;
  const auto& p = std::get<Triangle>(plan).points;
  return (p[1] - p[0]).norm() + (p[2] - p[1]).norm() + (p[0] - p[2]).norm();
}

} // namespace pneuma::geometry
