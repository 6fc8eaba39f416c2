// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "solver/material/material.h"
#include "tests/unit/finite_differences.h"

namespace pneuma::tests {

using base::Mat2;
using base::Mat3;
using base::Vec3;
using solver::material::Response;

// What a law without history answers.
template <solver::material::Material M>
Response answer(const M& law, const Vec3& strain) {
  Response a;
  EXPECT_EQ(law.evaluate(strain, nullptr, nullptr, 0, a), solver::material::Status::ok) << strain.transpose();
  return a;
}

// Largest differences of the tangent from differences of the stress, and of the stress from those of the potential,
// each relative to the largest entry.
template <solver::material::Material M>
double tangent_error(const M& law, const Vec3& strain, double step) {
  const auto stress = [&](const Eigen::VectorXd& e) { return Eigen::VectorXd(answer(law, Vec3(e)).stress); };
  return relative_difference(finite_difference_jacobian(stress, strain, step), answer(law, strain).tangent);
}

template <solver::material::Material M>
double stress_error(const M& law, const Vec3& strain, double step) {
  const auto energy = [&](const Eigen::VectorXd& e) {
    return Eigen::VectorXd::Constant(1, answer(law, Vec3(e)).potential).eval();
  };
  const Response at = answer(law, strain);
  return relative_difference(finite_difference_jacobian(energy, strain, step), at.stress.transpose());
}

// Counts how often it is asked.
template <solver::material::Material M>
struct Counted : M {
  static inline int asked = 0;
  solver::material::Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                                    Response& response) const noexcept {
    ++asked;
    return M::evaluate(strain, old_history, new_history, dt, response);
  }
};

// Green-Lagrange strain of stretches along axes turned by `angle`.
inline Vec3 strain_of(double stretch1, double stretch2, double angle = 0) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double e1 = 0.5 * (stretch1 * stretch1 - 1);
  const double e2 = 0.5 * (stretch2 * stretch2 - 1);
  return {c * c * e1 + s * s * e2, s * s * e1 + c * c * e2, 2 * c * s * (e1 - e2)};
}

} // namespace pneuma::tests
