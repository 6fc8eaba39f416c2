// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "solver/material/plane_stress_return.h"

namespace pneuma::solver::material {

enum class ModulusKind : std::uint8_t { plastic, tangent }; // d stress / d plastic strain, or d stress / d strain

// What `J2` and `Logarithmic` are made of, as their user states it.
struct Plasticity {
  Elasticity elasticity;
  std::vector<HardeningBranch> hardening;
  ModulusKind modulus = ModulusKind::plastic; // of the branches
  bool softening = false;                     // announced: a branch may fall
  Viscosity viscosity = {};
};

// Its branches with plastic moduli, Pa.
std::vector<HardeningBranch> plastic_branches(const Plasticity& law);

// What holds the plastic strain back. Throws std::invalid_argument where `faults` finds its branches at fault.
Flow flow_of(const Plasticity& law);

} // namespace pneuma::solver::material
