// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/unstructured.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/divisions.h"
#include "geometry/meshing/filled.h"

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

} // namespace

CornerMesh unstructured_mesh(const Plan& plan, const MeshOptions& options) {
  Rim rim = rim_of(plan, options);
  return filled(rim.points, std::move(rim.edges), corners_per_element(options.element));
}

} // namespace pneuma::geometry::meshing
