// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/filled.h"

#include <unordered_map>
#include <utility>

#include "geometry/meshing/fill.h"

namespace pneuma::geometry::meshing {

namespace {

CornerMesh triangles(std::span<const Vec2> ring, std::vector<std::vector<Index>> edges) {
  Filling filling = fill(ring, false);
  CornerMesh mesh;
  mesh.points = std::move(filling.points);
  mesh.edges = std::move(edges);
  for (const auto& cell : filling.triangles) mesh.cells.insert(mesh.cells.end(), cell.begin(), cell.end());
  release_rim(mesh);
  return mesh;
}

// Divides every element of the filling of every second point of the ring into quadrilaterals around its centre.
CornerMesh divided(std::span<const Vec2> points, std::vector<std::vector<Index>> edges) {
  std::vector<Vec2> coarse;
  for (std::size_t k = 0; k < points.size(); k += 2) coarse.push_back(points[k]);
  const Filling filling = fill(coarse, true);

  CornerMesh mesh;
  mesh.corners = 4;
  mesh.points.assign(points.begin(), points.end());
  mesh.edges = std::move(edges);
  const std::size_t ring = coarse.size();
  const auto shift = static_cast<Index>(points.size() - ring);
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

CornerMesh filled(std::span<const Vec2> ring, std::vector<std::vector<Index>> edges, int corners) {
  return corners == 3 ? triangles(ring, std::move(edges)) : divided(ring, std::move(edges));
}

} // namespace pneuma::geometry::meshing
