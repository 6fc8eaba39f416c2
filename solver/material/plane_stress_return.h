// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/material/viscosity.h"

namespace pneuma::solver::material {

// Isotropic linear elasticity in plane stress: s11 + s22 = sum_modulus (e11 + e22), s11 - s22 = 2 G (e11 - e22),
// s12 = 2 G e12.
struct Elasticity {
  double youngs_modulus = 0; // Pa
  double poissons_ratio = 0; // -, up to 0.5

  double sum_modulus() const noexcept { return youngs_modulus / (1 - poissons_ratio); }
  double shear_modulus() const noexcept { return 0.5 * youngs_modulus / (1 + poissons_ratio); }
  // plastic modulus above which the return has one solution, Pa (see plane_stress_return)
  double steepest_softening() const noexcept { return -std::min(0.5 * sum_modulus(), 3 * shear_modulus()); }
  // e33 of an elastic strain, from the stress-free thickness
  double thickness_strain(double sum) const noexcept { return -poissons_ratio / (1 - poissons_ratio) * sum; }
  // stored energy of a stress, J/m3; difference_squared = (s11 - s22)^2 + 4 s12^2
  double energy(double sum, double difference_squared) const noexcept {
    return (sum * sum * (1 - poissons_ratio) + difference_squared * (1 + poissons_ratio)) / (4 * youngs_modulus);
  }
};

// Plastic corrector of a step: the trial stress' s11 + s22 falls by the factor `sum`, its s11 - s22 and s12 by
// `difference`.
struct PlasticStep {
  bool flows = false;
  double sum = 1;
  double difference = 1;
  double multiplier = 0;        // gamma, 1/Pa: plastic strain increment = gamma P s, P s = (s11 - s22/2, .., 3 s12)
  double increment = 0;         // of the equivalent plastic strain: gamma sigma_eq
  double equivalent_stress = 0; // at the end of the step, Pa
  double time_ratio = 0;        // mu / dt of a viscous step
  double softening =
      0; // f in: consistent tangent = Xi - f (Xi P s) (Xi P s)^T, Xi the elastic moduli times the factors
};

// The plane-stress J2 return, associative, fully implicit (Simo and Taylor 1986, Int. J. Numer. Methods Eng. 22,
// 649-670): projected onto s33 = 0 the flow scales the eigen-components of the trial stress,
//   sigma_eq^2 (gamma) = A / (1 + a gamma)^2 + B / (1 + b gamma)^2,   a = sum_modulus / 2, b = 3 G,
//   A = (s11 + s22)^2 / 4, B = 3/4 [(s11 - s22)^2 + 4 s12^2] of the trial,
// and gamma solves sigma_eq(gamma) = flow stress(alpha + gamma sigma_eq(gamma), rate). The left side falls with gamma
// and gamma sigma_eq grows, so that hardening (and softening above a modulus of -min(a, b)) leaves one root. Newton
// on 1 - flow stress / sigma_eq, convex as 1 / sigma_eq is concave (a mean of two linear functions), from below; a
// bracket and bisection of its logarithm catch corners and rates of any size. dt = 0: a viscous material does not flow.
inline PlasticStep plane_stress_return(const Elasticity& elasticity, const Flow& flow, double sum,
                                       double difference_squared, double alpha, double dt) noexcept {
  PlasticStep step;
  const double A = 0.25 * sum * sum;
  const double B = 0.75 * difference_squared;
  const double onset = flow.onset(alpha);
  const double trial_squared = A + B;
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  // an accepted state evaluated anew lies on the yield surface to rounding
  if (!(trial_squared > onset * onset * (1 + 16 * rounding))) return step;
  const bool viscous = flow.viscous();
  if (viscous && !(dt > 0)) return step;

  const double time_ratio = viscous ? flow.viscosity.mu / dt : 0;
  const double a = 0.5 * elasticity.sum_modulus();
  const double b = 3 * elasticity.shear_modulus();
  const double trial = std::sqrt(trial_squared);
  // what gamma would be without viscosity and hardening
  const double plastic = (trial / std::max(onset, 1e-12 * trial) - 1) / std::min(a, b);
  double gamma = 0;
  if (viscous) {
    // and what with viscosity if the stress stayed: the smaller of both is near the root, where the slope at zero may
    // be infinite
    const double ratio = (trial - onset) / flow.hardening.stress(alpha);
    const double free = inverse_overstress_ratio(flow.viscosity, ratio) / (time_ratio * trial);
    constexpr double smallest = 1e-250;
    if (free * trial < smallest) return step;
    gamma = 1 / (1 / free + 1 / plastic);
  }
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  double u = 1;
  double v = 1;
  double sigma = trial;
  double slope = 0; // of the flow stress by the increment
  constexpr int soon = 12;
  constexpr int enough = 300; // bisection alone needs about 70
  for (int i = 0; i < enough; ++i) {
    u = 1 / (1 + a * gamma);
    v = 1 / (1 + b * gamma);
    const double Au = A * u * u;
    const double Bv = B * v * v;
    sigma = std::sqrt(Au + Bv);
    const Flow::Stress y = flow.stress(alpha, gamma * sigma, time_ratio);
    slope = y.slope;
    const double excess = sigma - y.value;
    (excess > 0 ? low : high) = gamma;
    const double sigma_slope = -(a * Au * u + b * Bv * v) / sigma;
    const double increment_slope = (Au * u + Bv * v) / sigma; // sigma + gamma sigma_slope
    const double change = excess * sigma / (slope * increment_slope * sigma - y.value * sigma_slope);
    const double newton = gamma + change;
    const bool last = std::abs(change) <= rounding * gamma || std::abs(excess) <= 4 * rounding * sigma;
    if (last) break;
    if (newton > low && newton < high && !(i > soon && i % 2 == 0)) { // false for NaN
      gamma = newton;
    } else if (high == std::numeric_limits<double>::infinity()) {
      gamma = gamma > 0 ? 16 * gamma : plastic;
    } else {
      const double middle = low > 0 ? std::sqrt(low) * std::sqrt(high) : 1e-6 * high;
      if (!(middle > low && middle < high)) break;
      gamma = middle;
    }
  }
  step.flows = true;
  step.time_ratio = time_ratio;
  step.sum = u;
  step.difference = v;
  step.multiplier = gamma;
  step.increment = gamma * sigma;
  step.equivalent_stress = sigma;
  // dgamma = (Xi P s) . dtrial strain times this, from d(sigma_eq) = slope d(gamma sigma_eq); by 1 / slope where that
  // is the smaller number, as the slope may be next to infinite where viscous flow begins
  const double stiffness = a * A * u * u * u + b * B * v * v * v;
  const double projected = A * u * u * u + B * v * v * v;
  step.softening = slope < a ? (1 - slope * gamma) / (stiffness + slope * projected)
                             : (1 / slope - gamma) / (stiffness / slope + projected);
  return step;
}

} // namespace pneuma::solver::material
