// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/stages.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/circles.h"
#include "pipeline/workflow/effect.h"
#include "pipeline/workflow/in_plan.h"

namespace pneuma::pipeline::workflow {

using schema::below;
using yaml::Node;

std::string path_of(const StageSettings& stage) {
  return stage.run == "mesh" ? "mesh" : "stages." + stage.id;
}

namespace {

template <class S>
schema::Keys<StageSettings> keys_of_stage(bool is_stage_file) {
  schema::Keys<StageSettings> keys;
  keys("from", &StageSettings::from, word(), "the stage it starts from");
  if (is_stage_file) keys("from_run", &StageSettings::from_run, word(), "kind of the stage it starts from");
  keys.alternative(schema::keys_of<S>(), &StageSettings::settings);
  return keys;
}

} // namespace

Form<StageSettings> stage_form(bool is_stage_file) {
  return schema::tagged<StageSettings>(
      "run", {keys_of_stage<FormfindSettings>(is_stage_file), keys_of_stage<PatternSettings>(is_stage_file),
              keys_of_stage<InflateSettings>(is_stage_file), keys_of_stage<WindSettings>(is_stage_file)});
}

namespace {

std::string text_of(const Node& map, const char* key) {
  const Node* value = yaml::find(map, key);
  return value != nullptr ? value->text : "";
}

std::vector<std::string> starts_of(const std::string& run) {
  if (run == "formfind") return {"mesh"};
  if (run == "pattern") return {"formfind"};
  if (run == "inflate") return {"mesh", "formfind", "pattern"};
  return {"inflate", "wind"};
}

} // namespace

void link(Reader& reader, const Node& written, std::vector<StageSettings>& stages) {
  if (reader.is_stage_file()) return;
  std::map<std::string, std::string> runs = {{"mesh", "mesh"}}, froms; // of stages with faults too
  std::vector<std::string> ids = {"mesh"};
  for (const yaml::Entry& entry : written.entries) {
    if (entry.key == "mesh") {
      reader.fail(entry.mark,
                  "a stage cannot be called `mesh`: this is the stage that the key `mesh` at the top level makes");
      continue;
    }
    runs[entry.key] = text_of(entry.value, "run");
    froms[entry.key] = text_of(entry.value, "from");
    ids.push_back(entry.key);
  }
  std::set<std::string> in_circle;
  for (const std::vector<std::string>& circle : circles(ids, froms)) {
    in_circle.insert(circle.begin(), circle.end());
    reader.spoil("stages");
    reader.fail(
        "stages." + circle.front() + ".from",
        fmt::format("`from` goes in a circle: {}; a chain of stages begins at mesh", fmt::join(circle, " <- ")));
  }
  for (const auto& [id, from] : froms) {
    if (from.empty() || runs.contains(from) || !reader.is_whole("stages." + id + ".from")) continue;
    const auto others = schema::others(ids, id);
    reader.fail("stages." + id + ".from", fmt::format("there is no stage `{}`{}; stages: {}", from,
                                                      schema::suggestion(from, others), schema::joined(others)));
  }
  for (StageSettings& stage : stages) {
    const auto from = runs.find(stage.from);
    if (stage.run == "mesh" || from == runs.end() || in_circle.contains(stage.id)) continue;
    stage.from_run = from->second;
    const std::vector<std::string> allowed = starts_of(stage.run);
    const bool is_known = schema::is_among(stage.from_run, {"mesh", "formfind", "pattern", "inflate", "wind"});
    if (!is_known || schema::is_among(stage.from_run, allowed)) continue;
    reader.fail(path_of(stage) + ".from",
                fmt::format("`run: {}` cannot start from `{}` (`run: {}`); it starts from: {}", stage.run, stage.from,
                            stage.from_run, schema::joined(allowed)));
  }
}

namespace {

// Chambers that have an air of their own.
std::vector<std::string> airs_of(const Cushion& cushion) {
  std::vector<std::string> airs;
  for (const ChamberSettings& chamber : cushion.chambers) {
    if (cushion.air_of(chamber.name) == chamber.name) airs.push_back(chamber.name);
  }
  return airs;
}

// {CHAMBER: ...} says something about every chamber that has an air of its own; the others have the pressure of those
// they are connected to.
void settle_pressures(Reader& reader, const Cushion& cushion, std::map<std::string, double>& pressures,
                      const std::string& path) {
  for (const ChamberSettings& chamber : cushion.chambers) {
    const std::string &air = cushion.air_of(chamber.name), own_path = below(path, chamber.name);
    const auto own = pressures.find(chamber.name), shared = pressures.find(air);
    if (air == chamber.name && own == pressures.end()) {
      const auto sharing = std::find_if(pressures.begin(), pressures.end(),
                                        [&](const auto& one) { return cushion.air_of(one.first) == chamber.name; });
      reader.fail(path,
                  fmt::format("{} says nothing about the chamber `{}`; {}", reader.title(path), chamber.name,
                              sharing == pressures.end()
                                  ? "0 Pa leaves it empty"
                                  : fmt::format("`{}` is connected to it and takes its pressure", sharing->first)));
    }
    if (shared == pressures.end()) continue;
    if (own == pressures.end()) reader.came_from(own_path, below(path, air));
    // 0.4 kPa and 400 Pa may differ in the last bit
    if (own == pressures.end() || std::abs(own->second - shared->second) <= 1e-12 * std::abs(shared->second)) {
      pressures[chamber.name] = shared->second;
      continue;
    }
    reader.fail(own_path, fmt::format("`{}` is connected to `{}` and has its pressure, {}, not {}; leave it out",
                                      chamber.name, air, reader.written(below(path, air)), reader.written(own_path)));
  }
}

void check_mesh(Reader& reader, const Cushion& cushion, const At<MeshSettings>& mesh) {
  const bool is_triangle = std::holds_alternative<geometry::Triangle>(cushion.plan);
  const bool is_polygon = std::holds_alternative<geometry::Polygon>(cushion.plan);
  if (mesh->divisions && (is_triangle || is_polygon) && (*mesh->divisions)[0] != (*mesh->divisions)[1]) {
    reader.fail(mesh[&MeshSettings::divisions].path,
                is_triangle ? "a triangle has one number of `divisions`, along each side"
                            : "a polygon has one number of `divisions`, along its longest side");
  }
  if (mesh->pattern == MeshPattern::structured && is_polygon) {
    reader.fail(mesh[&MeshSettings::pattern].path, "a polygon has no structured pattern; allowed: unstructured");
  }
}

void check_inflate(Reader& reader, const StageSettings& stage, const At<InflateSettings>& inflate) {
  const std::string reference = inflate[&InflateSettings::reference].path;
  const std::string prestress = inflate[&InflateSettings::prestress].path;
  if (stage.from_run == "formfind") {
    if (!inflate->reference) {
      reader.fail(inflate.path, "from a formfind stage, " + schema::name(&InflateSettings::reference) +
                                    " must say what the found form is: prestressed or stress_free");
    }
    if (inflate->prestress) {
      reader.fail_key(prestress, reader.title(prestress) +
                                     " is for a start from mesh; from a formfind stage use `reference: prestressed`");
    }
  } else if (stage.from_run == "pattern") {
    for (const std::string& path : {reference, prestress}) {
      if (!reader.given(path)) continue;
      reader.fail_key(path, reader.title(path) + " cannot stand beside a start from a pattern stage: the flat strips "
                                                 "are the reference; leave it out");
    }
  } else if (stage.from_run == "mesh" && inflate->reference) {
    reader.fail_key(reference, reader.title(reference) +
                                   " is for a start from a formfind stage; from mesh the flat plan is the reference");
  }
}

// The foil or chamber of a control is named where there are several.
void settle_name(Reader& reader, const std::string& control, const std::string& key,
                 const std::vector<std::string>& known, std::string& name) {
  if (!name.empty()) return;
  if (known.size() == 1) {
    name = known.front();
    return;
  }
  reader.fail(control, known.empty()
                           ? fmt::format("the cushion has no {} whose air could be controlled", key)
                           : fmt::format("`control` lacks the key `{0}`; {0}s: {1}", key, schema::joined(known)));
}

void settle_path(Reader& reader, const Cushion& cushion, PathSettings& path, const std::string& at,
                 const std::map<std::string, Gas>& gas) {
  const std::string control = At<PathSettings>{path, at}[&PathSettings::control].path;
  std::vector<Moment>& history = path.history;
  if (!history.empty() && history.front().time == 0 && history.front().factor == 0) {
    history.erase(history.begin()); // the beginning, said
  }
  auto* displacement = std::get_if<DisplacementControl>(&path.control);
  if (displacement != nullptr && reader.knows("foil")) {
    settle_name(reader, control, "foil", reader.names("foil"), displacement->foil);
  }
  const std::vector<std::string> airs = airs_of(cushion);
  auto* arc = std::get_if<ArcLengthControl>(&path.control);
  if (arc != nullptr && arc->needs_chamber() && !arc->chamber) {
    settle_name(reader, control, "chamber", airs, arc->chamber.emplace());
  }
  auto* volume = std::get_if<VolumeControl>(&path.control);
  if (volume == nullptr) return;
  settle_name(reader, control, "chamber", airs, volume->chamber);
  const auto law = gas.find(cushion.air_of(volume->chamber));
  if (law == gas.end() || std::holds_alternative<RegulatedGas>(law->second)) return;
  reader.fail(below(control, "chamber"),
              fmt::format("the volume of `{}` cannot be controlled: its gas (`law: {}`) decides it; allowed: regulated",
                          law->first, std::holds_alternative<ClosedGas>(law->second) ? "closed" : "volume"));
}

void check_loaded_foil(Reader& reader, const Cushion& cushion, const At<Load>& load) {
  const std::vector<std::string>& foils = reader.names("foil");
  const auto found = std::find(foils.begin(), foils.end(), load->foil);
  if (found == foils.end() || found == foils.begin() || !reader.knows("foil")) return;
  const std::string path = load[&Load::foil].path;
  if (std::holds_alternative<SnowLoad>(load->kind)) {
    reader.warn(path, fmt::format("snow on `{}`, which is not the weather side; is it meant?", load->foil));
  }
  if (!std::holds_alternative<WindLoad>(load->kind)) return;
  if (found + 1 != foils.end()) {
    reader.fail(path, fmt::format("wind cannot reach the middle foil `{}`; it acts on the first or the last: {}, {}",
                                  load->foil, foils.front(), foils.back()));
  } else if (cushion.rigid_base) {
    reader.fail(path, fmt::format("wind cannot reach `{}` in front of the rigid base; it acts on {}", load->foil,
                                  foils.front()));
  }
}

// What a stage says about foils, chambers and edges; what a user left open is put in place.
void settle(Reader& reader, const Workflow& workflow, const StageSettings& stage, const MeshSettings& mesh) {
  if (!reader.given("cushion.plan") || !reader.is_whole("cushion.plan")) return;
  check_mesh(reader, workflow.cushion, {mesh, path_of(stage)});
  if (reader.is_whole("cushion")) check_in_plan(reader, workflow.cushion, {mesh, path_of(stage)});
}

void settle(Reader& reader, const Workflow& workflow, const StageSettings& stage, FormfindSettings& form) {
  if (!reader.is_whole("cushion")) return;
  const std::string path = path_of(stage);
  const At<FormfindSettings> at{form, path};
  settle_pressures(reader, workflow.cushion, form.gauge_pressure, at[&FormfindSettings::gauge_pressure].path);
  if (!form.stress) return;
  reader.came_from(at[&FormfindSettings::prestress].path, at[&FormfindSettings::stress].path);
  for (const FoilSettings& foil : workflow.cushion.foils) {
    form.prestress[foil.name] = (*form.stress)[foil.name] * foil.thickness;
  }
  form.stress.reset();
}

// Which foils are flat and need no curves only the stage knows; those it is told to cut do.
void settle_curves(Reader& reader, const At<PatternSettings>& pattern, std::map<std::string, PlanCurves>& curves) {
  if (!pattern->foils || curves.empty() || !reader.knows("foil")) return;
  const std::vector<std::string>& cut = *pattern->foils;
  const std::string path = pattern[&PatternSettings::curves].path;
  for (const std::string& foil : cut) {
    if (curves.contains(foil) || !schema::is_among(foil, reader.names("foil"))) continue;
    reader.fail(path, fmt::format("{} says nothing about the foil `{}` of {}; name it, or use `all`",
                                  reader.title(path), foil, schema::name(&PatternSettings::foils)));
  }
  std::erase_if(curves, [&](const auto& one) {
    if (schema::is_among(one.first, cut)) return false;
    const std::string own = below(path, one.first);
    if (!reader.given(own)) return true; // of all
    reader.fail_key(own, fmt::format("{} does not name `{}`, so its curves have no effect; foils to be cut: {}",
                                     schema::name(&PatternSettings::foils), one.first, fmt::join(cut, ", ")));
    return true;
  });
}

void settle(Reader& reader, const Workflow& workflow, const StageSettings& stage, PatternSettings& pattern) {
  const At<PatternSettings> at{pattern, path_of(stage)};
  settle_curves(reader, at, pattern.curves);
  if (!reader.is_whole("cushion")) return;
  check_in_plan(reader, workflow.cushion.plan, at, std::get_if<MeshSettings>(&workflow.stages.front().settings));
}

void settle(Reader& reader, const Workflow& workflow, const StageSettings& stage, InflateSettings& inflate) {
  const std::string path = path_of(stage);
  const At<InflateSettings> at{inflate, path};
  check_inflate(reader, stage, at);
  if (!reader.is_whole("cushion")) return;
  settle_pressures(reader, workflow.cushion, inflate.gauge_pressure, at[&InflateSettings::gauge_pressure].path);
  settle_path(reader, workflow.cushion, inflate, path, {});
  check_in_plan(reader, workflow.cushion.plan, At<PathSettings>(at));
}

void settle(Reader& reader, const Workflow& workflow, const StageSettings& stage, WindSettings& wind) {
  if (!reader.is_whole("cushion")) return;
  const Cushion& cushion = workflow.cushion;
  const std::string path = path_of(stage);
  const At<WindSettings> at{wind, path};
  const auto gas = at[&WindSettings::gas];
  for (const auto& [chamber, law] : gas.value) {
    const std::string& air = cushion.air_of(chamber);
    if (air == chamber) continue;
    reader.fail_key(
        gas.at(law, chamber).path,
        fmt::format("`{}` is connected to `{}` and has no air of its own; say the law of `{}`", chamber, air, air));
  }
  for (const At<Load>& load : items(at[&WindSettings::loads])) check_loaded_foil(reader, cushion, load);
  check_in_plan(reader, cushion.plan, at);
  for (const std::string& air : airs_of(cushion)) wind.gas.emplace(air, RegulatedGas{});
  for (const Load& load : wind.loads) wind.factors.emplace(load.name, 1);
  settle_path(reader, cushion, wind, path, wind.gas);
}

// The loads that act when a stage begins are those of the wind stages before it. Stages by their number.
class LoadsBefore {
public:
  LoadsBefore(Reader& reader, const std::vector<StageSettings>& stages)
      : reader_(reader), stages_(stages), before_(stages.size(), none) {
    std::map<std::string, std::size_t> winds;
    for (std::size_t i = 0; i < stages.size(); ++i) {
      if (stages[i].run != "wind") continue;
      winds[stages[i].id] = i;
      for (const Load& load : wind(i).loads) with_[load.name].push_back(i);
    }
    for (const auto& [id, i] : winds) {
      if (const auto found = winds.find(stages[i].from); found != winds.end()) before_[i] = found->second;
    }
  }

