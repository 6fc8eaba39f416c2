// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/plan_point.h"

#include "geometry/volume.h"

namespace pneuma::geometry {

std::optional<PlanPoint> point_over(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                                    const base::Vec2& at) {
  return dispatch(mesh.element, [&]<ElementType E>() -> std::optional<PlanPoint> {
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const std::span<const Index> nodes = mesh.element_nodes(block, e);
      const std::optional<PlanPlace> place = place_in_plan<E>(gather<E>(nodes, positions), at);
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
