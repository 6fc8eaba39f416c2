// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/keys.h"

#include <algorithm>

namespace pneuma::pipeline::schema {

void AnyKeys::is(const std::string& name, const std::string& text, const std::string& told_by) {
  named_.name = name, named_.text = text, named_.told_by = told_by;
}

void AnyKeys::unavailable(const std::string& name, const std::string& instead) {
  list.emplace_back().option = not_available(name, instead);
}

void AnyKeys::include(const AnyKeys& keys, const Part& part) {
  const auto inner = [part](const void* owner) { return part(const_cast<void*>(owner)); };
  for (const Key& key : keys.list) {
    Key& own = list.emplace_back(key);
    own.is_member = false;
    if (key.target) own.target = [part, target = key.target](void* owner) { return target(part(owner)); };
    if (key.condition) own.condition = [is = key.condition, inner](const void* owner) { return is(inner(owner)); };
  }
  for (const Rule& rule : keys.rules) {
    rules.push_back([rule, inner](Reader& reader, const void* owner, const std::string& path) {
      rule(reader, inner(owner), path);
    });
  }
  sets_.insert(sets_.end(), keys.sets_.begin(), keys.sets_.end());
  if (!keys.named_.name.empty()) named_ = keys.named_;
}

Option AnyKeys::option() const {
  std::vector<Option> members;
  for (const Key& key : list) members.push_back(key.option);
  Option out = option_of(Type::group, std::move(members));
  out.name = named_.name, out.text = named_.text, out.told_by = named_.told_by;
  out.alternatives = sets_;
  return out;
}

bool AnyKeys::read(const Source& source, void* owner) const {
  Reader& reader = source.reader;
  bool complete = reader.keys(source);
  for (const Key& key : list) {
    if (!key.access) continue;
    const std::string path = below(source.path, key.option.name);
    const Node* given = find(source.node, key.option.name);
    const bool good = given != nullptr && key.access->read({reader, key.option, *given, path}, key.target(owner));
    if (!good && !key.option.defines.empty()) reader.cannot_know(key.option.defines);
    if (good && !key.option.stands_for.empty()) reader.came_from(below(source.path, key.option.stands_for), path);
    if (good) continue;
    if (given != nullptr) {
      reader.spoil(path);
      complete = false;
    } else if (key.option.default_node && key.option.tag.empty()) {
      Reader apart; // a default has no place in the file
      key.access->read({apart, key.option, *key.option.default_node, path}, key.target(owner));
    }
  }
  return complete && judge(reader, owner, source.path);
}

Node AnyKeys::write(const void* owner, Node node) const {
  node.kind = NodeKind::map;
  for (const Key& key : list) {
    if (!key.access || (key.condition && !key.condition(owner))) continue;
    std::optional<Node> one = key.access->write(key.target(const_cast<void*>(owner)));
    if (one) add(node, key.option.name, std::move(*one));
  }
  return node;
}

bool AnyKeys::judge(Reader& reader, const void* owner, const std::string& path) const {
  const auto before = static_cast<std::ptrdiff_t>(reader.problems.size());
  for (const Key& key : list) {
    const std::string at = below(path, key.option.name);
    if (!key.condition || key.otherwise.empty() || !reader.given(at) || key.condition(owner)) continue;
    reader.refuse(at, key.otherwise);
  }
  for (const Rule& rule : rules) rule(reader, owner, path);
  return std::none_of(reader.problems.begin() + before, reader.problems.end(),
                      [](const Problem& problem) { return problem.error; });
}

} // namespace pneuma::pipeline::schema
