// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "solver/material/hardening.h"

namespace pneuma::solver::material {

enum class Overstress : std::uint8_t { none, peric, perzyna };

// Rate dependence of the flow stress (de Souza Neto, Peric and Owen 2008, Computational Methods for Plasticity, sec.
// 11.3). Flow begins at sigma_0 and goes on at an equivalent stress that exceeds it by a multiple of the yield stress
// sigma_y(alpha), which grows with z = mu dalpha/dt:
//   sigma_eq = sigma_0(alpha) + sigma_y(alpha) g(z),   Peric g = (1 + z)^epsilon - 1,   Perzyna g = z^epsilon
// Without a threshold sigma_0 = sigma_y, which is the standard form of both: sigma_eq = sigma_y (1 + z)^epsilon and
// dalpha/dt = [sigma_eq / sigma_y - 1]^(1/epsilon) / mu; mu -> 0 gives the plastic law, epsilon -> 0 too with Peric,
// twice the yield stress with Perzyna. A threshold moves the onset of flow, sigma_0 = threshold + sigma_y(alpha) -
// sigma_y(0), and leaves sigma_y as the scale of overstress: a foil creeps below its yield stress, and mu -> 0 gives
// the plastic law that yields at the threshold.
struct Viscosity {
  Overstress model = Overstress::none;
  double mu = 0;                   // s
  double epsilon = 1;              // -, > 0
  std::optional<double> threshold; // Pa, >= 0
};

// (1 + z)^epsilon - 1 or z^epsilon and its derivative by z, z >= 0.
struct OverstressRatio {
  double value = 0;
  double slope = 0;
};

inline OverstressRatio overstress_ratio(const Viscosity& v, double z) noexcept {
  if (v.model == Overstress::peric) {
    const double value = std::expm1(v.epsilon * std::log1p(z));
    return {value, v.epsilon * (1 + value) / (1 + z)};
  }
  const double value = std::pow(z, v.epsilon);
  return {value, v.epsilon * value / z};
}

// The z whose overstress ratio is g >= 0.
inline double inverse_overstress_ratio(const Viscosity& v, double g) noexcept {
  return v.model == Overstress::peric ? std::expm1(std::log1p(g) / v.epsilon) : std::pow(g, 1 / v.epsilon);
}

// Once and twice integrated overstress ratio: 1/z int_0^z g and 1/z^2 int_0^z int_0^y g(x) dx dy.
struct OverstressIntegrals {
  double once = 0;
  double twice = 0;
};

inline OverstressIntegrals overstress_integrals(const Viscosity& v, double z) noexcept {
  const double e = v.epsilon;
  if (v.model == Overstress::perzyna) {
    const double once = std::pow(z, e) / (e + 1);
    return {once, once / (e + 2)};
  }
  constexpr double series_converges = 0.1; // by a digit a term; beyond, the closed form loses two digits at most
  if (z > series_converges) {
    const double l = std::log1p(z);
    const double once = std::expm1((e + 1) * l) / ((e + 1) * z);
    return {once - 1, (std::expm1((e + 2) * l) / z - (e + 2)) / ((e + 1) * (e + 2) * z) - 0.5};
  }
  OverstressIntegrals sum;
  double term = 1; // binomial (epsilon over k) z^k
  for (int k = 1; k < 18; ++k) {
    term *= (e - k + 1) / k * z;
    sum.once += term / (k + 1);
    sum.twice += term / ((k + 1) * (k + 2));
  }
  return sum;
}

// What holds the plastic strain back: hardening and, where a model is set, viscosity.
struct Flow {
  Hardening hardening;
  Viscosity viscosity;

  bool viscous() const noexcept { return viscosity.model != Overstress::none && viscosity.mu > 0; }

  // sigma_0 - sigma_y, Pa
  double threshold_shift() const noexcept {
    return viscosity.model != Overstress::none && viscosity.threshold
               ? *viscosity.threshold - hardening.branches->front().stress
               : 0;
  }

  // Equivalent stress below which nothing flows, Pa.
  double onset(double alpha) const noexcept {
    return hardening.branches ? hardening.stress(alpha) + threshold_shift() : hardening.stress(alpha);
  }

  // Whether sigma_0 > 0 for every alpha > 0: of a threshold and a table that softens by more than it, not. Such a flow
  // has no meaning and its return no root.
  bool onset_stays_positive() const noexcept {
    return !hardening.branches ||
           std::all_of(hardening.branches->begin() + 1, hardening.branches->end(),
                       [this](const Hardening::Branch& b) { return b.stress + threshold_shift() > 0; });
  }

  // Stress at the end of a step in which alpha grows by `increment` and its derivative by that; time_ratio = mu / dt
  // (0: rate-independent), Pa.
  struct Stress {
    double value = 0;
    double slope = 0;
  };
  Stress stress(double alpha, double increment, double time_ratio) const noexcept {
    const double end = alpha + increment;
    const Hardening::Branch* b = hardening.branch(end);
    const double yield = Hardening::stress(*b, end);
    Stress s{yield + threshold_shift(), b->modulus};
    if (time_ratio > 0) {
      const OverstressRatio g = overstress_ratio(viscosity, time_ratio * increment);
      s.value += yield * g.value;
      s.slope += b->modulus * g.value + yield * g.slope * time_ratio;
    }
    return s;
  }

  // Work of the flow stress while alpha grows at the step's rate, J/m3, `end` that stress at its end: sigma_eq times
  // increment, as exact in hardening as a step without viscosity allows.
  double dissipation(double alpha, double increment, double end) const noexcept {
    const double shift = threshold_shift();
    return shift * increment + (end - shift) / hardening.stress(alpha + increment) * hardening.work(alpha, increment);
  }

  // int_0^increment of `stress`, which sees the rate grow: what the increment adds to the incremental potential, J/m3.
  // By parts within each branch, with G1 and G2 the overstress ratio integrated once and twice: int s g = [s G1] - K
  // [G2].
  double potential(double alpha, double increment, double time_ratio) const noexcept {
    double sum = hardening.work(alpha, increment) + threshold_shift() * increment;
    if (!(time_ratio > 0)) return sum;
    double g1 = 0;
    double g2 = 0;
    hardening.for_each_part(alpha, increment, [&](double from, double to, double stress_at_from, double modulus) {
      const OverstressIntegrals at = overstress_integrals(viscosity, time_ratio * to);
      const double next1 = to * at.once;
      const double next2 = to * to * at.twice;
      const double stress_at_to = stress_at_from + modulus * (to - from);
      sum += stress_at_to * next1 - stress_at_from * g1 - modulus * (next2 - g2);
      g1 = next1;
      g2 = next2;
    });
    return sum;
  }
};

} // namespace pneuma::solver::material
