// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "solver/material/concept.h"
#include "solver/material/plane_stress_return.h"

namespace pneuma::solver::material {

// J2 plasticity and viscoplasticity at large strain, isotropic, plane stress: F = Fe Fp, the logarithmic elastic strain
// e = ln(Ce)/2 gives the Kirchhoff stress T through linear isotropic elasticity (Hencky), whose von Mises stress flows;
// Fp <- exp(plastic increment) Fp keeps the volume exactly, Fp33 = 1 / det Fp (Weber and Anand 1990, Comput. Methods
// Appl. Mech. Eng. 79; Eterovic and Bathe 1990; de Souza Neto, Peric and Owen 2008, sec. 14.4). With isotropy e of the
// trial state Ce = Up^-1 C Up^-1 and T are coaxial: the return is that of small strains on the principal values,
//   s_i = T_i / c_i, c_i and n_i principal of Ce, S = Up^-1 (s_1 n_1 n_1 + s_2 n_2 n_2) Up^-1,
// and the tangent is exact and symmetric: with E_i = (c_i - 1) / 2 of Ce
//   ds_i/dE_j = D_ij / (c_i c_j) - 2 delta_ij T_i / c_i^2,   ds_12 = (s_1 - s_2) / (E_1 - E_2) dE_12,
// where the quotient is written with that of the logarithms, so that equal stretches lose no digits. Fails where
// det C <= 0. History: plastic stretch Up - I (of Fp only Cp = Up Up matters), alpha, dissipated work.
struct Logarithmic {
  static constexpr std::array<std::string_view, 5> history_names = {"plastic_stretch_11", "plastic_stretch_22",
                                                                    "plastic_stretch_12", equivalent_plastic_strain,
                                                                    dissipated_energy}; // stretches less one

  Elasticity elasticity;
  Flow flow;

