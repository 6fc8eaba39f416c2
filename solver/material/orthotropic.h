// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "solver/material/st_venant_kirchhoff.h"

namespace pneuma::solver::material {

// St. Venant-Kirchhoff with properties of its own along the axes of its frame (warp 1, weft 2), plane stress (Jones
// 1999, Mechanics of Composite Materials, eq. 2.61):
//   S11 = c (E1 E11 + nu12 E2 E22), S22 = c (nu12 E2 E11 + E2 E22), S12 = G12 2 E12, c = 1 / (1 - nu12 nu21),
// nu21 = nu12 E2 / E1: nu12 is the narrowing along 2 in tension along 1. Energy is positive where `positive_definite`
// says so.
// The thickness follows from S33 = 0, E33 = -(nu13 / E1) S11 - (nu23 / E2) S22, and affects neither stress nor
// stiffness. A test in the plane does not tell nu13 and nu23. By default a pull narrows the thickness as it narrows the
// width, nu13 = nu12 and nu23 = nu21: a foil's properties differ little with direction, and where they do not differ
// this is the isotropic law. Volume that stays is nu13 = 1 - nu12, nu23 = 1 - nu21.
struct Orthotropic {
  static constexpr std::array history_names = no_history;

  double youngs_modulus_1 = 0;  // Pa
  double youngs_modulus_2 = 0;  // Pa
  double poissons_ratio_12 = 0; // -
  double shear_modulus = 0;     // Pa, G12
  double poissons_ratio_13 = poissons_ratio_12;
  double poissons_ratio_23 = poissons_ratio_12 * youngs_modulus_2 / youngs_modulus_1; // nu21

  bool positive_definite() const noexcept {
    return youngs_modulus_1 > 0 && youngs_modulus_2 > 0 && shear_modulus > 0 &&
           poissons_ratio_12 * poissons_ratio_12 * youngs_modulus_2 < youngs_modulus_1;
  }

  Mat3 stiffness() const noexcept {
    const double poissons_ratio_21 = poissons_ratio_12 * youngs_modulus_2 / youngs_modulus_1;
    const double c = 1 / (1 - poissons_ratio_12 * poissons_ratio_21);
    const double coupling = c * poissons_ratio_12 * youngs_modulus_2;
    Mat3 d;
    d << c * youngs_modulus_1, coupling, 0, coupling, c * youngs_modulus_2, 0, 0, 0, shear_modulus;
    return d;
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    return respond_linearly(stiffness(), strain, response);
  }

  // NaN where the law has no such thickness
  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    const Vec3 stress = stiffness() * strain;
    return std::sqrt(
        1 - 2 * (poissons_ratio_13 / youngs_modulus_1 * stress[0] + poissons_ratio_23 / youngs_modulus_2 * stress[1]));
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }
};
static_assert(Material<Orthotropic>);

} // namespace pneuma::solver::material
