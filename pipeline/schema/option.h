// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/schema/node.h"

namespace pneuma::pipeline::schema {

enum class Type : std::uint8_t {
  text,
  name, // [A-Za-z0-9_-]+
  flag, // on, off
  integer,
  number,
  quantity, // number and unit
  choice,   // one of the members' names
  list,     // of the one member
  group,    // a map with the members as keys
  table,    // a map from free names to the one member
  either,   // the member that fits what is written: a scalar (a choice's word before a number), a list or a map
  variant,  // a group chosen among the members by the value of its key `tag`
};

struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string words;        // as a user would write it: "positive", "from -1 to 0.5"
  bool includes_min = true; // in SI
  bool includes_max = true;
};

// How many keys of a set stand in a group.
struct KeySet {
  std::vector<std::string> keys;
  std::size_t least = 1, most = 1;
};

// One option, declared once: parsing, checks, defaults, documentation and the JSON schema come from it.
struct Option {
  std::string name;
  Type type = Type::text;
  std::string text; // what it means, half a sentence
  std::string unit; // of a quantity, SI
  std::vector<Option> members;
  std::string tag; // of a variant

  bool is_required = false;
  std::string default_value;    // as YAML; empty: none
  std::string not_yet;          // known but not available: what is available instead
  std::optional<Range> limits;  // outside is an error
  std::optional<Range> usually; // outside is a warning
  std::size_t min_items = 0;
  std::size_t max_items = std::numeric_limits<std::size_t>::max();
  std::vector<KeySet> alternatives; // of a group

  // The table reads as sentences: quantity("thickness", "m", "...").required().positive()
  Option required() const;
  Option otherwise(std::string yaml) const; // the default
  Option unavailable(std::string instead) const;
  Option positive() const;
  Option at_least(double min, std::string words) const;
  Option between(double min, double max, std::string words) const;
  Option within(Range range) const;
  Option usual(double min, double max, std::string words) const;
  Option items(std::size_t least, std::size_t most) const;
  Option exactly_one(std::vector<std::string> keys) const;
  Option at_least_one(std::vector<std::string> keys) const;
  Option not_both(std::string first, std::string second) const;
};

Option text(std::string name, std::string what);
Option word(std::string name, std::string what);
Option flag(std::string name, std::string what);
Option integer(std::string name, std::string what);
Option number(std::string name, std::string what);
Option quantity(std::string name, std::string unit, std::string what);
Option choice(std::string name, std::vector<Option> values, std::string what);
Option value(std::string name, std::string what); // a value of a choice
Option list(std::string name, Option item, std::string what);
Option group(std::string name, std::vector<Option> keys, std::string what);
Option table(std::string name, Option value, std::string what);
Option either(std::string name, std::vector<Option> kinds, std::string what);
Option variant(std::string name, std::string tag, std::vector<Option> groups, std::string what);

struct Member;

// What was read for an option: checked, in SI, defaults filled in.
struct Value {
  Mark mark; // of a default: of the group it belongs to
  Mark key;
  bool given = false; // by the user, not a default
  bool valid = false; // a problem was reported otherwise
  bool flag = false;
  double number = 0;               // integer, number, quantity
  std::string text;                // text, name, choice; tag of a variant; otherwise what was written
  const Option* read_as = nullptr; // which of the kinds or groups it is
  std::vector<Value> items;
  std::vector<Member> members;

  const Value* find(const std::string& name) const;       // present, valid or not
  const Value* operator[](const std::string& name) const; // present and valid, otherwise nullptr
};

struct Member {
  std::string name;
  Value value;
};

// What a key of a group holds; `otherwise`, nothing or an empty text if it is absent or wrong.
double number_of(const Value& group, const std::string& key, double otherwise = 0);
std::optional<double> optional_number(const Value& group, const std::string& key);
std::optional<int> optional_integer(const Value& group, const std::string& key);
std::string text_of(const Value& group, const std::string& key);

// Checks a tree against an option and converts it. Every problem is added to `problems`. The places of values
// that the user gave go to `origins` by path.
struct Check {
  std::vector<Problem>& problems;
  std::map<std::string, Mark>& origins;
};
Value check(const Option& option, const Node& node, const std::string& path, Check& context);

// The reference of all keys as plain text.
std::string reference(const Option& root);

} // namespace pneuma::pipeline::schema
