// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "solver/material/material.h"

namespace pneuma::solver::material {

// The symmetric stress-free predeformation G = (G11, G22, G12), in the material frame, with which a foil that lies
// unmoved (F = I) carries the Cauchy force per current length `force` = (n11, n22, n12), N/m: its strain is
// (G G - I)/2 and n = h / det(G) G S G (numerics 11). `thickness` is the nominal one, m. Newton in three unknowns from
// the identity; none if the law cannot carry it, or only by yielding.
std::optional<Vec3> predeformation(const Law& law, double thickness, const Vec3& force);

// Cauchy force per current length of a foil with predeformation G at F = I, (n11, n22, n12), N/m.
Vec3 prestress_of(const Law& law, double thickness, const Vec3& predeformation);

} // namespace pneuma::solver::material
