// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/command_line/command_line.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <getopt.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::command_line {

namespace {

using base::InputError;

constexpr std::size_t help_width = 100; // columns

using Given = std::vector<std::vector<Words>>; // of each option, each time: the values

Words split(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

bool is_by_place(const Option& option) {
  return !option.name.starts_with("-");
}

bool is_needed(const Option& option) {
  return option.times == Times::once || option.times == Times::at_least_once;
}

bool repeats(const Option& option) {
  return option.times == Times::any || option.times == Times::at_least_once;
}

std::string call_of(const Option& option) {
  const std::string call = option.values.empty() ? option.name : option.name + " " + option.values;
  return is_by_place(option) && repeats(option) ? call + " ..." : call;
}

// " STATE.hdf --out PICTURE.png": what must be given, and the words by place.
std::string usage(const Command& command) {
  std::string text;
  for (const Option& option : command.options) {
    if (is_needed(option)) text += fmt::format(" {}", call_of(option));
    if (!is_needed(option) && is_by_place(option)) text += fmt::format(" [{}]", call_of(option));
  }
  return text;
}

// `text` behind `start`, in lines of which all but the first are indented.
std::string wrapped(const std::string& start, const std::string& text, std::size_t indent) {
  std::string lines = start;
  std::size_t used = start.size();
  for (const std::string& word : split(text)) {
    if (used + 1 + word.size() > help_width) {
      lines += fmt::format("\n{:{}}{}", "", indent, word);
      used = indent + word.size();
    } else {
      lines += (used == 0 ? "" : " ") + word;
      used += (used == 0 ? 0 : 1) + word.size();
    }
  }
  return lines + "\n";
}

std::string help(const std::string& called, const Command& command) {
  const bool has_commands = !command.commands.empty();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Command& one : command.commands) rows.emplace_back(one.name + usage(one), one.purpose);
  for (const Option& option : command.options) rows.emplace_back(call_of(option), option.text);
  rows.emplace_back("-h, --help", has_commands ? "this text; behind a command, what that takes" : "this text");
  rows.emplace_back("--version", "the version");
  std::size_t widest = 0;
  for (const auto& [left, right] : rows) widest = std::max(widest, left.size());

  std::string text = wrapped(called + ":", command.purpose, 2);
  text += wrapped("usage: " + called, has_commands ? "COMMAND ..." : usage(command) + " [options]", 9) + "\n";
  for (const auto& [left, right] : rows) text += wrapped(fmt::format("  {:<{}} ", left, widest), right, widest + 4);
  if (!command.footer.empty()) text += fmt::format("\n{}", wrapped("", command.footer, 0));
  text.pop_back();
  return text;
}

// Where a word by place belongs.
std::size_t find_place(const Command& command, const std::string& word, const Given& given) {
  for (std::size_t i = 0; i < command.options.size(); ++i) {
    if (is_by_place(command.options[i]) && (given[i].empty() || repeats(command.options[i]))) return i;
  }
  throw InputError(fmt::format("unexpected argument `{}`", word));
}

[[noreturn]] void refuse_option(const Command& command, const std::string& name) {
  Words known = {"--help", "--version"};
  for (const Option& option : command.options) {
    if (!is_by_place(option)) known.push_back(option.name);
  }
  throw InputError(fmt::format("unknown option `{}`{}", name, schema::suggestion(name, known)));
}

// What getopt_long returns for the first option; those after it follow.
constexpr int first_option = 256;

std::vector<::option> as_getopt_takes_them(const Command& command) {
  std::vector<::option> all;
  for (std::size_t i = 0; i < command.options.size(); ++i) {
    const Option& one = command.options[i];
    if (is_by_place(one)) continue;
    all.push_back({one.name.c_str() + 2, one.values.empty() ? no_argument : required_argument, nullptr,
                   first_option + static_cast<int>(i)});
  }
  all.push_back({});
  return all;
}

bool is_option(const Command& command, const std::string& word) {
  return word.starts_with("--") && std::any_of(command.options.begin(), command.options.end(),
                                               [&](const Option& option) { return option.name == word; });
}

[[noreturn]] void refuse_values(const Option& option) {
  const std::size_t count = split(option.values).size();
  throw InputError(fmt::format("{} needs {}: {}", option.name, count == 1 ? "a value" : fmt::format("{} values", count),
                               option.values));
}

Given sort(const Command& command, std::span<const std::string> words) {
  Given given(command.options.size());
  std::vector<std::string> copies = {command.name}; // getopt takes what could be changed
  copies.insert(copies.end(), words.begin(), words.end());
  std::vector<char*> line;
  for (std::string& word : copies) line.push_back(word.data());
  const int count = static_cast<int>(line.size());
  line.push_back(nullptr);
  const std::vector<::option> options = as_getopt_takes_them(command);
  opterr = optind = 0;
  const auto option_of = [&](int code) -> const Option& {
    return command.options[static_cast<std::size_t>(code - first_option)];
  };
  const auto take_word = [&](const std::string& word) { given[find_place(command, word, given)].push_back({word}); };
  for (int code = 0; (code = getopt_long(count, line.data(), "-:", options.data(), nullptr)) != -1;) {
    if (code == 1) {
      take_word(optarg);
    } else if (code == ':') {
      refuse_values(option_of(optopt));
    } else if (code == '?') {
      if (optopt >= first_option) throw InputError(fmt::format("{} takes no value", option_of(optopt).name));
      const std::string word = line[static_cast<std::size_t>(std::max(1, optind - 1))];
      refuse_option(command, word.substr(0, word.find('=')));
    } else {
      const Option& one = option_of(code);
      const bool is_apart = optarg != nullptr && optarg == line[static_cast<std::size_t>(optind - 1)];
      const std::string word = line[static_cast<std::size_t>(optind - (is_apart ? 2 : 1))];
      const std::string name = word.substr(0, word.find('='));
      if (name != one.name) refuse_option(command, name); // getopt takes what is short for one
      if (is_apart && is_option(command, optarg)) refuse_values(one);
      std::vector<Words>& times = given[static_cast<std::size_t>(code - first_option)];
      if (!times.empty() && !repeats(one)) throw InputError(fmt::format("{} is given twice", one.name));
      Words& values = times.emplace_back();
      if (optarg != nullptr) values.emplace_back(optarg);
      while (values.size() < split(one.values).size()) {
        if (optind == count) refuse_values(one);
        values.emplace_back(line[static_cast<std::size_t>(optind++)]);
      }
    }
  }
  for (int i = optind; i < count; ++i) take_word(line[static_cast<std::size_t>(i)]); // behind `--`
  return given;
}

void read_options(const Command& command, std::span<const std::string> words) {
  const Given given = sort(command, words);
  const auto is_empty = [](const Words& values) { return !values.empty() && values.front().empty(); };
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (is_needed(command.options[i]) &&
        (given[i].empty() || std::any_of(given[i].begin(), given[i].end(), is_empty))) {
      throw InputError(fmt::format("{} is missing", command.options[i].name));
    }
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    for (const Words& values : given[i]) command.options[i].set(values);
  }
  if (command.check) command.check();
}

