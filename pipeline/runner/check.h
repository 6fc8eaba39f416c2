// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

enum class MeshCheck : std::uint8_t { made, left_out };

// Asks the programs of the stages what only they can judge, whether the materials are laws and the plan can be meshed:
// a process for each kind of stage, side by side. Prints each of their lines once, with places as those of
// read_workflow; throws Error where there is an error. The check of the mesh makes it; a run, which begins with the
// mesh, leaves that out.
void check_by_stages(const workflow::Workflow& workflow, MeshCheck mesh);

} // namespace pneuma::pipeline::runner
