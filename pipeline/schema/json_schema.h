// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/schema/option.h"

namespace pneuma::pipeline::schema {

// The JSON schema (draft-07) of a file with the keys of `root`, for editors that complete and check YAML.
std::string json_schema(const Option& root, const std::string& title);

} // namespace pneuma::pipeline::schema
