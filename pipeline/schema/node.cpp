// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/node.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

namespace pneuma::pipeline::schema {

std::string to_string(const Mark& mark) {
  return fmt::format("{}:{}:{}", mark.file, mark.line, mark.column);
}

std::string to_string(const Problem& problem) {
  return fmt::format("{}: {}{}", to_string(problem.mark), problem.error ? "" : "warning: ", problem.message);
}

Node scalar(std::string text) {
  Node node;
  node.kind = NodeKind::scalar;
  node.text = std::move(text);
  return node;
}

void add(Node& map, std::string key, Node value) {
  map.kind = NodeKind::map;
  map.entries.push_back({std::move(key), {}, std::move(value)});
}

const Node* find(const Node& map, const std::string& key) {
  for (const Entry& entry : map.entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

std::string read_text(const std::filesystem::path& file, const Mark& where, std::vector<Problem>& problems) {
  std::error_code ignored;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    const char* reason = stream ? "it is a folder" : std::strerror(errno);
    problems.push_back({where, fmt::format("the file `{}` cannot be read: {}", file.string(), reason)});
    return {};
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

namespace {

constexpr std::size_t line_length = 100;

bool is_plain(const std::string& text) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const auto inside = [&](char c) { return word(c) || std::strchr(" ./+-%()^*", c) != nullptr; };
  if (text.empty() || text == "null" || text.back() == ' ') return false;
  if (!word(text.front()) && !(text.front() == '-' && text.size() > 1 && word(text[1]))) return false;
  return std::all_of(text.begin(), text.end(), inside);
}

std::string quoted(const std::string& text) {
  if (is_plain(text)) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string in_one_line(const Node& node) {
  std::string text;
  switch (node.kind) {
  case NodeKind::null:
    return "~";
  case NodeKind::scalar:
    return quoted(node.text);
  case NodeKind::list:
    for (const Node& item : node.items) text += fmt::format("{}{}", text.empty() ? "" : ", ", in_one_line(item));
    return fmt::format("[{}]", text);
  case NodeKind::map:
    for (const Entry& entry : node.entries) {
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", quoted(entry.key), in_one_line(entry.value));
    }
    return fmt::format("{{{}}}", text);
  }
  return text;
}

bool is_short(const Node& node) {
  const auto plain = [](const Node& child) {
    return child.kind != NodeKind::map &&
           std::none_of(child.items.begin(), child.items.end(), [](const Node& n) { return n.kind == NodeKind::map; });
  };
  if (node.items.empty() && node.entries.empty()) return true;
  return std::all_of(node.items.begin(), node.items.end(), plain) &&
         std::all_of(node.entries.begin(), node.entries.end(), [&](const Entry& e) { return plain(e.value); }) &&
         in_one_line(node).size() <= line_length;
}

void write(const Node& node, const std::string& indent, std::string& out) {
  for (const Entry& entry : node.entries) {
    out += fmt::format("{}{}:", indent, quoted(entry.key));
    if (is_short(entry.value)) {
      out += fmt::format(" {}\n", in_one_line(entry.value));
    } else {
      out += "\n";
      write(entry.value, indent + "  ", out);
    }
  }
  for (const Node& item : node.items) {
    if (is_short(item)) {
      out += fmt::format("{}- {}\n", indent, in_one_line(item));
    } else {
      std::string block;
      write(item, indent + "  ", block);
      block[indent.size()] = '-';
      out += block;
    }
  }
}

template <typename Visit>
void walk(Node& node, const std::string& path, const Visit& visit) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + "." + name; };
  if (node.kind == NodeKind::scalar || node.kind == NodeKind::null) visit(path, node);
  for (std::size_t i = 0; i < node.items.size(); ++i) walk(node.items[i], below(std::to_string(i)), visit);
  for (Entry& entry : node.entries) walk(entry.value, below(entry.key), visit);
}

} // namespace

std::string write_yaml(const Node& node) {
  if (node.kind != NodeKind::map || node.entries.empty()) return in_one_line(node) + "\n";
  std::string out;
  write(node, "", out);
  return out;
}

std::vector<std::pair<std::string, const Node*>> leaves(const Node& node) {
  std::vector<std::pair<std::string, const Node*>> found;
  // walk only hands the nodes on; nothing is changed
  walk(const_cast<Node&>(node), "", [&](const std::string& path, Node& leaf) { found.emplace_back(path, &leaf); });
  return found;
}

void replace_marks(Node& node, const std::map<std::string, Mark>& marks) {
  walk(node, "", [&](const std::string& path, Node& leaf) {
    if (const auto known = marks.find(path); known != marks.end()) leaf.mark = known->second;
  });
  // a map stands where its first marked value stands: good enough to find it
  const auto settle = [&](const auto& self, Node& inner) -> void {
    for (Node& item : inner.items) self(self, item);
    for (Entry& entry : inner.entries) self(self, entry.value);
    if (!inner.items.empty()) inner.mark = inner.items.front().mark;
    for (const Entry& entry : inner.entries) {
      if (entry.value.mark.file == inner.mark.file || entry.value.mark.line == 0) continue;
      inner.mark = entry.value.mark;
      break;
    }
  };
  settle(settle, node);
}

} // namespace pneuma::pipeline::schema
