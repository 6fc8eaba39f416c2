// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string_view>

#include "geometry/base/types.h"

namespace pneuma::solver::material {

using base::Mat3;
using base::Vec3;

// What a point reports back.
enum class Status : std::uint8_t {
  ok,
  failed,       // there is no such state: a stretch that is not positive
  outside_data, // the law is a table, and this strain is not in it
};

// What a law answers to a strain.
struct Response {
  Vec3 stress = Vec3::Zero();  // second Piola-Kirchhoff (S11, S22, S12), Pa
  Mat3 tangent = Mat3::Zero(); // d stress / d strain of the whole step, Pa
  double energy = 0;           // stored and recoverable, per reference volume, J/m3
  // What the stress is the derivative of, given the old history and the time step, J/m3: the energy of elastic laws;
  // of others with what the step dissipates.
  double potential = 0;
};

// History components that a law may have under these names.
inline constexpr std::string_view equivalent_plastic_strain = "equivalent_plastic_strain"; // -
inline constexpr std::string_view dissipated_energy = "dissipated_energy"; // so far, per reference volume, J/m3

// A material is a value type with these members. Plane stress; strain and stress in an orthonormal material frame:
//   strain  Green-Lagrange (E11, E22, 2 E12), -
//   history_names  of the doubles of a point's history, old (accepted) and new; all zero: never loaded
//   dt      time step, s; 0: no time passes, so that nothing flows that needs time
//   thickness_stretch  current / nominal thickness at a strain and its history
//   stress_free_strain  at which a history leaves no stress
// Evaluated again from the new history at the same strain, without time, it answers the same stress.
// A law that flows with time says so by `bool is_rate_dependent() const`.
// Pure: no allocation, no exception, no state of its own.
template <class M>
concept Material = requires(const M& m, const Vec3& strain, const double* old_history, double* new_history, double dt,
                            Response& response) {
  { M::history_names[0] } -> std::convertible_to<std::string_view>;
  { m.evaluate(strain, old_history, new_history, dt, response) }
  noexcept->std::same_as<Status>;
  { m.thickness_stretch(strain, old_history) }
  noexcept->std::convertible_to<double>;
  { m.stress_free_strain(old_history) }
  noexcept->std::convertible_to<Vec3>;
};

// Doubles of a point's history.
template <Material M>
inline constexpr int history_size = static_cast<int>(M::history_names.size());

// Whether a law flows with time.
template <Material M>
constexpr bool flows_with_time(const M& law) noexcept {
  if constexpr (requires { law.is_rate_dependent(); }) {
    return law.is_rate_dependent();
  } else {
    return false;
  }
}

// The history of laws that have none.
inline constexpr std::array<std::string_view, 0> no_history{};

} // namespace pneuma::solver::material
