// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pneuma::pipeline::drawing {

constexpr double capital_height = 0.72; // of the font size, in the usual sans-serif fonts

// A text as it stands in XML: letters with a meaning of their own replaced, control characters blanked.
std::string escaped(std::string_view text);

} // namespace pneuma::pipeline::drawing
