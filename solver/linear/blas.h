// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/base/namespace.h"

namespace pneuma::solver::linear {

// Before the first factor: one BLAS thread in this process (two single-threaded factors side by side beat one threaded
// factor after another), and the work space that OpenBLAS takes for each of `threads` callers. Throws std::bad_alloc
// where there is none: OpenBLAS itself would ask for it for ever.
void prepare_blas(int threads);

} // namespace pneuma::solver::linear
