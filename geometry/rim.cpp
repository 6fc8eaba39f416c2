// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/rim.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geometry/polygon.h"

namespace pneuma::geometry {

namespace {

// Corners counterclockwise, the first edge of the plan first: run backwards, it begins at its second point.
std::vector<Vec2> corners_of(const Plan& plan) {
  std::vector<Vec2> corners = corner_points(plan);
  if (!corners.empty() && signed_area(corners) < 0) {
    std::reverse(corners.begin(), corners.end());
    std::rotate(corners.begin(), corners.end() - 2, corners.end());
  }
  return corners;
}

const Vec2& next(const std::vector<Vec2>& corners, std::size_t k) {
  return corners[(k + 1) % corners.size()];
}

std::vector<double> starts_of(const std::vector<Vec2>& corners) {
  std::vector<double> starts = {0.0};
  for (std::size_t k = 0; k + 1 < corners.size(); ++k)
    starts.push_back(starts.back() + (next(corners, k) - corners[k]).norm());
  return starts;
}

std::vector<double> circle_crossings(double radius, const Vec2& through, const Vec2& direction) {
  const double middle = -through.dot(direction); // along the line, where it is nearest to the centre
  const double half_squared = radius * radius - (through + middle * direction).squaredNorm();
  if (!(half_squared > 1e-24 * radius * radius)) return {};
  const double half = std::sqrt(half_squared);
  std::vector<double> positions;
  for (const double t : {middle - half, middle + half})
    positions.push_back(rim_position(Circle{radius}, through + t * direction));
  return positions;
}

} // namespace

Vec2 rim_point(const Plan& plan, double position) {
  if (const auto* circle = std::get_if<Circle>(&plan)) {
    const double angle = position / circle->radius;
    return circle->radius * Vec2(std::cos(angle), std::sin(angle));
  }
  const std::vector<Vec2> corners = corners_of(plan);
  const std::vector<double> starts = starts_of(corners);
  const auto after = std::upper_bound(starts.begin() + 1, starts.end(), position);
  const auto k = static_cast<std::size_t>(after - starts.begin()) - 1;
  const Vec2 along = next(corners, k) - corners[k];
  return corners[k] + (position - starts[k]) / along.norm() * along;
}

double rim_position(const Plan& plan, const Vec2& place) {
  const double around = perimeter(plan);
  double position = 0;
  if (const auto* circle = std::get_if<Circle>(&plan)) {
    position = circle->radius * std::atan2(place.y(), place.x());
    if (position < 0) position += around;
  } else {
    const std::vector<Vec2> corners = corners_of(plan);
    const std::vector<double> starts = starts_of(corners);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2 along = next(corners, k) - corners[k];
      const double part = std::clamp((place - corners[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (corners[k] + part * along - place).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      position = starts[k] + part * along.norm();
      if (part == 1) position = k + 1 < corners.size() ? starts[k + 1] : 0.0;
    }
  }
  return position < around ? position : 0.0;
}

std::vector<double> rim_corners(const Plan& plan) {
  return starts_of(corners_of(plan));
}

std::vector<std::size_t> rim_edges(const Plan& plan) {
  std::vector<std::size_t> edges(rim_corners(plan).size());
  std::iota(edges.begin(), edges.end(), std::size_t{0});
  const std::vector<Vec2> points = corner_points(plan);
  if (!points.empty() && signed_area(points) < 0) std::reverse(edges.begin() + 1, edges.end());
  return edges;
}

std::vector<double> rim_crossings(const Plan& plan, const Vec2& through, const Vec2& along) {
  const Vec2 direction = along.normalized();
  if (const auto* circle = std::get_if<Circle>(&plan)) return circle_crossings(circle->radius, through, direction);

  const std::vector<Vec2> corners = corners_of(plan);
  const std::vector<double> starts = starts_of(corners);
  const std::size_t n = corners.size();
  const double on = 1e-12 * perimeter(plan); // nearer corners lie on the line
  std::vector<double> side;                  // of each corner: left of the line positive
  for (const Vec2& corner : corners) {
    const double distance = cross(direction, corner - through);
    side.push_back(std::abs(distance) <= on ? 0.0 : distance);
  }
  std::vector<double> positions;
  for (std::size_t k = 0; k < n; ++k) {
    if (side[k] == 0) continue;
    std::size_t beyond = k + 1; // the next corner that is not on the line
    while (side[beyond % n] == 0) ++beyond;
    if ((side[k] > 0) == (side[beyond % n] > 0)) continue;
    if (beyond == k + 1) {
      const double part = side[k] / (side[k] - side[beyond % n]);
      positions.push_back(starts[k] + part * (next(corners, k) - corners[k]).norm());
      continue;
    }
    // Where the line runs along edges, it enters or leaves the plan at the corner that points inwards.
    const std::size_t first = (k + 1) % n;
    const std::size_t last = (beyond - 1) % n;
    const bool at_first = first != last && cross(corners[last] - corners[first], corners[k] - corners[first]) < 0;
    positions.push_back(starts[at_first ? first : last]);
  }
  std::sort(positions.begin(), positions.end(), [&](double a, double b) {
    return (rim_point(plan, a) - through).dot(direction) < (rim_point(plan, b) - through).dot(direction);
  });
  return positions;
}

bool inside(const Plan& plan, const Vec2& place, double tolerance) {
  if (const auto* circle = std::get_if<Circle>(&plan)) return place.norm() <= circle->radius + tolerance;
  return contains(corners_of(plan), place) || (rim_point(plan, rim_position(plan, place)) - place).norm() <= tolerance;
}

} // namespace pneuma::geometry
