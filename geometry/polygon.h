// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry {

using base::Index;
using base::Vec2;

inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Whether the segments a-b and c-d have a point in common.
bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

// Polygons are rings of points; the last is followed by the first.

double signed_area(std::span<const Vec2> ring); // positive counterclockwise

// Two sides, by their first points, that have a point in common without being neighbours.
std::optional<std::pair<std::size_t, std::size_t>> crossing_sides(std::span<const Vec2> ring);

// Two lines of straight parts that cross or touch, by their numbers in ascending order, and where; the same twice: one
// that meets itself. Where several do, one of them.
struct LineCrossing {
  std::size_t first, second;
  Vec2 at;
};
std::optional<LineCrossing> crossing_lines(std::span<const std::span<const Vec2>> lines);

bool contains(std::span<const Vec2> ring, const Vec2& point);

// Counterclockwise triangles, by the numbers of their points, that make up a simple polygon of either orientation
// (ear clipping). Throws GeometryError where the ring has no area or crosses itself.
std::vector<std::array<Index, 3>> triangulate(std::span<const Vec2> ring);

} // namespace pneuma::geometry
