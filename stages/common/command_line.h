// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::stages::common {

using Words = std::vector<std::string>;

// A switch of a program that is told everything on its command line.
template <class Options>
struct Switch {
  std::string name;      // "--size"
  std::size_t count = 0; // of the values behind it
  std::function<void(Options&, const Words&)> set;
};

inline bool asks_for_help(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--help" || word == "-h"; });
}

// Reads a command line into `options`: every switch with its values, every other word by `take`. Throws InputError
// with the nearest switch and the usage where one is unknown or lacks a value.
template <class Options, class Take>
void read_command_line(std::span<const std::string> words, const std::vector<Switch<Options>>& switches,
                       const char* usage, Options& options, const Take& take) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with("-")) {
      take(words[i]);
      continue;
    }
    const Switch<Options>* found = nullptr;
    Words names;
    for (const Switch<Options>& known : switches) {
      if (known.name == words[i]) found = &known;
      names.push_back(known.name);
    }
    if (found == nullptr) {
      throw base::InputError(
          fmt::format("unknown option `{}`{}\n{}", words[i], pipeline::schema::suggestion(words[i], names), usage));
    }
    const std::span<const std::string> rest = words.subspan(i + 1);
    if (rest.size() < found->count) {
      throw base::InputError(fmt::format("{} needs {}\n{}", found->name,
                                         found->count == 1 ? "a value" : fmt::format("{} values", found->count),
                                         usage));
    }
    found->set(options, Words(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(found->count)));
    i += found->count;
  }
}

} // namespace pneuma::stages::common
