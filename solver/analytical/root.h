// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace pneuma::solver::analytical {

// Root of a growing function between low (value not above 0) and high (above 0), to rounding: regula falsi with the
// Illinois rule (Dowell and Jarratt 1971), which halves the value of an end that stays for a second time.
template <class F>
double root_between(double low, double high, const F& f) {
  double f_low = f(low), f_high = f(high);
  double last = low;
  int side = 0; // of the root that the last point lay on
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    double x = low + (high - low) * f_low / (f_low - f_high);
    if (!std::isfinite(x)) x = 0.5 * (low + high);
    if (x <= low || x >= high || std::abs(x - last) <= 1e-15 * high) return x; // the other end may stay far away
    const double value = f(x);
    if (value == 0) return x;
    last = x;
    if (value < 0) {
      low = x;
      f_low = value;
      if (side == -1) f_high *= 0.5;
      side = -1;
    } else {
      high = x;
      f_high = value;
      if (side == 1) f_low *= 0.5;
      side = 1;
    }
  }
  return 0.5 * (low + high);
}

} // namespace pneuma::solver::analytical
