// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::yaml {

// The place of a byte of the text.
Mark mark_at(std::string_view text, std::size_t at, const std::string& name);

// What is wrong in `a:1`, or in a word where `key: value` belongs; empty: nothing of that kind.
std::string without_colon(std::string_view line);

// The quote of the value that begins at a byte, where it is not closed in the text.
std::optional<Problem> open_quote(std::string_view text, std::size_t at, const std::string& name);

// What is wrong where yaml-cpp gave up with `complaint`, in words and at the place where the slip began.
Problem slip(std::string_view text, std::size_t at, const std::string& complaint, const std::string& name);

} // namespace pneuma::pipeline::yaml
