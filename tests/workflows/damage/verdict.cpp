// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/workflows/damage/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "tests/workflows/damage/yaml_text.h"

namespace pneuma::tests::damage {

namespace {

constexpr std::size_t few = 4; // messages about one fault, those where the lost name is called not counted

// Whether a word stands in a text by itself: `at` is not in `that`.
bool holds(const std::string& text, const std::string& word) {
  if (word.empty()) return false;
  const auto joins = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if (at > 0 && joins(text[at - 1]) && joins(word.front())) continue;
    if (end < text.size() && joins(text[end]) && joins(word.back())) continue;
    return true;
  }
  return false;
}

bool holds_one(const std::string& text, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return holds(text, word); });
}

struct Message {
  std::string file, text;
  int line = 0;
  bool error = true;
};

void add_leaves(const Piece& piece, const std::string& path, std::map<std::string, std::string>& values) {
  for (std::size_t i = 0; i < piece.values.size(); ++i) {
    const bool is_list = piece.kind == Piece::Kind::list;
    const std::string name = is_list ? std::to_string(i) : piece.keys[i].text;
    if (path.empty() && name == "origin") continue;
    add_leaves(piece.values[i], path.empty() ? name : path + "." + name, values);
  }
  const bool is_empty = piece.kind == Piece::Kind::list || piece.kind == Piece::Kind::map;
  if (is_empty && piece.values.empty()) values[path] = piece.kind == Piece::Kind::list ? "[]" : "{}";
  if (!is_empty) values[path] = piece.text;
}

using Values = std::map<std::string, std::string>;

bool is_at(const std::string& path, const std::string& prefix) {
  return path == prefix || (path.starts_with(prefix) && (prefix.empty() || path[prefix.size()] == '.'));
}

// What a value of the user's file turns into, where it is not itself, as patterns: {1} the stage.
struct Becomes {
  std::regex from;
  const char* to;
};

const std::vector<Becomes>& becomes() {
  static const std::vector<Becomes> all = {
      // a stress times the thickness; `all` of the foils
      {std::regex(R"((stages\.[^.]+)\.(stress|prestress)(\..*)?)"), R"($1\.prestress(\..*)?)"},
      {std::regex(R"(cushion\.foils(\.[0-9]+(\.thickness)?)?)"), R"(stages\.[^.]+\.prestress(\..*)?)"},
      // a pressure and a gas for each air
      {std::regex(R"(cushion\.chambers(\.[0-9]+(\.(connected_to|name))?)?)"),
       R"(stages\.[^.]+\.(gas|gauge_pressure)(\..*)?)"},
      {std::regex(R"((stages\.[^.]+)\.(gas|gauge_pressure)\..*)"), R"($1\.$2(\..*)?)"}, // chambers that share it
      {std::regex(R"((stages\.[^.]+)\.from)"), R"($1\.from_run)"},
      // what chooses it, where it is searched
      {std::regex(R"((stages\.[^.]+)\.direction)"), R"($1\.chosen_by)"},
      // what goes with it
      {std::regex(R"((stages\.[^.]+)\.compensation(\..*)?)"), R"($1\.(creep|decompensation))"},
      // a factor for each load
      {std::regex(R"((stages\.[^.]+)\.loads(\.[0-9]+(\.name)?)?)"), R"($1\.factors(\..*)?)"},
      // the names of the edges
      {std::regex(R"(cushion\.plan(\..*)?)"), R"(cushion\.edges(\..*)?)"},
      // a word for all of a map, and the place that is given where no other is
      {std::regex(R"((stages\.[^.]+)\.control(\..*)?)"), R"($1\.control(\..*)?)"},
  };
  return all;
}

bool may_change(const Damage& damage, const std::string& effective, const std::string& path) {
  if (is_at(effective, path)) return true;
  for (const Becomes& rule : becomes()) {
    std::smatch match;
    if (!std::regex_match(path, match, rule.from)) continue;
    if (std::regex_match(effective, std::regex(match.format(rule.to)))) return true;
  }
  // what stands behind an anchor is what its aliases say, too: materials.NAME.strength
  const auto below_name = [](const std::string& whole) {
    const auto dot = whole.find('.', std::string("materials.").size());
    return dot == std::string::npos ? whole : whole.substr(dot);
  };
  return damage.shared && effective.starts_with("materials.") && is_at(below_name(effective), below_name(path));
}

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

