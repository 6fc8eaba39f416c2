// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/load/loads.h"

#include "geometry/volume.h"

namespace pneuma::solver::load {

void add_plan_load(const geometry::Mesh& mesh, Index block, std::span<const Vec3> positions,
                   const geometry::RegionQuadrature& region, const Vec3& per_plan_area, VecX& force) {
  const geometry::Block& foil = mesh.blocks[static_cast<std::size_t>(block)];
  geometry::dispatch(mesh.element, [&]<geometry::ElementType E>() {
    for (const geometry::RegionQuadrature::Part& part : region.parts) {
      const std::span<const Index> nodes = mesh.element_nodes(foil, part.element);
      const geometry::ElementPositions<E> x = geometry::gather<E>(nodes, positions);
      for (const geometry::QuadraturePoint& q : region.points_of(part)) {
        const auto s = geometry::shape_functions<E>(q.xi, q.eta);
        const base::Mat32 g = x * s.derivative;
        const double plan = q.weight * (g(0, 0) * g(1, 1) - g(1, 0) * g(0, 1));
        for (std::size_t a = 0; a < nodes.size(); ++a) {
          force.segment<3>(3 * nodes[a]) += s.value[static_cast<Eigen::Index>(a)] * plan * per_plan_area;
        }
      }
    }
  });
}

assembly::PressureZone pressure_zone(const geometry::Mesh& mesh, Index block,
                                     const geometry::RegionQuadrature& region) {
  assembly::PressureZone zone;
  zone.block = block;
  const Index elements = mesh.element_count(mesh.blocks[static_cast<std::size_t>(block)]);
  auto part = region.parts.begin();
  zone.offset.push_back(0);
  for (Index e = 0; e < elements; ++e) {
    if (part != region.parts.end() && part->element == e) {
      const std::span<const geometry::QuadraturePoint> points = region.points_of(*part);
      zone.points.insert(zone.points.end(), points.begin(), points.end());
      ++part;
    }
    zone.offset.push_back(static_cast<Index>(zone.points.size()));
  }
  return zone;
}

} // namespace pneuma::solver::load
