// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/option.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::schema {

namespace {

Option make(std::string name, Type type, std::string what) {
  Option option;
  option.name = std::move(name);
  option.type = type;
  option.text = std::move(what);
  return option;
}

} // namespace

Option Option::required() const {
  Option copy = *this;
  copy.is_required = true;
  return copy;
}
Option Option::otherwise(std::string yaml) const {
  Option copy = *this;
  copy.default_value = std::move(yaml);
  return copy;
}
Option Option::unavailable(std::string instead) const {
  Option copy = *this;
  copy.not_yet = std::move(instead);
  return copy;
}
Option Option::within(Range range) const {
  Option copy = *this;
  copy.limits = std::move(range);
  return copy;
}
Option Option::positive() const {
  return within({0, std::numeric_limits<double>::infinity(), "positive", false, true});
}
Option Option::at_least(double min, std::string words) const {
  return within({min, std::numeric_limits<double>::infinity(), std::move(words)});
}
Option Option::between(double min, double max, std::string words) const {
  return within({min, max, std::move(words)});
}
Option Option::usual(double min, double max, std::string words) const {
  Option copy = *this;
  copy.usually = Range{min, max, std::move(words)};
  return copy;
}
Option Option::items(std::size_t least, std::size_t most) const {
  Option copy = *this;
  copy.min_items = least;
  copy.max_items = most;
  return copy;
}
Option Option::exactly_one(std::vector<std::string> keys) const {
  Option copy = *this;
  copy.alternatives.push_back({std::move(keys)});
  return copy;
}
Option Option::at_least_one(std::vector<std::string> keys) const {
  Option copy = *this;
  const std::size_t most = keys.size();
  copy.alternatives.push_back({std::move(keys), 1, most});
  return copy;
}
Option Option::not_both(std::string first, std::string second) const {
  Option copy = *this;
  copy.alternatives.push_back({{std::move(first), std::move(second)}, 0, 1});
  return copy;
}

Option text(std::string name, std::string what) {
  return make(std::move(name), Type::text, std::move(what));
}
Option word(std::string name, std::string what) {
  return make(std::move(name), Type::name, std::move(what));
}
Option flag(std::string name, std::string what) {
  return make(std::move(name), Type::flag, std::move(what));
}
Option integer(std::string name, std::string what) {
  return make(std::move(name), Type::integer, std::move(what));
}
Option number(std::string name, std::string what) {
  return make(std::move(name), Type::number, std::move(what));
}
Option value(std::string name, std::string what) {
  return make(std::move(name), Type::text, std::move(what));
}
Option quantity(std::string name, std::string unit, std::string what) {
  Option option = make(std::move(name), Type::quantity, std::move(what));
  option.unit = std::move(unit);
  return option;
}

namespace {

Option with(Option option, std::vector<Option> members) {
  option.members = std::move(members);
  return option;
}

} // namespace

Option choice(std::string name, std::vector<Option> values, std::string what) {
  return with(make(std::move(name), Type::choice, std::move(what)), std::move(values));
}
Option list(std::string name, Option item, std::string what) {
  return with(make(std::move(name), Type::list, std::move(what)), {std::move(item)});
}
Option group(std::string name, std::vector<Option> keys, std::string what) {
  return with(make(std::move(name), Type::group, std::move(what)), std::move(keys));
}
Option table(std::string name, Option item, std::string what) {
  return with(make(std::move(name), Type::table, std::move(what)), {std::move(item)});
}
Option either(std::string name, std::vector<Option> kinds, std::string what) {
  return with(make(std::move(name), Type::either, std::move(what)), std::move(kinds));
}
Option variant(std::string name, std::string tag, std::vector<Option> groups, std::string what) {
  Option option = with(make(std::move(name), Type::variant, std::move(what)), std::move(groups));
  option.tag = std::move(tag);
  return option;
}

const Value* Value::find(const std::string& name) const {
  for (const auto& [member, value] : members) {
    if (member == name) return &value;
  }
  return nullptr;
}

const Value* Value::operator[](const std::string& name) const {
  const Value* value = find(name);
  return value != nullptr && value->valid ? value : nullptr;
}

double number_of(const Value& group, const std::string& key, double otherwise) {
  const Value* value = group[key];
  return value != nullptr ? value->number : otherwise;
}

std::optional<double> optional_number(const Value& group, const std::string& key) {
  const Value* value = group[key];
  return value != nullptr ? std::optional<double>(value->number) : std::nullopt;
}