// Whether `after` is `before` with its number replaced as the user's was; a temperature has an origin of its own.
bool follows(const Number& user_before, const Number& user_after, const Number& before, const Number& after) {
  if (!before.is_number || !after.is_number || before.unit != after.unit) return false;
  if (user_before.unit == "degC") return near(after.value - before.value, user_after.value - user_before.value);
  return near(after.value * user_before.value, before.value * user_after.value);
}

Values below(const Values& values, const std::string& path) {
  Values found;
  for (const auto& [key, value] : values) {
    if (is_at(key, path)) found[key.substr(std::min(path.size(), key.size()))] = value;
  }
  return found;
}

std::string unquoted(const std::string& text) {
  return text.size() > 1 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2) : text;
}

} // namespace

void add_values(const std::string& text, Values& values) {
  add_leaves(pieces_of(text), "", values);
}

std::string wrong_refusal(const Damage& damage, const std::string& messages, const Names& names) {
  static const std::regex pattern(R"((.*?):([0-9]+):([0-9]+): (warning: )?(.*))");
  std::vector<Message> found;
  std::set<std::string> places;
  std::istringstream lines(messages);
  std::size_t errors = 0;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, pattern)) return "a message without a place";
    if (match[4].matched) continue;
    ++errors;
    if (line.find("``") != std::string::npos) return "a message about ``";
    const bool again = !places.insert(fmt::format("{}:{}:{}", match[1].str(), match[2].str(), match[3].str())).second;
    // a map in place of a value lacks every key of its own
    if (again && damage.kind != Kind::value_as_map) return "two messages at one place";
    found.push_back({match[1], match[5], std::stoi(match[2]), true});
  }
  if (errors == 0) return "no message";
  std::vector<std::string> words = damage.words;
  words.insert(words.end(), damage.names.begin(), damage.names.end());
  bool at_place = false;
  bool elsewhere = false; // where it is called
  bool named = false;
  std::size_t calling = 0;
  for (const Message& message : found) {
    if (message.file == names.damaged && message.line >= damage.at.first && message.line <= damage.at.last) {
      at_place = true;
      named = named || holds_one(message.text, damage.words);
    }
    bool calls = message.file == names.damaged &&
                 std::find(damage.references.begin(), damage.references.end(), message.line) != damage.references.end();
    if (message.file == names.user) {
      std::istringstream text(names.user_text);
      std::string line;
      for (int i = 0; i < message.line; ++i) std::getline(text, line);
      calls = holds_one(line, damage.names);
    }
    elsewhere = elsewhere || calls;
    calling += calls ? 1 : 0;
    named = named || (calls && holds_one(message.text, words));
  }
  // without `gravity: off` the weight asks for a density where the foil names its material
  const bool needs_weight = damage.path == "site.gravity" || damage.path == "site";
  for (const Message& message : found) {
    if (needs_weight && message.text.find("which gravity needs") != std::string::npos) return "";
  }
  if (!at_place && !elsewhere) return "the message points elsewhere";
  if (!named) return "the message names neither key nor value";
  if (errors - calling > few) return fmt::format("more than {} messages", few);
  return {};
}

