// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::schema {

namespace {

constexpr std::size_t longest_name = 64; // stages and foils name folders and files

// The path around; empty: the file itself.
std::string around(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string written_as(const Node& node) {
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

} // namespace

std::string quoted(const std::string& key) {
  return fmt::format("`{}`", key);
}

void Reader::fail_value(const Source& source, const std::string& fault) {
  fail(source.node.mark, fault.starts_with("must ") ? fmt::format("{} {}", title(source.path), fault) : fault);
}

void Reader::refuse(const std::string& path, const std::string& why) {
  fail_key(path, fmt::format("{} {}; leave it out", title(path), why));
}

const Node& Reader::keep(Node tree) {
  trees_.push_back(std::move(tree));
  places_.try_emplace("", Place{&trees_.back(), nullptr, {}});
  return trees_.back();
}

const Reader::Place* Reader::nearest_place(std::string path) const {
  for (;; path = around(path)) {
    if (const auto found = places_.find(path); found != places_.end()) return &found->second;
    if (path.empty()) return nullptr;
  }
}

Mark Reader::mark(const std::string& path) const {
  const Place* place = nearest_place(path);
  return place != nullptr ? place->node->mark : Mark{};
}

Mark Reader::key_mark(const std::string& path) const {
  const auto found = places_.find(path);
  return found != places_.end() && found->second.key != nullptr ? *found->second.key : mark(path);
}

std::string Reader::written(const std::string& path) const {
  const auto found = places_.find(path);
  return found != places_.end() ? found->second.node->text : "";
}

std::string Reader::title(const std::string& path) const {
  if (path.empty()) return "the file";
  const auto found = places_.find(path);
  if (found != places_.end() && found->second.position) {
    return fmt::format("entry {} of {}", *found->second.position + 1, title(around(path)));
  }
  return fmt::format("`{}`", std::string_view(path).substr(path.rfind('.') + 1));
}

std::optional<Mark> Reader::origin(const std::string& path) const {
  for (std::string at = path;; at = around(at)) {
    if (const auto found = sources_.find(at); found != sources_.end()) {
      const auto* other = std::get_if<std::string>(&found->second);
      return other != nullptr ? origin(*other + path.substr(at.size())) : std::get<Mark>(found->second);
    }
    if (const auto found = places_.find(at); found != places_.end()) {
      const bool is_value = found->second.node->kind == NodeKind::scalar;
      return is_value ? std::optional<Mark>(found->second.node->mark) : std::nullopt;
    }
    if (at.empty()) return std::nullopt;
  }
}

void Reader::define(const std::string& kind, const std::string& name, const Mark& mark) {
  Names& names = names_[kind];
  const auto [first, is_new] = names.first.emplace(name, mark);
  if (is_new) return names.known.push_back(name);
  fail(mark, fmt::format("a second {0} `{1}`: every {0} needs a name of its own", kind, name));
}

void Reader::refer(const std::string& kind, const std::string& name, const Mark& mark) {
  uses_.push_back({kind, name, mark});
}

bool Reader::knows(const std::string& kind) const {
  const auto found = names_.find(kind);
  return found == names_.end() || found->second.is_complete;
}

const std::vector<std::string>& Reader::names(const std::string& kind) const {
  static const std::vector<std::string> none;
  const auto found = names_.find(kind);
  return found != names_.end() ? found->second.known : none;
}

std::string Reader::no_such(const std::string& kind, const std::string& name) const {
  return fmt::format("there is no {0} `{1}`{2}; {0}s: {3}", kind, name, suggestion(name, names(kind)),
                     joined(names(kind)));
}

void Reader::expect_every(const std::string& kind, const std::string& all, const Source& table) {
  const std::vector<Entry>& entries = table.node.entries;
  const auto is_another = [&](const Entry& entry) { // a stranger is told, and perhaps one of them was meant
    return entry.key == all || !is_among(entry.key, names(kind));
  };
  if (!knows(kind) || std::any_of(entries.begin(), entries.end(), is_another)) return;
  for (const std::string& name : names(kind)) {
    if (find(table.node, name) != nullptr) continue;
    fail(table.node.mark,
         fmt::format("{} says nothing about the {} `{}`; name it, or use `{}`", title(table.path), kind, name, all));
  }
}

void Reader::check_references() {
  for (const auto& [kind, name, mark] : uses_) {
    const auto found = names_.find(kind);
    if (found != names_.end() && (found->second.first.contains(name) || !found->second.is_complete)) continue;
    fail(mark, no_such(kind, name));
  }
  uses_.clear();
}

std::nullopt_t Reader::not_yet(const Mark& mark, const std::string& what, const std::string& instead) {
  fail(mark, fmt::format("{} is not available yet; {}", what, instead));
  return std::nullopt;
}

std::nullopt_t Reader::misfit(const Source& source, const std::string& wanted, const std::string& hint) {
  fail(source.node.mark,
       fmt::format("{} must be {}, not {}{}", title(source.path), wanted, written_as(source.node), hint));
  return std::nullopt;
}

bool Reader::fits(const Source& source) {
  if (source.node.kind == kind_of(source.option)) return true;
  misfit(source, expected(source.option));
  return false;
}

bool Reader::name(const std::string& name, const Mark& mark) {
  const bool fine = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return (std::isalnum(c) != 0 && c < 128) || c == '_' || c == '-';
  });
  if (!fine) fail(mark, fmt::format("`{}` is no name: letters, digits, _ and - are allowed", name));
  const bool is_long = fine && name.size() > longest_name;
  if (is_long) {
    fail(mark, fmt::format("the name `{}...` has {} letters; at most {} are allowed", name.substr(0, 20), name.size(),
                           longest_name));
  }
  return fine && !is_long;
}

