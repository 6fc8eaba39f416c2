// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/yaml/node.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "pipeline/yaml/text.h"

namespace pneuma::pipeline::yaml {

std::string to_string(const Mark& mark) {
  return fmt::format("{}:{}:{}", printable(mark.file), mark.line, mark.column);
}

std::string to_string(const Problem& problem) {
  return fmt::format("{}: {}{}", to_string(problem.mark), problem.error ? "" : "warning: ", printable(problem.message));
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

void drop_templates(Node& root) {
  std::erase_if(root.entries, [](const Entry& entry) { return entry.key.starts_with("x-"); });
}

namespace {

constexpr std::size_t line_length = 100;

bool is_plain(const std::string& text) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const auto inside = [&](char c) { return word(c) || std::string_view(" ./+-%()^*").find(c) != std::string::npos; };
  if (text.empty() || text == "null" || text == "Null" || text == "NULL" || text.back() == ' ') return false;
  if (!word(text.front()) && !(text.front() == '-' && text.size() > 1 && word(text[1]))) return false;
  return std::all_of(text.begin(), text.end(), inside);
}

std::string quoted(const std::string& text) {
  if (is_plain(text)) return text;
  std::string out = "\"";
  for (std::size_t at = 0; at < text.size();) {
    const auto [code, size, valid] = character_at(text, at);
    if (code == '"' || code == '\\') out += '\\';
    if (valid && is_control(code)) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(code));
    } else {
      out += text.substr(at, size);
    }
    at += size;
  }
  return out + '"';
}

// Adds a node in one line; false as soon as `out` is longer than `limit`, so that a long node costs no more.
bool in_one_line(const Node& node, std::string& out, std::size_t limit = std::string::npos) {
  const auto add_text = [&](const std::string& text) {
    if (out.size() > limit || text.size() > limit) return false;
    out += quoted(text);
    return true;
  };
  if (node.kind == NodeKind::null) out += '~';
  if (node.kind == NodeKind::scalar && !add_text(node.text)) return false;
  const bool is_list = node.kind == NodeKind::list;
  if (is_list || node.kind == NodeKind::map) out += is_list ? '[' : '{';
  const std::size_t first = out.size();
  for (const Node& item : node.items) {
    if (out.size() > first) out += ", ";
    if (!in_one_line(item, out, limit)) return false;
  }
  for (const Entry& entry : node.entries) {
    if (out.size() > first) out += ", ";
    if (!add_text(entry.key)) return false;
    out += ": ";
    if (!in_one_line(entry.value, out, limit)) return false;
  }
  if (is_list || node.kind == NodeKind::map) out += is_list ? ']' : '}';
  return out.size() <= limit;
}

bool is_short(const Node& node) {
  const auto plain = [](const Node& child) {
    return child.kind != NodeKind::map &&
           std::none_of(child.items.begin(), child.items.end(), [](const Node& n) { return n.kind == NodeKind::map; });
  };
  if (node.items.empty() && node.entries.empty()) return true;
  std::string line;
  return in_one_line(node, line, line_length) && std::all_of(node.items.begin(), node.items.end(), plain) &&
         std::all_of(node.entries.begin(), node.entries.end(), [&](const Entry& e) { return plain(e.value); });
}

void write(const Node& node, const std::string& indent, std::string& out) {
  for (const Entry& entry : node.entries) {
    out += indent + quoted(entry.key) + ":";
    if (is_short(entry.value)) {
      out += ' ';
      in_one_line(entry.value, out);
      out += '\n';
    } else {
      out += '\n';
      write(entry.value, indent + "  ", out);
    }
  }
  for (const Node& item : node.items) {
    if (is_short(item)) {
      out += indent + "- ";
      in_one_line(item, out);
      out += '\n';
    } else {
      const std::size_t begin = out.size();
      write(item, indent + "  ", out);
      out[begin + indent.size()] = '-';
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
  std::string out;
  if (node.kind == NodeKind::map && !node.entries.empty()) {
    write(node, "", out);
  } else {
    in_one_line(node, out);
    out += '\n';
  }
  return out;
}

std::vector<std::pair<std::string, const Node*>> leaves(const Node& node) {
  std::vector<std::pair<std::string, const Node*>> found;
  // walk only hands the nodes on; nothing is changed
  walk(const_cast<Node&>(node), "", [&](const std::string& path, Node& leaf) { found.emplace_back(path, &leaf); });
  return found;
}

std::string to_string(const Difference& difference) {
  const auto& [path, before, after] = difference;
  if (!before) return fmt::format("{} {} is new", path, *after);
  if (!after) return fmt::format("{} {} is gone", path, *before);
  return fmt::format("{} {} -> {}", path, *before, *after);
}

std::vector<Difference> differences(const Node& before, const Node& after) {
  std::map<std::string, std::string> then;
  for (const auto& [path, leaf] : leaves(before)) then[path] = leaf->text;
  std::vector<Difference> found;
  for (const auto& [path, leaf] : leaves(after)) {
    const auto old = then.find(path);
    if (old == then.end()) {
      found.push_back({path, std::nullopt, leaf->text});
      continue;
    }
    if (old->second != leaf->text) found.push_back({path, old->second, leaf->text});
    then.erase(old);
  }
  for (const auto& [path, text] : then) found.push_back({path, text, std::nullopt});
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

} // namespace pneuma::pipeline::yaml
