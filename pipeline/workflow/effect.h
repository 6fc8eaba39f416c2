// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"

// What a user says and would have no effect, as far as the settings alone show it.
namespace pneuma::pipeline::workflow {

// Of settled settings. A time in which nothing flows, a wind stage that changes nothing, a `warp` that strips override.
void check_effects(Reader& reader, const Workflow& workflow);

} // namespace pneuma::pipeline::workflow
