// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pneuma::tests::damage {

// Where a key or value stands in the text of a YAML file, by byte offsets [begin, end), so that it can be cut out.
// A scanner of its own, for what stands in our files: maps and lists in blocks and in flow, plain and quoted words in
// one line, comments, anchors and aliases. It knows nothing of the code under test; what it does not know it refuses.
struct Piece {
  enum class Kind : std::uint8_t { null, word, alias, list, map } kind = Kind::null;
  bool in_flow = false; // [...], {...}
  bool quoted = false;  // a word
  bool anchored = false;
  std::size_t begin = 0; // with its anchor
  std::size_t end = 0;
  std::string text; // of a word, without quotes

  struct Key {
    std::string text;
    std::size_t begin = 0, end = 0;
  };
  std::vector<Key> keys;      // of a map
  std::vector<Piece> values;  // of a map, or the items of a list
  std::size_t item_begin = 0; // of an item of a block list: its dash
};

// Throws std::runtime_error with the line of what it does not know.
Piece pieces_of(const std::string& text);

// 1-based.
int line_of(const std::string& text, std::size_t offset);

} // namespace pneuma::tests::damage
