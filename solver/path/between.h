// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "solver/path/newton.h"

// What may lie hidden between two states that load control found one after the other. That both are stable says
// nothing: a foil that snapped through on the way is stable at both ends.
namespace pneuma::solver::path {

// Why a state that was found must not be accepted (foils that pass through each other); empty: it may.
using Objection = std::function<std::string(const Configuration&)>;

// The tangent at an accepted state, in the direction that the loads go on.
struct Look {
  std::optional<Change> way; // of everything as the load factor grows by one; none: no tangent (flat, slack), no load
};

// Right after an evaluation there, with tangents; one factorisation a foil.
Look look_at(Newton& newton, const Configuration& at);

// A step of load control that was found, and the tangents at its ends.
struct Stretch {
  const Configuration &from, &to;
  const Look &begin, &end;
};

// Why a step is too long to be taken in one; empty: nothing speaks against it. Looked at are the chord, which a jump
// makes longer than the tangents at both ends, and the positions on the cubic between them, which may meet with an
// objection. What stays within a hundredth of the span is not: a fold of a few elements depends on the mesh.
// The system is evaluated at the end of the step, before and after.
std::string hidden_between(System& system, Newton& newton, const Stretch& step, const Objection& objection);

} // namespace pneuma::solver::path
