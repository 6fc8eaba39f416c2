// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>

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

} // namespace pneuma::solver::material
