// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "solver/material/concept.h"

namespace pneuma::solver::material {

// The answer of a law whose stiffness is the same at every strain.
inline Status respond_linearly(const Mat3& stiffness, const Vec3& strain, Response& response) noexcept {
  response.tangent = stiffness;
  response.stress = response.tangent * strain;
  response.energy = response.potential = 0.5 * response.stress.dot(strain);
  return Status::ok;
}

// St. Venant-Kirchhoff, isotropic, plane stress: S = E/(1-nu^2) [E + nu ...] (Holzapfel 2000, eq. 6.151, with the
// thickness stress condensed).
struct StVenantKirchhoff {
  static constexpr std::array history_names = no_history;

  double youngs_modulus = 0; // Pa
  double poissons_ratio = 0; // -

  Mat3 stiffness() const {
    const double c = youngs_modulus / (1 - poissons_ratio * poissons_ratio);
    Mat3 d;
    d << c, c * poissons_ratio, 0, c * poissons_ratio, c, 0, 0, 0, c * (1 - poissons_ratio) / 2;
    return d;
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    return respond_linearly(stiffness(), strain, response);
  }

  // E33 = -nu/(1-nu) (E11 + E22) follows from S33 = 0; NaN where the law has no such thickness
  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return std::sqrt(1 - 2 * poissons_ratio / (1 - poissons_ratio) * (strain[0] + strain[1]));
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }
};
static_assert(Material<StVenantKirchhoff>);

} // namespace pneuma::solver::material
