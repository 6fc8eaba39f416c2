// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/plan_point.h"

namespace pneuma::geometry {

std::optional<PlanPoint> point_over(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                                    const base::Vec2& at) {
  return dispatch(mesh.element, [&]<ElementType E>() -> std::optional<PlanPoint> {
    constexpr int n = nodes_per_element(E);
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const std::span<const Index> nodes = mesh.element_nodes(block, e);
      Eigen::Matrix<double, 3, n> x;
      for (int a = 0; a < n; ++a) {
        x.col(a) = positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])];
      }
      const std::optional<PlanPlace> place = place_in_plan<E>(x, at);
      if (!place) continue;
      PlanPoint point;
      const auto values = shape_functions<E>(place->xi, place->eta).value;
      point.nodes.assign(nodes.begin(), nodes.end());
      point.weights.assign(values.begin(), values.end());
      return point;
    }
    return std::nullopt;
  });
}

} // namespace pneuma::geometry
