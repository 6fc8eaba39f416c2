// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

// Positions of an element's nodes, one a column, m.
template <ElementType E>
using ElementPositions = Eigen::Matrix<double, 3, nodes_per_element(E)>;

// Force of a unit pressure on the positive side's normal of an element, and the volume between element and origin.
template <ElementType E>
struct PressureElement {
  static constexpr int size = 3 * nodes_per_element(E);
  double volume = 0;                            // m3, 1/3 int x . (x_xi X x_eta)
  Eigen::Matrix<double, size, 1> force;         // m2, [node][component] int N (x_xi X x_eta)
  Eigen::Matrix<double, size, size> derivative; // m, d force / d x: unsymmetric in one element, symmetric when
                                                // summed over a surface whose boundary is held
};

// Volume, force and its derivative over the given points (of the pressure rule, or of a part of the element).
// On a closed surface, or with the boundary held, the force is the exact derivative of the volume if the points
// integrate the element exactly (numerics 1). Derivative only if `with_derivative`.
template <ElementType E>
void pressure_element(const ElementPositions<E>& x, std::span<const QuadraturePoint> points, bool with_derivative,
                      PressureElement<E>& result) {
  constexpr int n = nodes_per_element(E);
  result.volume = 0;
  result.force.setZero();
  if (with_derivative) result.derivative.setZero();
  for (const QuadraturePoint& q : points) {
    const ShapeValues<n> s = shape_functions<E>(q.xi, q.eta);
    const base::Mat32 g = x * s.derivative;
    const Vec3 normal = g.col(0).cross(g.col(1));
    const Vec3 at = x * s.value;
    result.volume += q.weight * at.dot(normal) / 3;
    for (int a = 0; a < n; ++a) result.force.template segment<3>(3 * a) += q.weight * s.value[a] * normal;
    if (!with_derivative) continue;
    for (int b = 0; b < n; ++b) {
      // d(normal) = dx_b N_b,xi X g2 + g1 X dx_b N_b,eta = [v]x dx_b with v as below
      const Vec3 v = s.derivative(b, 1) * g.col(0) - s.derivative(b, 0) * g.col(1);
      base::Mat3 cross;
      cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
      cross *= q.weight;
      for (int a = 0; a < n; ++a) result.derivative.template block<3, 3>(3 * a, 3 * b) += s.value[a] * cross;
    }
  }
}

// Volume between the surface of a block and the point `origin`, m3, positive where the normal points away from it.
double volume_below(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, const Vec3& origin);

// Volume enclosed by two blocks that share their edge: `outer` has its normals outwards, `inner` inwards. Does not
// depend on any origin.
double enclosed_volume(const Mesh& mesh, const Block& outer, const Block& inner, std::span<const Vec3> positions);

// Gathers the positions of an element's nodes.
template <ElementType E>
ElementPositions<E> gather(std::span<const Index> nodes, std::span<const Vec3> positions) {
  ElementPositions<E> x;
  for (int a = 0; a < nodes_per_element(E); ++a) {
    x.col(a) = positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])];
  }
  return x;
}

} // namespace pneuma::geometry
