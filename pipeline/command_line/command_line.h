// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "geometry/base/namespace.h"

namespace pneuma::pipeline::command_line {

using Words = std::vector<std::string>;

// How often an option may be given.
enum class Times : std::uint8_t { at_most_once, once, any, at_least_once };

// An option with its values, or a word by its place.
struct Option {
  std::string name;                      // "--size", or "STATE.hdf" for a word by place
  std::string values;                    // behind it: "WxH", "A B"; empty: a flag, or a word by place
  std::string text;                      // for --help: meaning, unit, [default]
  std::function<void(const Words&)> set; // takes the values, each time it is given; throws InputError for a wrong one
  Times times = Times::at_most_once;     // `once` and `at_least_once`: needed, and not empty
};

// What a program, or a command of one, takes.
struct Command {
  std::string name;                   // as called: "pneuma-picture", or "run" as a command of "pneuma"
  std::string purpose;                // for --help, one sentence without a full stop
  std::vector<Option> options = {};   // not of a program that has commands
  std::vector<Command> commands = {}; // one of them is the first word
  std::function<void()> check = {};   // of options that must go together, after all are set; throws InputError
  std::string footer = {};            // for --help
};

// Reads the words behind a program's name. Checks the whole line, calls `set` in the order of the declaration, then
// `check`. Returns the name of the command that is given, "" for a program without commands; nullopt: help or version
// was asked for and is printed. Throws InputError with what is wrong and how to get help.
std::optional<std::string> read(const Command& program, const Words& words);

// Of the project.
const char* version();

// The whole number that `text`, a value of `option`, is. Throws InputError.
int whole_number(const std::string& option, const std::string& text, int least,
                 int most = std::numeric_limits<int>::max());

} // namespace pneuma::pipeline::command_line
