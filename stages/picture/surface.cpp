// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/surface.h"

#include <algorithm>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/shape_functions.h"

namespace pneuma::stages::picture {

namespace {

using base::Vec2;
using geometry::ElementType;

// Corners and mid-sides in the reference element.
template <ElementType E>
Vec2 node_place(int k) {
  if constexpr (geometry::corners_per_element(E) == 3) {
    constexpr double x[] = {0, 1, 0, 0.5, 0.5, 0};
    constexpr double y[] = {0, 0, 1, 0, 0.5, 0.5};
    return {x[k], y[k]};
  } else {
    constexpr double x[] = {-1, 1, 1, -1, 0, 1, 0, -1, 0};
    constexpr double y[] = {-1, -1, 1, 1, -1, 0, 1, 0, 0};
    return {x[k], y[k]};
  }
}

// The places of an element's fine points and the triangles between them.
struct Division {
  std::vector<Vec2> places;
  std::vector<std::array<Index, 3>> triangles;
};

template <ElementType E>
Division divide(int n) {
  Division division;
  if constexpr (geometry::corners_per_element(E) == 3) {
    const auto number = [n](int i, int j) { return static_cast<Index>(j * (n + 1) - j * (j - 1) / 2 + i); };
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n - j; ++i) {
        division.places.emplace_back(static_cast<double>(i) / n, static_cast<double>(j) / n);
        if (i + j < n) division.triangles.push_back({number(i, j), number(i + 1, j), number(i, j + 1)});
        if (i + j < n - 1) division.triangles.push_back({number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)});
      }
    }
  } else {
    const auto number = [n](int i, int j) { return static_cast<Index>(j * (n + 1) + i); };
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        division.places.emplace_back(2.0 * i / n - 1, 2.0 * j / n - 1);
        if (i == n || j == n) continue;
        division.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
        division.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
      }
    }
  }
  return division;
}

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(0, 0, 1);
}

// Sums of what the elements around each node have as normal there.
template <ElementType E>
std::vector<Vec3> node_normals(const geometry::Mesh& mesh, const geometry::Block& block,
                               const std::vector<Vec3>& positions) {
  constexpr int n = geometry::nodes_per_element(E);
  std::vector<Vec3> normals(positions.size(), Vec3(0, 0, 0));
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    for (int k = 0; k < n; ++k) {
      const Vec2 place = node_place<E>(k);
      const auto shape = geometry::shape_functions<E>(place.x(), place.y());
      Vec3 along_xi(0, 0, 0);
      Vec3 along_eta(0, 0, 0);
      for (int i = 0; i < n; ++i) {
        const Vec3& x = positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])];
        along_xi += shape.derivative(i, 0) * x;
        along_eta += shape.derivative(i, 1) * x;
      }
      normals[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)])] += unit(along_xi.cross(along_eta));
    }
  }
  return normals;
}

template <ElementType E>
void add_edges(const geometry::Mesh& mesh, const geometry::Block& block, const std::vector<Vec3>& positions,
               const std::vector<Index>& strip_of_element, int n, Surface& surface) {
  constexpr int corners = geometry::corners_per_element(E);
  struct Side {
    std::vector<Vec3> line;
    int elements = 0;
    Index strip = 0; // of the first element
    bool seam = false;
  };
  std::map<std::pair<Index, Index>, Side> sides;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    const Index strip = strip_of_element.empty() ? 0 : strip_of_element[static_cast<std::size_t>(e)];
    for (int k = 0; k < corners; ++k) {
      const int next = (k + 1) % corners;
      Side& side =
          sides[std::minmax(Index{nodes[static_cast<std::size_t>(k)]}, Index{nodes[static_cast<std::size_t>(next)]})];
      if (++side.elements > 1) {
        side.seam = strip != side.strip;
        continue;
      }
      side.strip = strip;
      const Vec2 from = node_place<E>(k);
      const Vec2 to = node_place<E>(next);
      for (int i = 0; i <= n; ++i) {
        const Vec2 place = from + (to - from) * i / n;
        const auto shape = geometry::shape_functions<E>(place.x(), place.y());
        Vec3 point(0, 0, 0);
        for (int j = 0; j < geometry::nodes_per_element(E); ++j) {
          point += shape.value[j] * positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(j)])];
        }
        side.line.push_back(point);
      }
    }
  }
  for (auto& [ends, side] : sides) {
    auto& lines = side.seam ? surface.seams : side.elements > 1 ? surface.edges : surface.borders;
    lines.push_back(std::move(side.line));
  }
}

template <ElementType E>
Surface make_surface(const geometry::Mesh& mesh, const geometry::Block& block, const std::vector<Vec3>& positions,
                     const std::vector<double>& node_values, const std::vector<double>& element_values,
                     const std::vector<Index>& strip_of_element, int n) {
  const Division division = divide<E>(n);
  const std::vector<Vec3> normals = node_normals<E>(mesh, block, positions);
  Surface surface;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    const auto first = static_cast<Index>(surface.points.size());
    for (const Vec2& place : division.places) {
      const auto shape = geometry::shape_functions<E>(place.x(), place.y());
      Vec3 point(0, 0, 0);
      Vec3 normal(0, 0, 0);
      double value = 0;
      for (int i = 0; i < geometry::nodes_per_element(E); ++i) {
        const auto node = static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)]);
        point += shape.value[i] * positions[node];
        normal += shape.value[i] * unit(normals[node]);
        if (!node_values.empty()) value += shape.value[i] * node_values[node];
      }
      surface.points.push_back(point);
      surface.normals.push_back(unit(normal));
      if (!element_values.empty()) value = element_values[static_cast<std::size_t>(e)];
      if (!node_values.empty() || !element_values.empty()) surface.values.push_back(value);
    }
    for (const auto& [a, b, c] : division.triangles) surface.triangles.push_back({first + a, first + b, first + c});
  }
  add_edges<E>(mesh, block, positions, strip_of_element, n, surface);
  return surface;
}

} // namespace

Surface surface_of(const geometry::Mesh& mesh, const geometry::Block& block, const std::vector<Vec3>& positions,
                   const std::vector<double>& node_values, const std::vector<double>& element_values,
                   const std::vector<Index>& strip_of_element, int divisions) {
  return geometry::dispatch(mesh.element, [&]<ElementType E>() {
    return make_surface<E>(mesh, block, positions, node_values, element_values, strip_of_element, divisions);
  });
}

} // namespace pneuma::stages::picture
