// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/schema/option.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/options.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::Node;
using schema::NodeKind;
using schema::suggestion;
using schema::Value;

constexpr const char* base_wall = "base";
constexpr const char* all_foils = "all";

double number_of(const Value& group, const std::string& key, double otherwise = 0) {
  const Value* value = group[key];
  return value != nullptr ? value->number : otherwise;
}

std::optional<double> optional_number(const Value& group, const std::string& key) {
  const Value* value = group[key];
  return value != nullptr ? std::optional<double>(value->number) : std::nullopt;
}

std::optional<int> optional_integer(const Value& group, const std::string& key) {
  const std::optional<double> value = optional_number(group, key);
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

std::string text_of(const Value& group, const std::string& key) {
  const Value* value = group[key];
  return value != nullptr ? value->text : "";
}

base::Vec2 vec2_of(const Value& list) {
  return {list.items.at(0).number, list.items.at(1).number};
}

Vec3 vec3_of(const Value& list) {
  return {list.items.at(0).number, list.items.at(1).number, list.items.at(2).number};
}

std::string folder_relative(const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (file.is_absolute() == folder.is_absolute()) {
    const auto relative = file.lexically_normal().lexically_relative((folder / "").lexically_normal());
    if (!relative.empty()) return relative.generic_string();
  }
  const auto base = std::filesystem::absolute(folder).lexically_normal();
  return std::filesystem::absolute(file).lexically_normal().lexically_relative(base).generic_string();
}

// Turns checked values into settings and checks what no single option can know: names, neighbours, the graph.
class Builder {
public:
  Builder(std::filesystem::path file, bool is_stage_file) : is_stage_file_(is_stage_file) {
    workflow_.file = std::move(file);
  }

  std::vector<Problem> problems;

  Workflow build(const Node& tree) {
    const schema::Option& options = is_stage_file_ ? stage_file_options() : workflow_options();
    schema::Check context{problems, workflow_.origins};
    const Value root = schema::check(options, tree, "", context);
    if (tree.kind != NodeKind::map) return std::move(workflow_);
    workflow_.name = text_of(root, "name");
    if (const Value* site = root["site"]) read_site(*site);
    read_materials(root);
    if (const Value* cushion = root.find("cushion")) read_cushion(*cushion);
    if (const Value* mesh = root.find("mesh")) add_mesh(*mesh);
    if (const Value* stages = root.find("stages")) read_stages(*stages);
    check_gravity();
    keep_used_materials();
    if (!is_stage_file_) {
      for (auto& [path, mark] : workflow_.origins) {
        mark.file = folder_relative(mark.file, workflow_.file.parent_path());
      }
    }
    return std::move(workflow_);
  }

private:
  void fail(const Mark& mark, std::string message) { problems.push_back({mark, std::move(message), true}); }
  void warn(const Mark& mark, std::string message) { problems.push_back({mark, std::move(message), false}); }

  void read_site(const Value& site) {
    Site& out = workflow_.site;
    out.ambient_pressure.pascal = number_of(site, "ambient_pressure", out.ambient_pressure.pascal);
    out.temperature = number_of(site, "temperature", out.temperature);
    if (const Value* gravity = site["gravity"]) out.gravity = gravity->flag;
    const double ambient = out.ambient_pressure.pascal;
    if (ambient != 0 && (ambient < 5e4 || ambient > 1.1e5)) {
      warn(site["ambient_pressure"]->mark,
           fmt::format(
               "`ambient_pressure` {} Pa is unusual: 101325 Pa at sea level, 70 kPa at 3000 m, 0 Pa for the thesis' "
               "gas law; is it meant?",
               ambient));
    }
    if (const Value* up = site["up"]) {
      out.up = vec3_of(*up);
      const double norm = out.up.norm();
      if (norm == 0) return fail(up->mark, "`up` must not be zero");
      // a normalised one stays as it is to the last bit: it is read again from stage.yaml
      if (std::abs(norm - 1) > 1e-14) out.up /= norm;
    }
  }

  Material material_of(const std::string& name, const Value& value) const {
    Material material;
    material.name = name;
    material.mark = value.key;
    material.law = {number_of(value, "E"), number_of(value, "nu")};
    material.density = optional_number(value, "density");
    material.thermal_expansion = optional_number(value, "thermal_expansion");
    material.source = text_of(value, "source");
    return material;
  }

  // `is_used`: by a foil, or in place; a file may hold more
  void add_material(const std::string& name, const Value& value, bool is_used) {
    material_names_.push_back(name);
    if (!value.valid) return;
    if (const Value* tension_field = value["tension_field"];
        tension_field != nullptr && tension_field->flag && is_used) {
      fail(tension_field->mark, "`tension_field: on` is not available yet; foils carry compression: off");
    }
    workflow_.materials[name] = material_of(name, value);
  }

  void read_materials(const Value& root) {
    const Value* materials = root.find("materials");
    if (materials == nullptr) return;
    if (materials->read_as != nullptr && materials->read_as->type == schema::Type::table) {
      for (const auto& [name, value] : materials->members) add_material(name, value, true);
      return;
    }
    materials_known_ = materials->valid;
    if (!materials->valid) return;
    if (materials->read_as->type == schema::Type::text) return read_materials_file(*materials, root);
    for (const Value& item : materials->items) read_materials_file(item, root);
  }

  // Names of materials that foils of the file use: a file may hold laws that are not available yet.
  static std::set<std::string> used_materials(const Value& root) {
    std::set<std::string> names;
    const Value* cushion = root.find("cushion");
    const Value* foils = cushion != nullptr ? cushion->find("foils") : nullptr;
    if (foils == nullptr) return names;
    for (const Value& foil : foils->items) names.insert(text_of(foil, "material"));
    return names;
  }

  void read_materials_file(const Value& path, const Value& root) {
    const auto file = (workflow_.file.parent_path() / path.text).lexically_normal();
    const std::size_t before = problems.size();
    const std::string text = schema::read_text(file, path.mark, problems);
    const Node tree = schema::parse_yaml(text, file.generic_string(), problems);
    if (problems.size() > before && tree.kind == NodeKind::null) {
      materials_known_ = false;
      return;
    }
    if (tree.kind != NodeKind::map) {
      materials_known_ = false;
      return fail(tree.mark, "a file of materials is a map: NAME: {law: elastic, E: 900 MPa, nu: 0.45}");
    }
    const std::set<std::string> used = used_materials(root);
    for (const schema::Entry& entry : tree.entries) {
      if (std::find(material_names_.begin(), material_names_.end(), entry.key) != material_names_.end()) {
        fail(entry.mark, fmt::format("the material `{}` is also in another file of materials; keep one", entry.key));
        continue;
      }
      Node one;
      one.kind = NodeKind::map;
      one.entries = {entry};
      schema::Check context{problems, workflow_.origins, used.contains(entry.key)};
      const Value table = schema::check(materials_file_options(), one, "materials", context);
      for (const auto& [name, value] : table.members) add_material(name, value, used.contains(name));
    }
  }

  // Only what foils use belongs to the settings of a stage.
  void keep_used_materials() {
    std::erase_if(workflow_.materials, [&](const auto& item) {
      return std::none_of(workflow_.cushion.foils.begin(), workflow_.cushion.foils.end(),
                          [&](const FoilSettings& foil) { return foil.material == item.first; });
    });
  }

  void read_cushion(const Value& cushion) {
    Cushion& out = workflow_.cushion;
    out.mark = cushion.mark;
    out.rigid_base = cushion["base"] != nullptr;
    if (const Value* plan = cushion["plan"]) read_plan(*plan);
    if (const Value* edges = cushion.find("edges"); edges != nullptr && plan_known_) read_edges(*edges);
    if (const Value* foils = cushion.find("foils")) read_foils(*foils);
    if (const Value* chambers = cushion.find("chambers")) read_chambers(*chambers);
  }

  void read_plan(const Value& plan) {
    geometry::Plan& out = workflow_.cushion.plan;
    plan_known_ = true;
    if (plan.text == "rectangle") {
      out = geometry::Rectangle{number_of(plan, "length"), number_of(plan, "width")};
    } else if (plan.text == "circle") {
      out = geometry::Circle{number_of(plan, "radius")};
    } else if (const Value* side = plan["side"]) {
      out = geometry::equilateral(side->number);
      if (const auto place = workflow_.origins.find("cushion.plan.side"); place != workflow_.origins.end()) {
        const Mark mark = place->second;
        for (int i = 0; i < 6; ++i) workflow_.origins[fmt::format("cushion.plan.points.{}.{}", i / 2, i % 2)] = mark;
      }
    } else if (const Value* points = plan["points"]) {
      geometry::Triangle triangle;
      for (std::size_t i = 0; i < 3; ++i) triangle.points[i] = vec2_of(points->items[i]);
      out = triangle;
      const double longest =
          std::max({(triangle.points[1] - triangle.points[0]).norm(), (triangle.points[2] - triangle.points[1]).norm(),
                    (triangle.points[0] - triangle.points[2]).norm()});
      if (!(geometry::area(out) > 1e-6 * longest * longest)) {
        fail(points->mark, "the three `points` lie on a line: a triangle needs an area");
        plan_known_ = false;
      }
    }
  }

  void read_edges(const Value& edges) {
    const std::vector<std::string> known = geometry::edge_names(workflow_.cushion.plan);
    const Value* all = edges["all"];
    for (const std::string& name : known) {
      const Value* own = edges[name];
      const Value* used = own != nullptr ? own : all;
      workflow_.cushion.edges[name] = used != nullptr ? used->text : "clamped";
      if (own == nullptr) copy_origin("cushion.edges.all", "cushion.edges." + name);
    }
    for (const auto& [name, value] : edges.members) {
      if (name == "all" || std::find(known.begin(), known.end(), name) != known.end()) continue;
      fail(value.key, fmt::format("the plan has no edge `{}`{}; its edges: {}", name, suggestion(name, known),
                                  schema::joined(known)));
    }
  }

  void read_foils(const Value& foils) {
    for (const Value& item : foils.items) {
      FoilSettings foil;
      foil.mark = item.mark;
      foil.name = text_of(item, "name");
      foil.material = text_of(item, "material");
      foil.thickness = number_of(item, "thickness");
      foil.warp = number_of(item, "warp");
      if (const Value* name = item["name"]) check_foil_name(*name);
      if (const Value* material = item["material"]; material != nullptr && materials_known_) {
        const auto& known = material_names_;
        if (std::find(known.begin(), known.end(), material->text) == known.end()) {
          fail(material->mark, fmt::format("there is no material `{}`{}; known: {}", material->text,
                                           suggestion(material->text, known), schema::joined(known)));
        }
        material_places_.emplace_back(material->text, material->mark);
      }
      foil_names_.push_back(foil.name);
      workflow_.cushion.foils.push_back(std::move(foil));
    }
  }

  void check_foil_name(const Value& name) {
    if (name.text == all_foils || name.text == base_wall) {
      fail(name.mark, fmt::format("a foil cannot be called `{}`: the word has a meaning of its own", name.text));
    }
    if (std::find(foil_names_.begin(), foil_names_.end(), name.text) != foil_names_.end()) {
      fail(name.mark, fmt::format("a second foil `{}`: every foil needs a name of its own", name.text));
    }
  }

  // Position of a wall from the weather side inwards; the base comes after the last foil.
  std::optional<std::size_t> wall_position(const Value& wall) {
    const auto found = std::find(foil_names_.begin(), foil_names_.end(), wall.text);
    if (found != foil_names_.end()) return static_cast<std::size_t>(found - foil_names_.begin());
    if (wall.text == base_wall) {
      if (workflow_.cushion.rigid_base) return foil_names_.size();
      fail(wall.mark, "the cushion has no base; say `base: rigid` in `cushion`, or name two foils");
      return std::nullopt;
    }
    fail_unknown_foil(wall.mark, wall.text);
    return std::nullopt;
  }

  void fail_unknown_foil(const Mark& mark, const std::string& name) {
    fail(mark, fmt::format("there is no foil `{}`{}; foils: {}", name, suggestion(name, foil_names_),
                           schema::joined(foil_names_)));
  }

  void read_chambers(const Value& chambers) {
    std::map<std::size_t, std::string> gaps;
    for (const Value& item : chambers.items) {
      ChamberSettings chamber;
      chamber.mark = item.mark;
      chamber.name = text_of(item, "name");
      chamber.dead_volume = number_of(item, "dead_volume");
      if (const Value* name = item["name"]) {
        if (std::find(chamber_names_.begin(), chamber_names_.end(), name->text) != chamber_names_.end()) {
          fail(name->mark, fmt::format("a second chamber `{}`: every chamber needs a name of its own", name->text));
        }
      }
      chamber_names_.push_back(chamber.name);
      if (const Value* between = item["between"]; between != nullptr && !foil_names_.empty()) {
        read_walls(*between, chamber, gaps);
      }
      workflow_.cushion.chambers.push_back(std::move(chamber));
    }
  }

  void read_walls(const Value& between, ChamberSettings& chamber, std::map<std::size_t, std::string>& gaps) {
    const auto a = wall_position(between.items[0]);
    const auto b = wall_position(between.items[1]);
    if (!a || !b) return;
    const auto [first, second] = std::minmax(*a, *b);
    if (second - first != 1) {
      return fail(between.mark, fmt::format("`{}` and `{}` are no neighbours; from the weather side inwards: {}{}",
                                            between.items[0].text, between.items[1].text, schema::joined(foil_names_),
                                            workflow_.cushion.rigid_base ? ", base" : ""));
    }
    const auto [gap, is_new] = gaps.emplace(first, chamber.name);
    if (!is_new) {
      return fail(between.mark, fmt::format("between these foils lies the chamber `{}` already", gap->second));
    }
    chamber.outer = foil_names_[first];
    chamber.inner = second < foil_names_.size() ? foil_names_[second] : base_wall;
  }

  void add_mesh(const Value& mesh) {
    MeshSettings out;
    out.mark = mesh.mark;
    const std::string element = text_of(mesh, "element");
    const std::vector<std::string> names = {"T3", "T6", "Q4", "Q9"};
    const auto found = std::find(names.begin(), names.end(), element);
    if (found != names.end()) out.element = static_cast<geometry::ElementType>(found - names.begin());
    out.size = optional_number(mesh, "size");
    if (const Value* divisions = mesh["divisions"]) {
      const bool is_pair = !divisions->items.empty();
      const double first = is_pair ? divisions->items[0].number : divisions->number;
      const double second = is_pair ? divisions->items[1].number : divisions->number;
      out.divisions = {static_cast<int>(first), static_cast<int>(second)};
      if (is_pair && plan_known_ && std::holds_alternative<geometry::Triangle>(workflow_.cushion.plan)) {
        fail(divisions->mark, "a triangle has one number of `divisions`, along each side");
      }
      for (const char* end : {"0", "1"}) {
        copy_origin("mesh.divisions", std::string("mesh.divisions.") + end);
      }
    }
    const std::string pattern = text_of(mesh, "pattern");
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

  void check_size(const Value& mesh, const MeshSettings& out) {
    if (!out.size || !plan_known_) return;
    const double across = std::sqrt(geometry::area(workflow_.cushion.plan));
    if (*out.size <= across) return;
    warn(mesh["size"]->mark,
         fmt::format("`size` {} m is larger than the cushion (about {:.3g} m); is it meant?", *out.size, across));
  }

  void copy_origin(const std::string& from, const std::string& to) {
    const auto known = workflow_.origins.find(from);
    if (known == workflow_.origins.end()) return;
    const Mark mark = known->second;
    workflow_.origins[to] = mark;
  }

  // {FOIL or all: value} for every foil.
  std::map<std::string, double> per_foil(const Value& table, const std::string& path, const std::string& key) {
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

  void check_chamber(const Mark& mark, const std::string& name) {
    if (std::find(chamber_names_.begin(), chamber_names_.end(), name) != chamber_names_.end()) return;
    fail(mark, fmt::format("there is no chamber `{}`{}; chambers: {}", name, suggestion(name, chamber_names_),
                           schema::joined(chamber_names_)));
  }

  std::map<std::string, double> pressures_of(const Value& stage) {
    std::map<std::string, double> out;
    const Value* table = stage.find("gauge_pressure");
    if (table == nullptr || table->read_as == nullptr) return out;
    for (const auto& [name, value] : table->members) {
      check_chamber(value.key, name);
      out[name] = value.number;
    }
    for (const std::string& name : chamber_names_) {
      if (table->valid && table->find(name) == nullptr) {
        fail(table->mark,
             fmt::format("`gauge_pressure` says nothing about the chamber `{}`; 0 Pa leaves it empty", name));
      }
    }
    return out;
  }

  static SolverOptions options_of(const Value& stage) {
    const Value* options = stage["options"];
    if (options == nullptr) return {};
    return {optional_number(*options, "tolerance"), optional_integer(*options, "max_iterations")};
  }

  static Control control_of(const Value& stage) {
    const Value* control = stage["control"];
    if (control == nullptr) return {};
    return {optional_integer(*control, "steps")};
  }

  void read_stages(const Value& stages) {
    std::map<std::string, const Value*> known;
    for (const auto& [id, stage] : stages.members) {
      if (id == "mesh" && !is_stage_file_) {
        fail(stage.key,
             "a stage cannot be called `mesh`: this is the stage that the key `mesh` at the top level makes");
      }
      known[id] = &stage;
    }
    for (const auto& [id, stage] : stages.members) add_stage(id, stage, known);
  }

  // Kind of the stage that `from` names; empty: unknown.
  static std::string kind_of(const std::string& id, const std::map<std::string, const Value*>& known) {
    if (id == "mesh") return "mesh";
    const auto found = known.find(id);
    return found != known.end() ? found->second->text : "";
  }

  void add_stage(const std::string& id, const Value& stage, const std::map<std::string, const Value*>& known) {
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
    } else if (out.run == "inflate") {
      out.settings = inflate_of(stage, path, out.from_run);
    } else if (out.run == "wind") {
      out.settings = wind_of(stage);
    }
    workflow_.stages.push_back(std::move(out));
  }

  void check_from(const std::string& id, const Value& stage, const Value& from, const StageSettings& out,
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
    static const std::map<std::string, std::vector<std::string>> starts = {
        {"formfind", {"mesh"}}, {"inflate", {"mesh", "formfind"}}, {"wind", {"inflate"}}};
    const auto allowed = starts.find(out.run);
    if (!stage.valid || allowed == starts.end() || out.from_run.empty()) return;
    if (std::find(allowed->second.begin(), allowed->second.end(), out.from_run) != allowed->second.end()) return;
    const std::string where = schema::joined(allowed->second);
    if (out.from_run == "pattern" || (out.run == "wind" && out.from_run == "wind")) {
      return fail(from.mark, fmt::format("a {} stage from a {} stage is not available yet; allowed: {}", out.run,
                                         out.from_run, where));
    }
    fail(from.mark, fmt::format("a {} stage cannot start from `{}`, a {} stage; allowed: {}", out.run, out.from,
                                out.from_run, where));
  }

  // Follows `from`; each circle is reported once, at its first stage in the file.
  bool in_cycle(const std::string& id, const Value& from, const std::map<std::string, const Value*>& known) {
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

  FormfindSettings formfind_of(const Value& stage, const std::string& path) {
    FormfindSettings out;
    out.gauge_pressure = pressures_of(stage);
    if (const Value* prestress = stage["prestress"]) out.prestress = per_foil(*prestress, path, "prestress");
    if (const Value* stress = stage["stress"]) {
      out.prestress = per_foil(*stress, path, "stress");
      for (const FoilSettings& foil : workflow_.cushion.foils) out.prestress[foil.name] *= foil.thickness;
    }
    return out;
  }

  InflateSettings inflate_of(const Value& stage, const std::string& path, const std::string& from_run) {
    InflateSettings out;
    out.gauge_pressure = pressures_of(stage);
    out.contact_stops = text_of(stage, "contact") != "ignore";
    out.control = control_of(stage);
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
        fail(prestress->key,
             "`prestress` is for a start from mesh; from a formfind stage use `reference: prestressed`");
      }
    } else if (from_run == "mesh" && reference != nullptr) {
      fail(reference->key,
           "`reference` is for a start from a formfind stage; from mesh the flat plan is the reference");
    }
    if (const Value* valid = stage["prestress"]) out.prestress = per_foil(*valid, path, "prestress");
    return out;
  }

  WindSettings wind_of(const Value& stage) {
    WindSettings out;
    out.contact_stops = text_of(stage, "contact") != "ignore";
    out.control = control_of(stage);
    for (const std::string& chamber : chamber_names_) out.gas[chamber] = RegulatedGas{};
    if (const Value* table = stage.find("gas")) {
      for (const auto& [name, value] : table->members) {
        check_chamber(value.key, name);
        if (value.valid) out.gas[name] = gas_of(value);
      }
    }
    const Value* factors = stage.find("factors");
    if (const Value* loads = stage.find("loads")) {
      for (const Value& load : loads->items) out.loads.push_back(load_of(load, factors, out.loads));
    }
    check_factors(factors, out.loads);
    return out;
  }

  Gas gas_of(const Value& value) {
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

  Load load_of(const Value& value, const Value* factors, const std::vector<Load>& before) {
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

  void check_loaded_foil(const Value& foil, const Load& load) {
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

  Region region_of(const Value& region) {
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

  void check_factors(const Value* factors, const std::vector<Load>& loads) {
    if (factors == nullptr) return;
    std::vector<std::string> names;
    for (const Load& load : loads) names.push_back(load.name);
    for (const auto& [name, value] : factors->members) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      fail(value.key,
           fmt::format("there is no load `{}`{}; loads: {}", name, suggestion(name, names), schema::joined(names)));
    }
  }

  void check_gravity() {
    const bool has_weight =
        std::any_of(workflow_.stages.begin(), workflow_.stages.end(),
                    [](const StageSettings& stage) { return stage.run == "inflate" || stage.run == "wind"; });
    if (!workflow_.site.gravity || !has_weight) return;
    std::set<std::string> told;
    for (const auto& [name, mark] : material_places_) {
      const auto found = workflow_.materials.find(name);
      if (found == workflow_.materials.end() || found->second.density || !told.insert(name).second) continue;
      fail(mark, fmt::format(
                     "the material `{}` has no `density`, which gravity needs; add it, or say `site: {{gravity: off}}`",
                     name));
    }
  }

  Workflow workflow_;
  bool is_stage_file_ = false;
  bool materials_known_ = true;
  bool plan_known_ = false;
  std::vector<std::string> material_names_, foil_names_, chamber_names_;
  std::vector<std::pair<std::string, Mark>> material_places_; // where foils name them
};

// In the order of the files and in each from top to bottom; the same once.
void put_in_order(std::vector<Problem>& problems, const std::string& first_file) {
  const auto key = [&](const Problem& p) {
    return std::tuple(p.mark.file != first_file, p.mark.file, p.mark.line, p.mark.column);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return key(a) < key(b); });
  const auto same = [](const Problem& a, const Problem& b) {
    return to_string(a.mark) == to_string(b.mark) && a.message == b.message;
  };
  problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
}

// "cushion.yaml:14:22" -> Mark
std::optional<Mark> parse_mark(const std::string& text) {
  const auto second = text.rfind(':');
  if (second == std::string::npos || second == 0) return std::nullopt;
  const auto first = text.rfind(':', second - 1);
  if (first == std::string::npos) return std::nullopt;
  Mark mark{text.substr(0, first), 0, 0};
  std::from_chars(text.data() + first + 1, text.data() + second, mark.line);
  std::from_chars(text.data() + second + 1, text.data() + text.size(), mark.column);
  return mark.line > 0 && mark.column > 0 ? std::optional<Mark>(mark) : std::nullopt;
}

// Takes `origin` out of the tree of a stage.yaml.
std::map<std::string, Mark> take_origins(Node& tree) {
  std::map<std::string, Mark> origins;
  const auto found = std::find_if(tree.entries.begin(), tree.entries.end(),
                                  [](const schema::Entry& entry) { return entry.key == "origin"; });
  if (found == tree.entries.end()) return origins;
  for (const schema::Entry& entry : found->value.entries) {
    if (const auto mark = parse_mark(entry.value.text)) origins[entry.key] = *mark;
  }
  tree.entries.erase(found);
  return origins;
}

} // namespace

ReadResult read_workflow(const std::filesystem::path& file) {
  Builder builder(file, false);
  const std::string name = file.generic_string();
  const std::string text = schema::read_text(file, {name, 1, 1}, builder.problems);
  const Node tree = schema::parse_yaml(text, name, builder.problems);
  ReadResult result;
  if (tree.kind != NodeKind::null) {
    result.workflow = builder.build(tree);
  } else if (builder.problems.empty()) {
    builder.problems.push_back({tree.mark, "the file is empty; a workflow begins with `pneuma: 1`"});
  }
  result.workflow.file = file;
  result.problems = std::move(builder.problems);
  put_in_order(result.problems, name);
  return result;
}

Workflow read_stage(const std::filesystem::path& file) {
  Builder builder(file, true);
  const std::string name = file.generic_string();
  const std::string text = schema::read_text(file, {name, 1, 1}, builder.problems);
  Node tree = schema::parse_yaml(text, name, builder.problems);
  const std::map<std::string, Mark> origins = take_origins(tree);
  schema::replace_marks(tree, origins);
  Workflow workflow;
  if (tree.kind != NodeKind::null) workflow = builder.build(tree);
  workflow.file = file;
  workflow.origins = origins;
  const auto is_error = [](const Problem& problem) { return problem.error; };
  const bool bad = std::any_of(builder.problems.begin(), builder.problems.end(), is_error);
  if (!bad && workflow.stages.size() != 1) {
    Problem problem;
    problem.mark = {name, 1, 1};
    problem.message = fmt::format("a stage file holds one stage, not {}", workflow.stages.size());
    builder.problems.push_back(problem);
  }
  put_in_order(builder.problems, name);
  std::string message;
  for (const Problem& problem : builder.problems) {
    if (problem.error) message += (message.empty() ? "" : "\n") + to_string(problem);
  }
  if (!message.empty()) throw base::InputError(message);
  return workflow;
}

} // namespace pneuma::pipeline::workflow
