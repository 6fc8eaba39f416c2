// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

namespace pneuma::solver::analytical {

// Elastic laws by their energy per nominal volume, W(l1, l2), of the two stretches in the plane; plane stress.

// W = E / (2 (1 - nu^2)) (e1^2 + e2^2 + 2 nu e1 e2), e = (l^2 - 1) / 2 (Holzapfel 2000, eq. 6.151, with the thickness
// stress condensed).
struct SaintVenantKirchhoff {
  double youngs_modulus = 0; // Pa
  double poissons_ratio = 0;
};

// W = C1 (I1 - 3) + C2 (I2 - 3), incompressible: l3 = 1 / (l1 l2) (Mooney 1940, Rivlin 1948). Neo-Hookean with C2 = 0;
// the shear modulus is 2 (C1 + C2).
struct MooneyRivlin {
  double c1 = 0, c2 = 0; // Pa
};

using StretchLaw = std::variant<SaintVenantKirchhoff, MooneyRivlin>;

// The energy at two stretches with its derivatives by them, Pa: w1 and w2 are nominal stresses.
struct Energy {
  double w = 0, w1 = 0, w2 = 0, w11 = 0, w12 = 0, w22 = 0;
  double thickness_stretch = 1; // NaN where St. Venant-Kirchhoff's law has no such thickness
};

Energy energy(const StretchLaw& law, double l1, double l2);

} // namespace pneuma::solver::analytical