std::optional<std::string> Reader::text(const Source& source) {
  const Node& node = source.node;
  if (!fits(source) || (source.option.type == Type::name && !name(node.text, node.mark))) return std::nullopt;
  return node.text;
}

std::optional<bool> Reader::flag(const Source& source) {
  if (!fits(source)) return std::nullopt;
  for (const char* word : {"on", "true", "yes"}) {
    if (source.node.text == word) return true;
  }
  for (const char* word : {"off", "false", "no"}) {
    if (source.node.text == word) return false;
  }
  return misfit(source, expected(source.option));
}

std::optional<double> Reader::number(const Source& source) {
  const auto& [reader, option, node, path, variant] = source;
  if (!fits(source)) return std::nullopt;
  double value = 0;
  if (option.type == Type::quantity) {
    const Quantity read = parse_quantity(node.text, option.unit, option.example);
    if (!read.error.empty()) return fail(node.mark, fmt::format("{}: {}", title(path), read.error)), std::nullopt;
    value = read.value;
  } else {
    const std::optional<double> plain = parse_number(node.text);
    int whole = 0;
    const char* end = node.text.data() + node.text.size();
    const bool is_whole = std::from_chars(node.text.data(), end, whole).ptr == end;
    if (!plain || (option.type == Type::integer && !is_whole)) return misfit(source, expected(option));
    value = *plain;
  }
  if (option.limits && !option.limits->holds(value)) {
    fail(node.mark, fmt::format("{} must be {}, not {}", title(path), option.limits->words, node.text));
    return std::nullopt;
  }
  if (option.usually && !option.usually->holds(value)) {
    const std::string taken = option.type == Type::quantity ? shown(value, option.unit) : node.text;
    warn(path, fmt::format("{} {} is unusual ({}){}; is it meant?", title(path), node.text, option.usually->words,
                           taken == node.text ? "" : ", taken as " + taken));
  }
  return value;
}

std::optional<std::size_t> Reader::choice(const Source& source) {
  if (!fits(source)) return std::nullopt;
  const std::vector<Option>& words = source.option.members();
  const std::string& word = source.node.text;
  const auto found = std::find_if(words.begin(), words.end(), [&](const Option& one) { return one.name == word; });
  if (found == words.end()) {
    return misfit(source, "one of: " + joined(available_names(words)), suggestion(word, names_of(words)));
  }
  if (found->not_yet.empty()) return static_cast<std::size_t>(found - words.begin());
  return not_yet(source.node.mark, fmt::format("{}: `{}`", title(source.path), word), found->not_yet);
}

bool Reader::items(const Source& list) {
  const auto& [reader, option, node, path, variant] = list;
  if (!fits(list)) return false;
  const std::size_t count = node.items.size();
  for (std::size_t i = 0; i < count; ++i) note(below(path, std::to_string(i)), node.items[i], nullptr, i);
  if (count >= option.min_items && count <= option.max_items) return true;
  const bool few = count < option.min_items;
  const char* bound = option.min_items == option.max_items ? "" : few ? "at least " : "at most ";
  fail(node.mark, fmt::format("{} must have {}{} entries, not {}", title(path), bound,
                              few ? option.min_items : option.max_items, count));
  return false;
}

bool Reader::entries(const Source& table) {
  const auto& [reader, option, node, path, variant] = table;
  if (!fits(table)) return false;
  bool complete = node.entries.size() >= option.min_items;
  if (!complete) fail(node.mark, fmt::format("{} is empty; it needs {}", title(path), expected(option)));
  for (const Entry& entry : node.entries) {
    note(below(path, entry.key), entry.value, &entry.mark);
    complete = name(entry.key, entry.mark) && complete;
  }
  return complete;
}

