// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pneuma::tests::damage {

enum class Kind : std::uint8_t {
  key_dropped,
  key_doubled,
  key_misspelt,
  unit_dropped,
  unit_doubled,
  unit_foreign,
  list_shortened,
  list_lengthened,
  list_emptied,
  value_as_list, // of another type
  value_as_map,
  value_as_word,
  value_as_number,
  value_empty,
  value_nan,
  value_inf,
  value_huge, // 1e400
  value_negative,
  value_zero,
  number_behind,
  name_unknown,
};
constexpr int kind_count = static_cast<int>(Kind::name_unknown) + 1;
std::string to_string(Kind kind);

// Lines of a damaged text, 1-based.
struct Lines {
  int first = 0, last = 0;
};

// One thing wrong in a YAML file, and where a message about it may point and what it must name.
struct Damage {
  Kind kind = Kind::key_dropped;
  std::string path; // of the key or value, "cushion.foils.0.thickness"
  std::size_t begin = 0, end = 0;
  std::string with;         // stands instead of [begin, end)
  std::string before, line; // what was there (a value, a key); the damaged line as it is now
  std::string after;        // a value: what stands there now; a misspelt key
  Lines at;
  std::vector<std::string> words; // key, value: one of them is in the message
  // Elsewhere, where something is called that is lost or changed: `foil: upper` where `name: upper` is gone.
  std::vector<std::string> names;
  std::vector<int> references;
  std::size_t value_begin = 0, value_end = 0; // of a dropped key, in the undamaged text, from behind its colon
  bool shared = false;                        // inside an anchor, whose aliases share it
};

// All damages of a text by one step, in the order of the file; aliases are cut out and replaced whole, what they stand
// for is damaged at its anchor. Throws std::runtime_error for YAML beyond `pieces_of`.
std::vector<Damage> damages_of(const std::string& text);

std::string damaged(const std::string& text, const Damage& damage);

// The number that a value begins with, and its unit.
struct Number {
  bool is_number = false;
  double value = 0;
  std::string digits, unit;
};
Number number_in(const std::string& text);

} // namespace pneuma::tests::damage
