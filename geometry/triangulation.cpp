// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulation.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

template <ElementType E>
class Divider {
public:
  Divider(const Mesh& mesh, std::span<const Vec3> positions, int parts)
      : positions_(positions), parts_(parts), corner_(mesh.nodes.size(), none) {}

  void divide(std::span<const Index> nodes) {
    const auto n = static_cast<std::size_t>(parts_ + 1);
    std::vector<Index> lattice(n * n, none); // [row][column] of the element's points
    const auto point = [&](int i, int j) -> Index& {
      return lattice[static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i)];
    };
    const auto last = [&](int j) { return triangle ? parts_ - j : parts_; }; // column of a row
    for (int j = 0; j <= parts_; ++j) {
      for (int i = 0; i <= last(j); ++i) point(i, j) = point_at(nodes, i, j);
    }
    for (int j = 0; j < parts_; ++j) {
      for (int i = 0; i < last(j); ++i) {
        const Index a = point(i, j);
        const Index b = point(i + 1, j);
        const Index d = point(i, j + 1);
        if (triangle && i + 1 == last(j)) {
          surface.triangles.push_back({a, b, d});
        } else {
          add_square(a, b, point(i + 1, j + 1), d);
        }
      }
    }
  }

  Triangulation surface;

private:
  static constexpr bool triangle = corners_per_element(E) == 3;
  static constexpr Index none = -1;

  Index add(const Vec3& point) {
    surface.points.push_back(point);
    return static_cast<Index>(surface.points.size() - 1);
  }

  // the shorter diagonal follows the surface more closely
  void add_square(Index a, Index b, Index c, Index d) {
    const auto at = [&](Index i) -> const Vec3& { return surface.points[static_cast<std::size_t>(i)]; };
    if (!triangle && (at(a) - at(c)).norm() <= (at(b) - at(d)).norm()) {
      surface.triangles.push_back({a, b, c});
      surface.triangles.push_back({a, c, d});
    } else {
      surface.triangles.push_back({a, b, d});
      surface.triangles.push_back({b, c, d});
    }
  }

  Vec3 interpolated(std::span<const Index> nodes, int i, int j) const {
    const double xi = static_cast<double>(i) / parts_;
    const double eta = static_cast<double>(j) / parts_;
    const auto shape = triangle ? shape_functions<E>(xi, eta) : shape_functions<E>(2 * xi - 1, 2 * eta - 1);
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < nodes.size(); ++k)
      point += shape.value[static_cast<Eigen::Index>(k)] * positions_[static_cast<std::size_t>(nodes[k])];
    return point;
  }

  // Number of the element's lattice point (i, j), made where no neighbour has made it.
  Index point_at(std::span<const Index> nodes, int i, int j) {
    const int p = parts_;
    if (j == 0) return on_side(nodes, 0, i, i, j);
    if (triangle ? i + j == p : i == p) return on_side(nodes, 1, j, i, j);
    if (!triangle && j == p) return on_side(nodes, 2, p - i, i, j);
    if (i == 0) return on_side(nodes, triangle ? 2 : 3, p - j, i, j);
    return add(interpolated(nodes, i, j));
  }

  Index corner(Index node) {
    Index& number = corner_[static_cast<std::size_t>(node)];
    if (number == none) number = add(positions_[static_cast<std::size_t>(node)]);
    return number;
  }

  // the point (i, j), which lies on a side of the element, so many steps from the side's first corner
  Index on_side(std::span<const Index> nodes, std::size_t side, int steps, int i, int j) {
    const Index a = nodes[side];
    const Index b = nodes[(side + 1) % corners_per_element(E)];
    if (steps == 0) return corner(a);
    if (steps == parts_) return corner(b);
    const auto step = static_cast<std::size_t>(a < b ? steps : parts_ - steps) - 1; // from the lower corner
    auto& points = on_sides_[side_key(a, b)];
    points.resize(static_cast<std::size_t>(parts_ - 1), none);
    if (points[step] == none) points[step] = add(interpolated(nodes, i, j));
    return points[step];
  }

  std::span<const Vec3> positions_;
  int parts_;
  std::vector<Index> corner_;                                      // number of the point at each corner node
  std::unordered_map<std::uint64_t, std::vector<Index>> on_sides_; // points between the corners
};

} // namespace

Triangulation triangulated(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, int parts) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    Divider<E> divider(mesh, positions, parts);
    for (Index e = 0; e < mesh.element_count(block); ++e) divider.divide(mesh.element_nodes(block, e));
    return std::move(divider.surface);
  });
}

} // namespace pneuma::geometry
