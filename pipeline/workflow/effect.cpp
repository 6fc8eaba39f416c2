// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/effect.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/stages.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::below;

// What the foils' laws do beside stretching: whether one flows with time, whether one yields at all.
struct Flow {
  bool with_time = false, at_all = false;
};

// None: a foil's material is not known.
std::optional<Flow> flow_of(const Workflow& workflow) {
  Flow flow;
  for (const FoilSettings& foil : workflow.cushion.foils) {
    const auto material = workflow.materials.find(foil.material);
    if (material == workflow.materials.end()) return {};
    const auto* law = std::get_if<J2Law>(&material->second.law);
    flow.at_all = flow.at_all || law != nullptr;
    flow.with_time = flow.with_time || (law != nullptr && law->viscosity);
  }
  return flow;
}

void check_time(Reader& reader, const At<PathSettings>& path, const Flow& flow) {
  const std::string duration = below(path.path, "duration"), history = path[&PathSettings::history].path;
  if (reader.given(duration) && !flow.with_time) {
    reader.fail_key(duration, fmt::format("{} has no effect: no foil flows with time (`law: j2` with `viscosity` does)",
                                          reader.title(duration)));
  }
  if (reader.given(history) && !flow.at_all) {
    reader.fail_key(history,
                    fmt::format("{} has no effect: the foils are elastic, and only what acts in the end counts "
                                "(`law: j2` remembers; say the end in `factors`)",
                                reader.title(history)));
  }
}

bool changes(const Load& load) {
  if (const auto* wind = std::get_if<WindLoad>(&load.kind)) return wind->pressure != 0;
  if (const auto* snow = std::get_if<SnowLoad>(&load.kind)) return snow->weight != 0;
  return !std::get<PatchLoad>(load.kind).force.isZero(0);
}

bool changes(const Gas& gas) {
  if (const auto* regulated = std::get_if<RegulatedGas>(&gas)) return regulated->gauge_pressure.has_value();
  if (const auto* closed = std::get_if<ClosedGas>(&gas)) return closed->temperature || closed->ambient_pressure;
  return true;
}

// Whether anything acts, leaves, or flows.
bool changes(const WindSettings& wind, const Flow& flow) {
  const auto is_own = [&](const std::string& name) {
    return std::any_of(wind.loads.begin(), wind.loads.end(), [&](const Load& load) { return load.name == name; });
  };
  const auto& history = wind.history;
  if (flow.with_time && !history.empty()) return true;
  if (!history.empty() && std::all_of(history.begin(), history.end(), [](const Moment& m) { return m.factor == 0; })) {
    return false;
  }
  return std::any_of(wind.loads.begin(), wind.loads.end(),
                     [&](const Load& load) { return changes(load) && wind.factors.at(load.name) != 0; }) ||
         std::any_of(wind.factors.begin(), wind.factors.end(),
                     [&](const auto& factor) { return !is_own(factor.first) && factor.second != 1; }) ||
         std::any_of(wind.gas.begin(), wind.gas.end(), [](const auto& gas) { return changes(gas.second); });
}

// The key of a stage that changes nothing at which that is best told.
std::string idle_key(const Reader& reader, const At<WindSettings>& wind) {
  const auto loads = wind[&WindSettings::loads];
  for (const At<Load>& load : items(loads)) {
    for (const char* kind : {"wind", "snow", "patch.force"}) {
      const std::string path = below(load.path, kind);
      if (reader.given(path) && !changes(load.value)) return path;
    }
  }
  for (const std::string& path : {wind[&WindSettings::factors].path, wind[&WindSettings::history].path, loads.path}) {
    if (reader.given(path)) return path;
  }
  return wind.path;
}

// Whether the strips that a stage cuts of a foil replace its warp direction; false where only the form shows it.
bool cuts(const Workflow& workflow, const PatternSettings& pattern, const StageSettings& form, std::size_t foil) {
  const Cushion& cushion = workflow.cushion;
  const std::string& name = cushion.foils[foil].name;
  if (pattern.foils) return schema::is_among(name, *pattern.foils);
  if (!pattern.curves.empty()) return pattern.curves.contains(name);
  const auto* settings = std::get_if<FormfindSettings>(&form.settings);
  if (settings == nullptr) return false;
  double push = 0; // between the foil's sides, Pa
  for (const ChamberSettings& chamber : cushion.chambers) {
    const auto pressure = settings->gauge_pressure.find(chamber.name);
    if (pressure == settings->gauge_pressure.end()) continue;
    if (chamber.between[0] == name) push += pressure->second;
    if (chamber.between[1] == name) push -= pressure->second;
  }
  return push != 0;
}

const StageSettings* find(const Workflow& workflow, const std::string& id) {
  const auto found = std::find_if(workflow.stages.begin(), workflow.stages.end(),
                                  [&](const StageSettings& stage) { return stage.id == id; });
  return found == workflow.stages.end() ? nullptr : &*found;
}

// The pattern stage that cuts a foil before another stage comes to it; none: it is as the cushion has it.
const StageSettings* cut_before(const Workflow& workflow, const StageSettings& stage, std::size_t foil) {
  for (const StageSettings* at = &stage; at != nullptr; at = find(workflow, at->from)) {
    const auto* pattern = std::get_if<PatternSettings>(&at->settings);
    const StageSettings* form = find(workflow, at->from);
    if (pattern != nullptr && form != nullptr && cuts(workflow, *pattern, *form, foil)) return at;
  }
  return nullptr;
}

void check_warp(Reader& reader, const Workflow& workflow) {
  for (std::size_t foil = 0; foil < workflow.cushion.foils.size(); ++foil) {
    const std::string warp = fmt::format("cushion.foils.{}.warp", foil);
    if (!reader.given(warp)) continue;
    const StageSettings* cut = nullptr;
    bool acts = false;
    for (const StageSettings& stage : workflow.stages) {
      const StageSettings* before = cut_before(workflow, stage, foil);
      if (before != nullptr) cut = before;
      acts = acts || (before == nullptr && (stage.run == "inflate" || stage.run == "wind"));
    }
    if (cut == nullptr || acts) continue;
    reader.fail_key(warp,
                    fmt::format("{} has no effect: the strips that `{}` cuts have their own, along the roll; leave "
                                "it out",
                                reader.title(warp), cut->id));
  }
}

} // namespace

void check_effects(Reader& reader, const Workflow& workflow) {
  const std::optional<Flow> flow = flow_of(workflow);
  for (const StageSettings& stage : workflow.stages) {
    if (!flow) break;
    if (const auto* inflate = std::get_if<InflateSettings>(&stage.settings)) {
      check_time(reader, At<PathSettings>{*inflate, path_of(stage)}, *flow);
    }
    const auto* wind = std::get_if<WindSettings>(&stage.settings);
    if (wind == nullptr) continue;
    check_time(reader, At<PathSettings>{*wind, path_of(stage)}, *flow);
    if (changes(*wind, *flow)) continue;
    const std::string idle = idle_key(reader, {*wind, path_of(stage)});
    reader.fail_key(idle,
                    fmt::format("{}: `{}` changes nothing: no load acts, none of a stage before changes its factor, "
                                "and every gas stays as it is; give `loads`, `factors` or `gas`",
                                reader.title(idle), stage.id));
  }
  if (!reader.is_stage_file()) check_warp(reader, workflow);
}

} // namespace pneuma::pipeline::workflow
