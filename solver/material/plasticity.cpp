// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/plasticity.h"

#include <stdexcept>

namespace pneuma::solver::material {

std::vector<HardeningBranch> plastic_branches(const Plasticity& law) {
  std::vector<HardeningBranch> branches = law.hardening;
  if (law.modulus == ModulusKind::plastic) return branches;
  for (HardeningBranch& b : branches) b.modulus = plastic_modulus(b.modulus, law.elasticity.youngs_modulus);
  return branches;
}

Flow flow_of(const Plasticity& law) {
  const std::optional<Hardening> hardening = piecewise_linear(plastic_branches(law));
  if (!hardening) throw std::invalid_argument("a branch of the hardening does not lead to the next");
  return {*hardening, law.viscosity};
}

} // namespace pneuma::solver::material
