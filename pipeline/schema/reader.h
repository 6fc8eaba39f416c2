// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "pipeline/schema/option.h"

namespace pneuma::pipeline::schema {

class Reader;

// What is read: a node at its path, as an option describes it.
struct Source {
  Reader& reader;
  const Option& option;
  const Node& node;
  const std::string& path;
  const Option* variant = nullptr; // of which the option is one of several groups
};

// Reads trees of YAML against options: reports every problem at its place, remembers where each value stands, and which
// names are defined and referred to. Values have paths of keys and list positions, "cushion.foils.0.thickness"; what a
// Form (form.h) makes of them it makes itself.
class Reader {
public:
  explicit Reader(bool is_stage_file = false) : is_stage_file_(is_stage_file) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::vector<Problem> problems;

  bool is_stage_file() const { return is_stage_file_; }
  const Node& keep(Node tree); // places point into it

  // The value at a path as a user wrote it; messages of a value that is absent or a default stand at the group around.
  bool given(const std::string& path) const { return places_.contains(path); }
  Mark mark(const std::string& path) const;
  Mark key_mark(const std::string& path) const;
  std::string written(const std::string& path) const; // text of a scalar
  std::string title(const std::string& path) const;   // "`thickness`", "entry 2 of `foils`"
  void fail(const Mark& mark, std::string message) { problems.push_back({mark, std::move(message), true}); }
  void fail(const std::string& path, std::string message) { fail(mark(path), std::move(message)); }
  void fail_key(const std::string& path, std::string message) { fail(key_mark(path), std::move(message)); }
  void fail_value(const Source& source, const std::string& fault); // "must ..." of its title
  void refuse(const std::string& path, const std::string& why);    // a key: "`creep` <why>; leave it out"
  void warn(const std::string& path, std::string message) {
    problems.push_back({mark(path), std::move(message), false});
  }

  // A group, or a value in one, in which a problem was reported.
  void spoil(const std::string& path) { spoiled_.insert(path); }
  bool is_whole(const std::string& path) const { return !spoiled_.contains(path); }

  // Where the values of a path came from, if not from what is written there: from another path, or a place elsewhere.
  void came_from(const std::string& path, std::variant<std::string, Mark> other) { sources_[path] = std::move(other); }
  std::optional<Mark> origin(const std::string& path) const; // none: a default

  // Names of a kind ("foil") that a file defines, in its order, and where it uses them.
  void define(const std::string& kind, const std::string& name, const Mark& mark);
  void refer(const std::string& kind, const std::string& name, const Mark& mark);
  void cannot_know(const std::string& kind) { names_[kind].is_complete = false; }
  bool knows(const std::string& kind) const; // every one is readable
  const std::vector<std::string>& names(const std::string& kind) const;
  std::string no_such(const std::string& kind, const std::string& name) const; // "there is no foil `uper`; did ..."
  // Reports those that a table with keys of a kind, or a word for all, says nothing about.
  void expect_every(const std::string& kind, const std::string& all, const Source& table);
  void check_references(); // reports those to names that are not defined

  // One level of a tree; false or none: a problem was reported.
  std::optional<double> number(const Source& source);
  std::optional<bool> flag(const Source& source);
  std::optional<std::size_t> choice(const Source& source);
  std::optional<std::string> text(const Source& source); // or name
  bool items(const Source& list);                        // their number; notes their places
  bool entries(const Source& table);
  bool keys(const Source& group);
  std::optional<std::size_t> either(const Source& source);
  std::optional<std::size_t> alternative(const Source& variant); // which of its groups

private:
  struct Place {
    const Node* node;
    const Mark* key;                     // nullptr: none
    std::optional<std::size_t> position; // in a list
  };
  struct Names {
    std::vector<std::string> known;
    std::map<std::string, Mark> first;
    bool is_complete = true;
  };
  struct Use {
    std::string kind, name;
    Mark mark;
  };

  void note(const std::string& path, const Node& node, const Mark* key, std::optional<std::size_t> position = {}) {
    places_.insert_or_assign(path, Place{&node, key, position});
  }
  const Place* nearest_place(std::string path) const;
  bool name(const std::string& name, const Mark& mark);
  bool fits(const Source& source); // list, map or scalar as it must be
  // Something else must stand there; `hint`: more of the message.
  std::nullopt_t misfit(const Source& source, const std::string& wanted, const std::string& hint = "");
  std::nullopt_t not_yet(const Mark& mark, const std::string& what, const std::string& instead);
  // Returns the key that was meant; empty: none is near.
  std::string unknown_key(const Source& group, const Entry& entry);
  // `meant`: keys that stand there misspelt, which is told.
  bool has_all(const Source& group, const std::set<std::string>& meant);

  bool is_stage_file_;
  std::deque<Node> trees_;
  std::unordered_map<std::string, Place> places_;
  std::set<std::string> spoiled_;
  std::map<std::string, std::variant<std::string, Mark>> sources_;
  std::map<std::string, Names> names_;
  std::vector<Use> uses_;
};

std::string quoted(const std::string& key); // "`thickness`"

inline std::string below(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

} // namespace pneuma::pipeline::schema
