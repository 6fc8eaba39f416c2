// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/unit/solver/laws.h"

namespace pneuma::tests {

inline solver::material::Hardening hardening(std::vector<solver::material::HardeningBranch> branches) {
  return solver::material::piecewise_linear(branches).value();
}

// The foil of the thesis' uniaxial and biaxial tests (B9): moduli and stresses in Pa.
inline const solver::material::Elasticity etfe_elasticity{1100e6, 0.43};
inline solver::material::Hardening etfe_hardening() {
  return hardening({{16e6, 160e6}, {27e6, 80e6}});
}

// A material point on its path.
template <solver::material::Material M>
struct Path {
  M law;
  std::array<double, solver::material::history_size<M>> history{};

  struct Trial {
    Response response;
    std::array<double, solver::material::history_size<M>> history{};
  };
  Trial at(const Vec3& strain, double dt = 0) const {
    Trial trial;
    EXPECT_EQ(law.evaluate(strain, history.data(), trial.history.data(), dt, trial.response),
              solver::material::Status::ok)
        << strain.transpose();
    return trial;
  }
  Response accept(const Vec3& strain, double dt = 0) {
    const Trial trial = at(strain, dt);
    history = trial.history;
    return trial.response;
  }

  double alpha() const { return history[3]; }
  double dissipated() const { return history[4]; }
  double thickness(const Vec3& strain) const { return law.thickness_stretch(strain, history.data()); }

  double tangent_error(const Vec3& strain, double dt, double step) const {
    const auto stress = [&](const Eigen::VectorXd& e) { return Eigen::VectorXd(at(Vec3(e), dt).response.stress); };
    return relative_difference(finite_difference_jacobian(stress, strain, step), at(strain, dt).response.tangent);
  }
  double stress_error(const Vec3& strain, double dt, double step) const {
    const auto potential = [&](const Eigen::VectorXd& e) {
      return Eigen::VectorXd::Constant(1, at(Vec3(e), dt).response.potential).eval();
    };
    return relative_difference(finite_difference_jacobian(potential, strain, step),
                               at(strain, dt).response.stress.transpose());
  }
};

} // namespace pneuma::tests
