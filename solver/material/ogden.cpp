// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/ogden.h"

#include <algorithm>

namespace pneuma::solver::material {

namespace {

// of ln l1 and ln l2
bool stable(const Ogden& law, double b1, double b2) {
  double a1 = 0, a2 = 0, a3 = 0;
  for (int k = 0; k < law.count; ++k) {
    const auto& [mu, alpha] = law.terms[static_cast<std::size_t>(k)];
    a1 += mu * alpha * std::exp(alpha * b1);
    a2 += mu * alpha * std::exp(alpha * b2);
    a3 += mu * alpha * std::exp(-alpha * (b1 + b2));
  }
  return a1 + a2 + 2 * a3 > 0 && a1 * a2 + a2 * a3 + a3 * a1 > 0;
}

} // namespace

std::vector<Instability> instabilities(const Ogden& law, double smallest, double largest, int steps) {
  std::vector<Instability> found;
  for (const auto& [pull, across] :
       {std::pair{Pull::uniaxial, -0.5}, {Pull::equibiaxial, 1.0}, {Pull::pure_shear, 0.0}}) {
    const auto at = [&, slope = across](double b) { return stable(law, b, slope * b); };
    const double first = std::log(smallest);
    const double step = (std::log(largest) - first) / steps;
    // between a stable and an unstable place
    const auto border = [&](double b) {
      double low = b - step, high = b;
      const bool before = at(low);
      while (high - low > 1e-7) {
        const double middle = 0.5 * (low + high);
        (at(middle) == before ? low : high) = middle;
      }
      return std::exp(0.5 * (low + high));
    };
    bool before = true;
    for (int i = 0; i <= steps; ++i) {
      const double b = first + i * step;
      const bool now = at(b);
      if (!now && before) found.push_back({pull, i == 0 ? smallest : border(b), largest});
      if (now && !before) found.back().to = border(b);
      before = now;
    }
  }
  return found;
}

} // namespace pneuma::solver::material
