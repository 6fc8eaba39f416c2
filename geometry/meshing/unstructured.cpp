// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/unstructured.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/divisions.h"
#include "geometry/meshing/fill.h"

namespace pneuma::geometry::meshing {

namespace {

// The rim as a polygon, counterclockwise, and the numbers of its points on each edge.
struct Rim {
  std::vector<Vec2> points;
  std::vector<std::vector<Index>> edges;
};

Rim polygon_rim(const std::vector<Vec2>& corners, const std::vector<int>& divisions) {
  Rim rim;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec2& a = corners[k];
    const Vec2& b = corners[(k + 1) % corners.size()];
    const int n = divisions[k];
    auto& edge = rim.edges.emplace_back();
    for (int i = 0; i < n; ++i) {
      edge.push_back(static_cast<Index>(rim.points.size()));
      rim.points.push_back(((n - i) * a + i * b) / n);
    }
    edge.push_back(k + 1 < corners.size() ? static_cast<Index>(rim.points.size()) : 0);
  }
  return rim;
}

Rim circle_rim(double radius, int count) {
  Rim rim;
  rim.edges.resize(1);
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    rim.edges[0].push_back(i);
    rim.points.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return rim;
}

Rim rim_of(const Plan& plan, const MeshOptions& options) {
  const bool quadrilaterals = corners_per_element(options.element) == 4;
  const auto [n, m] = divisions_of(plan, options);
  if (quadrilaterals && (n % 2 != 0 || (std::holds_alternative<Rectangle>(plan) && m % 2 != 0))) {
    throw base::InputError(fmt::format("mesh divisions {}: unstructured quadrilaterals need even numbers of divisions",
                                       n % 2 != 0 ? n : m));
  }
  if (const auto* circle = std::get_if<Circle>(&plan)) return circle_rim(circle->radius, 4 * n);
  const std::vector<Vec2> corners = corner_points(plan);
  if (std::holds_alternative<Rectangle>(plan)) return polygon_rim(corners, {n, m, n, m});
  std::vector<int> divisions(corners.size(), n);
  const double longest = longest_side(corners);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const double side = (corners[(k + 1) % corners.size()] - corners[k]).norm();
    if (options.size) {
      divisions[k] = std::max(static_cast<int>(std::ceil(side / *options.size * (1 - 1e-12))), 2);
      if (quadrilaterals) divisions[k] += divisions[k] % 2;
    } else if (std::holds_alternative<Polygon>(plan)) {
      const int unit = quadrilaterals ? 2 : 1;
      divisions[k] = std::max(unit * static_cast<int>(std::lround(n * side / (longest * unit))), 2);
    }
  }
  return polygon_rim(corners, divisions);
}

// Divides every element of the filling of every second point of the rim into quadrilaterals around its centre.
CornerMesh divided(const Rim& rim) {
  std::vector<Vec2> coarse;
  for (std::size_t k = 0; k < rim.points.size(); k += 2) coarse.push_back(rim.points[k]);
  const Filling filling = fill(coarse, true);

  CornerMesh mesh;
  mesh.corners = 4;
  mesh.points = rim.points;
  mesh.edges = rim.edges;
  const std::size_t ring = coarse.size();
  const auto shift = static_cast<Index>(rim.points.size() - ring);
  const auto point = [&](Index i) { return static_cast<std::size_t>(i) < ring ? 2 * i : i + shift; };
  mesh.points.insert(mesh.points.end(), filling.points.begin() + static_cast<std::ptrdiff_t>(ring),
                     filling.points.end());
  std::unordered_map<std::uint64_t, Index> middle_of; // of the sides, by the coarse points at their ends
  for (std::size_t k = 0; k < ring; ++k)
    middle_of[side_key(static_cast<Index>(k), static_cast<Index>((k + 1) % ring))] = static_cast<Index>(2 * k + 1);

  const auto divide = [&](std::span<const Index> cell) {
    const std::size_t n = cell.size();
    const auto centre = static_cast<Index>(mesh.points.size());
    Vec2 sum = Vec2::Zero();
    for (const Index i : cell) sum += filling.points[static_cast<std::size_t>(i)];
    mesh.points.push_back(sum / static_cast<double>(n));
    const auto middle = [&](std::size_t k) {
      const Index a = cell[k];
      const Index b = cell[(k + 1) % n];
      const auto [found, fresh] = middle_of.try_emplace(side_key(a, b), static_cast<Index>(mesh.points.size()));
      if (fresh) {
        mesh.points.push_back(
            (filling.points[static_cast<std::size_t>(a)] + filling.points[static_cast<std::size_t>(b)]) / 2);
      }
      return found->second;
    };
    for (std::size_t k = 0; k < n; ++k) {
      const Index before = middle((k + n - 1) % n);
      const Index after = middle(k);
      mesh.cells.insert(mesh.cells.end(), {point(cell[k]), after, centre, before});
    }
  };
  for (const auto& cell : filling.quadrilaterals) divide(cell);
  for (const auto& cell : filling.triangles) divide(cell);
  return mesh;
}

} // namespace

CornerMesh unstructured_mesh(const Plan& plan, const MeshOptions& options) {
  const Rim rim = rim_of(plan, options);
  if (corners_per_element(options.element) == 4) return divided(rim);
  const Filling filling = fill(rim.points, false);
  CornerMesh mesh;
  mesh.points = filling.points;
  mesh.edges = rim.edges;
  for (const auto& cell : filling.triangles) mesh.cells.insert(mesh.cells.end(), cell.begin(), cell.end());
  release_rim(mesh);
  return mesh;
}

} // namespace pneuma::geometry::meshing
