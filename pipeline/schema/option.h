// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::schema {

using yaml::add;
using yaml::Entry;
using yaml::find;
using yaml::Mark;
using yaml::Node;
using yaml::NodeKind;
using yaml::Problem;
using yaml::scalar;

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

  bool holds(double value) const {
    return (includes_min ? value >= min : value > min) && (includes_max ? value <= max : value < max);
  }
};

// How many keys of a set stand in a group.
struct KeySet {
  std::vector<std::string> keys;
  std::size_t least = 1, most = 1;
  std::string beside = {}, why = {}; // not empty: only where this key is given, and why
};

// What a user may write at one place: plain data, from which reading, messages, the reference and the JSON schema come.
// Declared through `Form` and `Keys` (form.h, keys.h), which bind it to the member that it fills.
struct Option {
  std::string name;
  Type type = Type::text;
  std::string text;                                 // what it means, half a sentence
  std::string unit;                                 // of a quantity, SI
  std::string example;                              // of a quantity; empty: as usual for the dimension
  std::shared_ptr<const std::vector<Option>> parts; // see members()
  std::string tag;                                  // of a variant
  std::string told_by; // of a group: the key by which it is told from others of its name in a variant

  bool is_required = false;
  std::string default_value;                // as YAML; empty: none
  std::shared_ptr<const Node> default_node; // the same, read
  std::string not_yet;                      // known but not available: what is available instead
  std::optional<Range> limits;              // outside is an error
  std::optional<Range> usually;             // outside is a warning
  std::size_t min_items = 0;
  std::size_t max_items = std::numeric_limits<std::size_t>::max();
  std::vector<KeySet> alternatives; // of a group
  std::string defines;              // kind of thing ("foil") that gets its name here
  std::string stands_for;           // of a short form: the key, or a path from it, that is written

  // Words of a choice, item of a list or table, kinds, keys of a group, groups of a variant. Shared by copies.
  const std::vector<Option>& members() const;
};

Option option_of(Type type, std::vector<Option> members = {});
Option not_available(const std::string& name, const std::string& instead); // which the format knows: a map
void set_default(Option& option, const std::string& yaml);

NodeKind kind_of(const Option& option); // what it is written as; of `either` what a scalar is

// What may stand for an option, for messages: "a length with its unit".
std::string expected(const Option& option);

std::string wanted(const KeySet& set); // "exactly one of: a, b"

// Names of those that are available, or of all.
std::vector<std::string> available_names(const std::vector<Option>& options);
std::vector<std::string> names_of(const std::vector<Option>& options);

// The reference of all keys as plain text.
std::string reference(const Option& root);

} // namespace pneuma::pipeline::schema
