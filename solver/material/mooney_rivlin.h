// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "solver/material/concept.h"

namespace pneuma::solver::material {

// Mooney-Rivlin rubber, incompressible, plane stress: W = C1 (I1 - 3) + C2 (I2 - 3) with C33 = 1 / J, J = det C of the
// plane; I1 = tr C + 1/J, I2 = J + tr C / J (Holzapfel 2000, eq. 6.147 and sec. 6.5; neo-Hooke: C2 = 0). Stress and
// tangent are written in the components of C, so that equal stretches are nothing special, and in J - 1 and tr C - 2,
// so that small strains lose no digits. C1 > 0, C2 >= 0; fails where J <= 0.
struct MooneyRivlin {
  static constexpr std::array history_names = no_history;

  double c1 = 0; // Pa
  double c2 = 0; // Pa

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    const Vec3 identity(1, 1, 0);
    const Vec3 cofactor(2 * strain[1], 2 * strain[0], -strain[2]);      // of C, less the identity
    const double d = 4 * strain[0] * strain[1] - strain[2] * strain[2]; // det(2 E)
    const double t = 2 * (strain[0] + strain[1]);                       // tr C - 2
    const double j = t + d;                                             // J - 1
    const double J = 1 + j;
    if (!(J > 0)) return Status::failed;
    const double p = 2 / (J * J);
    response.stress = p * (c1 * (j * (2 + j) * identity - cofactor) +
                           c2 * ((3 * j + j * j - t) * identity - (1 + t - 2 * j - j * j) * cofactor));
    response.energy = response.potential = (c1 * (t * j - d) + c2 * (j * j - d)) / J;
    // S = 2 W_t I + 2 W_J A with A = I + cofactor = dJ/dC: derivatives of W(t, J)
    const Vec3 a = identity + cofactor;
    const double w_J = c2 - (c1 + c2 * (2 + t)) / (J * J);
    const double w_tJ = -c2 / (J * J);
    const double w_JJ = 2 * (c1 + c2 * (2 + t)) / (J * J * J);
    Mat3& tangent = response.tangent;
    tangent = 4 * (w_tJ * (identity * a.transpose() + a * identity.transpose()) + w_JJ * a * a.transpose());
    tangent(0, 1) += 4 * w_J;
    tangent(1, 0) += 4 * w_J;
    tangent(2, 2) -= 2 * w_J;
    return Status::ok;
  }

  // the volume stays
  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return 1 / std::sqrt((1 + 2 * strain[0]) * (1 + 2 * strain[1]) - strain[2] * strain[2]);
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }
};
static_assert(Material<MooneyRivlin>);

} // namespace pneuma::solver::material
