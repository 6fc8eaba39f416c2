// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "stages/common/stage.h"
#include "stages/pattern/flat_foil.h"

namespace pneuma::stages::pattern {

using common::State;

// The cushion on its new mesh, welded from strips where a foil is cut.
struct Welded {
  State state;
  std::vector<geometry::strips::CutFoil> cuts; // per block
  std::vector<std::optional<FlatFoil>> flat;   // per block, of the foils that are cut
  std::vector<std::optional<Wanted>> wanted;   // what they were asked for
};

// The form of the old state on a new mesh: nodes on the old surface, then moved to the equilibrium of the film on the
// new mesh where the old state says which prestress and pressure that is; supports and chambers as before.
State transferred(const common::Start& start, const geometry::strips::CutMesh& cut);

// Puts the flat strips into the state: references, seams, the target's prestress, fields for pictures.
void weld(Welded& welded);

} // namespace pneuma::stages::pattern
