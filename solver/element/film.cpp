// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/film.h"

#include <cmath>

#include "geometry/volume.h"

namespace pneuma::solver::element {

namespace {

template <ElementType E>
Index film_forces_of(const Film& film, std::span<const Vec3> positions, double current, double& area,
                     const std::function<void(const ElementBatch&)>& take) {
  constexpr int n = geometry::nodes_per_element(E);
  constexpr int size = 3 * n;
  const std::span<const geometry::QuadraturePoint> rule = geometry::stress_rule(E, film.rule);
  const auto elements = static_cast<Index>(film.connectivity.size()) / n;
  Eigen::Matrix<double, 3, n> f;
  Eigen::Matrix<double, size, size> K;
  for (Index e = 0; e < elements; ++e) {
    const geometry::ElementPositions<E> x = geometry::gather<E>(
        film.connectivity.subspan(static_cast<std::size_t>(e * n), static_cast<std::size_t>(n)), positions);
    f.setZero();
    K.setZero();
    for (const geometry::QuadraturePoint& q : rule) {
      const geometry::ShapeValues<n> s = geometry::shape_functions<E>(q.xi, q.eta);
      const base::Mat32 g = x * s.derivative;
      const base::Mat2 metric = g.transpose() * g;
      const double jacobian = std::sqrt(metric.determinant());
      if (!(jacobian > 1e-10 * metric.trace())) return e;
      const base::Mat2 inverse = metric.inverse();
      const base::Mat32 contravariant = g * inverse;
      const double weight = film.tension * q.weight * jacobian; // N m
      area += q.weight * jacobian;
      const Eigen::Matrix<double, 3, n> gradient = contravariant * s.derivative.transpose(); // surface gradients of N
      f += weight * gradient;
      const Eigen::Matrix<double, n, n> product = s.derivative * inverse * s.derivative.transpose();
      // area: grad a grad b^T - grad b grad a^T + (grad a . grad b) (normal normal^T); reference: (grad a . grad b) I
      const base::Mat3 across = base::Mat3::Identity() - current * (contravariant * g.transpose());
      for (int b = 0; b < n; ++b) {
        for (int a = 0; a < n; ++a) {
          const base::Mat3 pair = gradient.col(a) * gradient.col(b).transpose();
          K.template block<3, 3>(3 * a, 3 * b) +=
              weight * (product(a, b) * across + current * (pair - pair.transpose()));
        }
      }
    }
    take({e, 1, f.data(), K.data()});
  }
  return -1;
}

} // namespace

Index film_forces(const Film& film, std::span<const Vec3> positions, double current, double& area,
                  const std::function<void(const ElementBatch&)>& take) {
  return geometry::dispatch(film.element,
                            [&]<ElementType E>() { return film_forces_of<E>(film, positions, current, area, take); });
}

} // namespace pneuma::solver::element
