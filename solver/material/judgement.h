// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solver/material/mooney_rivlin.h"
#include "solver/material/ogden.h"
#include "solver/material/orthotropic.h"
#include "solver/material/plasticity.h"

namespace pneuma::solver::material {

// What is wrong with the parameters of a law, or looks so.
struct Fault {
  // Which one, by its symbol and in lists by its position: "nu12", "hardening.1.modulus", "terms.0.alpha"; of several
  // that do not go together the one or the list that is to be changed.
  std::string parameter;
  std::string message; // what is wrong, what is allowed, what to do; stresses in MPa
  bool error = true;   // otherwise a warning
};

// Judges a law as its user states it. First each number by itself (finite, its sign, its range), then, where those are
// in order, what they are together. A law without an error can be evaluated: every strain has positive energy (of
// Ogden's constants: up to four times the length), the return to the yield surface has one solution (where it
// softens and has viscosity: unless a step is far shorter than mu), and nothing flows without stress.

// E, nu: E > 0, -1 < nu <= 0.5.
std::vector<Fault> faults(const StVenantKirchhoff& law);

// E1, E2, nu12, G12: positive definite.
std::vector<Fault> faults(const Orthotropic& law);

// C1, C2: C1 > 0, C2 >= 0.
std::vector<Fault> faults(const MooneyRivlin& law);

// terms, terms.i.mu, terms.i.alpha: 1 to Ogden::capacity terms of effect, exponents up to 100, a positive shear
// modulus, half the sum of mu alpha, and no instability (Drucker's) at stretches from 1/4 to 4, as far as a foil is
// stretched. Of a term whose mu and alpha have different signs a warning.
std::vector<Fault> faults(const Ogden& law);

// E, nu, hardening, hardening.i.stress, hardening.i.modulus, viscosity.mu, viscosity.epsilon, viscosity.threshold:
// branches that lead to one another and fall only where softening is announced, less steeply than E / (2 (1 - nu)) and
// never at last; a threshold up to first yield and above what softening takes.
std::vector<Fault> faults(const Plasticity& law);

} // namespace pneuma::solver::material
