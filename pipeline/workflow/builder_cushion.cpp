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

using schema::Node;
using schema::NodeKind;
using schema::number_of;
using schema::suggestion;
using schema::text_of;

namespace {

constexpr const char* base_wall = "base";

std::string folder_relative(const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (file.is_absolute() == folder.is_absolute()) {
    const auto relative = file.lexically_normal().lexically_relative((folder / "").lexically_normal());
    if (!relative.empty()) return relative.generic_string();
  }
  const auto base = std::filesystem::absolute(folder.empty() ? std::filesystem::path(".") : folder).lexically_normal();
  return std::filesystem::absolute(file).lexically_normal().lexically_relative(base).generic_string();
}

} // namespace

base::Vec2 vec2_of(const Value& list) {
  return {list.items.at(0).number, list.items.at(1).number};
}

Vec3 vec3_of(const Value& list) {
  return {list.items.at(0).number, list.items.at(1).number, list.items.at(2).number};
}

Vec3 unit(const Vec3& v) {
  const double norm = v.norm();
  return std::abs(norm - 1) > 1e-14 ? Vec3(v / norm) : v;
}

Builder::Builder(std::filesystem::path file, bool is_stage_file) : is_stage_file_(is_stage_file) {
  workflow_.file = std::move(file);
}

Workflow Builder::build(const Node& tree) {
  const schema::Option& options = is_stage_file_ ? stage_file_options() : workflow_options();
  schema::Check context{problems, workflow_.origins};
  const Value root = schema::check(options, tree, "", context);
  if (tree.kind != NodeKind::map) return std::move(workflow_);
  workflow_.name = text_of(root, "name");
  if (const Value* site = root["site"]) read_site(*site);
  read_materials(root);
  if (const Value* cushion = root.find("cushion")) read_cushion(*cushion);
  finish_materials();
  if (const Value* mesh = root.find("mesh")) add_mesh(*mesh);
  if (const Value* stages = root.find("stages")) read_stages(*stages);
  check_gravity();
  if (!is_stage_file_) {
    for (auto& [path, mark] : workflow_.origins) {
      mark.file = folder_relative(mark.file, workflow_.file.parent_path());
    }
  }
  return std::move(workflow_);
}

void Builder::read_site(const Value& site) {
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
    if (out.up.norm() == 0) return fail(up->mark, "`up` must not be zero");
    out.up = unit(out.up);
  }
}

void Builder::read_cushion(const Value& cushion) {
  Cushion& out = workflow_.cushion;
  out.mark = cushion.mark;
  out.rigid_base = cushion["base"] != nullptr;
  if (const Value* plan = cushion["plan"]) read_plan(*plan);
  if (const Value* edges = cushion.find("edges"); edges != nullptr && plan_known_) read_edges(*edges);
  if (const Value* foils = cushion.find("foils")) read_foils(*foils);
  if (const Value* chambers = cushion.find("chambers")) read_chambers(*chambers);
}

void Builder::read_plan(const Value& plan) {
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
    geometry::Polygon polygon;
    for (const Value& corner : points->items) polygon.points.push_back(vec2_of(corner));
    if (plan.text == "polygon") {
      out = polygon;
    } else {
      const auto& p = polygon.points;
      out = geometry::Triangle{{p[0], p[1], p[2]}};
    }
    if (const std::string fault = geometry::plan_fault(out); !fault.empty()) {
      fail(points->mark, fault);
      plan_known_ = false;
    }
  } else {
    plan_known_ = false; // its points are wrong
  }
}

void Builder::read_edges(const Value& edges) {
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

void Builder::read_foils(const Value& foils) {
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

void Builder::check_foil_name(const Value& name) {
  if (name.text == all_foils || name.text == base_wall) {
    fail(name.mark, fmt::format("a foil cannot be called `{}`: the word has a meaning of its own", name.text));
  }
  if (std::find(foil_names_.begin(), foil_names_.end(), name.text) != foil_names_.end()) {
    fail(name.mark, fmt::format("a second foil `{}`: every foil needs a name of its own", name.text));
  }
}

std::optional<std::size_t> Builder::wall_position(const Value& wall) {
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

void Builder::fail_unknown_foil(const Mark& mark, const std::string& name) {
  fail(mark, fmt::format("there is no foil `{}`{}; foils: {}", name, suggestion(name, foil_names_),
                         schema::joined(foil_names_)));
}

void Builder::read_chambers(const Value& chambers) {
  std::map<std::size_t, std::string> gaps;
  for (const Value& item : chambers.items) {
    ChamberSettings chamber;
    chamber.mark = item.mark;
    chamber.name = text_of(item, "name");
    chamber.dead_volume = number_of(item, "dead_volume");
    chamber.connected_to = text_of(item, "connected_to");
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
  for (const Value& item : chambers.items) {
    if (const Value* connected_to = item["connected_to"]) check_connection(text_of(item, "name"), *connected_to);
  }
}

void Builder::check_connection(const std::string& name, const Value& connected_to) {
  const std::string &other = connected_to.text, next = air_of(other);
  const bool is_known = std::find(chamber_names_.begin(), chamber_names_.end(), other) != chamber_names_.end();
  if (is_known && other != name && next == other) return;
  connections_known_ = false;
  if (!is_known) return check_chamber(connected_to.mark, other);
  if (other == name) return fail(connected_to.mark, fmt::format("`{}` cannot be connected to itself", name));
  fail(connected_to.mark,
       next == name ? fmt::format("`{}` is connected to `{}` in turn; say it at one of the two", other, name)
                    : fmt::format("`{}` is itself connected to `{}`; connect both to `{}`", other, next, next));
}

std::string Builder::air_of(const std::string& chamber) const {
  const std::vector<ChamberSettings>& chambers = workflow_.cushion.chambers;
  const auto found =
      std::find_if(chambers.begin(), chambers.end(), [&](const ChamberSettings& one) { return one.name == chamber; });
  if (found == chambers.end() || found->connected_to.empty()) return chamber;
  return found->connected_to;
}

void Builder::read_walls(const Value& between, ChamberSettings& chamber, std::map<std::size_t, std::string>& gaps) {
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

void Builder::copy_origin(const std::string& from, const std::string& to) {
  std::map<std::string, Mark> copies;
  if (const auto known = workflow_.origins.find(from); known != workflow_.origins.end()) copies[to] = known->second;
  const std::string inside = from + ".";
  for (auto at = workflow_.origins.lower_bound(inside); at != workflow_.origins.end() && at->first.starts_with(inside);
       ++at) {
    copies[to + "." + at->first.substr(inside.size())] = at->second;
  }
  for (const auto& [path, mark] : copies) workflow_.origins[path] = mark;
}

} // namespace pneuma::pipeline::workflow
