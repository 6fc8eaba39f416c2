// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/corner_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pneuma::geometry::meshing {

namespace {

// smallest angle of the counterclockwise triangle, negative if it is turned over
double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c) {
  const auto at = [](const Vec2& p, const Vec2& q, const Vec2& r) {
    return std::atan2(cross(q - p, r - p), (q - p).dot(r - p));
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
}

struct Side {
  Index low, high;  // ends
  std::size_t cell; // triangle it belongs to
  Index opposite;   // third corner
};

// sides of all triangles that join two points of the rim, those of one edge next to each other
std::vector<Side> rim_to_rim(const CornerMesh& mesh, const std::vector<bool>& rim) {
  std::vector<Side> sides;
  for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = mesh.cells[3 * cell + k];
      const Index b = mesh.cells[3 * cell + (k + 1) % 3];
      if (rim[static_cast<std::size_t>(a)] && rim[static_cast<std::size_t>(b)])
        sides.push_back({std::min(a, b), std::max(a, b), cell, mesh.cells[3 * cell + (k + 2) % 3]});
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  return sides;
}

} // namespace

std::vector<bool> on_rim(const CornerMesh& mesh) {
  std::vector<bool> rim(mesh.points.size(), false);
  for (const std::vector<Index>& edge : mesh.edges) {
    for (const Index node : edge) rim[static_cast<std::size_t>(node)] = true;
  }
  return rim;
}

void release_rim(CornerMesh& mesh) {
  constexpr double needle = 0.25; // rad, about 14 degrees
  std::vector<bool> rim = on_rim(mesh);
  const auto point = [&](Index i) -> const Vec2& { return mesh.points[static_cast<std::size_t>(i)]; };
  const auto set = [&](std::size_t cell, Index a, Index b, Index c) {
    mesh.cells[3 * cell] = a;
    mesh.cells[3 * cell + 1] = b;
    mesh.cells[3 * cell + 2] = c;
  };
  // each round changes every triangle at most once, so that the list of sides stays right
  for (bool again = true; again;) {
    again = false;
    std::vector<bool> changed(mesh.cell_count(), false);
    const std::vector<Side> sides = rim_to_rim(mesh, rim);
    for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
      const Side& first = sides[s];
      const Side& second = sides[s + 1];
      if (first.low != second.low || first.high != second.high) continue;
      again = true;
      if (changed[first.cell] || changed[second.cell]) continue;
      changed[first.cell] = changed[second.cell] = true;
      // the four corners counterclockwise: c, a, d, b with the edge a-b
      Index a = first.low;
      Index b = first.high;
      const Index c = first.opposite;
      const Index d = second.opposite;
      if (cross(point(a) - point(c), point(b) - point(c)) < 0) std::swap(a, b);
      const double before =
          std::min(smallest_angle(point(c), point(a), point(b)), smallest_angle(point(a), point(d), point(b)));
      const double after =
          std::min(smallest_angle(point(c), point(a), point(d)), smallest_angle(point(c), point(d), point(b)));
      const bool joins_rim = rim[static_cast<std::size_t>(c)] && rim[static_cast<std::size_t>(d)];
      if (!joins_rim && after > std::min(needle, 0.4 * before)) {
        set(first.cell, c, a, d);
        set(second.cell, c, d, b);
      } else {
        const auto middle = static_cast<Index>(mesh.points.size());
        mesh.points.push_back((point(a) + point(b)) / 2);
        rim.push_back(false);
        set(first.cell, c, a, middle);
        set(second.cell, a, d, middle);
        mesh.cells.insert(mesh.cells.end(), {c, middle, b, middle, d, b});
        changed.insert(changed.end(), 2, true);
      }
    }
  }
}

} // namespace pneuma::geometry::meshing
