// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pneuma::pipeline::yaml {

// Where something stands in a user's file (1-based), to be quoted in messages.
struct Mark {
  std::string file;
  int line = 0;
  int column = 0;
};
std::string to_string(const Mark& mark); // "cushion.yaml:14:22"

// One thing wrong in a user's file. error: exit code 2; otherwise a warning.
struct Problem {
  Mark mark;
  std::string message; // what is wrong, what is allowed, the nearest known key
  bool error = true;
};
std::string to_string(const Problem& problem); // "cushion.yaml:14:22: thickness ..."

// YAML as plain data: what is written, not yet what it means.
enum class NodeKind : std::uint8_t { null, scalar, list, map };

struct Entry;

struct Node {
  NodeKind kind = NodeKind::null;
  Mark mark;
  std::string text;           // scalar
  std::vector<Node> items;    // list
  std::vector<Entry> entries; // map, in the order of the file
};

struct Entry {
  std::string key;
  Mark mark; // of the key
  Node value;
};

Node scalar(std::string text);
void add(Node& map, std::string key, Node value);
const Node* find(const Node& map, const std::string& key); // nullptr: no such key

// Parses YAML; `name` stands for the file in the marks. Syntax errors, duplicate keys, tags, more than one document,
// more than 1e6 keys and values or 100 levels (aliases written out) are added to `problems`; the result is what could
// be read. `<<: *name` and `<<: [*name, *other]` take over the entries of other maps which the map has not itself, the
// first of a list first; they stand behind its own and keep the marks of where they were written.
Node parse_yaml(const std::string& text, const std::string& name, std::vector<Problem>& problems);

// Takes away the entries of a file that begin with `x-`: they only hold what `*name` and `<<` refer to.
void drop_templates(Node& root);

// The text of a file; one that cannot be read, is no regular file or has more than 10 MB is a problem at `where`.
std::string read_text(const std::filesystem::path& file, const Mark& where, std::vector<Problem>& problems);

// YAML text of a tree: a line per scalar, short lists and maps of scalars in one line. The same tree gives the same
// bytes; parse_yaml gives the same tree back.
std::string write_yaml(const Node& node);

// Every scalar with its path of keys and list positions, "cushion.foils.0.thickness", in the order of the file.
std::vector<std::pair<std::string, const Node*>> leaves(const Node& node);

// A value that differs between two trees; none: it is not there.
struct Difference {
  std::string path;
  std::optional<std::string> before, after;
};
std::string to_string(const Difference& difference); // "mesh.size 0.15 m -> 0.1 m", "mesh.size 0.1 m is new"

// Those of `after` in its order, then what is gone.
std::vector<Difference> differences(const Node& before, const Node& after);

// Replaces the mark of each scalar (and of the map around it) whose path is in `marks`.
void replace_marks(Node& node, const std::map<std::string, Mark>& marks);

} // namespace pneuma::pipeline::yaml
