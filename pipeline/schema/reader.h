// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pipeline/schema/option.h"

namespace pneuma::pipeline::schema {

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
  void fail_value(const Mark& mark, const std::string& path, const std::string& fault); // "must ..." of its title
  void refuse(const std::string& path, const std::string& why); // a key: "`creep` <why>; leave it out"
  void warn(const std::string& path, std::string message) {
    problems.push_back({mark(path), std::move(message), false});
  }

  // A group, or a value in one, in which a problem was reported.
  void spoil(const std::string& path) { spoiled_.insert(path); }
  bool is_whole(const std::string& path) const { return !spoiled_.contains(path); }

  // Where the values of a path came from, if not from what is written there: from another path, or a place elsewhere.
  void came_from(const std::string& path, std::string other) { sources_[path] = std::move(other); }
  void came_from(const std::string& path, Mark mark) { marks_[path] = std::move(mark); }
  std::optional<Mark> origin(const std::string& path) const; // none: a default

  // Names of a kind ("foil") that a file defines, in its order, and where it uses them.
  void define(const std::string& kind, const std::string& name, const Mark& mark);
  void refer(const std::string& kind, const std::string& name, const Mark& mark);
  void cannot_know(const std::string& kind) { names_[kind].is_complete = false; }
  bool knows(const std::string& kind) const; // every one is readable
  const std::vector<std::string>& names(const std::string& kind) const;
  std::string no_such(const std::string& kind, const std::string& name) const; // "there is no foil `uper`; did ..."
  void check_references(); // reports those to names that are not defined

  // One level of a tree; false or none: a problem was reported.
  bool fits(const Option& option, const Node& node, const std::string& path); // list, map or scalar as it must be
  std::optional<double> number(const Option& option, const Node& node, const std::string& path);
  std::optional<bool> flag(const Option& option, const Node& node, const std::string& path);
  std::optional<std::size_t> choice(const Option& option, const Node& node, const std::string& path);
  std::optional<std::string> text(const Option& option, const Node& node, const std::string& path); // or name
  bool name(const std::string& name, const Mark& mark);
  bool items(const Option& list, const Node& node, const std::string& path); // their number; notes their places
  bool entries(const Option& table, const Node& node, const std::string& path);
  bool keys(const Option& group, const Node& node, const std::string& path, const Option* variant);
  std::optional<std::size_t> either(const Option& option, const Node& node, const std::string& path);
  // Which of a variant's groups; its tag is noted.
  std::optional<std::size_t> alternative(const Option& option, const Node& node, const std::string& path);

  // While a default is read no place is noted.
  class Default {
  public:
    explicit Default(Reader& reader) : reader_(reader), before_(std::exchange(reader.reads_default_, true)) {}
    ~Default() { reader_.reads_default_ = before_; }
    Default(const Default&) = delete;
    Default& operator=(const Default&) = delete;

  private:
    Reader& reader_;
    bool before_;
  };

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

  void note(const std::string& path, const Node& node, const Mark* key, std::optional<std::size_t> position = {});
  const Place* nearest_place(std::string path) const;
  bool not_yet(const Mark& mark, const std::string& what, const std::string& instead);
  // Returns the key that was meant; empty: none is near.
  std::string unknown_key(const Option& group, const Entry& entry, const std::string& path, const Option* variant);
  // `meant`: keys that stand there misspelt, which is told.
  bool has_all(const Option& group, const Node& node, const std::string& path, const std::set<std::string>& meant);

  bool is_stage_file_, reads_default_ = false;
  std::deque<Node> trees_;
  std::unordered_map<std::string, Place> places_;
  std::set<std::string> spoiled_;
  std::map<std::string, std::string> sources_;
  std::map<std::string, Mark> marks_;
  std::map<std::string, Names> names_;
  std::vector<Use> uses_;
};

std::string quoted(const std::string& key); // "`thickness`"

inline std::string below(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

} // namespace pneuma::pipeline::schema