std::string wrong_acceptance(const Damage& damage, const Settings& before, const Settings& after, bool in_materials) {
  const std::string path = in_materials ? "materials." + damage.path : damage.path;
  std::vector<std::string> changed;
  for (const auto& [key, value] : before.values) {
    const auto now = after.values.find(key);
    if (now == after.values.end() || now->second != value) changed.push_back(key);
  }
  for (const auto& [key, value] : after.values) {
    if (!before.values.contains(key)) changed.push_back(key);
  }

  std::string renamed = path; // a key that is a free name
  if (damage.kind == Kind::key_misspelt) renamed = path.substr(0, path.size() - damage.before.size()) + damage.after;
  for (const std::string& key : changed) {
    if (may_change(damage, key, path) || may_change(damage, key, renamed)) continue;
    return "something else changed: " + key;
  }

  const auto text_at = [&](const Settings& settings) {
    const auto found = settings.values.find(path);
    return found == settings.values.end() ? std::string() : found->second;
  };
  const Number user_before = number_in(damage.before), user_after = number_in(damage.after);
  switch (damage.kind) {
  case Kind::key_doubled:
  case Kind::unit_dropped:
  case Kind::unit_doubled:
  case Kind::unit_foreign:
  case Kind::value_empty:
    return "accepted";
  case Kind::number_behind:
  case Kind::value_nan:
  case Kind::value_inf:
  case Kind::value_huge:
  case Kind::name_unknown: // texts
    return text_at(after) == damage.after ? "" : "accepted, and not as a text";
  case Kind::key_dropped: // what it is now: wrong_default
    return "";
  case Kind::key_misspelt:
    if (below(before.values, path) == below(after.values, renamed) && below(after.values, path).empty()) return "";
    return changed.empty() ? "accepted, and the key is not heard of" : "accepted, and its values are others";
  case Kind::list_shortened:
  case Kind::list_lengthened: {
    const Values was = below(before.values, path), is = below(after.values, path);
    const bool shorter = damage.kind == Kind::list_shortened;
    const Values &few_values = shorter ? is : was, &more = shorter ? was : is;
    const bool kept = std::all_of(few_values.begin(), few_values.end(), [&](const auto& entry) {
      const auto found = more.find(entry.first);
      return found != more.end() && found->second == entry.second;
    });
    return more.size() > few_values.size() && kept ? "" : "accepted, and not one entry less or more";
  }
  case Kind::list_emptied: {
    const Values is = below(after.values, path);
    const bool empty = is.empty() || (is.size() == 1 && is.begin()->second == "[]");
    return empty ? "" : "accepted, and there are entries";
  }
  case Kind::value_as_list: // one for a list of one
    return changed.empty() ? "" : "accepted, and the settings changed";
  case Kind::value_as_map:
    return "accepted";
  case Kind::value_as_word:
  case Kind::value_as_number: {
    const Values is = below(after.values, path);
    const bool taken = !is.empty() && std::all_of(is.begin(), is.end(), [&](const auto& entry) {
      return unquoted(entry.second) == damage.after;
    });
    return taken ? "" : "accepted, and not as it is written";
  }
  case Kind::value_negative:
  case Kind::value_zero:
    if (changed.empty()) return "accepted, and nothing changed";
    for (const std::string& key : changed) {
      const auto was = before.values.find(key), is = after.values.find(key);
      if (was == before.values.end() || is == after.values.end()) return "other keys came or went: " + key;
      if (!follows(user_before, user_after, number_in(was->second), number_in(is->second))) {
        return fmt::format("{} became {} in {}", was->second, is->second, key);
      }
    }
    return "";
  }
  return "";
}

std::string wrong_default(const Damage& damage, const Settings& dropped, const Settings* with_default,
                          bool in_materials) {
  const std::string path = in_materials ? "materials." + damage.path : damage.path;
  if (with_default == nullptr) {
    // each chamber has its own default gas, each edge is clamped: tables say so in words
    static const std::regex filled(R"(stages\.[^.]+\.gas\.[^.]+(\.law)?|cushion\.edges\.[^.]+)");
    if (std::regex_match(path, filled) || below(dropped.values, path).empty()) return {};
    return fmt::format("dropped, and {} is left, where the schema has no default",
                       below(dropped.values, path).begin()->second);
  }
  for (const auto& [key, value] : with_default->values) {
    const auto now = dropped.values.find(key);
    if (now != dropped.values.end() && now->second == value) continue;
    return fmt::format("dropped, {} is {}, by the schema's default {}", key,
                       now == dropped.values.end() ? "absent" : now->second, value);
  }
  return with_default->values.size() == dropped.values.size() ? "" : "dropped, and there is more than by default";
}

} // namespace pneuma::tests::damage
