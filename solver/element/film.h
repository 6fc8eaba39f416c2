// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "geometry/quadrature.h"
#include "solver/element/membrane.h"

namespace pneuma::solver::element {

// A film: a surface whose force per current length is the same everywhere and in every direction, N/m.
struct Film {
  ElementType element = ElementType::T3;
  StressRule rule = StressRule::full;
  std::span<const Index> connectivity; // [element][node]
  double tension = 0;                  // N/m
};

// Forces and tangent of a film, `take` once an element batch. The stress is a mix (homotopy of the updated reference
// strategy, Bletzinger & Ramm 1999): `current` parts Cauchy stress on the current surface (1: the exact derivative of
// tension x area, whose tangent has no stiffness along the surface), the rest second Piola-Kirchhoff stress on the
// reference, which is the current surface itself: same force, tangent n int (grad N_a . grad N_b) I, always positive.
// Returns the number of the first degenerate element, or -1; the area is added to `area`, m2.
Index film_forces(const Film& film, std::span<const Vec3> positions, double current, double& area,
                  const std::function<void(const ElementBatch&)>& take);

} // namespace pneuma::solver::element
