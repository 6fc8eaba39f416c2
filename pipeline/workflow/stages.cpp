// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/stages.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/circles.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::below;
using yaml::Node;

std::string path_of(const StageSettings& stage) {
  return stage.run == "mesh" ? "mesh" : "stages." + stage.id;
}

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
    const std::vector<std::string> known = {"mesh", "formfind", "pattern", "inflate", "wind"};
    const std::vector<std::string> allowed = starts_of(stage.run);
    const auto is_in = [&](const std::vector<std::string>& list) {
      return std::find(list.begin(), list.end(), stage.from_run) != list.end();
    };
    if (!is_in(known) || is_in(allowed)) continue;
    reader.fail(path_of(stage) + ".from",
                fmt::format("`run: {}` cannot start from `{}` (`run: {}`); it starts from: {}", stage.run, stage.from,
                            stage.from_run, schema::joined(allowed)));
  }
}

namespace {

// {FOIL or all: ...} says something about every foil.
template <class V>
void check_foils(Reader& reader, const std::map<std::string, V>& table, const std::string& path) {
  const std::vector<std::string>& foils = reader.names("foil");
  const auto is_stranger = [&](const auto& entry) { // which is told, and perhaps one of them was meant
    return std::find(foils.begin(), foils.end(), entry.first) == foils.end();
  };
  if (table.empty() || table.contains(all) || !reader.knows("foil") ||
      std::any_of(table.begin(), table.end(), is_stranger))
    return;
  for (const std::string& foil : foils) {
    if (table.contains(foil)) continue;
    reader.fail(path,
                fmt::format("{} says nothing about the foil `{}`; name it, or use `all`", reader.title(path), foil));
  }
}

// {CHAMBER: ...} says something about every chamber that has an air of its own, and nothing else about the others.
void check_pressures(Reader& reader, const Cushion& cushion, const std::map<std::string, double>& pressures,
                     const std::string& path) {
  for (const ChamberSettings& chamber : cushion.chambers) {
    const std::string& air = cushion.air_of(chamber.name);
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
    if (air == chamber.name || own == pressures.end() || shared == pressures.end()) continue;
    // 0.4 kPa and 400 Pa may differ in the last bit
    if (std::abs(own->second - shared->second) <= 1e-12 * std::abs(shared->second)) continue;
    reader.fail(below(path, chamber.name),
                fmt::format("`{}` is connected to `{}` and has its pressure, {}, not {}; leave it out", chamber.name,
                            air, reader.written(below(path, air)), reader.written(below(path, chamber.name))));
  }
}

// Chambers that have an air of their own.
std::vector<std::string> airs_of(const Cushion& cushion) {
  std::vector<std::string> airs;
  for (const ChamberSettings& chamber : cushion.chambers) {
    if (cushion.air_of(chamber.name) == chamber.name) airs.push_back(chamber.name);
  }
  return airs;
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
  if (!mesh->size) return;
  const std::string path = mesh[&MeshSettings::size].path;
  const double area = geometry::area(cushion.plan);
  const double elements = area / (*mesh->size * *mesh->size);
  if (elements < 1) {
    reader.warn(path, fmt::format("{} {} m is larger than the cushion (about {:.3g} m); is it meant?",
                                  reader.title(path), *mesh->size, std::sqrt(area)));
  } else if (elements > 500'000) {
    reader.warn(path, fmt::format("{} {} m makes about {:.0e} elements a foil; is it meant?", reader.title(path),
                                  *mesh->size, elements));
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
  if (inflate->prestress) check_foils(reader, *inflate->prestress, prestress);
}

// The foil or chamber that a control must name where there are several.
void check_named(Reader& reader, const std::string& path, const std::string& key,
                 const std::vector<std::string>& known) {
  if (reader.given(below(path, key)) || known.size() == 1) return;
  reader.fail(path, known.empty()
                        ? fmt::format("the cushion has no {} whose air could be controlled", key)
                        : fmt::format("`control` lacks the key `{0}`; {0}s: {1}", key, schema::joined(known)));
}

void check_control(Reader& reader, const Cushion& cushion, const At<PathSettings>& path,
                   const std::map<std::string, Gas>& gas) {
  const std::string control = path[&PathSettings::control].path;
  if (std::holds_alternative<DisplacementControl>(path->control) && reader.knows("foil")) {
    check_named(reader, control, "foil", reader.names("foil"));
  }
  const auto* arc = std::get_if<ArcLengthControl>(&path->control);
  if (arc != nullptr && arc->needs_chamber()) check_named(reader, control, "chamber", airs_of(cushion));
  const auto* volume = std::get_if<VolumeControl>(&path->control);
  if (volume == nullptr) return;
  const std::vector<std::string> airs = airs_of(cushion);
  check_named(reader, control, "chamber", airs);
  const std::string named = reader.written(below(control, "chamber"));
  const std::string air = !named.empty() ? cushion.air_of(named) : airs.size() == 1 ? airs.front() : "";
  const auto law = gas.find(air);
  if (law == gas.end() || std::holds_alternative<RegulatedGas>(law->second)) return;
  reader.fail(below(control, "chamber"),
              fmt::format("the volume of `{}` cannot be controlled: its gas (`law: {}`) decides it; allowed: regulated",
                          air, std::holds_alternative<ClosedGas>(law->second) ? "closed" : "volume"));
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

void check_wind(Reader& reader, const Cushion& cushion, const At<WindSettings>& wind) {
  const auto gas = wind[&WindSettings::gas];
  for (const auto& [chamber, law] : gas.value) {
    const std::string& air = cushion.air_of(chamber);
    if (air == chamber) continue;
    reader.fail_key(
        gas.at(law, chamber).path,
        fmt::format("`{}` is connected to `{}` and has no air of its own; say the law of `{}`", chamber, air, air));
  }
  for (const At<Load>& load : items(wind[&WindSettings::loads])) check_loaded_foil(reader, cushion, load);
}

void check_pattern(Reader& reader, const At<PatternSettings>& pattern) {
  if (!pattern->foils || pattern->curves.empty()) return;
  const std::vector<std::string>& cut = *pattern->foils;
  const auto curves = pattern[&PatternSettings::curves];
  // which foils are flat and need no curves only the stage knows; those it is told to cut do
  for (const std::string& foil : cut) {
    if (curves->contains(foil) || curves->contains(all)) continue;
    reader.fail(curves.path, fmt::format("{} says nothing about the foil `{}` of {}; name it, or use `all`",
                                         reader.title(curves.path), foil, schema::name(&PatternSettings::foils)));
  }
  for (const auto& [foil, lines] : curves.value) {
    if (foil == all || std::find(cut.begin(), cut.end(), foil) != cut.end()) continue;
    reader.fail_key(curves.at(lines, foil).path,
                    fmt::format("{} does not name `{}`, so its curves have no effect; foils to be cut: {}",
                                schema::name(&PatternSettings::foils), foil, fmt::join(cut, ", ")));
  }
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

void check_stages(Reader& reader, const Workflow& workflow) {
  const Cushion& cushion = workflow.cushion;
  const bool cushion_known = reader.is_whole("cushion");
  for (const StageSettings& stage : workflow.stages) {
    const std::string path = path_of(stage);
    if (const auto* form = std::get_if<FormfindSettings>(&stage.settings)) {
      const At<FormfindSettings> at{*form, path};
      check_foils(reader, form->prestress, at[&FormfindSettings::prestress].path);
      if (form->stress) check_foils(reader, *form->stress, at[&FormfindSettings::stress].path);
      if (cushion_known) {
        check_pressures(reader, cushion, form->gauge_pressure, at[&FormfindSettings::gauge_pressure].path);
      }
    } else if (const auto* inflate = std::get_if<InflateSettings>(&stage.settings)) {
      const At<InflateSettings> at{*inflate, path};
      check_inflate(reader, stage, at);
      if (!cushion_known) continue;
      check_pressures(reader, cushion, inflate->gauge_pressure, at[&InflateSettings::gauge_pressure].path);
      check_control(reader, cushion, {*inflate, path}, {});
    } else if (const auto* wind = std::get_if<WindSettings>(&stage.settings)) {
      if (!cushion_known) continue;
      check_wind(reader, cushion, {*wind, path});
      check_control(reader, cushion, {*wind, path}, wind->gas);
    } else if (const auto* pattern = std::get_if<PatternSettings>(&stage.settings)) {
      check_pattern(reader, {*pattern, path});
    } else if (reader.given("cushion.plan") && reader.is_whole("cushion.plan")) {
      check_mesh(reader, cushion, {std::get<MeshSettings>(stage.settings), path});
    }
  }
  if (!reader.is_whole("stages")) return;
  const LoadsBefore loads(reader, workflow.stages);
  for (std::size_t i = 0; i < workflow.stages.size(); ++i) {
    if (workflow.stages[i].run == "wind") loads.check(i);
  }
}

} // namespace pneuma::pipeline::workflow
