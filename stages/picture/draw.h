// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/state/state.h"
#include "stages/picture/options.h"

namespace pneuma::stages::picture {

// Draws `state` into the PNG file that the options name. Throws InputError for a field or component that the state does
// not have, StateError if the picture cannot be written.
void draw(const pipeline::state::State& state, const Options& options);

} // namespace pneuma::stages::picture
