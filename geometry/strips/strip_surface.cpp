// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/strip_surface.h"

#include <unordered_map>

namespace pneuma::geometry::strips {

namespace {

using Triangles = std::vector<std::array<std::size_t, 3>>;

// Triangles between the nodes of an element.
const Triangles& triangles_between_nodes(ElementType element) {
  static const Triangles parts[] = {
      {{0, 1, 2}},
      {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}},
      {{0, 1, 2}, {0, 2, 3}},
      {{0, 4, 8}, {0, 8, 7}, {4, 1, 5}, {4, 5, 8}, {8, 5, 2}, {8, 2, 6}, {7, 8, 6}, {7, 6, 3}}};
  return parts[static_cast<std::size_t>(element)];
}

} // namespace

StripSurface strip_surface(ElementType element, std::span<const Index> connectivity,
                           std::span<const Index> strip_of_element, Index strip, std::span<const Vec3> positions) {
  const auto n = static_cast<std::size_t>(nodes_per_element(element));
  StripSurface result;
  std::unordered_map<Index, Index> number;
  for (std::size_t e = 0; e < strip_of_element.size(); ++e) {
    if (strip_of_element[e] != strip) continue;
    for (const auto& triangle : triangles_between_nodes(element)) {
      auto& corners = result.surface.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const Index node = connectivity[e * n + triangle[k]];
        const auto [found, fresh] = number.try_emplace(node, static_cast<Index>(result.nodes.size()));
        if (fresh) {
          result.nodes.push_back(node);
          result.surface.points.push_back(positions[static_cast<std::size_t>(node)]);
        }
        corners[k] = found->second;
      }
    }
  }
  return result;
}

} // namespace pneuma::geometry::strips