  bool is_rate_dependent() const noexcept { return flow.viscous(); }

  Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                  Response& response) const noexcept {
    const Stretch up{old_history[0], old_history[1], old_history[2]};
    const double alpha = old_history[3];
    const double dissipated = old_history[4];
    // Ee = (Ce - I) / 2 = V E V + (V V - I) / 2 with V = Up^-1
    const Stretch v = inverse(up);
    const double v11 = 1 + v.x11;
    const double v22 = 1 + v.x22;
    const double v12 = v.x12;
    const double e12 = 0.5 * strain[2];
    const double l11 = v11 * strain[0] + v12 * e12; // V E
    const double l12 = v11 * e12 + v12 * strain[1];
    const double l21 = v12 * strain[0] + v22 * e12;
    const double l22 = v12 * e12 + v22 * strain[1];
    const double trial11 = l11 * v11 + l12 * v12 + v.x11 + 0.5 * (v.x11 * v.x11 + v12 * v12);
    const double trial22 = l21 * v12 + l22 * v22 + v.x22 + 0.5 * (v.x22 * v.x22 + v12 * v12);
    const double trial12 = l11 * v12 + l12 * v22 + v12 * (1 + 0.5 * (v.x11 + v.x22));

    // its principal values E_1 >= E_2, the first along (c, s), and those of e
    const double half = 0.5 * (trial11 - trial22);
    const double radius = std::sqrt(half * half + trial12 * trial12);
    const double smaller = 0.5 * (trial11 + trial22) - radius;
    const double c2 = 1 + 2 * smaller;
    const double c1 = c2 + 4 * radius;
    if (!(c2 > 0 && c1 < std::numeric_limits<double>::infinity())) return Status::failed;
    double c = 1;
    double s = 0;
    double e_difference = 0;
    double quotient = 1 / c2;        // (e_1 - e_2) / (E_1 - E_2)
    constexpr double equal = 1e-140; // the squares below lose digits to underflow
    if (radius > equal) {
      c = std::sqrt(0.5 + 0.5 * std::abs(half) / radius);
      s = 0.5 * trial12 / (radius * c);
      if (half < 0) std::swap(c, s);
      e_difference = 0.5 * std::log1p(4 * radius / c2);
      quotient = e_difference / (2 * radius);
    }

    const double two_g = 2 * elasticity.shear_modulus();
    double sum = elasticity.sum_modulus() * (std::log1p(2 * smaller) + e_difference); // T_1 + T_2
    double difference = two_g * e_difference;
    const PlasticStep step = plane_stress_return(elasticity, flow, sum, difference * difference, alpha, dt);
    sum *= step.sum;
    difference *= step.difference;
    const double T1 = 0.5 * (sum + difference);
    const double T2 = 0.5 * (sum - difference);
    const double xi_sum = elasticity.sum_modulus() * step.sum;
    const double xi_difference = two_g * step.difference;
    double D11 = 0.5 * (xi_sum + xi_difference);
    double D12 = 0.5 * (xi_sum - xi_difference);
    double D22 = D11;
    response.energy = elasticity.energy(sum, difference * difference);
    response.potential = response.energy;
    std::copy_n(old_history, history_names.size(), new_history);
    if (step.flows) {
      const double w1 = 0.25 * (xi_sum * sum + 3 * xi_difference * difference); // Xi P T
      const double w2 = 0.25 * (xi_sum * sum - 3 * xi_difference * difference);
      D11 -= step.softening * w1 * w1;
      D12 -= step.softening * w1 * w2;
      D22 -= step.softening * w2 * w2;
      response.potential += flow.potential(alpha, step.increment, step.time_ratio);
      const Stretch grown = grow(up, std::expm1(0.25 * step.multiplier * (sum + 3 * difference)),
                                 std::expm1(0.25 * step.multiplier * (sum - 3 * difference)), c, s);
      new_history[0] = grown.x11;
      new_history[1] = grown.x22;
      new_history[2] = grown.x12;
      new_history[3] = alpha + step.increment;
      new_history[4] = dissipated + step.increment * step.equivalent_stress;
    }

    const double i1 = 1 / c1;
    const double i2 = 1 / c2;
    const double P11 = (D11 - 2 * T1) * i1 * i1;
    const double P22 = (D22 - 2 * T2) * i2 * i2;
    const double P12 = D12 * i1 * i2;
    const double P33 = 0.25 * xi_difference * quotient * (i1 + i2) - 0.5 * sum * i1 * i2;
    // y_i = V n_i carries a strain to the principal axes and the stress back
    const double y11 = v11 * c + v12 * s;
    const double y12 = v12 * c + v22 * s;
    const double y21 = v12 * c - v11 * s;
    const double y22 = v22 * c - v12 * s;
    const Vec3 m1(y11 * y11, y12 * y12, y11 * y12);
    const Vec3 m2(y21 * y21, y22 * y22, y21 * y22);
    const Vec3 m3(2 * y11 * y21, 2 * y12 * y22, y11 * y22 + y12 * y21);
    response.stress = T1 * i1 * m1 + T2 * i2 * m2;
    for (int j = 0; j < 3; ++j) {
      const double p1 = P11 * m1[j] + P12 * m2[j];
      const double p2 = P12 * m1[j] + P22 * m2[j];
      const double p3 = P33 * m3[j];
      for (int i = j; i < 3; ++i) {
        response.tangent(i, j) = m1[i] * p1 + m2[i] * p2 + m3[i] * p3;
        response.tangent(j, i) = response.tangent(i, j);
      }
    }
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
  // A symmetric stretch less the identity, so that small ones lose no digits.
  struct Stretch {
    double x11 = 0, x22 = 0, x12 = 0;
  };

  // (I + X)^-1 = I - (X + det(X) I) / det(I + X)
  static Stretch inverse(const Stretch& x) noexcept {
    const double det = x.x11 * x.x22 - x.x12 * x.x12;
    const double factor = -1 / (1 + x.x11 + x.x22 + det);
    return {factor * (x.x11 + det), factor * (x.x22 + det), factor * x.x12};
  }

  // Stretch of M = (I + p) (I + X), p = p1 n1 n1 + p2 n2 n2, n1 = (c, s): M less its rotation.
  static Stretch grow(const Stretch& x, double p1, double p2, double c, double s) noexcept {
    const double p11 = p1 * c * c + p2 * s * s;
    const double p22 = p1 * s * s + p2 * c * c;
    const double p12 = (p1 - p2) * c * s;
    const double n11 = p11 + x.x11 + p11 * x.x11 + p12 * x.x12; // of M - I
    const double n12 = p12 + x.x12 + p11 * x.x12 + p12 * x.x22;
    const double n21 = p12 + x.x12 + p12 * x.x11 + p22 * x.x12;
    const double n22 = p22 + x.x22 + p12 * x.x12 + p22 * x.x22;
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
