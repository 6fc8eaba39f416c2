// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "solver/material/concept.h"
#include "solver/material/plane_stress_return.h"
#include "solver/material/principal.h"

namespace pneuma::solver::material {

// J2 plasticity and viscoplasticity at large strain, isotropic, plane stress: F = Fe Fp, the logarithmic elastic strain
// e = ln(Ce)/2 gives the Kirchhoff stress T through linear isotropic elasticity (Hencky), whose von Mises stress flows;
// Fp <- exp(plastic increment) Fp keeps the volume exactly, Fp33 = 1 / det Fp (Weber and Anand 1990, Comput. Methods
// Appl. Mech. Eng. 79; Eterovic and Bathe 1990; de Souza Neto, Peric and Owen 2008, sec. 14.4). With isotropy e of the
// trial state Ce = Up^-1 C Up^-1 and T are coaxial: the return is that of small strains on the principal values,
//   s_i = T_i / c_i, c_i and n_i principal of Ce, S = Up^-1 (s_1 n_1 n_1 + s_2 n_2 n_2) Up^-1,
// and the tangent is exact and symmetric (`of_logarithm`). Fails where det C <= 0. History: plastic stretch Up - I (of
// Fp only Cp = Up Up matters), alpha, dissipated work.
struct Logarithmic {
  static constexpr std::array<std::string_view, 5> history_names = {"plastic_stretch_11", "plastic_stretch_22",
                                                                    "plastic_stretch_12", equivalent_plastic_strain,
                                                                    dissipated_energy}; // stretches less one

  Elasticity elasticity;
  Flow flow;

  bool is_rate_dependent() const noexcept { return flow.viscous(); }

  Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                  Response& response) const noexcept {
    const Symmetric up(old_history[0], old_history[1], old_history[2]);
    const double alpha = old_history[3];
    const double dissipated = old_history[4];
    const Symmetric v = inverse(up); // Up^-1 - I
    PrincipalStrain trial = principal_strain(pulled_back(strain, v));
    const PrincipalLogarithm log = principal_logarithm(trial);
    if (!(log.c2 > 0) || !std::isfinite(log.c1)) return Status::failed;

    const double two_g = 2 * elasticity.shear_modulus();
    double sum = elasticity.sum_modulus() * (2 * log.second + log.difference); // T1 + T2
    double difference = two_g * log.difference;
    if (!std::isfinite(sum * sum + difference * difference)) return Status::failed; // of a step gone wild
    const PlasticStep step = plane_stress_return(elasticity, flow, sum, difference * difference, alpha, dt);
    sum *= step.sum;
    difference *= step.difference;
    const double xi_sum = elasticity.sum_modulus() * step.sum;
    const double xi_difference = two_g * step.difference;
    PrincipalKirchhoff t;
    t.t1 = 0.5 * (sum + difference);
    t.t2 = 0.5 * (sum - difference);
    t.quotient = xi_difference;
    t.d11 = t.d22 = 0.5 * (xi_sum + xi_difference);
    t.d12 = 0.5 * (xi_sum - xi_difference);
    response.energy = elasticity.energy(sum, difference * difference);
    response.potential = response.energy;
    std::copy_n(old_history, history_names.size(), new_history);
    if (step.flows) {
      const double w1 = 0.25 * (xi_sum * sum + 3 * xi_difference * difference); // Xi P T
      const double w2 = 0.25 * (xi_sum * sum - 3 * xi_difference * difference);
      t.d11 -= step.softening * w1 * w1;
      t.d12 -= step.softening * w1 * w2;
      t.d22 -= step.softening * w2 * w2;
      response.potential += flow.potential(alpha, step.increment, step.time_ratio);
      const Symmetric grown = grow(up, std::expm1(0.25 * step.multiplier * (sum + 3 * difference)) * trial.along1 +
                                           std::expm1(0.25 * step.multiplier * (sum - 3 * difference)) * trial.along2);
      new_history[0] = grown[0];
      new_history[1] = grown[1];
      new_history[2] = grown[2];
      new_history[3] = alpha + step.increment;
      new_history[4] = dissipated + flow.dissipation(alpha, step.increment, step.equivalent_stress);
    }

    trial.along1 = pushed_forward(trial.along1, v);
    trial.along2 = pushed_forward(trial.along2, v);
    trial.shear = pushed_forward(trial.shear, v);
    in_frame(trial, of_logarithm(log, t), response.stress, response.tangent);
    return Status::ok;
  }

