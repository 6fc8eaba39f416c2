// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"

namespace pneuma::geometry {

namespace {

bool in_triangle(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

} // namespace

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto apart = [](const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
    const double first = cross(q - p, r - p);
    const double second = cross(q - p, s - p);
    return (first > 0 && second > 0) || (first < 0 && second < 0);
  };
  const bool boxes_apart =
      (a.cwiseMax(b).array() < c.cwiseMin(d).array()).any() || (c.cwiseMax(d).array() < a.cwiseMin(b).array()).any();
  return !boxes_apart && !apart(a, b, c, d) && !apart(c, d, a, b);
}

double signed_area(std::span<const Vec2> ring) {
  double doubled = 0;
  for (std::size_t k = 0; k < ring.size(); ++k)
    doubled += cross(ring[k] - ring[0], ring[(k + 1) % ring.size()] - ring[0]);
  return doubled / 2;
}

std::optional<std::pair<std::size_t, std::size_t>> crossing_sides(std::span<const Vec2> ring) {
  const std::size_t n = ring.size();
  const auto left = [&](std::size_t k) { return std::min(ring[k].x(), ring[(k + 1) % n].x()); };
  const auto right = [&](std::size_t k) { return std::max(ring[k].x(), ring[(k + 1) % n].x()); };
  std::vector<std::size_t> by_left(n);
  std::iota(by_left.begin(), by_left.end(), std::size_t{0});
  std::sort(by_left.begin(), by_left.end(), [&](std::size_t a, std::size_t b) { return left(a) < left(b); });
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = by_left[i];
    for (std::size_t j = i + 1; j < n && left(by_left[j]) <= right(a); ++j) {
      const std::size_t b = by_left[j];
      const bool neighbours = (a + 1) % n == b || (b + 1) % n == a;
      if (!neighbours && meet(ring[a], ring[(a + 1) % n], ring[b], ring[(b + 1) % n])) return std::pair(a, b);
    }
  }
  return {};
}

namespace {

// Of two segments that cross or touch.
Vec2 meeting_point(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double turn = cross(b - a, d - c);
  if (std::abs(turn) > 1e-12 * (b - a).norm() * (d - c).norm()) {
    return a + std::clamp(cross(c - a, d - c) / turn, 0.0, 1.0) * (b - a);
  }
  return (std::max(a.x(), b.x()) >= c.x() && c.x() >= std::min(a.x(), b.x())) ? c : d; // along each other
}

} // namespace

std::optional<LineCrossing> crossing_lines(std::span<const std::span<const Vec2>> lines) {
  struct Segment {
    std::size_t line, number;
    Vec2 a, b;
    double left() const { return std::min(a.x(), b.x()); }
    double right() const { return std::max(a.x(), b.x()); }
  };
  std::vector<Segment> segments;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    for (std::size_t k = 0; k + 1 < lines[l].size(); ++k) segments.push_back({l, k, lines[l][k], lines[l][k + 1]});
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& s, const Segment& t) { return s.left() < t.left(); });
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& s = segments[i];
    for (std::size_t j = i + 1; j < segments.size() && segments[j].left() <= s.right(); ++j) {
      const Segment& t = segments[j];
      const bool neighbours = s.line == t.line && (s.number + 1 == t.number || t.number + 1 == s.number);
      if (neighbours || !meet(s.a, s.b, t.a, t.b)) continue;
      return LineCrossing{std::min(s.line, t.line), std::max(s.line, t.line), meeting_point(s.a, s.b, t.a, t.b)};
    }
  }
  return {};
}

bool contains(std::span<const Vec2> ring, const Vec2& point) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2& a = ring[k];
    const Vec2& b = ring[(k + 1) % ring.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point.x() < x) inside = !inside;
  }
  return inside;
}

std::vector<std::array<Index, 3>> triangulate(std::span<const Vec2> ring) {
  const double area = ring.size() < 3 ? 0 : signed_area(ring);
  if (!(area != 0)) throw base::GeometryError("a polygon needs three points at least, and an area");
  if (const auto sides = crossing_sides(ring)) {
    const Vec2& a = ring[sides->first];
    const Vec2& b = ring[sides->second];
    throw base::GeometryError(fmt::format("the polygon crosses or touches itself: its sides from {} and from {} meet",
                                          base::place_text(a), base::place_text(b)));
  }
  std::vector<Index> left(ring.size()); // points not yet cut off, counterclockwise
  std::iota(left.begin(), left.end(), 0);
  if (area < 0) std::reverse(left.begin(), left.end());
  const auto point = [&](std::size_t k) -> const Vec2& { return ring[static_cast<std::size_t>(left[k])]; };

  std::vector<std::array<Index, 3>> triangles;
  while (left.size() >= 3) {
    const std::size_t n = left.size();
    // rounding may hide every ear of a thin rest: then the widest corner without a point in it, or any, is taken
    std::size_t ear = n;
    double widest = 0;
    for (std::size_t k = 0; k < n && n > 3; ++k) {
      const Vec2& a = point((k + n - 1) % n);
      const Vec2& b = point(k);
      const Vec2& c = point((k + 1) % n);
      const double turn = cross(b - a, c - b);
      if (turn <= widest) continue;
      bool empty = true;
      for (std::size_t other = 0; other < n && empty; ++other) {
        const Vec2& p = point(other);
        const bool corner = other == k || other == (k + 1) % n || other == (k + n - 1) % n;
        empty = corner || !in_triangle(p, a, b, c);
      }
      if (!empty) continue;
      ear = k;
      widest = turn;
    }
    if (ear == n) ear = 0;
    const std::array triangle = {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]};
    const auto corner = [&](std::size_t k) -> const Vec2& { return ring[static_cast<std::size_t>(triangle[k])]; };
    if (cross(corner(1) - corner(0), corner(2) - corner(0)) > 0) triangles.push_back(triangle);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

} // namespace pneuma::geometry
