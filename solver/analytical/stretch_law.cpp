// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/analytical/stretch_law.h"

#include <cmath>

namespace pneuma::solver::analytical {

namespace {

Energy energy(const SaintVenantKirchhoff& law, double l1, double l2) {
  const double nu = law.poissons_ratio;
  const double c = law.youngs_modulus / (1 - nu * nu);
  const double e1 = 0.5 * (l1 * l1 - 1), e2 = 0.5 * (l2 * l2 - 1);
  const double s1 = c * (e1 + nu * e2), s2 = c * (e2 + nu * e1); // second Piola-Kirchhoff
  return {0.5 * (s1 * e1 + s2 * e2),
          l1 * s1,
          l2 * s2,
          s1 + c * l1 * l1,
          c * nu * l1 * l2,
          s2 + c * l2 * l2,
          std::sqrt(1 - 2 * nu / (1 - nu) * (e1 + e2))};
}

Energy energy(const MooneyRivlin& law, double l1, double l2) {
  const double a = l1 * l1, b = l2 * l2;
  const double c = 1 / (a * b); // l3^2; I1 = a + b + c, I2 = a b + 1/a + 1/b
  return {law.c1 * (a + b + c - 3) + law.c2 * (a * b + 1 / a + 1 / b - 3),
          2 / l1 * (law.c1 * (a - c) + law.c2 * (a * b - 1 / a)),
          2 / l2 * (law.c1 * (b - c) + law.c2 * (a * b - 1 / b)),
          2 / a * (law.c1 * (a + 3 * c) + law.c2 * (a * b + 3 / a)),
          4 / (l1 * l2) * (law.c1 * c + law.c2 * a * b),
          2 / b * (law.c1 * (b + 3 * c) + law.c2 * (a * b + 3 / b)),
          1 / (l1 * l2)};
}

} // namespace

Energy energy(const StretchLaw& law, double l1, double l2) {
  return std::visit([&](const auto& one) { return energy(one, l1, l2); }, law);
}

} // namespace pneuma::solver::analytical