  void check(std::size_t i) const {
    const At<WindSettings> at{wind(i), path_of(stages_[i])};
    for (const At<Load>& load : items(at[&WindSettings::loads])) {
      const std::size_t since = last_with(load->name, before_[i]);
      if (since == none) continue;
      reader_.fail(load.path, fmt::format("load `{}` acts since stage `{}`: to change it give its factor in {}, "
                                          "or choose another name",
                                          load->name, stages_[since].id, schema::name(&WindSettings::factors)));
    }
    // in stage.yaml the stage itself knows the names of the state that it starts from
    if (reader_.is_stage_file() && stages_[i].from_run == "wind") return;
    const auto factors = at[&WindSettings::factors];
    for (const auto& [name, factor] : factors.value) {
      if (last_with(name, i) != none) continue;
      std::vector<std::string> names;
      for (std::size_t k = i; k != none; k = before_[k]) {
        for (const Load& load : wind(k).loads) names.push_back(load.name);
      }
      reader_.fail_key(factors.at(factor, name).path,
                       fmt::format("there is no load `{}`{}; loads: {}", name, schema::suggestion(name, names),
                                   schema::joined(names)));
    }
  }

private:
  static constexpr auto none = static_cast<std::size_t>(-1);

  const WindSettings& wind(std::size_t i) const { return std::get<WindSettings>(stages_[i].settings); }

