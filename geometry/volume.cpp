// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/volume.h"

namespace pneuma::geometry {

double volume_below(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, const Vec3& origin) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    const std::span<const QuadraturePoint> rule = pressure_rule(E);
    PressureElement<E> element;
    double volume = 0;
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      ElementPositions<E> x = gather<E>(mesh.element_nodes(block, e), positions);
      x.colwise() -= origin;
      pressure_element<E>(x, rule, false, element);
      volume += element.volume;
    }
    return volume;
  });
}

double enclosed_volume(const Mesh& mesh, const Block& outer, const Block& inner, std::span<const Vec3> positions) {
  // an origin on the common surface keeps the two terms small
  const Vec3& origin = positions[static_cast<std::size_t>(outer.connectivity.front())];
  return volume_below(mesh, outer, positions, origin) - volume_below(mesh, inner, positions, origin);
}

} // namespace pneuma::geometry
