// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "solver/material/concept.h"
#include "solver/material/plane_stress_return.h"

namespace pneuma::solver::material {

// J2 plasticity and viscoplasticity for small strains but any rotation: Green-Lagrange strain less plastic strain
// through isotropic elasticity gives S, whose von Mises stress flows (Simo and Hughes 1998, Computational Inelasticity,
// sec. 3.4 and box 3.3; the return is in plane_stress_return.h). Strains beyond a few percent belong to `Logarithmic`.
// History: plastic strain (tensor components), alpha, dissipated work of the plastic strain.
struct J2 {
  static constexpr std::array<std::string_view, 5> history_names = {
      "plastic_strain_11", "plastic_strain_22", "plastic_strain_12", equivalent_plastic_strain, dissipated_energy};

  Elasticity elasticity;
  Flow flow;

  bool is_rate_dependent() const noexcept { return flow.viscous(); }

  Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                  Response& response) const noexcept {
    const Vec3 elastic = strain - stress_free_strain(old_history);
    const double two_g = 2 * elasticity.shear_modulus();
    double sum = elasticity.sum_modulus() * (elastic[0] + elastic[1]);
    double difference = two_g * (elastic[0] - elastic[1]);
    double shear = 0.5 * two_g * elastic[2];
    const double alpha = old_history[3];
    const double dissipated = old_history[4];
    const double difference_squared = difference * difference + 4 * shear * shear;
    if (!std::isfinite(sum * sum + difference_squared)) return Status::failed; // a wild step
    const PlasticStep step = plane_stress_return(elasticity, flow, sum, difference_squared, alpha, dt);
    sum *= step.sum;
    difference *= step.difference;
    shear *= step.difference;
    response.stress = Vec3(0.5 * (sum + difference), 0.5 * (sum - difference), shear);
    const double xi_sum = elasticity.sum_modulus() * step.sum;
    const double xi_difference = two_g * step.difference;
    const double diagonal = 0.5 * (xi_sum + xi_difference);
    const double off = 0.5 * (xi_sum - xi_difference);
    response.tangent << diagonal, off, 0, off, diagonal, 0, 0, 0, 0.5 * xi_difference;
    response.energy = elasticity.energy(sum, difference * difference + 4 * shear * shear);
    response.potential = response.energy;
    std::copy_n(old_history, history_names.size(), new_history);
    if (!step.flows) return Status::ok;

    const Vec3 w(0.25 * (xi_sum * sum + 3 * xi_difference * difference),
                 0.25 * (xi_sum * sum - 3 * xi_difference * difference), 1.5 * xi_difference * shear); // Xi P s
    response.tangent.noalias() -= step.softening * w * w.transpose();
    response.potential += flow.potential(alpha, step.increment, step.time_ratio);
    new_history[0] += 0.25 * step.multiplier * (sum + 3 * difference);
    new_history[1] += 0.25 * step.multiplier * (sum - 3 * difference);
    new_history[2] += 1.5 * step.multiplier * shear;
    new_history[3] = alpha + step.increment;
    new_history[4] = dissipated + flow.dissipation(alpha, step.increment, step.equivalent_stress);
    return Status::ok;
  }

  // As St. Venant-Kirchhoff's of the elastic strain (NaN where that law has no thickness), times that of the plastic
  // one, which keeps the volume however large it is.
  double thickness_stretch(const Vec3& strain, const double* history) const noexcept {
    const double elastic = elasticity.thickness_strain(strain[0] + strain[1] - history[0] - history[1]);
    const double plastic_area = (1 + 2 * history[0]) * (1 + 2 * history[1]) - 4 * history[2] * history[2]; // squared
    return std::sqrt((1 + 2 * elastic) / plastic_area);
  }

  Vec3 stress_free_strain(const double* history) const noexcept { return {history[0], history[1], 2 * history[2]}; }
};
static_assert(Material<J2>);

} // namespace pneuma::solver::material
