// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pneuma::pipeline::schema {

// The known word nearest to a mistyped one; empty: none is near, or there are too many.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

// "; did you mean `thickness`?", or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

// The words but one, of many the first ones.
std::vector<std::string> others(const std::vector<std::string>& words, std::string_view than);

bool is_among(std::string_view word, const std::vector<std::string>& words);

// "a, b, c"; "none" for an empty list, of a long one the beginning and the number.
std::string joined(const std::vector<std::string>& words);

} // namespace pneuma::pipeline::schema
