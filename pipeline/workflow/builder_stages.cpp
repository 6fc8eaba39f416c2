// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/builder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/options.h"

namespace pneuma::pipeline::workflow {

using schema::number_of;
using schema::optional_integer;
using schema::optional_number;
using schema::suggestion;
using schema::text_of;

void Builder::refuse(const Value& group, const std::string& key, const std::string& reason) {
  const Value* value = group.find(key);
  if (value != nullptr && value->given) fail(value->key, fmt::format("`{}` {}; leave it out", key, reason));
}

void Builder::add_mesh(const Value& mesh) {
  MeshSettings out;
  out.mark = mesh.mark;
  const std::string element = text_of(mesh, "element");
  const std::vector<std::string> names = {"T3", "T6", "Q4", "Q9"};
  const auto found = std::find(names.begin(), names.end(), element);
  if (found != names.end()) out.element = static_cast<geometry::ElementType>(found - names.begin());
  out.size = optional_number(mesh, "size");
  const bool is_polygon = plan_known_ && std::holds_alternative<geometry::Polygon>(workflow_.cushion.plan);
  if (const Value* divisions = mesh["divisions"]) {
    const bool is_pair = !divisions->items.empty();
    const double first = is_pair ? divisions->items[0].number : divisions->number;
    const double second = is_pair ? divisions->items[1].number : divisions->number;
    out.divisions = {static_cast<int>(first), static_cast<int>(second)};
    if (is_pair && plan_known_ && std::holds_alternative<geometry::Triangle>(workflow_.cushion.plan)) {
      fail(divisions->mark, "a triangle has one number of `divisions`, along each side");
    } else if (is_pair && is_polygon) {
      fail(divisions->mark, "a polygon has one number of `divisions`, along its longest side");
    }
    for (const char* end : {"0", "1"}) {
      copy_origin("mesh.divisions", std::string("mesh.divisions.") + end);
    }
  }
  const std::string pattern = text_of(mesh, "pattern");
  if (pattern == "structured" && is_polygon) {
    fail(mesh["pattern"]->mark, "a polygon has no structured pattern; allowed: unstructured");
  }
  if (!pattern.empty()) {
    out.pattern = pattern == "structured" ? MeshPattern::structured : MeshPattern::unstructured;
  }
  if (const Value* rule = mesh["stress_rule"]; rule != nullptr && rule->text == "reduced") {
    out.stress_rule = geometry::StressRule::reduced;
    if (mesh["element"] != nullptr && out.element != geometry::ElementType::Q9) {
      fail(rule->mark, fmt::format("the reduced rule is for Q9, not {}; allowed: full", element));
    }
  }
  check_size(mesh, out);
  StageSettings stage;
  stage.id = stage.run = "mesh";
  stage.mark = mesh.key;
  stage.settings = out;
  workflow_.stages.push_back(std::move(stage));
}

void Builder::check_size(const Value& mesh, const MeshSettings& out) {
  if (!out.size || !plan_known_) return;
  const Mark& mark = mesh["size"]->mark;
  const double area = geometry::area(workflow_.cushion.plan);
  if (!(area > 0)) return; // the plan has errors of its own
  const double elements = area / (*out.size * *out.size);
  if (elements < 1) {
    warn(mark, fmt::format("`size` {} m is larger than the cushion (about {:.3g} m); is it meant?", *out.size,
                           std::sqrt(area)));
  } else if (elements > 500'000) {
    warn(mark, fmt::format("`size` {} m makes about {:.0e} elements a foil; is it meant?", *out.size, elements));
  }
}

std::map<std::string, double> Builder::per_foil(const Value& table, const std::string& path, const std::string& key) {
  std::map<std::string, double> out;
  const Value* all = table[all_foils];
  for (const std::string& foil : foil_names_) {
    const Value* own = table[foil];
    if (const Value* used = own != nullptr ? own : all) out[foil] = used->number;
    copy_origin(path + "." + key + "." + (own != nullptr ? foil : all_foils), path + ".prestress." + foil);
    if (table.find(foil) == nullptr && table.find(all_foils) == nullptr) {
      fail(table.mark, fmt::format("`{}` says nothing about the foil `{}`; name it, or use `all`", key, foil));
    }
  }
  for (const auto& [name, value] : table.members) {
    const bool known = std::find(foil_names_.begin(), foil_names_.end(), name) != foil_names_.end();
    if (!known && name != all_foils && !foil_names_.empty()) fail_unknown_foil(value.key, name);
  }
  return out;
}

void Builder::check_chamber(const Mark& mark, const std::string& name) {
  if (std::find(chamber_names_.begin(), chamber_names_.end(), name) != chamber_names_.end()) return;
  fail(mark, fmt::format("there is no chamber `{}`{}; chambers: {}", name, suggestion(name, chamber_names_),
                         schema::joined(chamber_names_)));
}

std::map<std::string, double> Builder::pressures_of(const Value& stage, const std::string& path) {
  std::map<std::string, double> out;
  const Value* table = stage.find("gauge_pressure");
  if (table == nullptr || table->read_as == nullptr) return out;
  for (const auto& [name, value] : table->members) {
    check_chamber(value.key, name);
    out[name] = value.number;
  }
  for (const std::string& name : chamber_names_) {
    const std::string air = air_of(name);
    if (air == name && table->valid && table->find(name) == nullptr) {
      const auto sharing = std::find_if(table->members.begin(), table->members.end(),
                                        [&](const auto& member) { return air_of(member.name) == name; });
      fail(table->mark,
           fmt::format("`gauge_pressure` says nothing about the chamber `{}`; {}", name,
                       sharing == table->members.end()
                           ? "0 Pa leaves it empty"
                           : fmt::format("`{}` is connected to it and takes its pressure", sharing->name)));
    }
    const Value *shared = (*table)[air], *own = (*table)[name];
    if (air == name || shared == nullptr || !connections_known_) continue;
    if (own == nullptr) copy_origin(path + ".gauge_pressure." + air, path + ".gauge_pressure." + name);
    // 0.4 kPa and 400 Pa may differ in the last bit
    if (own != nullptr && std::abs(own->number - shared->number) > 1e-12 * std::abs(shared->number)) {
      fail(own->mark, fmt::format("`{}` is connected to `{}` and has its pressure, {}, not {}; leave it out", name, air,
                                  shared->text, own->text));
    }
    out[name] = shared->number;
  }
  return out;
}

SolverOptions Builder::options_of(const Value& stage) {
  const Value* options = stage["options"];
  if (options == nullptr) return {};
  return {optional_number(*options, "tolerance"), optional_integer(*options, "max_iterations"),
          optional_integer(*options, "max_steps"), optional_number(*options, "plastic_step")};
}

Control Builder::control_of(const Value& stage, const std::string& path, const std::map<std::string, Gas>& gas) {
  Control out;
  out.schedule = schedule_of(stage, path);
  const Value* control = stage["control"];
  if (control == nullptr) return out;
  out.steps = optional_integer(*control, "steps");
  if (control->members.empty()) copy_origin(path + ".control", path + ".control.type"); // `control: load`
  if (control->text == "displacement") out.kind = displacement_control(*control);
  if (control->text == "volume") out.kind = volume_control(*control, gas);
  if (control->text == "arc_length") out.kind = arc_length_control(*control);
  for (const char* key : {"duration", "history"}) {
    if (control->text != "load") refuse(stage, key, "is for load control: on the path of another no time passes");
  }
  return out;
}

std::vector<Moment> Builder::schedule_of(const Value& stage, const std::string& path) {
  if (const Value* duration = stage["duration"]) {
    copy_origin(path + ".duration", path + ".history.0.time");
    return {{duration->number, 1}};
  }
  std::vector<Moment> schedule;
  const Value* history = stage["history"];
  if (history == nullptr) return schedule;
  Moment last;
  for (const Value& item : history->items) {
    const Moment moment{number_of(item, "time"), number_of(item, "factor")};
    if (moment.time < last.time) {
      fail(item.mark, fmt::format("time goes back: {} s after {} s", moment.time, last.time));
    } else if (moment.time == last.time && moment.factor == last.factor) {
      if (schedule.empty() && moment.time == 0) continue; // the beginning, said
      fail(item.mark, "nothing happens up to this moment: neither time nor factor change");
    }
    last = moment;
    schedule.push_back(moment);
  }
  return schedule;
}

DisplacementControl Builder::displacement_control(const Value& control) {
  DisplacementControl out;
  out.foil = controlled_foil(control);
  out.until = number_of(control, "until");
  const Value *at = control["at"], *until = control["until"];
  const bool is_largest = at != nullptr && at->items.empty();
  if (at != nullptr && !is_largest) out.at = vec2_of(*at);
  if (until != nullptr && out.until == 0) fail(until->mark, "`until` must not be zero");
  if (until != nullptr && out.until < 0 && is_largest) {
    fail(until->mark, fmt::format("`until` must be positive, not {}: the largest displacement (`at: max`) has no sign",
                                  until->text));
  }
  if (is_largest) refuse(control, "direction", "is for a displacement at a place, not the largest (`at: max`)");
  if (const Value* direction = control["direction"]; direction != nullptr && out.at) {
    out.direction = vec3_of(*direction);
    if (out.direction.norm() == 0) {
      fail(direction->mark, "`direction` must not be zero");
    } else {
      out.direction = unit(out.direction);
    }
  }
  return out;
}

VolumeControl Builder::volume_control(const Value& control, const std::map<std::string, Gas>& gas) {
  VolumeControl out{controlled_chamber(control), number_of(control, "until")};
  const std::string air = air_of(out.chamber);
  const auto law = gas.find(air);
  if (law == gas.end() || std::holds_alternative<RegulatedGas>(law->second)) return out;
  const Value* chamber = control["chamber"];
  fail(chamber != nullptr ? chamber->mark : control.mark,
       fmt::format("the volume of `{}` cannot be controlled: its gas (`law: {}`) decides it; allowed: regulated", air,
                   std::holds_alternative<ClosedGas>(law->second) ? "closed" : "volume"));
  return out;
}

ArcLengthControl Builder::arc_length_control(const Value& control) {
  ArcLengthControl out;
  const Value* until = control["until"];
  if (until == nullptr) return out;
  out.load_factor = optional_number(*until, "load_factor");
  out.pressure = optional_number(*until, "pressure");
  out.volume = optional_number(*until, "volume");
  out.displacement = optional_number(*until, "displacement");
  out.after_peak = optional_number(*until, "after_peak");
  if (out.pressure || out.volume) {
    out.chamber = controlled_chamber(control);
  } else {
    refuse(control, "chamber", "is for `until: {pressure: ...}` or `{volume: ...}`");
  }
  if (!out.displacement) {
    refuse(control, "foil", "is for `until: {displacement: ...}`");
  } else if (control.find("foil") != nullptr) {
    out.foil = controlled_foil(control);
  }
  return out;
}

std::string Builder::controlled_foil(const Value& control) {
  const Value* foil = control["foil"];
  if (foil == nullptr && foil_names_.size() == 1) return foil_names_.front();
  if (foil_names_.empty() || (foil == nullptr && control.find("foil") != nullptr)) return "";
  if (foil == nullptr) {
    fail(control.mark, fmt::format("`control` lacks the key `foil`; foils: {}", schema::joined(foil_names_)));
    return "";
  }
  if (std::find(foil_names_.begin(), foil_names_.end(), foil->text) == foil_names_.end()) {
    fail_unknown_foil(foil->mark, foil->text);
  }
  return foil->text;
}

std::string Builder::controlled_chamber(const Value& control) {
  std::vector<std::string> airs;
  std::copy_if(chamber_names_.begin(), chamber_names_.end(), std::back_inserter(airs),
               [&](const std::string& name) { return air_of(name) == name; });
  const Value* chamber = control["chamber"];
  if (chamber != nullptr) {
    check_chamber(chamber->mark, chamber->text);
    return chamber->text;
  }
  if (airs.size() == 1) return airs.front();
  if (control.find("chamber") != nullptr || !connections_known_) return "";
  fail(control.mark, airs.empty()
                         ? "the cushion has no chamber whose air could be controlled"
                         : fmt::format("`control` lacks the key `chamber`; chambers: {}", schema::joined(airs)));
  return "";
}

void Builder::read_stages(const Value& stages) {
  std::map<std::string, const Value*> known;
  for (const auto& [id, stage] : stages.members) {
    if (id == "mesh" && !is_stage_file_) {
      fail(stage.key, "a stage cannot be called `mesh`: this is the stage that the key `mesh` at the top level makes");
    }
    known[id] = &stage;
  }
  for (const auto& [id, stage] : stages.members) add_stage(id, stage, known);
}

std::string Builder::kind_of(const std::string& id, const std::map<std::string, const Value*>& known) {
  if (id == "mesh") return "mesh";
  const auto found = known.find(id);
  if (found == known.end() || found->second->read_as == nullptr) return "";
  const schema::Option& read_as = *found->second->read_as;
  return read_as.type == schema::Type::group && read_as.not_yet.empty() ? read_as.name : "";
}

void Builder::add_stage(const std::string& id, const Value& stage, const std::map<std::string, const Value*>& known) {
  StageSettings out;
  out.id = id;
  out.run = stage.text;
  out.mark = stage.key;
  out.options = options_of(stage);
  if (const Value* from = stage["from"]) {
    out.from = from->text;
    out.from_run = is_stage_file_ ? text_of(stage, "from_run") : kind_of(out.from, known);
    check_from(id, stage, *from, out, known);
  }
  const std::string path = "stages." + id;
  if (out.run == "formfind") {
    out.settings = formfind_of(stage, path);
  } else if (out.run == "pattern") {
    out.settings = pattern_of(stage, path);
  } else if (out.run == "inflate") {
    out.settings = inflate_of(stage, path, out.from_run);
  } else if (out.run == "wind") {
    out.settings = wind_of(stage, path, known);
  }
  workflow_.stages.push_back(std::move(out));
}

void Builder::check_from(const std::string& id, const Value& stage, const Value& from, const StageSettings& out,
                         const std::map<std::string, const Value*>& known) {
  if (!is_stage_file_ && out.from != "mesh" && !known.contains(out.from)) {
    std::vector<std::string> ids = {"mesh"};
    for (const StageSettings& other : workflow_.stages) {
      if (other.id != "mesh") ids.push_back(other.id);
    }
    for (const auto& item : known) {
      if (item.first != id && std::find(ids.begin(), ids.end(), item.first) == ids.end()) ids.push_back(item.first);
    }
    return fail(from.mark, fmt::format("there is no stage `{}`{}; stages: {}", out.from, suggestion(out.from, ids),
                                       schema::joined(ids)));
  }
  if (in_cycle(id, from, known)) return;
  static const std::map<std::string, std::vector<std::string>> starts = {{"formfind", {"mesh"}},
                                                                         {"pattern", {"formfind"}},
                                                                         {"inflate", {"mesh", "formfind", "pattern"}},
                                                                         {"wind", {"inflate", "wind"}}};
  const auto allowed = starts.find(out.run);
  if (!stage.valid || allowed == starts.end() || out.from_run.empty()) return;
  if (std::find(allowed->second.begin(), allowed->second.end(), out.from_run) != allowed->second.end()) return;
  fail(from.mark, fmt::format("`run: {}` cannot start from `{}` (`run: {}`); it starts from: {}", out.run, out.from,
                              out.from_run, schema::joined(allowed->second)));
}

bool Builder::in_cycle(const std::string& id, const Value& from, const std::map<std::string, const Value*>& known) {
  std::vector<std::string> way = {id};
  std::string at = from.text;
  while (at != id) {
    const auto next = known.find(at);
    if (at == "mesh" || next == known.end() || std::find(way.begin(), way.end(), at) != way.end()) return false;
    way.push_back(at);
    at = text_of(*next->second, "from");
  }
  const bool is_first = std::all_of(way.begin(), way.end(), [&](const std::string& other) {
    const Mark &here = known.at(id)->key, &there = known.at(other)->key;
    return std::tie(here.line, here.column) <= std::tie(there.line, there.column);
  });
  if (is_first) {
    way.push_back(id);
    fail(from.mark,
         fmt::format("`from` goes in a circle: {}; a chain of stages begins at mesh", fmt::join(way, " <- ")));
  }
  return true;
}

FormfindSettings Builder::formfind_of(const Value& stage, const std::string& path) {
  FormfindSettings out;
  out.gauge_pressure = pressures_of(stage, path);
  if (const Value* prestress = stage["prestress"]) out.prestress = per_foil(*prestress, path, "prestress");
  if (const Value* stress = stage["stress"]) {
    out.prestress = per_foil(*stress, path, "stress");
    for (const FoilSettings& foil : workflow_.cushion.foils) out.prestress[foil.name] *= foil.thickness;
  }
  return out;
}

InflateSettings Builder::inflate_of(const Value& stage, const std::string& path, const std::string& from_run) {
  InflateSettings out;
  out.gauge_pressure = pressures_of(stage, path);
  out.contact_stops = text_of(stage, "contact") != "ignore";
  out.control = control_of(stage, path);
  const Value* reference = stage.find("reference");
  const Value* prestress = stage.find("prestress");
  if (const Value* valid = stage["reference"]) {
    out.reference = valid->text == "prestressed" ? Reference::prestressed : Reference::stress_free;
  }
  if (from_run == "formfind") {
    if (reference == nullptr) {
      fail(stage.mark,
           "from a formfind stage, `reference` must say what the found form is: prestressed or stress_free");
    }
    if (prestress != nullptr) {
      fail(prestress->key, "`prestress` is for a start from mesh; from a formfind stage use `reference: prestressed`");
    }
  } else if (from_run == "pattern") {
    for (const char* key : {"reference", "prestress"}) {
      refuse(stage, key, "cannot stand beside a start from a pattern stage: the flat strips are the reference");
    }
  } else if (from_run == "mesh" && reference != nullptr) {
    fail(reference->key, "`reference` is for a start from a formfind stage; from mesh the flat plan is the reference");
  }
  if (const Value* valid = stage["prestress"]) out.prestress = per_foil(*valid, path, "prestress");
  return out;
}

WindSettings Builder::wind_of(const Value& stage, const std::string& path,
                              const std::map<std::string, const Value*>& known) {
  WindSettings out;
  out.contact_stops = text_of(stage, "contact") != "ignore";
  for (const std::string& chamber : chamber_names_) {
    if (air_of(chamber) == chamber) out.gas[chamber] = RegulatedGas{};
  }
  if (const Value* table = stage.find("gas")) {
    for (const auto& [name, value] : table->members) {
      check_chamber(value.key, name);
      if (const std::string air = air_of(name); air != name && connections_known_) {
        fail(value.key,
             fmt::format("`{}` is connected to `{}` and has no air of its own; say the law of `{}`", name, air, air));
      } else if (value.valid) {
        out.gas[name] = gas_of(value);
      }
    }
  }
  out.control = control_of(stage, path, out.gas);
  const Value* factors = stage.find("factors");
  if (const Value* loads = stage.find("loads")) {
    for (const Value& load : loads->items) out.loads.push_back(load_of(load, factors, out.loads));
  }
  const std::map<std::string, std::string> before = loads_before(stage, known);
  for (std::size_t i = 0; i < out.loads.size(); ++i) {
    const auto found = before.find(out.loads[i].name);
    if (found == before.end()) continue;
    fail((*stage.find("loads")).items[i].mark,
         fmt::format(
             "load `{}` acts since stage `{}`: to change it give its factor in `factors`, or choose another name",
             found->first, found->second));
  }
  out.carried = carried_of(factors, out.loads, before, is_stage_file_ && text_of(stage, "from_run") == "wind");
  return out;
}

std::map<std::string, std::string> Builder::loads_before(const Value& stage,
                                                         const std::map<std::string, const Value*>& known) {
  std::map<std::string, std::string> names;
  std::set<std::string> visited; // circles are told elsewhere
  for (std::string id = text_of(stage, "from"); visited.insert(id).second; id = text_of(*known.at(id), "from")) {
    const auto found = known.find(id);
    if (is_stage_file_ || found == known.end() || found->second->text != "wind") break;
    const Value* loads = found->second->find("loads");
    if (loads == nullptr) continue;
    for (const Value& load : loads->items) names.try_emplace(text_of(load, "name"), id);
  }
  return names;
}

Gas Builder::gas_of(const Value& value) {
  if (value.text == "regulated") return RegulatedGas{optional_number(value, "gauge_pressure")};
  if (value.text == "volume") return VolumeGas{number_of(value, "volume")};
  ClosedGas gas{number_of(value, "kappa", 1), optional_number(value, "temperature"),
                optional_number(value, "ambient_pressure")};
  if (gas.temperature && gas.kappa != 1) {
    fail(value["temperature"]->mark,
         fmt::format("`temperature` is for kappa 1, not {}: otherwise the gas law itself sets it", gas.kappa));
  }
  return gas;
}

Load Builder::load_of(const Value& value, const Value* factors, const std::vector<Load>& before) {
  Load load;
  load.mark = value.mark;
  load.name = text_of(value, "name");
  load.foil = text_of(value, "foil");
  if (const Value* name = value["name"]) {
    if (std::any_of(before.begin(), before.end(), [&](const Load& other) { return other.name == load.name; })) {
      fail(name->mark, fmt::format("a second load `{}`: every load needs a name of its own", load.name));
    }
  }
  if (factors != nullptr) load.factor = number_of(*factors, load.name, 1);
  if (const Value* wind = value["wind"]) load.kind = WindLoad{wind->number};
  if (const Value* snow = value["snow"]) load.kind = SnowLoad{snow->number};
  if (const Value* patch = value["patch"]) {
    load.kind = PatchLoad{vec2_of(*(*patch)["center"]), vec2_of(*(*patch)["size"]), vec3_of(*(*patch)["force"])};
  }
  if (const Value* foil = value["foil"]; foil != nullptr && !foil_names_.empty()) check_loaded_foil(*foil, load);
  if (const Value* region = value["region"]; region != nullptr && region->text != "all")
    load.region = region_of(*region);
  return load;
}

void Builder::check_loaded_foil(const Value& foil, const Load& load) {
  const auto found = std::find(foil_names_.begin(), foil_names_.end(), foil.text);
  if (found == foil_names_.end()) return fail_unknown_foil(foil.mark, foil.text);
  const bool is_first = found == foil_names_.begin();
  const bool is_last = found + 1 == foil_names_.end();
  if (std::holds_alternative<WindLoad>(load.kind) && !is_first) {
    const std::string weather = foil_names_.front();
    if (!is_last) {
      fail(foil.mark, fmt::format("wind cannot reach the middle foil `{}`; it acts on the first or the last: {}, {}",
                                  foil.text, weather, foil_names_.back()));
    } else if (workflow_.cushion.rigid_base) {
      fail(foil.mark,
           fmt::format("wind cannot reach `{}` in front of the rigid base; it acts on {}", foil.text, weather));
    }
  }
  if (std::holds_alternative<SnowLoad>(load.kind) && !is_first) {
    warn(foil.mark, fmt::format("snow on `{}`, which is not the weather side; is it meant?", foil.text));
  }
}

Region Builder::region_of(const Value& region) {
  if (const Value* polygon = region["polygon"]) {
    PlanPolygon corners;
    for (const Value& corner : polygon->items) corners.push_back(vec2_of(corner));
    return corners;
  }
  const Value *x = region["x"], *y = region["y"];
  if (x == nullptr || y == nullptr) {
    if (x != nullptr && region.find("y") == nullptr) fail(region.mark, "`region` lacks the key `y`: [from, to]");
    return {};
  }
  for (const Value* side : {x, y}) {
    if (side->items[0].number >= side->items[1].number) fail(side->mark, "the first end must be below the second");
  }
  return PlanBox{{x->items[0].number, x->items[1].number}, {y->items[0].number, y->items[1].number}};
}

std::map<std::string, double> Builder::carried_of(const Value* factors, const std::vector<Load>& own,
                                                  const std::map<std::string, std::string>& before, bool from_wind) {
  std::map<std::string, double> carried;
  if (factors == nullptr) return carried;
  std::vector<std::string> names;
  for (const Load& load : own) names.push_back(load.name);
  const std::size_t count = names.size();
  for (const auto& [name, stage] : before) names.push_back(name);
  for (const auto& [name, value] : factors->members) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found < names.begin() + static_cast<std::ptrdiff_t>(count)) continue;
    if (found != names.end() || from_wind) { // the stage itself knows the names of the state that it starts from
      carried[name] = value.number;
      continue;
    }
    fail(value.key,
         fmt::format("there is no load `{}`{}; loads: {}", name, suggestion(name, names), schema::joined(names)));
  }
  return carried;
}

void Builder::check_gravity() {
  const bool has_weight = std::any_of(workflow_.stages.begin(), workflow_.stages.end(), [](const StageSettings& stage) {
    return stage.run == "inflate" || stage.run == "wind";
  });
  if (!workflow_.site.gravity || !has_weight) return;
  std::set<std::string> told;
  for (const auto& [name, mark] : material_places_) {
    const auto found = workflow_.materials.find(name);
    if (found == workflow_.materials.end() || found->second.density || !told.insert(name).second) continue;
    fail(mark,
         fmt::format("the material `{}` has no `density`, which gravity needs; add it, or say `site: {{gravity: off}}`",
                     name));
  }
}

} // namespace pneuma::pipeline::workflow
