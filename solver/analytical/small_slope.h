// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "solver/analytical/circular_membrane.h"

namespace pneuma::solver::analytical {

// Power series for the flat circular membrane at small slopes. They differ in the pressure's radial part and in
// pretension.
enum class Theory : std::uint8_t {
  hencky,          // vertical load, no pretension (Hencky 1915)
  campbell,        // with pretension (Campbell 1956)
  fichter,         // the pressure follows the membrane (Fichter 1997, NASA TP-3658)
  modified_fichter // both (Coelho 2012, section 5.3.4)
};

struct SmallSlopeSolution {
  double deflection = 0;            // m, of the apex
  double volume = 0;                // m3, below the membrane
  double apex_tension = 0;          // meridional force per length at the pole, N/m, pretension included
  double edge_tension = 0;          // and at the rim
  std::vector<double> coefficients; // of tension / (E h) in powers of (r / radius)^2
};

// Solves, with t = tension / (E h), q = p a / (E h), s = (r / a)^2 and f = 1 where the pressure follows (else 0),
//   t^2 (8 t' + 4 s t'') + f q^2 ((3 + nu)/2 t - s t') + q^2 / 8 = 0,   ' = d/ds,
// which is radial balance and compatibility (thesis 5-36, 5-51, 5-69), by the recurrence of its coefficients; the first
// one from the rim that does not move,
//   t + 2 t' + f q^2 / (2 t) - nu t = (1 - nu) N0 / (E h)   at s = 1,
// where the pretension N0 enters alone: strains belong to the increments of force. Then w' = -p r / (2 N).
// `terms`: of the series; the thesis' three of Fichter's are 18 % off at 400 kPa, 20 are good to 2e-4.
// Pressure > 0. None if the theory takes no pretension and there is one, or if the series does not converge.
std::optional<SmallSlopeSolution> small_slope(Theory theory, const CircularMembrane& membrane, double pressure,
                                              int terms = 80);

} // namespace pneuma::solver::analytical
