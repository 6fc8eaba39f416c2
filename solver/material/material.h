// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <variant>

#include "geometry/base/types.h"

namespace pneuma::solver::material {

using base::Mat3;
using base::Vec3;

// What a point reports back.
enum class Status : std::uint8_t { ok, failed };

// A material is a value type with these members. Plane stress; strain and stress in an orthonormal material frame:
//   strain  Green-Lagrange (E11, E22, 2 E12), -
//   stress  second Piola-Kirchhoff (S11, S22, S12), Pa
//   tangent d stress / d strain, 3 x 3, Pa
//   energy  stored per reference volume, J/m3
//   history_components doubles a point, old (accepted) and new
//   dt      time step, s
//   thickness_stretch  current / nominal thickness at a strain and its history
// Pure: no allocation, no exception, no state of its own.
template <class M>
concept Material = requires(const M& m, const Vec3& strain, const double* old_history, double* new_history, double dt,
                            Vec3& stress, Mat3& tangent, double& energy) {
  { M::history_components } -> std::convertible_to<int>;
  { m.evaluate(strain, old_history, new_history, dt, stress, tangent, energy) }
  noexcept->std::same_as<Status>;
  { m.thickness_stretch(strain, old_history) }
  noexcept->std::convertible_to<double>;
};

// St. Venant-Kirchhoff, isotropic, plane stress: S = E/(1-nu^2) [E + nu ...] (Holzapfel 2000, eq. 6.151, with the
// thickness stress condensed).
struct StVenantKirchhoff {
  static constexpr int history_components = 0;

  double youngs_modulus = 0; // Pa
  double poissons_ratio = 0; // -

  Mat3 stiffness() const {
    const double c = youngs_modulus / (1 - poissons_ratio * poissons_ratio);
    Mat3 d;
    d << c, c * poissons_ratio, 0, c * poissons_ratio, c, 0, 0, 0, c * (1 - poissons_ratio) / 2;
    return d;
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Vec3& stress, Mat3& tangent,
                  double& energy) const noexcept {
    tangent = stiffness();
    stress = tangent * strain;
    energy = 0.5 * stress.dot(strain);
    return Status::ok;
  }

  // E33 = -nu/(1-nu) (E11 + E22) follows from S33 = 0; NaN where the law has no such thickness
  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return std::sqrt(1 - 2 * poissons_ratio / (1 - poissons_ratio) * (strain[0] + strain[1]));
  }
};
static_assert(Material<StVenantKirchhoff>);

using Law = std::variant<StVenantKirchhoff>;

int history_components(const Law& law);
double thickness_stretch(const Law& law, const Vec3& strain, const double* history);

// Points of several elements that meet their material in one call: one instantiation per law, none per element type.
struct Batch {
  static constexpr int capacity = 64;
  int count = 0;
  std::array<Vec3, capacity> strain;
  std::array<Vec3, capacity> stress;
  std::array<Mat3, capacity> tangent;
  std::array<double, capacity> energy;
  const double* old_history = nullptr; // [point][component]
  double* new_history = nullptr;
  double dt = 0; // s
};

// Evaluates all points; returns the number of the first one that failed, or -1.
int evaluate(const Law& law, Batch& batch);

} // namespace pneuma::solver::material
