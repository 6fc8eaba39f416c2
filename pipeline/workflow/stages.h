// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"

// What no key and no stage can know by itself: the graph of the stages, and what they say about foils, chambers and
// the loads of stages before.
namespace pneuma::pipeline::workflow {

// Where a stage stands in a file: "mesh", "stages.gust".
std::string path_of(const StageSettings& stage);

// Form of one stage, whose id and kind its reader knows; the kind of the stage it starts from stands in stage.yaml, in
// a user's file `link` finds it.
Form<StageSettings> stage_form(bool is_stage_file);

// Fills in what kind each stage starts from and checks that every chain of them begins at the mesh. `written`: the
// stages as they stand in the file, those with faults too.
void link(Reader& reader, const yaml::Node& written, std::vector<StageSettings>& stages);

// Rules between the stages and the cushion, of complete ones. Puts in place what the user left open: in a workflow
// without fault every foil, chamber, edge and load has its own value then.
void settle(Reader& reader, Workflow& workflow);

} // namespace pneuma::pipeline::workflow
