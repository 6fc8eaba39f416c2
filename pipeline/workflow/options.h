// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/schema/option.h"

namespace pneuma::pipeline::workflow {

// All keys of a workflow file.
const schema::Option& workflow_options();

// All keys of a stage.yaml: those of a workflow file, and in a stage the kind of the stage it starts from.
const schema::Option& stage_file_options();

// All keys of a file of materials: names with their laws.
const schema::Option& materials_file_options();

// The JSON schema of workflow files (configs/workflow.schema.json) and the reference of all keys as text.
std::string workflow_json_schema();
std::string workflow_reference();

} // namespace pneuma::pipeline::workflow
