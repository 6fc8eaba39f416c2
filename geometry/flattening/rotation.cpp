// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/flattening/rotation.h"

#include <cmath>

namespace pneuma::geometry::flattening {

namespace {

Vec2 centre_of(std::span<const Vec2> points) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

} // namespace

std::vector<Vec2> laid_over(std::span<const Vec2> points, std::span<const Vec2> targets) {
  const Vec2 from = centre_of(points);
  const Vec2 to = centre_of(targets);
  double along = 0;
  double across = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 p = points[i] - from;
    const Vec2 t = targets[i] - to;
    along += p.dot(t);
    across += p.x() * t.y() - p.y() * t.x();
  }
  const Eigen::Rotation2Dd turn(std::atan2(across, along));
  std::vector<Vec2> result;
  result.reserve(points.size());
  for (const Vec2& p : points) result.emplace_back(to + turn * (p - from));
  return result;
}

} // namespace pneuma::geometry::flattening
