// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/base/types.h"
#include "pipeline/schema/quantity.h"
#include "pipeline/schema/reader.h"

namespace pneuma::pipeline::schema {

// What may stand for a T: its description, how it is read and checked, and how it is written so that it reads back to
// the same bits. Declarations read as sentences: quantity("m").positive().otherwise("0.5 m").
template <class T>
struct Form {
  Option option;
  std::function<bool(const Source&, T&)> fill;          // false: a problem was reported
  std::function<std::optional<Node>(const T&)> node_of; // none: it is absent

  bool read(Reader& reader, const Node& node, const std::string& path, T& value) const {
    return fill({reader, option, node, path}, value);
  }
  Node write(const T& value) const { return node_of(value).value(); }

  Form otherwise(const std::string& yaml) const { // the default
    return changed([&](Option& o) { set_default(o, yaml); });
  }
  Form within(const Range& range) const { return with(&Option::limits, range); }
  Form positive() const { return within({0, std::numeric_limits<double>::infinity(), "positive", false, true}); }
  Form at_least(double min, const std::string& words) const {
    return within({min, std::numeric_limits<double>::infinity(), words});
  }
  Form between(double min, double max, const std::string& words) const { return within({min, max, words}); }
  Form usual(double min, double max, const std::string& words) const { // outside is a warning
    return with(&Option::usually, Range{min, max, words});
  }
  // Values of a short form are written in another, at a path from the map around.
  Form stands_for(const std::string& other) const { return with(&Option::stands_for, other); }
  Form such_as(const std::string& example) const { return with(&Option::example, example); }
  Form items(std::size_t least, std::size_t most) const {
    return with(&Option::min_items, least).with(&Option::max_items, most);
  }
  Form named(const std::string& name, const std::string& text) const {
    return with(&Option::name, name).with(&Option::text, text);
  }
  // What is done with a value that was read; false: a problem was reported.
  Form and_then(const std::function<bool(const Source&, T&)>& done) const {
    return {option,
            [fill = fill, done](const Source& source, T& value) { return fill(source, value) && done(source, value); },
            node_of};
  }
  // `fault` says what is wrong with a value by itself: a sentence, or "must ..." about its key; empty: nothing.
  Form judged(const std::function<std::string(const T&)>& fault) const {
    return and_then([fault](const Source& source, const T& value) {
      const std::string wrong = fault(value);
      if (!wrong.empty()) source.reader.fail_value(source, wrong);
      return wrong.empty();
    });
  }
  // A value gives names to things of a kind ("foil"), for others to refer to.
  Form defines(const std::string& kind, const std::function<std::vector<std::string>(const T&)>& names) const {
    return with(&Option::defines, kind).and_then([kind, names](const Source& source, const T& value) {
      for (const std::string& name : names(value)) source.reader.define(kind, name, source.node.mark);
      return true;
    });
  }

private:
  template <class Change>
  Form changed(const Change& change) const {
    Form copy = *this;
    change(copy.option);
    return copy;
  }
  template <class V, class Value>
  Form with(V Option::*member, const Value& value) const {
    return changed([&](Option& o) { o.*member = value; });
  }
};

Form<double> quantity(const std::string& unit);
Form<double> number();
Form<int> integer();
Form<bool> flag();
Form<std::string> text();
Form<std::string> word(); // letters, digits, _ and -
// The name that something of a kind ("foil") gets; and one that there must be, or a word that stands for none of them.
Form<std::string> name_of_a(const std::string& kind, const std::vector<std::string>& reserved = {});
Form<std::string> reference_to(const std::string& kind, const std::string& other = "");

Node list_of(std::vector<Node> items);

// The same value as another type; where `from` gives a pointer and that is null, the value is absent.
template <class U, class T, class To, class From>
Form<U> mapped(const Form<T>& form, const To& to, const From& from) {
  return {form.option,
          [fill = form.fill, to](const Source& source, U& value) {
            T one{};
            if (!fill(source, one)) return false;
            value = to(one);
            return true;
          },
          [write = form.node_of, from](const U& value) -> std::optional<Node> {
            const auto one = from(value);
            if constexpr (std::is_pointer_v<decltype(from(value))>) {
              return one != nullptr ? write(*one) : std::nullopt;
            } else {
              return write(one);
            }
          }};
}

// A value that may be absent.
template <class T>
Form<std::optional<T>> maybe(const Form<T>& form) {
  return mapped<std::optional<T>>(
      form, [](const T& value) { return std::optional<T>(value); },
      [](const std::optional<T>& value) { return value ? &*value : nullptr; });
}

// The same value as a part of another: a member, or what `part_of` gives.
template <class U, class T, class PartOf>
Form<U> part(const Form<T>& form, const PartOf& part_of) {
  return {
      form.option,
      [fill = form.fill, part_of](const Source& source, U& value) { return fill(source, std::invoke(part_of, value)); },
      [write = form.node_of, part_of](const U& value) { return write(std::invoke(part_of, value)); }};
}

template <class T>
struct Word {
  std::string name;
  std::optional<T> value; // none: not available yet
  std::string text;       // what it means, or what is available instead
};

// One of a few words.
template <class T>
Form<T> choice(const std::vector<Word<T>>& words) {
  std::vector<Option> members;
  for (const Word<T>& one : words) {
    Option allowed;
    allowed.name = one.name;
    (one.value ? allowed.text : allowed.not_yet) = one.text;
    members.push_back(std::move(allowed));
  }
  return {option_of(Type::choice, std::move(members)),
          [words](const Source& source, T& value) {
            const std::optional<std::size_t> found = source.reader.choice(source);
            if (found) value = *words[*found].value;
            return found.has_value();
          },
          [words](const T& value) {
            const auto found =
                std::find_if(words.begin(), words.end(), [&](const Word<T>& one) { return one.value == value; });
            return scalar(found->name);
          }};
}

template <class T>
Form<std::vector<T>> list(const Form<T>& item) {
  return {option_of(Type::list, {item.option}),
          [item](const Source& source, std::vector<T>& value) {
            bool complete = source.reader.items(source);
            value.clear();
            for (std::size_t i = 0; i < source.node.items.size(); ++i) {
              T& one = value.emplace_back();
              const std::string path = below(source.path, std::to_string(i));
              complete = item.read(source.reader, source.node.items[i], path, one) && complete;
            }
            return complete;
          },
          [item](const std::vector<T>& value) {
            std::vector<Node> items;
            for (const T& one : value) items.push_back(item.write(one));
            return list_of(std::move(items));
          }};
}

// A list of so many.
template <std::size_t N, class T>
Form<std::array<T, N>> tuple(const Form<T>& item) {
  return mapped<std::array<T, N>>(
      list(item).items(N, N),
      [](const std::vector<T>& values) {
        std::array<T, N> out{};
        std::copy(values.begin(), values.end(), out.begin());
        return out;
      },
      [](const std::array<T, N>& values) { return std::vector<T>(values.begin(), values.end()); });
}

// Components, each of this form.
template <class V>
Form<V> vector(const Form<double>& component) {
  constexpr auto size = static_cast<std::size_t>(V::RowsAtCompileTime);
  return mapped<V>(
      tuple<size>(component), [](const std::array<double, size>& values) { return V(values.data()); },
      [](const V& value) {
        std::array<double, size> out{};
        std::copy(value.data(), value.data() + size, out.begin());
        return out;
      });
}

// A map from names; of a kind that there must be ("foil"), or another word.
template <class T>
Form<std::map<std::string, T>> table(const Form<T>& item, const std::string& kind = "", const std::string& other = "") {
  return {option_of(Type::table, {item.option}),
          [item, kind, other](const Source& source, std::map<std::string, T>& value) {
            bool complete = source.reader.entries(source);
            for (const Entry& entry : source.node.entries) {
              if (!kind.empty() && entry.key != other) source.reader.refer(kind, entry.key, entry.mark);
              T one{};
              const bool good = item.read(source.reader, entry.value, below(source.path, entry.key), one);
              if (good) value.insert_or_assign(entry.key, std::move(one));
              complete = good && complete;
            }
            return complete;
          },
          [item](const std::map<std::string, T>& value) {
            Node node;
            node.kind = NodeKind::map;
            for (const auto& [name, one] : value) add(node, name, item.write(one));
            return node;
          }};
}

inline constexpr const char* all = "all"; // key that stands for every one of a kind that is not named

// A map from things of a kind, which are known by then, or from `all`, which is written out; `every`: it leaves out
// none.
template <class T>
Form<std::map<std::string, T>> each(const std::string& kind, const Form<T>& item, bool every) {
  return table(item, kind, all).and_then([kind, every](const Source& source, std::map<std::string, T>& value) {
    Reader& reader = source.reader;
    if (every) reader.expect_every(kind, all, source);
    const auto of_all = reader.knows(kind) ? value.extract(all) : typename std::map<std::string, T>::node_type();
    if (of_all.empty()) return true;
    for (const std::string& name : reader.names(kind)) {
      if (!value.emplace(name, of_all.mapped()).second) continue;
      reader.came_from(below(source.path, name), below(source.path, all));
    }
    return true;
  });
}

// The one of several forms that fits what is written; `which` says as which of them a value is written.
template <class T>
Form<T> either(const std::vector<Form<T>>& kinds, const std::function<std::size_t(const T&)>& which) {
  std::vector<Option> members;
  for (const Form<T>& kind : kinds) members.push_back(kind.option);
  return {option_of(Type::either, std::move(members)),
          [kinds](const Source& source, T& value) {
            const std::optional<std::size_t> found = source.reader.either(source);
            return found && kinds[*found].read(source.reader, source.node, source.path, value);
          },
          [kinds, which](const T& value) { return kinds[which(value)].write(value); }};
}

// A word that stands for no value, or one.
template <class T>
Form<std::optional<T>> word_or(const std::string& word, const std::string& text, const Form<T>& form) {
  using Maybe = std::optional<T>;
  const Form<Maybe> none = mapped<Maybe>(
      choice<bool>({{word, true, text}}), [](bool) { return Maybe(); }, [](const Maybe&) { return true; });
  return either<Maybe>({none, maybe(form)}, [](const Maybe& value) { return value ? 1 : 0; });
}

// An alternative of a std::variant; of another one the value is absent.
template <class Variant, class T>
Form<Variant> as(const Form<T>& form) {
  return mapped<Variant>(
      form, [](const T& value) { return Variant(value); }, [](const Variant& value) { return std::get_if<T>(&value); });
}

} // namespace pneuma::pipeline::schema
