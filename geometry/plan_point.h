// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include <Eigen/LU>

#include "geometry/mesh.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

// A place of an element, and its height there (third coordinate, m).
struct PlanPlace {
  double xi = 0, eta = 0, height = 0;
};

// The place of an element, nodes one a column, over a point of the plan; none if the point does not lie on it or the
// element does not face up there. Newton's method.
template <ElementType E>
std::optional<PlanPlace> place_in_plan(const Eigen::Matrix<double, 3, nodes_per_element(E)>& x, const base::Vec2& at) {
  const base::Vec2 low = x.template topRows<2>().rowwise().minCoeff();
  const base::Vec2 high = x.template topRows<2>().rowwise().maxCoeff();
  const double size = (high - low).maxCoeff();
  const double margin = is_quadratic(E) ? 0.2 * size : 1e-9 * size; // curved sides leave the box of their nodes
  if ((at.array() < low.array() - margin).any() || (at.array() > high.array() + margin).any()) return {};

  constexpr bool triangle = corners_per_element(E) == 3;
  base::Vec2 place = triangle ? base::Vec2(1.0 / 3, 1.0 / 3) : base::Vec2(0, 0);
  constexpr int most = E == ElementType::T3 ? 2 : 15;
  for (int iteration = 0; iteration < most; ++iteration) {
    const auto shape = shape_functions<E>(place[0], place[1]);
    const Eigen::Matrix<double, 3, 2> tangents = x * shape.derivative;
    const base::Mat2 jacobian = tangents.template topRows<2>();
    const double determinant = jacobian.determinant();
    const base::Vec3 point = x * shape.value;
    const base::Vec2 miss = at - point.head<2>();
    if (miss.norm() <= 1e-12 * size) {
      constexpr double edge = 1e-8; // a point on a side belongs to both neighbours
      const bool on =
          triangle ? place.minCoeff() >= -edge && place.sum() <= 1 + edge : place.cwiseAbs().maxCoeff() <= 1 + edge;
      if (!on || determinant <= 1e-12 * size * size) return {};
      return PlanPlace{place[0], place[1], point.z()};
    }
    if (!(std::abs(determinant) > 1e-14 * size * size)) return {};
    place += jacobian.inverse() * miss;
    if (!(place.cwiseAbs().maxCoeff() < 4)) return {};
  }
  return {};
}

// A point of a block over a point of the plan (seen along z): the nodes of its element, with their shape functions.
struct PlanPoint {
  std::vector<Index> nodes;
  std::vector<double> weights;
};

// None if the block does not reach over the point.
std::optional<PlanPoint> point_over(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                                    const base::Vec2& at);

} // namespace pneuma::geometry
