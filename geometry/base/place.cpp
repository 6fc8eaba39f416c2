// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/place.h"

#include <cmath>

#include <fmt/format.h>

namespace pneuma::geometry::base {

namespace {

Vec3& origin() {
  static Vec3 from(0, 0, 0);
  return from;
}

std::string coordinate(int axis, double local) {
  const double value = origin()[axis] + local;
  return std::abs(value) < 1e4 ? fmt::format("{:.6g}", value) : fmt::format("{:.3f}", value); // to a millimetre
}

} // namespace

std::string place_text(const Vec2& place) {
  return fmt::format("({}, {})", coordinate(0, place.x()), coordinate(1, place.y()));
}

std::string place_text(const Vec3& place) {
  return fmt::format("({}, {}, {})", coordinate(0, place.x()), coordinate(1, place.y()), coordinate(2, place.z()));
}

void tell_places_from(const Vec3& place) {
  origin() = place;
}

} // namespace pneuma::geometry::base
