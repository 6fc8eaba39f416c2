// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pneuma::pipeline::yaml {

// One character of a text in UTF-8; a byte that begins none is a character of its own which is not valid.
struct Character {
  char32_t code = 0;
  std::size_t size = 1; // bytes
  bool valid = true;
};
Character character_at(std::string_view text, std::size_t at);

// Of ASCII and of Latin-1, such as ESC and U+009B, which terminals obey.
bool is_control(char32_t code);

// The text in one line without anything that a terminal obeys: `\n`, `\x1b`, `\u202e`; at most about 1000 bytes.
std::string printable(std::string_view text);

} // namespace pneuma::pipeline::yaml