  // Of a stage and those before it the last that has a load of this name.
  std::size_t last_with(const std::string& load, std::size_t i) const {
    const auto found = with_.find(load);
    if (found == with_.end()) return none;
    while (i != none && !std::binary_search(found->second.begin(), found->second.end(), i)) i = before_[i];
    return i;
  }

  Reader& reader_;
  const std::vector<StageSettings>& stages_;
  std::vector<std::size_t> before_;                      // the wind stage that one starts from
  std::map<std::string, std::vector<std::size_t>> with_; // load -> stages that have one of its name
};

} // namespace

void settle(Reader& reader, Workflow& workflow) {
  Cushion& cushion = workflow.cushion;
  for (const std::string& edge : reader.names("edge")) cushion.edges.emplace(edge, "clamped");
  for (ChamberSettings& chamber : cushion.chambers) {
    const auto& foils = reader.names("foil");
    const auto at = [&](const std::string& wall) { return std::find(foils.begin(), foils.end(), wall); };
    auto& [first, second] = chamber.between;
    if (at(second) < at(first)) std::swap(first, second);
  }
  for (StageSettings& stage : workflow.stages) {
    std::visit([&](auto& settings) { settle(reader, workflow, stage, settings); }, stage.settings);
  }
  if (!reader.is_whole("stages")) return;
  if (reader.is_whole("cushion")) check_effects(reader, workflow);
  const LoadsBefore loads(reader, workflow.stages);
  for (std::size_t i = 0; i < workflow.stages.size(); ++i) {
    if (workflow.stages[i].run == "wind") loads.check(i);
  }
}

} // namespace pneuma::pipeline::workflow
