// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/state/state.h"

namespace pneuma::pipeline::state {

// The first thing in `state` that cannot be right (a length, a node number out of range, two fields of one name), or
// nothing if all fits together. What is written passes it, and what is read passes it again.
std::string first_fault(const State& state);

// Gauss points of a block: elements x points of the stress rule.
std::size_t gauss_count(const State& state, const geometry::Block& block);

} // namespace pneuma::pipeline::state
