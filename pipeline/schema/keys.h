// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

// One key of a map: its description and what it fills.
struct Key {
  Option option;
  std::shared_ptr<const Access> access;             // none: not available yet
  std::function<void*(void* owner)> target;         // what is read into: a member of the owner, or the owner
  bool is_member = false;                           // the former
  std::function<bool(const void* owner)> condition; // empty: the key always means something
  std::string otherwise;                            // why it is refused where it means nothing; empty: passed over
};

// The keys of a map as data: what Keys<T> (below) declares for a T, of which this knows nothing.
class AnyKeys {
public:
  using Rule = std::function<void(Reader&, const void* owner, const std::string& path)>;
  using Part = std::function<void*(void* outer)>;

  std::vector<Key> list;
  std::vector<Rule> rules;

  // What the map is called where it is one of several, and what it means; `told_by`: the key that tells it from
  // another of the same name.
  void is(const std::string& name, const std::string& text, const std::string& told_by = "");
  // A key that the format knows and the program does not offer yet.
  void unavailable(const std::string& name, const std::string& instead);
  void exactly_one(const std::vector<std::string>& keys) { sets_.push_back({keys, 1, 1}); }
  void at_least_one(const std::vector<std::string>& keys) { sets_.push_back({keys, 1, keys.size()}); }
  void not_both(const std::string& first, const std::string& second) { sets_.push_back({{first, second}, 0, 1}); }
  // The keys and rules of a part of the owner, and what they are called.
  void include(const AnyKeys& keys, const Part& part);
  // Of maps of which one is chosen: makes the owner one that is written with these keys; whether it is.
  std::function<void(void* owner)> begin;
  std::function<bool(const void* owner)> is_written;

  const std::string& called() const { return named_.name; }
  Option option() const;
  bool read(const Source& source, void* owner) const;
  Node write(const void* owner, Node node = {}) const;

private:
  bool judge(Reader& reader, const void* owner, const std::string& path) const;

  Option named_ = option_of(Type::group);
  std::vector<KeySet> sets_;
};

// The keys of a map that a T stands for: each with its form, its text and the member that it fills. A T declares them
// in `static void declare(auto& keys)`; rules between them stand in `static void check(Reader&,
// At<T>)`, which sees complete values only. A member must be given unless it is a std::optional or its form has a
// default.
template <class T>
class Keys : public AnyKeys {
public:
  // What may be said of a key behind its declaration.
  struct Declared {
    Key& key;

    // Where the condition is not met the key is not written, and refused where a user gave it: "`creep` <why>".
    Declared where(const std::function<bool(const T&)>& holds, const std::string& why) {
      key.condition = [holds](const void* owner) { return holds(*static_cast<const T*>(owner)); };
      key.otherwise = why;
      return *this;
    }
    Declared or_another() { // one of several, or one that is filled in
      key.option.is_required = false;
      return *this;
    }
  };

  template <class B, class V>
  Declared operator()(const std::string& name, V B::*member, const Form<V>& form, const std::string& text) {
    Key key{form.named(name, text).option, form.access, {}, true, {}, ""};
    key.option.is_required = key.option.default_value.empty();
    if constexpr (requires(const V& value) { value.empty(); }) {
      if (key.option.is_required) key.access = unless_empty(form).access;
    }
    key.target = [member](void* owner) -> void* { return &(static_cast<T*>(owner)->*member); };
    return {list.emplace_back(std::move(key))};
  }
  template <class B, class V>
  Declared operator()(const std::string& name, std::optional<V> B::*member, const Form<V>& form,
                      const std::string& text) {
    return (*this)(name, member, maybe(form), text).or_another();
  }
  // A key that fills the whole owner.
  Declared operator()(const std::string& name, const Form<T>& form, const std::string& text) {
    const auto whole = [](void* owner) { return owner; };
    return {list.emplace_back(Key{form.named(name, text).option, form.access, whole, false, {}, ""})};
  }

  // Also the keys of an A: `variant_of` an owner, or a member of it, is a std::variant.
  template <class A, class VariantOf>
  void alternative(const Keys<A>& keys, const VariantOf& variant_of) {
    const auto held = [variant_of](void* owner) -> auto& {
      return std::invoke(variant_of, *static_cast<T*>(owner));
    };
    include(keys, [held](void* owner) -> void* { return &std::get<A>(held(owner)); });
    begin = [held](void* owner) { held(owner) = A{}; };
    is_written = [held](const void* owner) { return std::holds_alternative<A>(held(const_cast<void*>(owner))); };
  }

  void rule(const std::function<void(Reader&, const At<T>&)>& check) {
    rules.push_back([check](Reader& reader, const void* owner, const std::string& path) {
      check(reader, {*static_cast<const T*>(owner), path});
    });
  }
  template <class B, class V>
  std::string name_of(V B::*member) const {
    static T probe{};
    for (const Key& key : list) {
      if (key.is_member && key.option.stands_for.empty() && key.target(&probe) == static_cast<void*>(&(probe.*member)))
        return key.option.name;
    }
    throw std::logic_error("a member without a key");
  }
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
  return form_of<T>(
      keys.option(), [shared](const Source& source, T& value) { return shared->read(source, &value); },
      [shared](const T& value) { return shared->write(&value); });
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
  return form_of<T>(
      std::move(option),
      [maps](const Source& source, T& value) {
        const std::optional<std::size_t> found = source.reader.alternative(source);
        if (!found) return false;
        maps[*found].begin(&value);
        const Option& group = source.option.members()[*found];
        return maps[*found].read({source.reader, group, source.node, source.path, &source.option}, &value);
      },
      [maps, tag](const T& value) {
        const auto found =
            std::find_if(maps.begin(), maps.end(), [&](const Keys<T>& one) { return one.is_written(&value); });
        Node node;
        add(node, tag, scalar(found->called()));
        return found->write(&value, std::move(node));
      });
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