std::optional<int> optional_integer(const Value& group, const std::string& key) {
  const std::optional<double> value = optional_number(group, key);
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

std::string text_of(const Value& group, const std::string& key) {
  const Value* value = group[key];
  return value != nullptr ? value->text : "";
}

namespace {

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
  for (const Option& option : options) names.push_back(option.name);
  return names;
}

std::vector<std::string> available_names(const std::vector<Option>& options) {
  std::vector<std::string> names;
  for (const Option& option : options) {
    if (option.not_yet.empty()) names.push_back(option.name);
  }
  return names;
}

// What may stand for an option, for messages.
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
    const std::vector<std::string> names = available_names(option.members);
    return (names.size() == 1 ? "" : "one of: ") + joined(names);
  }
  case Type::list:
    return "a list [...]";
  case Type::group:
    return "a map with the keys " + joined(available_names(option.members));
  case Type::table:
    return "a map from names to values";
  case Type::variant:
    return fmt::format("a map with the key `{}` (one of: {})", option.tag, joined(available_names(option.members)));
  case Type::either: {
    std::string words;
    for (const Option& kind : option.members) {
      if (kind.not_yet.empty()) words += (words.empty() ? "" : " or ") + expected(kind);
    }
    return words;
  }
  }
  return {};
}

std::string written(const Node& node) {
  switch (node.kind) {
  case NodeKind::null:
    return "nothing";
  case NodeKind::scalar:
    return "`" + node.text + "`";
  case NodeKind::list:
    return "a list";
  case NodeKind::map:
    return "a map";
  }
  return {};
}

// "exactly one of: a, b"
std::string wanted(const KeySet& set) {
  const char* count = set.least == 0 ? "at most one" : set.most == 1 ? "exactly one" : "at least one";
  return fmt::format("{} of: {}", count, joined(set.keys));
}

// What a value is called in messages: the last key of its path, with those before for list items.
std::string title(const std::string& path) {
  if (path.empty()) return "the file";
  const auto dot = path.rfind('.');
  const std::string last = dot == std::string::npos ? path : path.substr(dot + 1);
  const bool is_position =
      !last.empty() && std::all_of(last.begin(), last.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!is_position || dot == std::string::npos) return "`" + last + "`";
  return fmt::format("entry {} of {}", std::stoi(last) + 1, title(path.substr(0, dot)));
}

bool inside(const Range& range, double value) {
  return (range.includes_min ? value >= range.min : value > range.min) &&
         (range.includes_max ? value <= range.max : value < range.max);
}

class Reader {
public:
  explicit Reader(Check& context) : context_(context) {}

