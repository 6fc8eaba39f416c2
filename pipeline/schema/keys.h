// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <any>
#include <stdexcept>

#include "pipeline/schema/form.h"

namespace pneuma::pipeline::schema {

template <class T>
class Keys;
template <class T>
const Keys<T>& keys_of();

// A value that was read and its path: what a rule looks at, and where its message stands.
template <class T>
struct At {
  const T& value;
  std::string path;

  const T* operator->() const { return &value; }
  template <class Base>
  requires std::is_base_of_v<Base, T>
  operator At<Base>() const { return {value, path}; }
  template <class B, class V>
  At<V> operator[](V B::*member) const {
    return {value.*member, below(path, keys_of<B>().name_of(member))};
  }
  template <class V>
  At<V> at(const V& inner, const std::string& key) const {
    return {inner, below(path, key)};
  }
};

template <class V>
std::vector<At<V>> items(const At<std::vector<V>>& list) {
  std::vector<At<V>> out;
  for (std::size_t i = 0; i < list->size(); ++i) out.push_back(list.at(list.value[i], std::to_string(i)));
  return out;
}

// "`thickness`": what the key of a member is called.
template <class B, class V>
std::string name(V B::*member) {
  return quoted(keys_of<B>().name_of(member));
}

// One key of a map that a T stands for.
template <class T>
struct Key {
  Form<T> form;                                 // what it fills in the T
  std::any member = {};                         // if that is one: pointer to it
  std::function<bool(const T&)> condition = {}; // empty: the key always means something
  std::string otherwise = {};                   // why it is refused where it means nothing; empty: passed over

  // Where the condition is not met the key is not written, and refused where a user gave it: "`creep` <why>".
  Key& where(const std::function<bool(const T&)>& holds, const std::string& why) {
    condition = holds;
    otherwise = why;
    return *this;
  }
  Key& or_another() { // one of several, or one that is filled in
    form.option.is_required = false;
    return *this;
  }
};

// The keys of a map that a T stands for: each with its form, its text and the member that it fills. A T declares them
// in `static void declare(auto& keys)`; rules between them stand in `static void check(Reader&, At<T>)`, which sees
// complete values only. A member must be given unless it is a std::optional or its form has a default.
template <class T>
class Keys {
public:
  std::vector<Key<T>> list;
  std::vector<std::function<void(Reader&, const At<T>&)>> rules;
  // Of maps of which one is chosen: makes a T one that is written with these keys; whether it is.
  std::function<void(T&)> begin;
  std::function<bool(const T&)> is_written;

  // What the map is called where it is one of several, and what it means; `told_by`: the key that tells it from
  // another of the same name.
  void is(const std::string& name, const std::string& text, const std::string& told_by = "") {
    named_.name = name, named_.text = text, named_.told_by = told_by;
  }
  void exactly_one(const std::vector<std::string>& keys) { named_.alternatives.push_back({keys, 1, 1}); }
  void at_least_one(const std::vector<std::string>& keys) { named_.alternatives.push_back({keys, 1, keys.size()}); }
  void not_both(const std::string& first, const std::string& second) {
    named_.alternatives.push_back({{first, second}, 0, 1});
  }
  // One of them at least must stand beside a key.
  void needs(const std::string& key, const std::vector<std::string>& others, const std::string& why) {
    named_.alternatives.push_back({others, 1, others.size(), key, why});
  }
  // A key that the format knows and the program does not offer yet.
  void unavailable(const std::string& name, const std::string& instead) {
    list.push_back({{not_available(name, instead), {}, {}}});
  }

  template <class B, class V>
  Key<T>& operator()(const std::string& name, V B::*member, Form<V> form, const std::string& text) {
    form.option.is_required = form.option.default_value.empty();
    if constexpr (requires(const V& value) { value.empty(); }) { // an empty one is absent
      if (form.option.is_required) {
        form.node_of = [write = form.node_of](const V& value) { return value.empty() ? std::nullopt : write(value); };
      }
    }
    Key<T>& key = (*this)(name, part<T>(form, member), text);
    if (form.option.stands_for.empty()) key.member = member;
    return key;
  }
  template <class B, class V>
  Key<T>& operator()(const std::string& name, std::optional<V> B::*member, const Form<V>& form,
                     const std::string& text) {
    return (*this)(name, member, maybe(form), text).or_another();
  }
  // A key that fills the T itself.
  Key<T>& operator()(const std::string& name, const Form<T>& form, const std::string& text) {
    return list.emplace_back(Key<T>{form.named(name, text)});
  }

  void rule(const std::function<void(Reader&, const At<T>&)>& check) { rules.push_back(check); }
  // Also the keys and rules of a part of the T, and what they are called.
  template <class A, class PartOf>
  void include(const Keys<A>& keys, const PartOf& part_of) {
    for (const Key<A>& key : keys.list) {
      Key<T>& own = list.emplace_back(Key<T>{part<T>(key.form, part_of), {}, {}, key.otherwise});
      if (key.condition) own.condition = [is = key.condition, part_of](const T& owner) { return is(part_of(owner)); };
    }
    for (const auto& one : keys.rules) {
      rule([one, part_of](Reader& reader, const At<T>& owner) { one(reader, {part_of(owner.value), owner.path}); });
    }
    const std::vector<KeySet>& sets = keys.named_.alternatives;
    named_.alternatives.insert(named_.alternatives.end(), sets.begin(), sets.end());
    if (!keys.named_.name.empty()) is(keys.named_.name, keys.named_.text, keys.named_.told_by);
  }
  // Also the keys of an A: `variant_of` a T, or a member of it, is a std::variant.
  template <class A, class VariantOf>
  void alternative(const Keys<A>& keys, const VariantOf& variant_of) {
    include(
        keys, [variant_of](auto& owner) -> auto& { return std::get<A>(std::invoke(variant_of, owner)); });
    begin = [variant_of](T& owner) { std::invoke(variant_of, owner) = A{}; };
    is_written = [variant_of](const T& owner) { return std::holds_alternative<A>(std::invoke(variant_of, owner)); };
  }

