// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/state/state.h"

// How a state lies in a file (README.md has the table): /VTKHDF for ParaView and VTK, /pneuma for the rest.
namespace pneuma::pipeline::state {

// The bytes of the file; equal states give equal bytes. Throws hdf5::Failure if a text or a name cannot be stored.
std::string to_bytes(const State& state);

// The state in such bytes, every length checked. Throws hdf5::Failure with the place and what is wrong there. Damaged
// bytes can crash or hang libhdf5: judge them first.
State from_bytes(const std::string& bytes);

} // namespace pneuma::pipeline::state