  Value read(const Option& option, const Node& node, const std::string& path) {
    Value value;
    value.mark = node.mark;
    value.given = !reading_default_;
    value.read_as = &option;
    if (option.type == Type::either) return read_either(option, node, path);
    if (node.kind != kind_of(option)) {
      fail(node.mark, fmt::format("{} must be {}, not {}", title(path), expected(option), written(node)));
      return value;
    }
    if (node.kind == NodeKind::scalar && value.given) context_.origins[path] = node.mark;
    value.text = node.text;
    value.valid = true;
    switch (option.type) {
    case Type::text:
      break;
    case Type::name:
      check_name(node.text, node.mark, value);
      break;
    case Type::flag:
      read_flag(node, path, value);
      break;
    case Type::integer:
    case Type::number:
    case Type::quantity:
      read_number(option, node, path, value);
      break;
    case Type::choice:
      read_choice(option, node, path, value);
      break;
    case Type::list:
      read_list(option, node, path, value);
      break;
    case Type::table:
      for (const Entry& entry : node.entries) {
        check_name(entry.key, entry.mark, value);
        Value item = read(option.members.front(), entry.value, below(path, entry.key));
        item.key = entry.mark;
        value.members.push_back({entry.key, std::move(item)});
      }
      break;
    case Type::group:
      read_group(option, node, path, {}, value);
      break;
    case Type::variant:
      return read_variant(option, node, path, std::move(value));
    case Type::either:
      break;
    }
    return value;
  }

private:
  static std::string below(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  void fail(const Mark& mark, std::string message) { context_.problems.push_back({mark, std::move(message), true}); }

  void not_yet(const Mark& mark, const std::string& what, const std::string& instead) {
    fail(mark, fmt::format("{} is not available yet; {}", what, instead));
  }

  void check_name(const std::string& name, const Mark& mark, Value& value) {
    const bool fine = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return (std::isalnum(c) != 0 && c < 128) || c == '_' || c == '-';
    });
    if (fine) return;
    fail(mark, fmt::format("`{}` is no name: letters, digits, _ and - are allowed", name));
    value.valid = false;
  }

  void read_flag(const Node& node, const std::string& path, Value& value) {
    value.flag = node.text == "on" || node.text == "true" || node.text == "yes";
    if (value.flag || node.text == "off" || node.text == "false" || node.text == "no") return;
    fail(node.mark, fmt::format("{} must be on or off, not `{}`", title(path), node.text));
    value.valid = false;
  }

  void read_number(const Option& option, const Node& node, const std::string& path, Value& value) {
    value.valid = false;
    if (option.type == Type::quantity) {
      const Quantity read = parse_quantity(node.text, option.unit);
      if (!read.error.empty()) return fail(node.mark, fmt::format("{}: {}", title(path), read.error));
      value.number = read.value;
    } else if (option.type == Type::integer) {
      int whole = 0;
      const char* end = node.text.data() + node.text.size();
      const auto [stop, failure] = std::from_chars(node.text.data(), end, whole);
      if (failure != std::errc() || stop != end) {
        return fail(node.mark, fmt::format("{} must be a whole number, not `{}`", title(path), node.text));
      }
      value.number = whole;
    } else {
      const std::optional<double> plain = parse_number(node.text);
      if (!plain) return fail(node.mark, fmt::format("{} must be a plain number, not `{}`", title(path), node.text));
      value.number = *plain;
    }
    if (option.limits && !inside(*option.limits, value.number)) {
      return fail(node.mark, fmt::format("{} must be {}, not {}", title(path), option.limits->words, node.text));
    }
    if (option.usually && !inside(*option.usually, value.number)) {
      context_.problems.push_back(
          {node.mark, fmt::format("{} {} is unusual ({}); is it meant?", title(path), node.text, option.usually->words),
           false});
    }
    value.valid = true;
  }

  void read_choice(const Option& option, const Node& node, const std::string& path, Value& value) {
    for (const Option& allowed : option.members) {
      if (allowed.name != node.text) continue;
      value.read_as = &allowed;
      if (!allowed.not_yet.empty()) {
        not_yet(node.mark, fmt::format("{}: `{}`", title(path), node.text), allowed.not_yet);
        value.valid = false;
      }
      return;
    }
    value.valid = false;
    fail(node.mark,
         fmt::format("{} must be one of: {}, not `{}`{}", title(path), joined(available_names(option.members)),
                     node.text, suggestion(node.text, names_of(option.members))));
  }

  void read_list(const Option& option, const Node& node, const std::string& path, Value& value) {
    const std::size_t count = node.items.size();
    if (count < option.min_items || count > option.max_items) {
      const bool few = count < option.min_items;
      const char* bound = option.min_items == option.max_items ? "" : few ? "at least " : "at most ";
      const std::string wanted = fmt::format("{}{}", bound, few ? option.min_items : option.max_items);
      fail(node.mark, fmt::format("{} must have {} entries, not {}", title(path), wanted, count));
      value.valid = false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      value.items.push_back(read(option.members.front(), node.items[i], below(path, std::to_string(i))));
      value.valid = value.valid && value.items.back().valid;
    }
  }

  // Of two kinds of scalars a choice comes first: what begins like a number is left to the other.
  Value read_either(const Option& option, const Node& node, const std::string& path) {
    const auto scalars = std::count_if(option.members.begin(), option.members.end(),
                                       [](const Option& kind) { return kind_of(kind) == NodeKind::scalar; });
    std::vector<std::string> words;
    for (const Option& kind : option.members) {
      if (kind_of(kind) != node.kind) continue;
      if (!kind.not_yet.empty()) {
        not_yet(node.mark, fmt::format("{} as {}", title(path), written(node)), kind.not_yet);
        Value value;
        value.mark = node.mark;
        value.read_as = &kind;
        return value;
      }
      if (kind.type == Type::choice) {
        words = names_of(kind.members);
        if (std::find(words.begin(), words.end(), node.text) == words.end()) {
          if (scalars > 1 && node.text.find_first_of("+-.0123456789") == 0) continue;
          break;
        }
      }
      return read(kind, node, path);
    }
    Value value;
    value.mark = node.mark;
    fail(node.mark, fmt::format("{} must be {}, not {}{}", title(path), expected(option), written(node),
                                suggestion(node.text, words)));
    return value;
  }

  // `tag`: a key that belongs to the variant around and is no member
  void read_group(const Option& option, const Node& node, const std::string& path, const std::string& tag,
                  Value& value) {
    std::vector<std::string> known = names_of(option.members);
    if (!tag.empty()) known.insert(known.begin(), tag);
    bool has_unavailable = false;
    for (const Entry& entry : node.entries) {
      if (entry.key == tag && !tag.empty()) continue;
      const auto member = std::find_if(option.members.begin(), option.members.end(),
                                       [&](const Option& o) { return o.name == entry.key; });
      if (member == option.members.end()) {
        fail(entry.mark, fmt::format("unknown key `{}` in {}{}; known: {}", entry.key, title(path),
                                     suggestion(entry.key, known), joined(known)));
        value.valid = false;
        continue;
      }
      if (!member->not_yet.empty()) {
        not_yet(entry.mark, fmt::format("`{}`", entry.key), member->not_yet);
        has_unavailable = true;
        Value unread;
        unread.mark = entry.value.mark;
        unread.key = entry.mark;
        unread.given = true;
        value.members.push_back({entry.key, std::move(unread)});
        continue;
      }
      Value read_value = read(*member, entry.value, below(path, entry.key));
      read_value.key = entry.mark;
      value.members.push_back({entry.key, std::move(read_value)});
    }
    // a group that asks for something unavailable is not also told what else it lacks
    if (!has_unavailable) report_missing(option, node, path, value);
    for (const Option& member : option.members) {
      // an absent variant stays absent: its default names the group of one that is there
      if (!member.default_value.empty() && member.tag.empty() && value.find(member.name) == nullptr) {
        value.members.push_back({member.name, read_default(member, path, value)});
      }
    }
  }

  void report_missing(const Option& option, const Node& node, const std::string& path, Value& value) {
    for (const Option& member : option.members) {
      if (!member.is_required || value.find(member.name) != nullptr) continue;
      fail(node.mark,
           fmt::format("{} lacks the key `{}`: {} ({})", title(path), member.name, member.text, expected(member)));
      value.valid = false;
    }
    for (const KeySet& set : option.alternatives) {
      const auto is_present = [&](const std::string& key) { return value.find(key) != nullptr; };
      const auto present = static_cast<std::size_t>(std::count_if(set.keys.begin(), set.keys.end(), is_present));
      if (present >= set.least && present <= set.most) continue;
      fail(node.mark, fmt::format("{} needs {}; it has {}", title(path), wanted(set),
                                  present == 0 ? "none" : fmt::format("{}", present)));
      value.valid = false;
    }
  }

  Value read_default(const Option& option, const std::string& path, const Value& around) {
    std::vector<Problem> none;
    const Node node = parse_yaml(option.default_value, "default of " + option.name, none);
    const bool before = std::exchange(reading_default_, true);
    Value value = read(option, node, below(path, option.name));
    reading_default_ = before;
    value.mark = value.key = around.mark;
    return value;
  }

  Value read_variant(const Option& option, const Node& node, const std::string& path, Value value) {
    value.valid = false;
    const Node* tag = schema::find(node, option.tag);
    if (tag == nullptr && option.default_value.empty()) {
      fail(node.mark, fmt::format("{} lacks the key `{}`: one of {}", title(path), option.tag,
                                  joined(available_names(option.members))));
      return value;
    }
    const Node by_default = scalar(option.default_value);
    if (tag == nullptr) tag = &by_default;
    if (tag->kind != NodeKind::scalar) {
      fail(tag->mark, fmt::format("`{}` must be one of: {}, not {}", option.tag,
                                  joined(available_names(option.members)), written(*tag)));
      return value;
    }
    value.text = tag->text;
    for (const Option& chosen : option.members) {
      if (chosen.name != tag->text) continue;
      value.read_as = &chosen;
      if (!chosen.not_yet.empty()) {
        not_yet(tag->mark, fmt::format("`{}: {}`", option.tag, tag->text), chosen.not_yet);
        return value;
      }
      if (value.given && tag != &by_default) context_.origins[below(path, option.tag)] = tag->mark;
      value.valid = true;
      read_group(chosen, node, path, option.tag, value);
      return value;
    }
    fail(tag->mark,
         fmt::format("`{}` must be one of: {}, not `{}`{}", option.tag, joined(available_names(option.members)),
                     tag->text, suggestion(tag->text, names_of(option.members))));
    return value;
  }

  Check& context_;
  bool reading_default_ = false;
};

