// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pneuma::solver::analytical {

// Root of a growing function between low (value not above 0) and high (above 0), to rounding: regula falsi with the
// Illinois rule (Dowell and Jarratt 1971).
template <class F>
double root_between(double low, double high, const F& f) {
  double f_low = f(low), f_high = f(high);
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    double x = low + (high - low) * f_low / (f_low - f_high);
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    const double value = f(x);
    if (value == 0) return x;
    if (value < 0) {
      low = x;
      f_low = value;
      f_high *= 0.5;
    } else {
      high = x;
      f_high = value;
      f_low *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

} // namespace pneuma::solver::analytical
