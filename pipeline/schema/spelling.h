// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pneuma::pipeline::schema {

// The known word nearest to a mistyped one; empty: none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

// "; did you mean `thickness`?", or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

// "a, b, c"; "none" for an empty list.
std::string joined(const std::vector<std::string>& words);

} // namespace pneuma::pipeline::schema
