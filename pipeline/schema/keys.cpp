// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/keys.h"

#include <algorithm>

namespace pneuma::pipeline::schema {

void AnyKeys::is(const std::string& name, const std::string& text, const std::string& told_by) {
  named_.name = name, named_.text = text, named_.told_by = told_by;
}

void AnyKeys::unavailable(const std::string& name, const std::string& instead) {
  Key& key = list.emplace_back();
  key.option.type = Type::group;
  key.option.name = name, key.option.not_yet = instead;
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
    if (const Node* given = find(source.node, key.option.name)) {
      if (key.access->read({reader, key.option, *given, path}, key.target(owner))) continue;
      reader.spoil(path);
      complete = false;
    } else if (key.option.default_node && key.option.tag.empty()) {
      Reader apart; // a default has no place in the file
      key.access->read({apart, key.option, *key.option.default_node, path}, key.target(owner));
    }
  }
  return complete && judge(reader, owner, source.path);
}

Node AnyKeys::write(const void* owner) const {
  Node node;
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

AnyForm tagged_form(const std::string& tag, std::vector<Alternative> alternatives,
                    const std::vector<std::string>& not_yet, const std::string& instead) {
  std::vector<Option> members;
  for (const Alternative& one : alternatives) members.push_back(one.keys.option());
  for (const std::string& name : not_yet) {
    Option& member = members.emplace_back(option_of(Type::group));
    member.name = name, member.not_yet = instead;
  }
  AnyForm form{option_of(Type::variant, std::move(members)), {}};
  form.option.tag = tag;
  const auto kinds = std::make_shared<const std::vector<Alternative>>(std::move(alternatives));
  const auto read = [kinds](const Source& source, void* value) {
    const std::optional<std::size_t> found = source.reader.alternative(source);
    if (!found) return false;
    const Alternative& one = (*kinds)[*found];
    one.begin(value);
    return one.keys.read({source.reader, source.option.members()[*found], source.node, source.path, &source.option},
                         value);
  };
  const auto write = [kinds, tag](const void* value) {
    const auto found = std::find_if(kinds->begin(), kinds->end(), [&](const auto& one) { return one.is(value); });
    Node keys = found->keys.write(value), node;
    add(node, tag, scalar(found->keys.called()));
    std::move(keys.entries.begin(), keys.entries.end(), std::back_inserter(node.entries));
    return std::optional<Node>(std::move(node));
  };
  form.access = std::make_shared<Access>(Access{read, write});
  return form;
}

} // namespace pneuma::pipeline::schema
