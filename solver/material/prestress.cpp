// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/prestress.h"

#include <cmath>
#include <vector>

namespace pneuma::solver::material {

namespace {

base::Mat2 symmetric(const Vec3& v) {
  base::Mat2 m;
  m << v[0], v[2], v[2], v[1];
  return m;
}

Vec3 components(const base::Mat2& m) {
  return {m(0, 0), m(1, 1), 0.5 * (m(0, 1) + m(1, 0))};
}

// Cauchy force per current length, and whether the foil yielded on its way there from no stress.
struct Carried {
  Vec3 force;
  bool yields = false;
};

Carried carried(const Law& law, double thickness, const Vec3& predeformation) {
  const base::Mat2 g = symmetric(predeformation);
  const base::Mat2 c = g * g;
  Batch batch;
  batch.count = 1;
  batch.strain[0] = Vec3(0.5 * (c(0, 0) - 1), 0.5 * (c(1, 1) - 1), c(0, 1));
  const auto components_of_history = static_cast<std::size_t>(history_components(law));
  const std::vector<double> before(components_of_history, 0.0);
  std::vector<double> behind = before;
  batch.old_history = before.data();
  batch.new_history = behind.data();
  if (evaluate(law, batch) != -1) return {Vec3::Constant(std::nan(""))};
  return {components(thickness / g.determinant() * g * symmetric(batch.response[0].stress) * g), behind != before};
}

} // namespace

Vec3 prestress_of(const Law& law, double thickness, const Vec3& predeformation) {
  return carried(law, thickness, predeformation).force;
}

std::optional<Vec3> predeformation(const Law& law, double thickness, const Vec3& force) {
  const auto without_yield = [&](const Vec3& g) {
    return carried(law, thickness, g).yields ? std::nullopt : std::optional<Vec3>(g);
  };
  const double scale = force.cwiseAbs().maxCoeff();
  Vec3 g(1, 1, 0);
  if (scale == 0) return g;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Vec3 error = prestress_of(law, thickness, g) - force;
    if (!error.allFinite()) return std::nullopt;
    if (error.cwiseAbs().maxCoeff() < 1e-14 * scale) return without_yield(g);
    Mat3 slope; // three smooth unknowns, once a point: central differences serve, the residual decides
    constexpr double step = 1e-5;
    for (int j = 0; j < 3; ++j) {
      Vec3 forward = g;
      Vec3 backward = g;
      forward[j] += step;
      backward[j] -= step;
      slope.col(j) = (prestress_of(law, thickness, forward) - prestress_of(law, thickness, backward)) / (2 * step);
    }
    const Vec3 change = slope.inverse() * error;
    if (!change.allFinite()) return std::nullopt;
    g -= change;
    if (change.cwiseAbs().maxCoeff() < 4e-16)
      return without_yield(g); // rounding: a thick foil is hardly stretched by it
  }
  const Vec3 error = prestress_of(law, thickness, g) - force;
  return error.cwiseAbs().maxCoeff() < 1e-11 * scale ? without_yield(g) : std::nullopt;
}

} // namespace pneuma::solver::material
