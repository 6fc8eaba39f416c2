// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"

namespace pneuma::stages::common {

// Lowest and highest temperature that a material has values for, K; none: it does not depend on the temperature.
std::optional<std::array<double, 2>> temperatures_of(const pipeline::workflow::Material& material);

// The law of a material at a temperature between those of its table, K: each value is linear between neighbours.
pipeline::workflow::MaterialLaw law_at(const pipeline::workflow::Material& material, double temperature);

} // namespace pneuma::stages::common
