// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/path/controlled_path.h"
#include "stages/common/stage.h"

namespace pneuma::stages::common {

// A stage's `control` in the solver's terms: names as numbers, a point in plan as nodes with weights. None for load
// control. Throws InputError with the place where the point does not lie on the foil, or on its edge.
std::optional<solver::path::PathControl> path_control(const Start& start, const pipeline::workflow::Control& control);

} // namespace pneuma::stages::common
