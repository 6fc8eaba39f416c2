// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/option.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::schema {

const std::vector<Option>& Option::members() const {
  static const std::vector<Option> none;
  return parts != nullptr ? *parts : none;
}

Option option_of(Type type, std::vector<Option> members) {
  Option option;
  option.type = type;
  option.parts = std::make_shared<const std::vector<Option>>(std::move(members));
  return option;
}

Option not_available(const std::string& name, const std::string& instead) {
  Option option = option_of(Type::group);
  option.name = name, option.not_yet = instead;
  return option;
}

void set_default(Option& option, const std::string& yaml) {
  std::vector<Problem> none;
  option.default_node = std::make_shared<const Node>(parse_yaml(yaml, "default", none));
  option.default_value = yaml;
}

NodeKind kind_of(const Option& option) {
  switch (option.type) {
  case Type::list:
    return NodeKind::list;
  case Type::group:
  case Type::table:
  case Type::variant:
    return NodeKind::map;
  default:
    return NodeKind::scalar;
  }
}

std::vector<std::string> names_of(const std::vector<Option>& options) {
  std::vector<std::string> names;
  for (const Option& option : options) {
    if (names.empty() || names.back() != option.name) names.push_back(option.name);
  }
  return names;
}

std::vector<std::string> available_names(const std::vector<Option>& options) {
  std::vector<Option> available;
  std::copy_if(options.begin(), options.end(), std::back_inserter(available),
               [](const Option& option) { return option.not_yet.empty(); });
  return names_of(available);
}

std::string expected(const Option& option) {
  switch (option.type) {
  case Type::text:
    return "a text";
  case Type::name:
    return "a name of letters, digits, _ and -";
  case Type::flag:
    return "on or off";
  case Type::integer:
    return "a whole number";
  case Type::number:
    return "a plain number";
  case Type::quantity:
    return dimension_of(option.unit) + " with its unit";
  case Type::choice: {
    const std::vector<std::string> names = available_names(option.members());
    return (names.size() == 1 ? "" : "one of: ") + joined(names);
  }
  case Type::list:
    return "a list [...]";
  case Type::group:
    return "a map with the keys " + joined(available_names(option.members()));
  case Type::table:
    return "a map from names to values";
  case Type::variant:
    return fmt::format("a map with the key `{}` (one of: {})", option.tag, joined(available_names(option.members())));
  case Type::either: {
    std::string words;
    for (const Option& kind : option.members()) {
      if (kind.not_yet.empty()) words += (words.empty() ? "" : " or ") + expected(kind);
    }
    return words;
  }
  }
  return {};
}

std::string wanted(const KeySet& set) {
  if (!set.beside.empty()) return fmt::format("`{}` beside `{}`", fmt::join(set.keys, "` or `"), set.beside);
  const char* count = set.least == 0 ? "at most one" : set.most == 1 ? "exactly one" : "at least one";
  return fmt::format("{} of: {}", count, joined(set.keys));
}

namespace {

void describe(const Option& option, const std::string& name, const std::string& indent, std::string& out) {
  if (!option.not_yet.empty()) {
    out += fmt::format("{}{}: not available yet; {}\n", indent, name, option.not_yet);
    return;
  }
  out += fmt::format("{}{}: {}", indent, name, option.text);
  if (kind_of(option) == NodeKind::scalar && option.type != Type::either) out += "; " + expected(option);
  if (option.limits) out += ", " + option.limits->words;
  if (option.is_required) out += "; required";
  if (!option.default_value.empty())
    out += fmt::format(" [{}{}]", option.tag.empty() ? "" : option.tag + ": ", option.default_value);
  out += '\n';
  for (const KeySet& set : option.alternatives) out += fmt::format("{}  ({})\n", indent, wanted(set));
  if (option.type == Type::choice) return;
  const std::string lead = option.type == Type::variant ? option.tag + " " : "";
  for (const Option& member : option.members()) describe(member, lead + member.name, indent + "  ", out);
}

} // namespace

std::string reference(const Option& root) {
  std::string out;
  for (const Option& member : root.members()) describe(member, member.name, "", out);
  return out;
}

} // namespace pneuma::pipeline::schema
