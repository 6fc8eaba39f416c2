// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/reference.h"

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/shape_functions.h"

namespace pneuma::solver::element {

Reference make_reference(ElementType element, StressRule rule, std::span<const double> coordinates, const Vec3& warp,
                         std::span<const double> predeformation) {
  return geometry::dispatch(element, [&]<ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    const std::span<const geometry::QuadraturePoint> points = geometry::stress_rule(E, rule);
    const std::size_t count = coordinates.size() / (3 * n);
    Reference reference;
    reference.element = element;
    reference.rule = rule;
    reference.points = static_cast<Index>(points.size());
    reference.derivatives.resize(count * points.size() * n * 2);
    reference.area.resize(count * points.size());
    for (std::size_t e = 0; e < count; ++e) {
      const Eigen::Map<const Eigen::Matrix<double, 3, n>> x(coordinates.data() + e * 3 * n);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const geometry::ShapeValues<n> s = geometry::shape_functions<E>(points[k].xi, points[k].eta);
        const base::Mat32 g = x * s.derivative;
        const Vec3 normal = g.col(0).cross(g.col(1));
        const double jacobian = normal.norm();
        const Vec3 at = x * s.value;
        const Vec3 along = jacobian > 0 ? Vec3(warp - warp.dot(normal) / (jacobian * jacobian) * normal) : Vec3::Zero();
        if (!(jacobian > 1e-12 * g.squaredNorm()) || along.norm() < 1e-6 * warp.norm()) {
          throw base::GeometryError(
              fmt::format("element {} of the reference configuration is degenerate, or the warp direction is normal to "
                          "it, at {} m",
                          e, base::place_text(at)));
        }
        Eigen::Matrix<double, 3, 2> frame;
        frame.col(0) = along.normalized();
        frame.col(1) = normal.cross(frame.col(0)).normalized();
        const base::Mat2 jacobian_in_frame = frame.transpose() * g; // d material / d (xi, eta)
        base::Mat2 to_frame = jacobian_in_frame.inverse();          // d (xi, eta) / d material
        double area = points[k].weight * jacobian;
        if (!predeformation.empty()) {
          const double* p = predeformation.data() + (e * points.size() + k) * 3;
          base::Mat2 stretch;
          stretch << p[0], p[2], p[2], p[1];
          to_frame = to_frame * stretch; // d / d stress-free = d / d frame G
          area /= stretch.determinant();
        }
        Eigen::Map<Eigen::Matrix<double, n, 2, Eigen::RowMajor>>(
            reference.derivatives.data() + (e * points.size() + k) * n * 2) = s.derivative * to_frame;
        reference.area[e * points.size() + k] = area;
      }
    }
    return reference;
  });
}

std::vector<double> corner_coordinates(std::span<const Index> connectivity, std::span<const Vec3> positions) {
  std::vector<double> coordinates;
  coordinates.reserve(connectivity.size() * 3);
  for (const Index node : connectivity) {
    const Vec3& x = positions[static_cast<std::size_t>(node)];
    coordinates.insert(coordinates.end(), {x.x(), x.y(), x.z()});
  }
  return coordinates;
}

} // namespace pneuma::solver::element