  const std::string& called() const { return named_.name; }
  Option option() const {
    std::vector<Option> members;
    for (const Key<T>& key : list) members.push_back(key.form.option);
    Option out = named_;
    out.parts = std::make_shared<const std::vector<Option>>(std::move(members));
    return out;
  }
  template <class B, class V>
  std::string name_of(V B::*member) const {
    for (const Key<T>& key : list) {
      const auto* own = std::any_cast<V B::*>(&key.member);
      if (own != nullptr && *own == member) return key.form.option.name;
    }
    throw std::logic_error("a member without a key");
  }

  bool read(const Source& source, T& owner) const {
    Reader& reader = source.reader;
    bool complete = reader.keys(source);
    for (const Key<T>& key : list) {
      const Option& option = key.form.option;
      if (!option.not_yet.empty()) continue;
      const std::string path = below(source.path, option.name);
      const Node* given = find(source.node, option.name);
      const bool good = given != nullptr && key.form.read(reader, *given, path, owner);
      if (!good && !option.defines.empty()) reader.cannot_know(option.defines);
      if (good && !option.stands_for.empty()) reader.came_from(below(source.path, option.stands_for), path);
      if (given != nullptr && !good) {
        reader.spoil(path);
        complete = false;
      } else if (given == nullptr && option.default_node && option.tag.empty()) {
        Reader apart; // a default has no place in the file
        key.form.read(apart, *option.default_node, path, owner);
      }
    }
    return complete && judge(reader, {owner, source.path});
  }
  Node write(const T& owner, Node node = {}) const {
    node.kind = NodeKind::map;
    for (const Key<T>& key : list) {
      if (!key.form.option.not_yet.empty() || (key.condition && !key.condition(owner))) continue;
      std::optional<Node> one = key.form.node_of(owner);
      if (one) add(node, key.form.option.name, std::move(*one));
    }
    return node;
  }

private:
  template <class A>
  friend class Keys;

  bool judge(Reader& reader, const At<T>& owner) const {
    const auto before = static_cast<std::ptrdiff_t>(reader.problems.size());
    for (const Key<T>& key : list) {
      const std::string path = below(owner.path, key.form.option.name);
      const bool matters = key.condition && !key.otherwise.empty() && reader.given(path);
      if (matters && !key.condition(owner.value)) reader.refuse(path, key.otherwise);
    }
    for (const auto& one : rules) one(reader, owner);
    return std::none_of(reader.problems.begin() + before, reader.problems.end(),
                        [](const Problem& problem) { return problem.error; });
  }

  Option named_ = option_of(Type::group); // without its keys
};

// Where the keys of a T are declared; there are overloads for types of other folders.
template <class T>
void declare(Keys<T>& keys) {
  T::declare(keys);
}

template <class T>
const Keys<T>& keys_of() {
  static const Keys<T> keys = [] {
    Keys<T> made;
    declare(made);
    if constexpr (requires(Reader & reader, const At<T>& value) { T::check(reader, value); }) made.rule(T::check);
    return made;
  }();
  return keys;
}

// A map with these keys.
template <class T>
Form<T> group(const Keys<T>& keys) {
  const auto shared = std::make_shared<const Keys<T>>(keys);
  return {keys.option(), [shared](const Source& source, T& value) { return shared->read(source, value); },
          [shared](const T& value) { return shared->write(value); }};
}

template <class T>
Form<T> group() {
  return group(keys_of<T>());
}

// One of several maps; its key `tag` says which of them it is.
template <class T>
Form<T> tagged(const std::string& tag, const std::vector<Keys<T>>& maps, std::vector<Option> unavailable = {}) {
  std::vector<Option> members;
  for (const Keys<T>& one : maps) members.push_back(one.option());
  std::move(unavailable.begin(), unavailable.end(), std::back_inserter(members));
  Option option = option_of(Type::variant, std::move(members));
  option.tag = tag;
  return {std::move(option),
          [maps](const Source& source, T& value) {
            const std::optional<std::size_t> found = source.reader.alternative(source);
            if (!found) return false;
            maps[*found].begin(value);
            const Option& group = source.option.members()[*found];
            return maps[*found].read({source.reader, group, source.node, source.path, &source.option}, value);
          },
          [maps, tag](const T& value) {
            const auto found =
                std::find_if(maps.begin(), maps.end(), [&](const Keys<T>& one) { return one.is_written(value); });
            Node node;
            add(node, tag, scalar(found->called()));
            return found->write(value, std::move(node));
          }};
}

template <class... Ts>
std::vector<Keys<std::variant<Ts...>>> keys_of_all(const std::variant<Ts...>*) {
  std::vector<Keys<std::variant<Ts...>>> maps(sizeof...(Ts));
  std::size_t i = 0;
  (maps[i++].alternative(keys_of<Ts>(), std::identity()), ...);
  return maps;
}

// A variant of maps.
template <class Variant>
Form<Variant> variant(const std::string& tag, std::vector<Option> unavailable = {}) {
  return tagged<Variant>(tag, keys_of_all(static_cast<const Variant*>(nullptr)), std::move(unavailable));
}

// A T of which a user says nothing.
template <class T>
T defaults() {
  Reader reader;
  Node nothing;
  nothing.kind = NodeKind::map;
  T value{};
  group<T>().read(reader, nothing, "", value);
  return value;
}

} // namespace pneuma::pipeline::schema