  // exp of the elastic ln(Ce)33 / 2 = -nu / (1 - nu) ln(det Ce) / 2, times Fp33 = 1 / det Up
  double thickness_stretch(const Vec3& strain, const double* history) const noexcept {
    const double plastic = (1 + history[0]) * (1 + history[1]) - history[2] * history[2];
    const double area = std::sqrt((1 + 2 * strain[0]) * (1 + 2 * strain[1]) - strain[2] * strain[2]);
    return std::exp(elasticity.thickness_strain(std::log(area / plastic))) / plastic;
  }

  // (Up Up - I) / 2
  Vec3 stress_free_strain(const double* history) const noexcept {
    const double a = history[0];
    const double b = history[1];
    const double d = history[2];
    return {a + 0.5 * (a * a + d * d), b + 0.5 * (b * b + d * d), d * (2 + a + b)};
  }

private:
  // Components (11, 22, 12); stretches less the identity, so that small ones lose no digits.
  using Symmetric = Vec3;

  // (I + X)^-1 - I = -(X + det(X) I) / det(I + X)
  static Symmetric inverse(const Symmetric& x) noexcept {
    const double det = x[0] * x[1] - x[2] * x[2];
    const double factor = -1 / (1 + x[0] + x[1] + det);
    return factor * Symmetric(x[0] + det, x[1] + det, x[2]);
  }

  // (I + V) n (I + V): a direction of Ce makes a strain of C's one of Ce and a stress of Ce's one of C
  static Symmetric pushed_forward(const Symmetric& n, const Symmetric& v) noexcept {
    const double a = 1 + v[0];
    const double b = 1 + v[1];
    const double d = v[2];
    return {a * a * n[0] + 2 * a * d * n[2] + d * d * n[1], d * d * n[0] + 2 * b * d * n[2] + b * b * n[1],
            a * d * n[0] + (a * b + d * d) * n[2] + b * d * n[1]};
  }

  // (Ce - I)/2 = (I + V) E (I + V) + V + V V / 2, with 2 x the shear like the strain
  static Vec3 pulled_back(const Vec3& strain, const Symmetric& v) noexcept {
    const Symmetric e = pushed_forward(Symmetric(strain[0], strain[1], 0.5 * strain[2]), v);
    return {e[0] + v[0] + 0.5 * (v[0] * v[0] + v[2] * v[2]), e[1] + v[1] + 0.5 * (v[1] * v[1] + v[2] * v[2]),
            2 * e[2] + v[2] * (2 + v[0] + v[1])};
  }

  // Stretch of M = (I + p) (I + X), which is M less its rotation.
  static Symmetric grow(const Symmetric& x, const Symmetric& p) noexcept {
    const double n11 = p[0] + x[0] + p[0] * x[0] + p[2] * x[2]; // of M - I
    const double n12 = p[2] + x[2] + p[0] * x[2] + p[2] * x[1];
    const double n21 = p[2] + x[2] + p[2] * x[0] + p[1] * x[2];
    const double n22 = p[1] + x[1] + p[2] * x[2] + p[1] * x[1];
    const double size = std::hypot(2 + n11 + n22, n21 - n12);
    const double cosine = (2 + n11 + n22) / size;
    const double sine = (n21 - n12) / size;
    const double less_one = -sine * sine / (1 + cosine); // cosine - 1
    return {less_one + cosine * n11 + sine * n21, less_one + cosine * n22 - sine * n12,
            cosine * n12 + sine * (1 + n22)};
  }
};
static_assert(Material<Logarithmic>);

} // namespace pneuma::solver::material
