// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "stages/common/foil_results.h"

namespace pneuma::stages::inflate {

// Compares foils that were welded from strips with the form and the stress that the strips were cut for, and writes
//   shape_deviation.<foil>.{max, mean, at}   normal distance from the target, m
//   stress_deviation.<foil>.{rms, max}       |n - n0| / |n0|, n the force per length, n0 the target
//   seam_strain.<foil>.{max, min}            current length of whole seams / flat length - 1, of either strip
// `target`: the state that the stage started from. `area` [block][point]: m2, weights.
void report_against_target(const common::State& target, const common::State& end,
                           const std::vector<common::FoilResults>& foils, const std::vector<std::vector<double>>& area,
                           common::Summary& summary);

} // namespace pneuma::stages::inflate
