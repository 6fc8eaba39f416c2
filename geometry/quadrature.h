// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/mesh.h"

namespace pneuma::geometry {

struct QuadraturePoint {
  double xi, eta;
  double weight; // the weights sum to the area of the reference element: 1/2 or 4
};

enum class StressRule : std::uint8_t { full, reduced };

// Points at which strain and stress live: T3 1, T6 3, Q4 2x2, Q9 3x3 (reduced: Q9 2x2, otherwise
// std::invalid_argument).
std::span<const QuadraturePoint> stress_rule(ElementType type, StressRule rule = StressRule::full);

// Points for pressure and volume, exact for the volume below the element: T3 1, T6 6, Q4 2x2, Q9 3x3 (numerics: only
// then is the pressure force the derivative of the volume). Rules: Dunavant (1985), degree 4; Gauss-Legendre.
std::span<const QuadraturePoint> pressure_rule(ElementType type);

} // namespace pneuma::geometry
