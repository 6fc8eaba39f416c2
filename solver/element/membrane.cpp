// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/membrane.h"

#include <algorithm>
#include <cmath>

#include "geometry/shape_functions.h"
#include "geometry/volume.h"

namespace pneuma::solver::element {

namespace {

Vec3 green_lagrange(const base::Mat32& deformation) {
  return {0.5 * (deformation.col(0).squaredNorm() - 1), 0.5 * (deformation.col(1).squaredNorm() - 1),
          deformation.col(0).dot(deformation.col(1))};
}

template <ElementType E>
std::optional<Failed> membrane_forces_of(const Membrane& m, std::span<const Vec3> positions,
                                         std::span<const double> old_history, std::span<double> new_history, double dt,
                                         bool with_tangent, double& energy,
                                         const std::function<void(const ElementBatch&)>& take) {
  constexpr int n = geometry::nodes_per_element(E);
  constexpr int size = 3 * n;
  using Derivatives = Eigen::Map<const Eigen::Matrix<double, n, 2, Eigen::RowMajor>>;
  const Index points = m.reference.points;
  const Index per_batch = material::Batch::capacity / points;
  const Index elements = m.reference.element_count();
  const int components = material::history_components(m.law);

  material::Batch batch;
  batch.dt = dt;
  std::array<base::Mat32, material::Batch::capacity> deformation;
  std::vector<double> force(static_cast<std::size_t>(per_batch * size));
  std::vector<double> tangent(with_tangent ? static_cast<std::size_t>(per_batch * size * size) : 0);

  for (Index first = 0; first < elements; first += per_batch) {
    const Index count = std::min(per_batch, elements - first);
    batch.count = count * points;
    for (Index e = 0; e < count; ++e) {
      const geometry::ElementPositions<E> x = geometry::gather<E>(
          m.connectivity.subspan(static_cast<std::size_t>((first + e) * n), static_cast<std::size_t>(n)), positions);
      for (Index k = 0; k < points; ++k) {
        const auto i = static_cast<std::size_t>(e * points + k);
        const std::size_t point = static_cast<std::size_t>(first * points) + i;
        deformation[i].noalias() = x * Derivatives(m.reference.derivatives.data() + point * n * 2);
        batch.strain[i] = green_lagrange(deformation[i]);
      }
    }
    if (components > 0) {
      const auto offset = static_cast<std::size_t>(first * points * components);
      batch.old_history = old_history.data() + offset;
      batch.new_history = new_history.data() + offset;
    }
    if (const int failed = material::evaluate(m.law, batch); failed >= 0) {
      return Failed{first + failed / points, batch.status, batch.strain[static_cast<std::size_t>(failed)]};
    }

    std::fill(force.begin(), force.end(), 0.0);
    std::fill(tangent.begin(), tangent.end(), 0.0);
    for (Index e = 0; e < count; ++e) {
      Eigen::Map<Eigen::Matrix<double, 3, n>> f(force.data() + e * size);
      for (Index k = 0; k < points; ++k) {
        const auto i = static_cast<std::size_t>(e * points + k);
        const std::size_t point = static_cast<std::size_t>(first * points) + i;
        const Derivatives d(m.reference.derivatives.data() + point * n * 2);
        const double weight = m.thickness * m.reference.area[point]; // m3
        const base::Mat32& F = deformation[i];
        base::Mat2 S;
        const Vec3& stress = batch.response[i].stress;
        S << stress[0], stress[2], stress[2], stress[1];
        S *= weight;
        energy += weight * batch.response[i].energy;
        const base::Mat32 P = F * S;
        f.noalias() += P * d.transpose();
        if (!with_tangent) continue;
        Eigen::Matrix<double, 3, size> B; // d strain / d x
        for (int a = 0; a < n; ++a) {
          B.template block<1, 3>(0, 3 * a) = d(a, 0) * F.col(0).transpose();
          B.template block<1, 3>(1, 3 * a) = d(a, 1) * F.col(1).transpose();
          B.template block<1, 3>(2, 3 * a) = d(a, 0) * F.col(1).transpose() + d(a, 1) * F.col(0).transpose();
        }
        const Eigen::Matrix<double, 3, size> CB = weight * batch.response[i].tangent * B;
        Eigen::Map<Eigen::Matrix<double, size, size>> K(tangent.data() + e * size * size);
        K.noalias() += B.transpose() * CB;
        const Eigen::Matrix<double, n, 2> dS = d * S;
        const Eigen::Matrix<double, n, n> geometric = dS * d.transpose();
        for (int b = 0; b < n; ++b) {
          for (int a = 0; a < n; ++a) {
            for (int c = 0; c < 3; ++c) K(3 * a + c, 3 * b + c) += geometric(a, b);
          }
        }
      }
    }
    take({first, count, force.data(), with_tangent ? tangent.data() : nullptr});
  }
  return std::nullopt;
}

} // namespace

std::optional<Failed> membrane_forces(const Membrane& membrane, std::span<const Vec3> positions,
                                      std::span<const double> old_history, std::span<double> new_history, double dt,
                                      bool with_tangent, double& energy,
                                      const std::function<void(const ElementBatch&)>& take) {
  return geometry::dispatch(membrane.reference.element, [&]<ElementType E>() {
    return membrane_forces_of<E>(membrane, positions, old_history, new_history, dt, with_tangent, energy, take);
  });
}

std::vector<PointState> point_states(const Membrane& membrane, std::span<const Vec3> positions,
                                     std::span<const double> history) {
  return geometry::dispatch(membrane.reference.element, [&]<ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    const Index points = membrane.reference.points;
    const int components = material::history_components(membrane.law);
    std::vector<PointState> states(membrane.reference.area.size());
    std::vector<double> scratch(static_cast<std::size_t>(std::max(components, 1)));
    const std::span<const std::string_view> names = material::history_names(membrane.law);
    material::Batch one;
    one.count = 1;
    const auto component = [&](std::string_view name) {
      const auto which = std::ranges::find(names, name);
      return which == names.end() ? 0.0 : one.old_history[which - names.begin()];
    };
    one.new_history = scratch.data();
    for (std::size_t i = 0; i < states.size(); ++i) {
      const std::size_t element = i / static_cast<std::size_t>(points);
      const geometry::ElementPositions<E> x =
          geometry::gather<E>(membrane.connectivity.subspan(element * n, n), positions);
      PointState& state = states[i];
      state.deformation = x * Eigen::Map<const Eigen::Matrix<double, n, 2, Eigen::RowMajor>>(
                                  membrane.reference.derivatives.data() + i * n * 2);
      one.strain[0] = green_lagrange(state.deformation);
      one.old_history = components > 0 ? history.data() + i * static_cast<std::size_t>(components) : nullptr;
      material::evaluate(membrane.law, one);
      state.stress = one.response[0].stress;
      state.stored = one.response[0].energy;
      state.plastic_strain = component(material::equivalent_plastic_strain);
      state.dissipated = component(material::dissipated_energy);
      state.thickness_ratio = material::thickness_stretch(membrane.law, one.strain[0], one.old_history);
      const material::Relaxed relaxed = material::relaxed(membrane.law, one.strain[0], one.old_history);
      state.surface = relaxed.surface;
      state.strain = relaxed.strain;

      const Vec3& e = state.strain;
      const double area_ratio = std::sqrt((1 + 2 * e[0]) * (1 + 2 * e[1]) - e[2] * e[2]);
      const double volume_ratio = area_ratio * state.thickness_ratio;
      const Vec3 normal = state.deformation.col(0).cross(state.deformation.col(1));
      state.axes.col(0) = state.deformation.col(0).normalized();
      state.axes.col(1) = normal.normalized().cross(state.axes.col(0));
      const base::Mat2 F = state.axes.transpose() * state.deformation;
      base::Mat2 S;
      S << state.stress[0], state.stress[2], state.stress[2], state.stress[1];
      state.cauchy = F * S * F.transpose() / volume_ratio;
    }
    return states;
  });
}

void add_weight(const Membrane& membrane, double density, const Vec3& acceleration, std::span<double> force) {
  geometry::dispatch(membrane.reference.element, [&]<ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    const std::span<const geometry::QuadraturePoint> rule = geometry::stress_rule(E, membrane.reference.rule);
    for (std::size_t i = 0; i < membrane.reference.area.size(); ++i) {
      const std::size_t e = i / rule.size();
      const geometry::QuadraturePoint& q = rule[i % rule.size()];
      const geometry::ShapeValues<n> s = geometry::shape_functions<E>(q.xi, q.eta);
      const double mass = density * membrane.thickness * membrane.reference.area[i];
      for (int a = 0; a < n; ++a) {
        const auto node = static_cast<std::size_t>(membrane.connectivity[e * n + static_cast<std::size_t>(a)]);
        for (std::size_t c = 0; c < 3; ++c) {
          force[3 * node + c] += s.value[a] * mass * acceleration[static_cast<Eigen::Index>(c)];
        }
      }
    }
  });
}

} // namespace pneuma::solver::element
