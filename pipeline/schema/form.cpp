// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/form.h"

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::schema {

Node list_of(std::vector<Node> items) {
  Node node;
  node.kind = NodeKind::list;
  node.items = std::move(items);
  return node;
}

namespace {

// A form of what a function of the reader reads.
template <class T, class Found, class Write>
Form<T> scalar_form(Type type, std::optional<Found> (Reader::*read)(const Source&), const Write& write) {
  return {option_of(type),
          [read](const Source& source, T& value) {
            const std::optional<Found> found = (source.reader.*read)(source);
            if (found) value = static_cast<T>(*found);
            return found.has_value();
          },
          write};
}

Node number_node(double value) {
  return scalar(fmt::format("{}", value));
}

} // namespace

Form<double> quantity(const std::string& unit) {
  auto form = scalar_form<double>(Type::quantity, &Reader::number,
                                  [unit](double value) { return scalar(quantity_text(value, unit)); });
  form.option.unit = unit;
  return form;
}

Form<double> number() {
  return scalar_form<double>(Type::number, &Reader::number, number_node);
}

Form<int> integer() {
  return scalar_form<int>(Type::integer, &Reader::number, [](int value) { return number_node(value); });
}

Form<bool> flag() {
  return scalar_form<bool>(Type::flag, &Reader::flag, [](bool value) { return scalar(value ? "on" : "off"); });
}

Form<std::string> text() {
  return scalar_form<std::string>(Type::text, &Reader::text, scalar);
}

Form<std::string> word() {
  return scalar_form<std::string>(Type::name, &Reader::text, scalar);
}

Form<std::string> name_of_a(const std::string& kind, const std::vector<std::string>& reserved) {
  const auto fault = [kind, reserved](const std::string& name) {
    if (!is_among(name, reserved)) return std::string();
    return fmt::format("a {} cannot be called `{}`: the word has a meaning of its own", kind, name);
  };
  return word().judged(fault).defines(kind, [](const std::string& name) { return std::vector{name}; });
}

Form<std::string> reference_to(const std::string& kind, const std::string& other) {
  return word().and_then([kind, other](const Source& source, const std::string& name) {
    if (other.empty() || name != other) source.reader.refer(kind, name, source.node.mark);
    return true;
  });
}

} // namespace pneuma::pipeline::schema