void describe(const Option& option, const std::string& indent, std::string& out) {
  if (!option.not_yet.empty()) {
    out += fmt::format("{}{}: not available yet; {}\n", indent, option.name, option.not_yet);
    return;
  }
  out += fmt::format("{}{}: {}", indent, option.name, option.text);
  const bool is_scalar = kind_of(option) == NodeKind::scalar && option.type != Type::either;
  if (is_scalar) out += "; " + expected(option);
  if (option.limits) out += ", " + option.limits->words;
  if (option.is_required) out += "; required";
  if (!option.default_value.empty())
    out += fmt::format(" [{}{}]", option.tag.empty() ? "" : option.tag + ": ", option.default_value);
  out += '\n';
  for (const KeySet& set : option.alternatives) out += fmt::format("{}  ({})\n", indent, wanted(set));
  if (option.type == Type::choice) return;
  for (const Option& member : option.members) {
    const std::string lead = option.type == Type::variant ? option.tag + " " : "";
    Option shown = member;
    shown.name = lead + member.name;
    describe(shown, indent + "  ", out);
  }
}

} // namespace

Value check(const Option& option, const Node& node, const std::string& path, Check& context) {
  return Reader(context).read(option, node, path);
}

std::string reference(const Option& root) {
  std::string out;
  for (const Option& member : root.members) describe(member, "", out);
  return out;
}

} // namespace pneuma::pipeline::schema
