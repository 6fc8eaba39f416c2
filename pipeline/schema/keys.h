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
  bool with_temperature = false;                    // a material's: may be another at another temperature
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
  // The keys and rules of a part of the owner.
  void include(const AnyKeys& keys, const Part& part);

  const std::string& called() const { return named_.name; }
  Option option() const;
  bool read(const Source& source, void* owner) const;
  Node write(const void* owner) const;

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
    Declared internal() { // of stage.yaml alone
      key.option.is_internal = true;
      return *this;
    }
    Declared varies_with_temperature() {
      key.with_temperature = true;
      return *this;
    }
  };

  template <class B, class V>
  Declared operator()(const std::string& name, V B::*member, const Form<V>& form, const std::string& text) {
    Key key{form.named(name, text).option, form.access, {}, true, {}, "", false};
    key.option.is_required = key.option.default_value.empty();
    key.target = [member](void* owner) -> void* { return &(static_cast<T*>(owner)->*member); };
    return {list.emplace_back(std::move(key))};
  }
  template <class B, class V>
  Declared operator()(const std::string& name, std::optional<V> B::*member, const Form<V>& form,
                      const std::string& text) {
    return (*this)(name, member, maybe(form), text).or_another();
  }
  // A key that is turned into what a T holds; `get` gives it back, or nothing where it is written under another name.
  template <class V, class Set, class Get>
  Declared computed(const std::string& name, const Form<V>& form, const Set& set, const Get& get,
                    const std::string& text) {
    const auto read = [access = form.access, set](const Source& source, T& owner) {
      V one{};
      if (!access->read(source, &one)) return false;
      set(owner, std::move(one));
      return true;
    };
    const auto write = [access = form.access, get](const T& owner) {
      const std::optional<V> one = get(owner);
      return one ? access->write(&*one) : std::nullopt;
    };
    const Form<T> whole = form_of<T>(form.named(name, text).option, read, write);
    return {
        list.emplace_back(Key{whole.option, whole.access, [](void* owner) { return owner; }, false, {}, "", false})};
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
      if (key.is_member && key.target(&probe) == static_cast<void*>(&(probe.*member))) return key.option.name;
    }
    throw std::logic_error("a member without a key");
  }
};

// Where the keys of a T are declared; specialised for types of other folders.
template <class T>
struct Declaration {
  static void declare(Keys<T>& keys) { T::declare(keys); }
};

template <class T>
const Keys<T>& keys_of() {
  static const Keys<T> keys = [] {
    Keys<T> made;
    Declaration<T>::declare(made);
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

// One of the maps that a value may be written as.
struct Alternative {
  AnyKeys keys;
  std::function<void(void*)> begin;    // before its keys are read
  std::function<bool(const void*)> is; // whether a value is written so
};

struct AnyForm {
  Option option;
  std::shared_ptr<const Access> access;
};

// A map whose key `tag` says which of them it is. `not_yet`: names that the format knows.
AnyForm tagged_form(const std::string& tag, std::vector<Alternative> alternatives,
                    const std::vector<std::string>& not_yet, const std::string& instead);

template <class T>
Form<T> tagged(const std::string& tag, std::vector<Alternative> alternatives,
               const std::vector<std::string>& not_yet = {}, const std::string& instead = "") {
  AnyForm form = tagged_form(tag, std::move(alternatives), not_yet, instead);
  return {std::move(form.option), std::move(form.access)};
}

// The keys of a T where a std::variant holds it.
template <class T, class Variant>
Alternative alternative_of() {
  Alternative out;
  out.keys.include(keys_of<T>(), [](void* value) -> void* { return &std::get<T>(*static_cast<Variant*>(value)); });
  const Option option = keys_of<T>().option();
  out.keys.is(option.name, option.text, option.told_by);
  out.begin = [](void* value) { *static_cast<Variant*>(value) = T{}; };
  out.is = [](const void* value) { return std::holds_alternative<T>(*static_cast<const Variant*>(value)); };
  return out;
}

template <class... Ts>
std::vector<Alternative> alternatives_of(const std::variant<Ts...>*) {
  return {alternative_of<Ts, std::variant<Ts...>>()...};
}

// A variant of maps, told apart by the key `tag`.
template <class Variant>
Form<Variant> variant(const std::string& tag, const std::vector<std::string>& not_yet = {},
                      const std::string& instead = "") {
  return tagged<Variant>(tag, alternatives_of(static_cast<const Variant*>(nullptr)), not_yet, instead);
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
