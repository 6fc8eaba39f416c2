// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "pipeline/schema/node.h"

namespace pneuma::pipeline::schema {

namespace {

// No workflow comes near; aliases of aliases can ask for any number.
constexpr std::size_t node_limit = 100'000;

std::size_t count(const Node& node) {
  std::size_t sum = 1;
  for (const Node& item : node.items) sum += count(item);
  for (const Entry& entry : node.entries) sum += count(entry.value);
  return sum;
}

// Builds the tree from the parser's events: unlike YAML::Node they show every key, also the second of its name.
class Builder : public YAML::EventHandler {
public:
  Builder(std::string name, std::vector<Problem>& problems) : name_(std::move(name)), problems_(problems) {}

  Node root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(NodeKind::null, mark, "", anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool plain = tag == "?";
    const bool null = plain && (value == "~" || value == "null" || value.empty());
    leaf(null ? NodeKind::null : NodeKind::scalar, mark, value, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = anchors_.find(anchor);
    if (known == anchors_.end()) {
      problems_.push_back({place(mark), "this alias refers to itself; write the values out"});
      return close(Node{NodeKind::null, place(mark), "", {}, {}}, 0);
    }
    nodes_ += count(known->second);
    if (nodes_ > node_limit) {
      throw YAML::ParserException(mark, fmt::format("aliases blow the file up beyond {} values", node_limit));
    }
    close(known->second, 0);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({Node{NodeKind::list, place(mark), "", {}, {}}, anchor, {}, false});
  }
  void OnSequenceEnd() override { close_open(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({Node{NodeKind::map, place(mark), "", {}, {}}, anchor, {}, false});
  }
  void OnMapEnd() override { close_open(); }

private:
  struct Open {
    Node node;
    YAML::anchor_t anchor;
    Node key; // of a map, when read and its value is not yet
    bool has_key;
  };

  Mark place(const YAML::Mark& mark) const { return {name_, mark.line + 1, mark.column + 1}; }

  void leaf(NodeKind kind, const YAML::Mark& mark, const std::string& text, YAML::anchor_t anchor) {
    ++nodes_;
    close(Node{kind, place(mark), text, {}, {}}, anchor);
  }

  void close_open() {
    Open done = std::move(open_.back());
    open_.pop_back();
    ++nodes_;
    close(std::move(done.node), done.anchor);
  }

  // Puts a complete node where it belongs.
  void close(Node node, YAML::anchor_t anchor) {
    if (anchor != 0) anchors_[anchor] = node;
    if (open_.empty()) {
      root = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == NodeKind::list) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.has_key) {
      if (node.kind == NodeKind::list || node.kind == NodeKind::map) {
        problems_.push_back({node.mark, "a key must be a word, not a list or a map"});
      }
      parent.key = std::move(node);
      parent.has_key = true;
    } else {
      parent.has_key = false;
      if (const Node* first = find(parent.node, parent.key.text)) {
        problems_.push_back({parent.key.mark, fmt::format("the key `{}` stands here a second time (first in line {}); "
                                                          "keep one",
                                                          parent.key.text, first->mark.line)});
        return;
      }
      // where nothing stands, the parser names the place of what comes next
      if (node.kind == NodeKind::null && node.text.empty()) node.mark = parent.key.mark;
      parent.node.entries.push_back({parent.key.text, parent.key.mark, std::move(node)});
    }
  }

  std::string name_;
  std::vector<Problem>& problems_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Node> anchors_;
  std::size_t nodes_ = 0;
};

// What yaml-cpp says names its own grammar; the commonest slips have a plainer name.
std::string plainly(const YAML::Exception& error, const std::string& text) {
  const bool wide = text.starts_with("\xFE\xFF") || text.starts_with("\xFF\xFE"); // UTF-16, which may have NULs
  const auto binary = [](char c) { return c >= '\0' && c < '\t'; };
  if (!wide && std::any_of(text.begin(), text.end(), binary)) return "not valid YAML: this is no text file";
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i <= error.mark.line && std::getline(lines, line); ++i) {
    if (i < error.mark.line - 1) continue;
    const auto first = line.find_first_not_of(' ');
    if (first != std::string::npos && line[first] == '\t') {
      return fmt::format("not valid YAML: line {} is indented with a tab; use spaces", i + 1);
    }
  }
  if (error.msg == "end of map flow not found") {
    return "not valid YAML: a `{` above is not closed, or a comma is missing before this";
  }
  if (error.msg == "end of sequence flow not found") {
    return "not valid YAML: a `[` above is not closed, or a comma is missing before this";
  }
  return "not valid YAML: " + error.msg;
}

} // namespace

Node parse_yaml(const std::string& text, const std::string& name, std::vector<Problem>& problems) {
  Builder builder(name, problems);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    Builder second(name, problems);
    if (parser && parser.HandleNextDocument(second)) {
      problems.push_back({second.root.mark, "a second YAML document begins here; a file holds one"});
    }
  } catch (const YAML::Exception& error) {
    problems.push_back({{name, error.mark.line + 1, error.mark.column + 1}, plainly(error, text)});
  }
  if (builder.root.mark.line == 0) builder.root.mark = {name, 1, 1};
  return std::move(builder.root);
}

} // namespace pneuma::pipeline::schema
