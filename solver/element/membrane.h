// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "solver/element/reference.h"
#include "solver/material/material.h"

namespace pneuma::solver::element {

// A foil as the kernels see it.
struct Membrane {
  std::span<const Index> connectivity; // [element][node]
  Reference reference;
  material::Law law;
  double thickness = 0; // m, nominal
};

// What the kernel hands on: a batch of neighbouring elements. The buffers belong to the kernel and are overwritten.
struct ElementBatch {
  Index first = 0; // element
  Index count = 0;
  const double* force = nullptr;   // [element][node][component], N
  const double* tangent = nullptr; // [element][3 n][3 n], symmetric, N/m; null if not asked for
};

// A point whose material has no answer.
struct Failed {
  Index element = 0;
  material::Status status = material::Status::failed;
  Vec3 strain = Vec3::Zero(); // Green-Lagrange (E11, E22, 2 E12)
};

// Internal forces and, if asked for, the tangent of every element at `positions` (total Lagrangian, Green-Lagrange
// strain, second Piola-Kirchhoff stress), in one pass; `take` is called once a batch, in order. `old_history` and
// `new_history` are [element][point][component] (empty for laws without). Stored energy is added to `energy`, J.
// Source: Wriggers (2008), Nonlinear Finite Element Methods, sec. 4.2 and 9.2. Returns the first point
// whose material has no answer; then `take` has not seen its batch.
std::optional<Failed> membrane_forces(const Membrane& membrane, std::span<const Vec3> positions,
                                      std::span<const double> old_history, std::span<double> new_history, double dt,
                                      bool with_tangent, double& energy,
                                      const std::function<void(const ElementBatch&)>& take);

// State of one stress point, for results.
struct PointState {
  base::Mat32 deformation;    // F, 3 x 2: stress-free material frame -> space
  Vec3 stress;                // second Piola-Kirchhoff (S11, S22, S12), Pa
  base::Mat2 cauchy;          // in the plane spanned by `axes`, Pa, on the area of the foil itself
  base::Mat32 axes;           // orthonormal, tangent to the surface; the first along the carried first material axis
  double thickness_ratio = 1; // current / nominal, of the foil itself
  material::Surface surface = material::Surface::taut;
  Vec3 strain = Vec3::Zero(); // Green-Lagrange (E11, E22, 2 E12) of the foil itself: wrinkles laid flat
  double stored = 0;          // recoverable energy per reference volume, J/m3
  double dissipated = 0;      // so far, J/m3
  double plastic_strain = 0;  // equivalent, so far, -
};

// Deformation and stress at all points [element][point] as an accepted history leaves them, without time.
std::vector<PointState> point_states(const Membrane& membrane, std::span<const Vec3> positions,
                                     std::span<const double> history);

// Consistent weight: adds rho h g int N dA of the stress-free area to `force` [3 node + component], N.
// `acceleration` in m/s2 (direction of gravity included), density kg/m3.
void add_weight(const Membrane& membrane, double density, const Vec3& acceleration, std::span<double> force);

} // namespace pneuma::solver::element
