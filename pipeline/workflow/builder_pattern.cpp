// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>

#include "pipeline/workflow/builder.h"

namespace pneuma::pipeline::workflow {

using schema::number_of;
using schema::optional_integer;
using schema::text_of;

PatternSettings Builder::pattern_of(const Value& stage, const std::string& path) {
  PatternSettings out;
  out.strips_per_foil = optional_integer(stage, "strips_per_foil");
  if (const Value* roll = stage["roll"]) {
    out.roll = roll_of(*roll);
    out.roll_given = true;
  }
  if (const Value* foils = stage["foils"]) out.foils = foils_to_cut(*foils);
  if (text_of(stage, "lines") == "straight") out.lines = CuttingLines::straight;
  if (text_of(stage, "chosen_by") == "waste") out.chosen_by = ChosenBy::waste;
  const Value* direction = stage["direction"];
  if (direction != nullptr && direction->text != "auto") out.direction = direction->number;
  if (const Value* curves = stage.find("curves")) {
    for (const char* key : {"lines", "direction", "chosen_by"}) {
      refuse(stage, key, "has no effect beside `curves`, which are the seams themselves");
    }
    out.curves = curves_of(*curves, path, out.foils);
  } else if (out.direction) {
    refuse(stage, "chosen_by", "has no effect beside a given `direction`: it chooses among directions");
  }
  out.compensation = compensation_of(stage);
  out.decompensation = number_of(stage, "decompensation");
  if (const Value* allowance = stage["allowance"]) {
    out.clamp_allowance = number_of(*allowance, "clamp", out.clamp_allowance);
    out.notch_spacing = number_of(*allowance, "notches", out.notch_spacing);
  }
  return out;
}

Roll Builder::roll_of(const Value& roll) {
  const Roll out{number_of(roll, "width"), number_of(roll, "weld"), number_of(roll, "selvedge")};
  if (out.width > 0 && out.weld + 2 * out.selvedge >= out.width) {
    fail(roll.mark, fmt::format("the `weld` and two times the `selvedge` ({} m) leave nothing of the `width` {} m; it "
                                "must be larger than they are together",
                                out.weld + 2 * out.selvedge, out.width));
  }
  return out;
}

Compensation Builder::compensation_of(const Value& stage) {
  Compensation out;
  const Value* value = stage["compensation"];
  if (value == nullptr) return out;
  if (!value->members.empty()) {
    out = {Compensation::Kind::given, number_of(*value, "warp"), number_of(*value, "weft"), 0};
  } else if (value->text == "elastic") {
    out.kind = Compensation::Kind::elastic;
    out.creep = number_of(stage, "creep");
  }
  if (out.kind != Compensation::Kind::elastic) {
    refuse(stage, "creep", "is for `compensation: elastic`, to which it is added");
  }
  if (out.kind == Compensation::Kind::none) {
    refuse(stage, "decompensation", "is for `compensation: elastic` or {warp: ..., weft: ...}, which it lets fade in");
  }
  return out;
}

std::vector<std::string> Builder::foils_to_cut(const Value& foils) {
  std::vector<std::string> out;
  for (const Value& foil : foils.items) {
    if (std::find(foil_names_.begin(), foil_names_.end(), foil.text) == foil_names_.end()) {
      if (!foil_names_.empty()) fail_unknown_foil(foil.mark, foil.text);
    } else if (std::find(out.begin(), out.end(), foil.text) != out.end()) {
      fail(foil.mark, fmt::format("the foil `{}` stands here a second time", foil.text));
    } else {
      out.push_back(foil.text);
    }
  }
  return out;
}

std::map<std::string, PlanCurves> Builder::curves_of(const Value& table, const std::string& path,
                                                     const std::vector<std::string>& foils) {
  std::map<std::string, PlanCurves> out;
  if (table.read_as != nullptr && table.members.empty()) {
    fail(table.mark, "`curves` is empty; name a foil, or use `all`: {all: [[[0 m, -1 m], [0 m, 1 m]]]}");
  }
  const Value* all = table.find(all_foils);
  for (const std::string& foil : foils.empty() ? foil_names_ : foils) {
    const Value* own = table.find(foil);
    const Value* used = own != nullptr ? own : all;
    // which foils are flat and need no curves only the stage knows; those it is told to cut do
    if (used == nullptr && !foils.empty() && !table.members.empty()) {
      fail(table.mark,
           fmt::format("`curves` says nothing about the foil `{}` of `foils`; name it, or use `all`", foil));
    }
    if (used == nullptr || !used->valid) continue;
    for (const Value& curve : used->items) {
      std::vector<base::Vec2>& points = out[foil].emplace_back();
      for (const Value& point : curve.items) points.push_back(vec2_of(point));
    }
    if (own == nullptr) copy_origin(path + ".curves.all", path + ".curves." + foil);
  }
  for (const auto& [name, value] : table.members) {
    if (name == all_foils || foil_names_.empty()) continue;
    if (std::find(foil_names_.begin(), foil_names_.end(), name) == foil_names_.end()) {
      fail_unknown_foil(value.key, name);
    } else if (!foils.empty() && std::find(foils.begin(), foils.end(), name) == foils.end()) {
      fail(value.key, fmt::format("`foils` does not name `{}`, so its curves have no effect; foils to be cut: {}", name,
                                  fmt::join(foils, ", ")));
    }
  }
  return out;
}

} // namespace pneuma::pipeline::workflow