// Of two kinds of scalars a choice comes first: what begins like a number is left to the other.
std::optional<std::size_t> Reader::either(const Source& source) {
  const std::vector<Option>& kinds = source.option.members();
  const Node& node = source.node;
  const bool is_number = node.text.find_first_of("+-.0123456789") == 0;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kind_of(kinds[i]) != node.kind || (!words.empty() && !is_number)) continue;
    if (!kinds[i].not_yet.empty()) {
      return not_yet(node.mark, fmt::format("{} as {}", title(source.path), written_as(node)), kinds[i].not_yet);
    }
    if (kinds[i].type == Type::choice) words = names_of(kinds[i].members());
    if (kinds[i].type != Type::choice || is_among(node.text, words)) return i;
  }
  return misfit(source, expected(source.option), suggestion(node.text, words));
}

// The key `tag` is a choice of the groups' names.
std::optional<std::size_t> Reader::alternative(const Source& variant) {
  const auto& [reader, option, node, path, outer] = variant;
  if (!fits(variant)) return std::nullopt;
  const std::vector<Option>& groups = option.members();
  const Node by_default = scalar(option.default_value);
  const Node* tag = find(node, option.tag);
  if (tag == nullptr && option.default_value.empty()) {
    fail(node.mark,
         fmt::format("{} lacks the key `{}`: one of {}", title(path), option.tag, joined(available_names(groups))));
    return std::nullopt;
  }
  Option words = option;
  words.type = Type::choice;
  std::optional<std::size_t> found =
      choice({*this, words, tag != nullptr ? *tag : by_default, below(path, option.tag)});
  for (std::size_t i = found.value_or(groups.size()); i < groups.size(); ++i) {
    if (groups[i].name == groups[*found].name && find(node, groups[i].told_by) != nullptr) found = i;
  }
  return found;
}

std::string Reader::unknown_key(const Source& group, const Entry& entry) {
  const Option* variant = group.variant;
  std::vector<std::string> known = available_names(group.option.members());
  if (variant != nullptr) known.insert(known.begin(), variant->tag);
  std::string message = fmt::format("unknown key `{}` in {}{}; known: {}", entry.key, title(group.path),
                                    suggestion(entry.key, known), joined(known));
  for (const Option& other : variant != nullptr ? variant->members() : std::vector<Option>{}) {
    if (!is_among(entry.key, names_of(other.members()))) continue;
    message += fmt::format("; it belongs to `{}: {}`{}", variant->tag, other.name,
                           other.told_by.empty() ? "" : fmt::format(" with `{}`", other.told_by));
    break;
  }
  fail(entry.mark, message);
  return nearest(entry.key, known);
}

bool Reader::has_all(const Source& group, const std::set<std::string>& meant) {
  const auto& [reader, option, node, path, variant] = group;
  const auto is_present = [&](const std::string& key) { return find(group.node, key) || meant.contains(key); };
  bool complete = true;
  for (const Option& member : option.members()) {
    if (!member.is_required || is_present(member.name)) continue;
    fail(node.mark,
         fmt::format("{} lacks the key `{}`: {} ({})", title(path), member.name, member.text, expected(member)));
    complete = false;
  }
  for (const KeySet& set : option.alternatives) {
    const auto present = static_cast<std::size_t>(std::count_if(set.keys.begin(), set.keys.end(), is_present));
    if ((present >= set.least && present <= set.most) || (!set.beside.empty() && !is_present(set.beside))) continue;
    fail(node.mark, fmt::format("{} needs {}{}", title(path), wanted(set),
                                !set.why.empty() ? ": " + set.why
                                : present == 0   ? "; it has none"
                                                 : fmt::format("; it has {}", present)));
    complete = false;
  }
  return complete;
}

bool Reader::keys(const Source& group) {
  const auto& [reader, option, node, path, variant] = group;
  if (!fits(group)) return false;
  bool complete = true, has_unavailable = false;
  std::set<std::string> meant; // keys that stand there misspelt
  for (const Entry& entry : node.entries) {
    note(below(path, entry.key), entry.value, &entry.mark);
    if (variant != nullptr && entry.key == variant->tag) continue;
    const auto member = std::find_if(option.members().begin(), option.members().end(),
                                     [&](const Option& o) { return o.name == entry.key; });
    if (member == option.members().end()) {
      meant.insert(unknown_key(group, entry));
      complete = false;
    } else if (!member->not_yet.empty()) {
      not_yet(entry.mark, fmt::format("`{}`", entry.key), member->not_yet);
      complete = false;
      has_unavailable = true;
    }
  }
  // a group that asks for something unavailable is not also told what else it lacks
  return (has_unavailable || has_all(group, meant)) && complete;
}

} // namespace pneuma::pipeline::schema