const Command& find_command(const Command& program, const Words& words) {
  Words names;
  for (const Command& command : program.commands) {
    if (!words.empty() && command.name == words.front()) return command;
    names.push_back(command.name);
  }
  const std::string known = "commands: " + schema::joined(names);
  if (words.empty()) throw InputError("no command is given; " + known);
  if (words.front().starts_with("-")) refuse_option(program, words.front());
  throw InputError(
      fmt::format("there is no command `{}`{}; {}", words.front(), schema::suggestion(words.front(), names), known));
}

// Whether help or the version is asked for, and printed.
bool is_answered(const std::string& called, const Command& command, std::span<const std::string> words) {
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word == "--help" || word == "-h") {
      base::say(help(called, command));
      return true;
    }
    if (word == "--version") {
      base::say(fmt::format("{} {}", called.substr(0, called.find(' ')), version()));
      return true;
    }
  }
  return false;
}

} // namespace

std::optional<std::string> read(const Command& program, const Words& words) {
  std::span<const std::string> rest = words;
  std::string called = program.name;
  const Command* command = &program;
  try {
    if (!program.commands.empty()) {
      if (is_answered(called, program, rest.first(std::min<std::size_t>(1, rest.size())))) return std::nullopt;
      command = &find_command(program, words);
      called += " " + command->name;
      rest = rest.subspan(1);
    }
    if (is_answered(called, *command, rest)) return std::nullopt;
    read_options(*command, rest);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}\n`{} --help` shows all {}", error.what(), called,
                                 command->commands.empty() ? "options" : "commands"));
  }
  return command == &program ? "" : command->name;
}

const char* version() {
  return PNEUMA_VERSION;
}

int whole_number(const std::string& option, const std::string& text, int least, int most) {
  int value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error == std::errc() && end == last && value >= least && value <= most) return value;
  const std::string limit = most == std::numeric_limits<int>::max() ? "" : fmt::format(" to {}", most);
  throw InputError(fmt::format("{}: `{}` is not a whole number from {}{}", option, text, least, limit));
}

} // namespace pneuma::pipeline::command_line
