// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "geometry/base/namespace.h"

namespace pneuma::geometry::base {

// Calls `work(chunk)` for chunk = 0 .. chunks-1 on up to `threads` threads. The chunks are the caller's, so results do
// not depend on the number of threads. The first exception (by chunk) is rethrown after all chunks ended.
void parallel_chunks(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work);

} // namespace pneuma::geometry::base
