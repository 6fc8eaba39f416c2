// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "solver/material/concept.h"
#include "solver/material/principal.h"

namespace pneuma::solver::material {

// Ogden rubber, incompressible, plane stress: W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3) of the principal
// stretches, l3 = 1 / (l1 l2) (Ogden 1972, Proc. R. Soc. Lond. A 326, 565; Holzapfel 2000, eq. 6.119 and sec. 6.5).
// With b = ln l the Kirchhoff stress and its derivative are
//   T_i = dW/db_i = sum mu (l_i^alpha - l3^alpha),   dT_i/db_j = sum mu alpha (delta_ij l_i^alpha + l3^alpha),
// and S_i = T_i / C_i. Written in l^alpha - 1 and in the quotient of (l1/l2)^alpha - 1 and the strains' difference, so
// that neither small strains nor close stretches lose digits. Fails where C is not positive definite or a power
// overflows. `instabilities` tells where constants are of no use.
struct Ogden {
  static constexpr std::array history_names = no_history;
  static constexpr int capacity = 8; // terms

  struct Term {
    double mu = 0;    // Pa
    double alpha = 0; // -, not 0
  };

  int count = 0;
  std::array<Term, capacity> terms;

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    const PrincipalStrain e = principal_strain(strain);
    const PrincipalLogarithm l = principal_logarithm(e);
    if (!(l.c2 > 0)) return Status::failed;
    double energy = 0;
    PrincipalKirchhoff t;
    double a1 = 0; // sum mu alpha l^alpha of each direction
    double a2 = 0;
    double a3 = 0;
    for (int k = 0; k < count; ++k) {
      const auto& [mu, alpha] = terms[static_cast<std::size_t>(k)];
      // l^alpha - 1 of each direction; (l1 / l2)^alpha - 1; (l1 l2)^alpha - 1
      const double less2 = std::expm1(alpha * l.second);
      const double less3 = std::expm1(-alpha * (2 * l.second + l.difference));
      const double ratio = std::expm1(alpha * l.difference);
      const double less1 = less2 + (1 + less2) * ratio;
      const double product = less1 + less2 + less1 * less2;
      const double quotient = l.difference > 0 ? ratio / l.difference : alpha;
      // the sum of the three less one, whose first orders cancel
      energy -= mu / alpha * (product * less3 + less1 * less2);
      t.t1 += mu * (less1 - less3);
      t.t2 += mu * (less2 - less3);
      t.quotient += mu * (1 + less2) * quotient;
      a1 += mu * alpha * (1 + less1);
      a2 += mu * alpha * (1 + less2);
      a3 += mu * alpha * (1 + less3);
    }
    t.d11 = a1 + a3;
    t.d22 = a2 + a3;
    t.d12 = a3;
    in_frame(e, of_logarithm(l, t), response.stress, response.tangent);
    response.energy = response.potential = energy;
    return response.stress.allFinite() && response.tangent.allFinite() ? Status::ok : Status::failed;
  }

  // the volume stays
  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return 1 / std::sqrt((1 + 2 * strain[0]) * (1 + 2 * strain[1]) - strain[2] * strain[2]);
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }
};
static_assert(Material<Ogden>);

// A way to pull a sheet of rubber in a test.
enum class Pull : std::uint8_t {
  uniaxial,    // l, l^(-1/2)
  equibiaxial, // l, l
  pure_shear,  // l, 1
};

// Stretches between which a sheet pulled (l > 1) or shortened (l < 1) that way is not stable.
struct Instability {
  Pull pull = Pull::uniaxial;
  double from = 0, to = 0; // stretch l
};

// Where the constants violate Drucker's (Hill's) condition: more logarithmic strain needs more Kirchhoff stress, dT/db
// positive definite in plane stress (Hill 1970, J. Mech. Phys. Solids 18, 239), which is
//   a1 + a2 + 2 a3 > 0 and a1 a2 + a2 a3 + a3 a1 > 0,   a_i = sum mu alpha l_i^alpha.
// Holds for all stretches where every mu alpha > 0; otherwise looked for at `steps` places in the logarithm of the
// stretch between `smallest` < 1 and `largest` > 1, borders to 1e-6 of the stretch. A violation between two places goes
// unseen. By pull and growing stretch; empty: stable.
std::vector<Instability> instabilities(const Ogden& law, double smallest = 0.1, double largest = 10, int steps = 400);

} // namespace pneuma::solver::material
