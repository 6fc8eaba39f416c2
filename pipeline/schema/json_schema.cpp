// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/json_schema.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/schema/quantity.h"

namespace pneuma::pipeline::schema {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* name_pattern = "^[A-Za-z0-9_-]+$";

Json schema_of(const Option& option);

// Says so of what the program does not offer yet.
std::string refusal(const Option& option) {
  if (option.not_yet.empty()) return "";
  return fmt::format("`{}` is not available yet; {}", option.name, option.not_yet);
}

Json group_of(const Option& option, const std::string& tag) {
  Json json = {{"type", "object"}, {"additionalProperties", false}};
  Json properties = Json::object(), required = Json::array();
  if (!tag.empty()) properties[tag] = {{"const", option.name}};
  for (const Option& member : option.members()) {
    properties[member.name] = schema_of(member);
    if (member.is_required) required.push_back(member.name);
  }
  json["properties"] = std::move(properties);
  if (!required.empty()) json["required"] = std::move(required);
  for (const KeySet& set : option.alternatives) {
    Json one = Json::array(), words = Json::object();
    for (const std::string& key : set.keys) one.push_back({{"required", {key}}});
    if (set.least == 0) {
      words["not"]["required"] = set.keys;
    } else {
      words[set.most == 1 && set.beside.empty() ? "oneOf" : "anyOf"] = std::move(one);
    }
    if (!set.beside.empty()) words["anyOf"].push_back({{"not", {{"required", {set.beside}}}}});
    json["allOf"].push_back(std::move(words));
  }
  return json;
}

void add_limits(const Option& option, Json& json) {
  if (!option.limits) return;
  const Range& range = *option.limits;
  if (std::isfinite(range.min)) json[range.includes_min ? "minimum" : "exclusiveMinimum"] = range.min;
  if (std::isfinite(range.max)) json[range.includes_max ? "maximum" : "exclusiveMaximum"] = range.max;
}

Json body_of(const Option& option) {
  if (!option.not_yet.empty()) return {{"not", Json::object()}}; // nothing fits
  switch (option.type) {
  case Type::text:
    return {{"type", {"string", "number", "boolean"}}};
  case Type::name:
    return {{"type", {"string", "number"}}, {"pattern", name_pattern}};
  case Type::flag:
    return {{"enum", {true, false, "on", "off", "yes", "no"}}};
  case Type::integer:
  case Type::number: {
    Json json = {{"type", option.type == Type::integer ? "integer" : "number"}};
    add_limits(option, json);
    return json;
  }
  case Type::quantity:
    return {{"type", "string"}, {"pattern", R"(^\s*[+-]?[0-9.]+([eE][+-]?[0-9]+)?\s*[^0-9\s].*$)"}};
  case Type::choice: {
    Json names = Json::array();
    for (const Option& allowed : option.members()) {
      if (allowed.not_yet.empty()) names.push_back(allowed.name);
    }
    return {{"enum", std::move(names)}};
  }
  case Type::list: {
    Json json = {{"type", "array"}, {"items", schema_of(option.members().front())}};
    if (option.min_items > 0) json["minItems"] = option.min_items;
    if (option.max_items < std::numeric_limits<std::size_t>::max()) json["maxItems"] = option.max_items;
    return json;
  }
  case Type::group:
    return group_of(option, "");
  case Type::table: {
    Json json = {{"type", "object"},
                 {"propertyNames", {{"pattern", name_pattern}}},
                 {"additionalProperties", schema_of(option.members().front())}};
    if (option.min_items > 0) json["minProperties"] = option.min_items;
    return json;
  }
  case Type::either:
  case Type::variant: {
    Json kinds = Json::array();
    for (const Option& kind : option.members()) {
      const bool is_group = option.type == Type::variant && kind.not_yet.empty();
      Json one = is_group ? group_of(kind, option.tag) : schema_of(kind);
      if (option.type == Type::variant && option.default_value != kind.name) one["required"].push_back(option.tag);
      kinds.push_back(std::move(one));
    }
    return {{"anyOf", std::move(kinds)}};
  }
  }
  return Json::object();
}

Json schema_of(const Option& option) {
  std::string text = option.text;
  if (option.type == Type::quantity) text += "; " + dimension_of(option.unit) + " with its unit";
  if (option.limits) text += ", " + option.limits->words;
  if (!option.not_yet.empty()) text += refusal(option);
  if (option.type == Type::choice) {
    for (const Option& word : option.members()) {
      if (!word.not_yet.empty()) text += "; " + refusal(word);
    }
  }
  Json json = body_of(option);
  Json described = {{"description", text}};
  described.update(json);
  if (!option.default_value.empty() && option.tag.empty()) described["default"] = option.default_value;
  return described;
}

} // namespace

std::string json_schema(const Option& root, const std::string& title) {
  Json json = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  json.update(schema_of(root));
  json["patternProperties"]["^x-"] = {{"description", "a template for anchors and merge keys, read by nobody"}};
  return json.dump(2) + "\n";
}

} // namespace pneuma::pipeline::schema
