// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace pneuma::pipeline::state {

// Runs `work` in a child process that may take `seconds` and `bytes` of memory more than this process has now. Returns
// nothing if it ended well, otherwise what went wrong: the exception's text, a crash, too long. The child's effects
// are lost; its standard error is silent. Call it while no other thread is inside libhdf5.
std::string try_in_child(const std::function<void()>& work, unsigned seconds, std::size_t bytes);

} // namespace pneuma::pipeline::state
