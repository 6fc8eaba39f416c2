// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/analytical/small_slope.h"

#include <cmath>
#include <numbers>

namespace pneuma::solver::analytical {

namespace {

using Series = std::vector<double>; // in powers of s

// The series of the tension whose first coefficient is `first`.
Series tension_series(double first, double q, double follows, double nu, int terms) {
  const auto count = static_cast<std::size_t>(terms);
  Series t{first};
  Series square{first * first}; // of t
  Series d;                     // of 8 t' + 4 s t'': d_k = 4 (k + 1)(k + 2) t_(k+1)
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const auto n = static_cast<double>(k);
    double sum = follows * q * q * ((3 + nu) / 2 - n) * t[k] + (k == 0 ? q * q / 8 : 0);
    for (std::size_t j = 0; j < k; ++j) sum += square[k - j] * d[j];
    d.push_back(-sum / square[0]);
    t.push_back(d[k] / (4 * (n + 1) * (n + 2)));
    double product = 0;
    for (std::size_t j = 0; j <= k + 1; ++j) product += t[j] * t[k + 1 - j];
    square.push_back(product);
  }
  return t;
}

Series reciprocal(const Series& t) {
  Series r{1 / t[0]};
  for (std::size_t k = 1; k < t.size(); ++k) {
    double sum = 0;
    for (std::size_t j = 1; j <= k; ++j) sum += t[j] * r[k - j];
    r.push_back(-sum / t[0]);
  }
  return r;
}

struct Rim {
  double value = 0, derivative = 0;
};

Rim at_rim(const Series& t) {
  Rim rim;
  for (std::size_t k = 0; k < t.size(); ++k) {
    rim.value += t[k];
    rim.derivative += static_cast<double>(k) * t[k];
  }
  return rim;
}

} // namespace

std::optional<SmallSlopeSolution> small_slope(Theory theory, const CircularMembrane& membrane, double pressure,
                                              int terms) {
  const bool takes_pretension = theory == Theory::campbell || theory == Theory::modified_fichter;
  if (!(pressure > 0) || terms < 2 || (membrane.pretension != 0 && !takes_pretension)) return std::nullopt;
  const double follows = theory == Theory::fichter || theory == Theory::modified_fichter ? 1 : 0;
  const double nu = membrane.poissons_ratio;
  const double q = pressure * membrane.radius / membrane.stiffness;
  const double n0 = membrane.pretension / membrane.stiffness;
  // outward displacement of the rim, in strain times (1 + ...): falls with the pole's tension
  const auto rim_moves = [&](double first) {
    const Rim rim = at_rim(tension_series(first, q, follows, nu, terms));
    if (!(rim.value > 0)) return -1.0; // the series went beyond its membrane
    return rim.value + 2 * rim.derivative + follows * q * q / (2 * rim.value) - nu * rim.value - (1 - nu) * n0;
  };
  // Hencky's pole has 0.43 q^(2/3); the root lies between far below it and far above it
  double high = n0 + 4 * std::cbrt(q * q) + 4 * q;
  double low = high;
  if (!(rim_moves(high) > 0)) return std::nullopt;
  while (rim_moves(low) > 0 && low > 1e-6 * high) low *= 0.95;
  for (int i = 0; i < 200 && high - low > 1e-16 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (rim_moves(middle) > 0 ? high : low) = middle;
  }
  SmallSlopeSolution solution;
  solution.coefficients = tension_series(high, q, follows, nu, terms);
  const Series& t = solution.coefficients;
  const Rim rim = at_rim(t);
  if (!(rim.value > 0) || !(std::abs(t.back()) < 1e-3 * rim.value)) return std::nullopt;
  const Series flexibility = reciprocal(t);
  for (std::size_t k = 0; k < t.size(); ++k) {
    const auto n = static_cast<double>(k);
    solution.deflection += membrane.radius * q / 4 * flexibility[k] / (n + 1);
    solution.volume += std::numbers::pi * std::pow(membrane.radius, 3) * q / 4 * flexibility[k] / (n + 2);
  }
  solution.apex_tension = membrane.stiffness * t[0];
  solution.edge_tension = membrane.stiffness * rim.value;
  return solution;
}

} // namespace pneuma::solver::analytical
