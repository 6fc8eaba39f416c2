// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/deviation.h"

#include <cmath>

#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

template <int N>
using Nodes = Eigen::Matrix<double, 3, N>;

template <int N>
Nodes<N> nodes_of(std::span<const Index> element, std::span<const Vec3> positions) {
  Nodes<N> x;
  for (int a = 0; a < N; ++a) x.col(a) = positions[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])];
  return x;
}

// Distance of a point from the element's surface, whose foot lies near (xi, eta): Gauss-Newton for the foot.
template <ElementType E>
double distance(const Nodes<nodes_per_element(E)>& target, const Vec3& point, double xi, double eta) {
  Vec3 offset;
  for (int i = 0; i < 8; ++i) {
    const auto s = shape_functions<E>(xi, eta);
    const base::Mat32 g = target * s.derivative;
    offset = point - target * s.value;
    const base::Vec2 move = (g.transpose() * g).ldlt().solve(g.transpose() * offset);
    xi += move[0];
    eta += move[1];
    if (move.norm() < 1e-12) break;
  }
  return (point - target * shape_functions<E>(xi, eta).value).norm();
}

template <ElementType E>
Deviation deviation_of(const Mesh& mesh, const Block& block, std::span<const Vec3> target, std::span<const Vec3> now) {
  constexpr int n = nodes_per_element(E);
  const auto corners = node_coordinates<E>();
  Deviation deviation;
  double area = 0;
  const auto widen = [&](double d, const Vec3& at) {
    if (d <= deviation.max) return;
    deviation.max = d;
    deviation.at = at;
  };
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const Nodes<n> wanted = nodes_of<n>(mesh.element_nodes(block, e), target);
    const Nodes<n> x = nodes_of<n>(mesh.element_nodes(block, e), now);
    for (int a = 0; a < n; ++a) {
      const auto& [xi, eta] = corners[static_cast<std::size_t>(a)];
      widen(distance<E>(wanted, x.col(a), xi, eta), x.col(a));
    }
    for (const QuadraturePoint& point : pressure_rule(E)) {
      const auto s = shape_functions<E>(point.xi, point.eta);
      const base::Mat32 g = wanted * s.derivative;
      const double part = point.weight * g.col(0).cross(g.col(1)).norm();
      const double d = distance<E>(wanted, x * s.value, point.xi, point.eta);
      widen(d, x * s.value);
      deviation.mean += part * d;
      area += part;
    }
  }
  if (area > 0) deviation.mean /= area;
  return deviation;
}

} // namespace

Deviation normal_deviation(const Mesh& mesh, const Block& block, std::span<const Vec3> target,
                           std::span<const Vec3> now) {
  return dispatch(mesh.element, [&]<ElementType E>() { return deviation_of<E>(mesh, block, target, now); });
}

} // namespace pneuma::geometry
