// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "pipeline/schema/node.h"
#include "pipeline/schema/quantity.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::add;
using schema::Node;
using schema::NodeKind;
using schema::quantity_text;
using schema::scalar;

Node empty_map() {
  Node node;
  node.kind = NodeKind::map;
  return node;
}

Node empty_list() {
  Node node;
  node.kind = NodeKind::list;
  return node;
}

Node plain(double value) {
  return scalar(fmt::format("{}", value));
}

Node quantity(double value, const char* unit) {
  return scalar(quantity_text(value, unit));
}

Node components(const Vec3& v) {
  Node node = empty_list();
  for (int i = 0; i < 3; ++i) node.items.push_back(plain(v[i]));
  return node;
}

Node lengths(double a, double b) {
  Node node = empty_list();
  node.items = {quantity(a, "m"), quantity(b, "m")};
  return node;
}

Node per_name(const std::map<std::string, double>& values, const char* unit) {
  Node node = empty_map();
  for (const auto& [name, value] : values) add(node, name, quantity(value, unit));
  return node;
}

Node site_node(const Site& site) {
  Node node = empty_map();
  add(node, "ambient_pressure", quantity(site.ambient_pressure.pascal, "Pa"));
  add(node, "temperature", quantity(site.temperature, "K"));
  add(node, "up", components(site.up));
  add(node, "gravity", scalar(site.gravity ? "on" : "off"));
  return node;
}

void add_law(Node& node, const ElasticLaw& law) {
  add(node, "E", quantity(law.E, "Pa"));
  add(node, "nu", plain(law.nu));
}

void add_law(Node& node, const OrthotropicLaw& law) {
  add(node, "E1", quantity(law.E1, "Pa"));
  add(node, "E2", quantity(law.E2, "Pa"));
  add(node, "nu12", plain(law.nu12));
  add(node, "G12", quantity(law.G12, "Pa"));
}

// What depends on the temperature.
void add_law(Node& node, const J2Law& law) {
  add(node, "E", quantity(law.E, "Pa"));
  add(node, "nu", plain(law.nu));
  Node hardening = empty_list();
  for (const HardeningBranch& branch : law.hardening) {
    Node item = empty_map();
    add(item, "stress", quantity(branch.stress, "Pa"));
    add(item, "modulus", quantity(branch.modulus, "Pa"));
    hardening.items.push_back(item);
  }
  add(node, "hardening", hardening);
}

void add_law(Node& node, const OgdenLaw& law) {
  Node terms = empty_list();
  for (const OgdenLaw::Term& term : law.terms) {
    Node item = empty_map();
    add(item, "mu", quantity(term.mu, "Pa"));
    add(item, "alpha", plain(term.alpha));
    terms.items.push_back(item);
  }
  add(node, "terms", terms);
}

void add_law(Node& node, const MooneyRivlinLaw& law) {
  add(node, "C1", quantity(law.C1, "Pa"));
  add(node, "C2", quantity(law.C2, "Pa"));
}

Node numbers(std::initializer_list<double> values) {
  Node node = empty_list();
  for (const double value : values) node.items.push_back(plain(value));
  return node;
}

void add_law(Node& node, const TableLaw& law) {
  Node points = empty_list(), shear_points = empty_list();
  for (const TableLaw::Point& p : law.points) {
    points.items.push_back(numbers({p.strain_1, p.strain_2, p.stress_1, p.stress_2, p.weight}));
  }
  for (const TableLaw::ShearPoint& p : law.shear_points) {
    shear_points.items.push_back(numbers({p.strain, p.stress, p.weight}));
  }
  if (!law.points.empty()) add(node, "points", points);
  if (!law.shear_points.empty()) add(node, "shear_points", shear_points);
  if (!law.fit_to.empty()) add(node, "fit_to", scalar(law.fit_to));
  Node net = empty_list();
  net.items = {plain(law.net[0]), plain(law.net[1])};
  add(node, "net", net);
  add(node, "degree", plain(law.degree));
  if (law.range) add(node, "range", numbers({(*law.range)[0], (*law.range)[1]}));
  add(node, "outside", scalar(law.goes_on ? "linear" : "error"));
  add(node, "potential", scalar(law.potential ? "on" : "off"));
  if (law.smoothing) add(node, "smoothing", plain(*law.smoothing));
  add(node, "nu", plain(law.nu));
}

const char* name_of(const MaterialLaw& law) {
  if (std::holds_alternative<J2Law>(law)) return "j2";
  if (std::holds_alternative<OgdenLaw>(law)) return "ogden";
  if (std::holds_alternative<MooneyRivlinLaw>(law)) return "mooney_rivlin";
  if (const auto* table = std::get_if<TableLaw>(&law)) {
    return table->kind == TableLaw::Kind::pd_nurbs ? "pd_nurbs" : "le_nurbs";
  }
  return "elastic";
}

// What does not depend on the temperature.
void add_rest(Node& node, const J2Law& law) {
  add(node, "modulus", scalar(law.modulus == ModulusKind::plastic ? "plastic" : "tangent"));
  add(node, "softening", scalar(law.softening ? "on" : "off"));
  add(node, "strain", scalar(law.logarithmic ? "logarithmic" : "small"));
  if (!law.viscosity) return;
  const bool is_peric = law.viscosity->model == ViscositySettings::Model::peric;
  Node viscosity = empty_map();
  add(viscosity, "model", scalar(is_peric ? "peric" : "perzyna"));
  add(viscosity, "mu", quantity(law.viscosity->mu, "s"));
  add(viscosity, "epsilon", plain(law.viscosity->epsilon));
  if (law.viscosity->threshold) add(viscosity, "threshold", quantity(*law.viscosity->threshold, "Pa"));
  add(node, "viscosity", viscosity);
}

Node strength_node(const Strength& strength) {
  Node node = empty_map();
  add(node, "characteristic", quantity(strength.characteristic, "Pa"));
  if (strength.weld) add(node, "weld", quantity(*strength.weld, "Pa"));
  if (strength.ultimate) add(node, "ultimate", quantity(*strength.ultimate, "Pa"));
  Node factors = empty_map(), temperature = empty_list();
  for (const auto& [name, factor] : strength.factors) add(factors, name, plain(factor));
  for (const auto& [at, factor] : strength.temperature) {
    Node item = empty_map();
    add(item, "at", quantity(at, "K"));
    add(item, "factor", plain(factor));
    temperature.items.push_back(item);
  }
  add(node, "factors", factors);
  add(node, "temperature", temperature);
  if (!strength.source.empty()) add(node, "source", scalar(strength.source));
  return node;
}

Node material_node(const Material& material) {
  Node node = empty_map();
  add(node, "law", scalar(name_of(material.law)));
  std::visit([&](const auto& law) { add_law(node, law); }, material.law);
  if (const auto* j2 = std::get_if<J2Law>(&material.law)) add_rest(node, *j2);
  if (!material.other.empty()) {
    Node temperature = empty_list();
    for (const auto& [at, other] : material.other) {
      Node item = empty_map();
      add(item, "at", quantity(at, "K"));
      std::visit([&](const auto& law) { add_law(item, law); }, other);
      temperature.items.push_back(item);
    }
    add(node, "at", quantity(material.at, "K"));
    add(node, "temperature", temperature);
  }
  add(node, "tension_field", scalar(material.tension_field ? "on" : "off"));
  if (material.density) add(node, "density", quantity(*material.density, "kg/m3"));
  if (material.thermal_expansion) add(node, "thermal_expansion", quantity(*material.thermal_expansion, "K-1"));
  if (material.strength) add(node, "strength", strength_node(*material.strength));
  if (!material.source.empty()) add(node, "source", scalar(material.source));
  return node;
}

Node plan_node(const geometry::Plan& plan) {
  Node node = empty_map();
  if (const auto* rectangle = std::get_if<geometry::Rectangle>(&plan)) {
    add(node, "shape", scalar("rectangle"));
    add(node, "length", quantity(rectangle->length, "m"));
    add(node, "width", quantity(rectangle->width, "m"));
  } else if (const auto* circle = std::get_if<geometry::Circle>(&plan)) {
    add(node, "shape", scalar("circle"));
    add(node, "radius", quantity(circle->radius, "m"));
  } else {
    add(node, "shape", scalar(std::holds_alternative<geometry::Triangle>(plan) ? "triangle" : "polygon"));
    Node points = empty_list();
    for (const base::Vec2& point : geometry::corner_points(plan)) {
      points.items.push_back(lengths(point.x(), point.y()));
    }
    add(node, "points", points);
  }
  return node;
}

Node cushion_node(const Cushion& cushion) {
  Node node = empty_map();
  add(node, "plan", plan_node(cushion.plan));
  Node edges = empty_map();
  for (const auto& [name, held] : cushion.edges) add(edges, name, scalar(held));
  add(node, "edges", edges);
  Node foils = empty_list();
  for (const FoilSettings& foil : cushion.foils) {
    Node item = empty_map();
    add(item, "name", scalar(foil.name));
    add(item, "material", scalar(foil.material));
    add(item, "thickness", quantity(foil.thickness, "m"));
    add(item, "warp", quantity(foil.warp, "rad"));
    foils.items.push_back(item);
  }
  add(node, "foils", foils);
  if (cushion.rigid_base) add(node, "base", scalar("rigid"));
  Node chambers = empty_list();
  for (const ChamberSettings& chamber : cushion.chambers) {
    Node item = empty_map();
    add(item, "name", scalar(chamber.name));
    Node between = empty_list();
    between.items = {scalar(chamber.outer), scalar(chamber.inner)};
    add(item, "between", between);
    add(item, "dead_volume", quantity(chamber.dead_volume, "m3"));
    if (!chamber.connected_to.empty()) add(item, "connected_to", scalar(chamber.connected_to));
    chambers.items.push_back(item);
  }
  add(node, "chambers", chambers);
  return node;
}

Node mesh_node(const MeshSettings& mesh) {
  static constexpr const char* elements[] = {"T3", "T6", "Q4", "Q9"};
  Node node = empty_map();
  add(node, "element", scalar(elements[static_cast<int>(mesh.element)]));
  if (mesh.size) add(node, "size", quantity(*mesh.size, "m"));
  if (mesh.divisions) {
    const auto [first, second] = *mesh.divisions;
    Node pair = empty_list();
    pair.items = {plain(first), plain(second)};
    add(node, "divisions", first == second ? plain(first) : pair);
  }
  if (mesh.pattern != MeshPattern::automatic) {
    add(node, "pattern", scalar(mesh.pattern == MeshPattern::structured ? "structured" : "unstructured"));
  }
  add(node, "stress_rule", scalar(mesh.stress_rule == geometry::StressRule::full ? "full" : "reduced"));
  return node;
}

void add_control(Node& path, const LoadControl&) {
  add(path, "type", scalar("load"));
}

void add_control(Node& path, const DisplacementControl& control) {
  add(path, "type", scalar("displacement"));
  add(path, "at", control.at ? lengths(control.at->x(), control.at->y()) : scalar("max"));
  add(path, "foil", scalar(control.foil));
  if (control.direction.norm() > 0) add(path, "direction", components(control.direction));
  add(path, "until", quantity(control.until, "m"));
}

void add_control(Node& path, const VolumeControl& control) {
  add(path, "type", scalar("volume"));
  add(path, "chamber", scalar(control.chamber));
  add(path, "until", quantity(control.until, "m3"));
}

void add_control(Node& path, const ArcLengthControl& control) {
  add(path, "type", scalar("arc_length"));
  Node until = empty_map();
  if (control.load_factor) add(until, "load_factor", plain(*control.load_factor));
  if (control.pressure) add(until, "pressure", quantity(*control.pressure, "Pa"));
  if (control.volume) add(until, "volume", quantity(*control.volume, "m3"));
  if (control.displacement) add(until, "displacement", quantity(*control.displacement, "m"));
  if (control.after_peak) add(until, "after_peak", plain(*control.after_peak));
  add(path, "until", until);
  if (!control.chamber.empty()) add(path, "chamber", scalar(control.chamber));
  if (!control.foil.empty()) add(path, "foil", scalar(control.foil));
}

void add_path(Node& node, bool contact_stops, const Control& control) {
  add(node, "contact", scalar(contact_stops ? "stop" : "ignore"));
  Node path = empty_map();
  std::visit([&](const auto& kind) { add_control(path, kind); }, control.kind);
  if (control.steps) add(path, "steps", plain(*control.steps));
  add(node, "control", path);
  if (control.schedule.empty()) return;
  Node history = empty_list();
  for (const Moment& moment : control.schedule) {
    Node item = empty_map();
    add(item, "time", quantity(moment.time, "s"));
    add(item, "factor", plain(moment.factor));
    history.items.push_back(item);
  }
  add(node, "history", history);
}

void add_settings(Node& node, const FormfindSettings& settings) {
  add(node, "gauge_pressure", per_name(settings.gauge_pressure, "Pa"));
  add(node, "prestress", per_name(settings.prestress, "N/m"));
}

Node curves_node(const PlanCurves& curves) {
  Node node = empty_list();
  for (const std::vector<base::Vec2>& curve : curves) {
    Node points = empty_list();
    for (const base::Vec2& point : curve) points.items.push_back(lengths(point.x(), point.y()));
    node.items.push_back(points);
  }
  return node;
}

Node compensation_node(const Compensation& compensation) {
  if (compensation.kind == Compensation::Kind::none) return scalar("none");
  if (compensation.kind == Compensation::Kind::elastic) return scalar("elastic");
  Node node = empty_map();
  add(node, "warp", quantity(compensation.warp, "1"));
  add(node, "weft", quantity(compensation.weft, "1"));
  return node;
}

// What has no effect beside the other settings is not written: it would be refused when read again.
void add_settings(Node& node, const PatternSettings& settings) {
  if (settings.strips_per_foil) add(node, "strips_per_foil", plain(*settings.strips_per_foil));
  if (settings.roll_given) {
    Node roll = empty_map();
    add(roll, "width", quantity(settings.roll.width, "m"));
    add(roll, "weld", quantity(settings.roll.weld, "m"));
    add(roll, "selvedge", quantity(settings.roll.selvedge, "m"));
    add(node, "roll", roll);
  }
  if (settings.curves.empty()) {
    add(node, "lines", scalar(settings.lines == CuttingLines::geodesic ? "geodesic" : "straight"));
    add(node, "direction", settings.direction ? quantity(*settings.direction, "rad") : scalar("auto"));
    if (!settings.direction) {
      add(node, "chosen_by", scalar(settings.chosen_by == ChosenBy::distortion ? "distortion" : "waste"));
    }
  } else {
    Node curves = empty_map();
    for (const auto& [foil, lines] : settings.curves) add(curves, foil, curves_node(lines));
    add(node, "curves", curves);
  }
  const Compensation& compensation = settings.compensation;
  add(node, "compensation", compensation_node(compensation));
  if (compensation.kind == Compensation::Kind::elastic) add(node, "creep", quantity(compensation.creep, "1"));
  if (compensation.kind != Compensation::Kind::none) {
    add(node, "decompensation", quantity(settings.decompensation, "m"));
  }
  if (!settings.foils.empty()) {
    Node foils = empty_list();
    for (const std::string& foil : settings.foils) foils.items.push_back(scalar(foil));
    add(node, "foils", foils);
  }
  Node allowance = empty_map();
  add(allowance, "clamp", quantity(settings.clamp_allowance, "m"));
  add(allowance, "notches", quantity(settings.notch_spacing, "m"));
  add(node, "allowance", allowance);
}

void add_settings(Node& node, const InflateSettings& settings) {
  add(node, "gauge_pressure", per_name(settings.gauge_pressure, "Pa"));
  if (settings.reference) {
    add(node, "reference", scalar(*settings.reference == Reference::prestressed ? "prestressed" : "stress_free"));
  }
  if (!settings.prestress.empty()) add(node, "prestress", per_name(settings.prestress, "N/m"));
  add_path(node, settings.contact_stops, settings.control);
}

Node gas_node(const Gas& gas) {
  Node node = empty_map();
  if (const auto* regulated = std::get_if<RegulatedGas>(&gas)) {
    add(node, "law", scalar("regulated"));
    if (regulated->gauge_pressure) add(node, "gauge_pressure", quantity(*regulated->gauge_pressure, "Pa"));
  } else if (const auto* closed = std::get_if<ClosedGas>(&gas)) {
    add(node, "law", scalar("closed"));
    add(node, "kappa", plain(closed->kappa));
    if (closed->temperature) add(node, "temperature", quantity(*closed->temperature, "K"));
    if (closed->ambient_pressure) add(node, "ambient_pressure", quantity(*closed->ambient_pressure, "Pa"));
  } else {
    add(node, "law", scalar("volume"));
    add(node, "volume", quantity(std::get<VolumeGas>(gas).volume, "m3"));
  }
  return node;
}

Node region_node(const Region& region) {
  if (std::holds_alternative<std::monostate>(region)) return scalar("all");
  Node node = empty_map();
  if (const auto* box = std::get_if<PlanBox>(&region)) {
    add(node, "x", lengths(box->x[0], box->x[1]));
    add(node, "y", lengths(box->y[0], box->y[1]));
  } else {
    Node corners = empty_list();
    for (const base::Vec2& corner : std::get<PlanPolygon>(region)) {
      corners.items.push_back(lengths(corner.x(), corner.y()));
    }
    add(node, "polygon", corners);
  }
  return node;
}

Node load_node(const Load& load) {
  Node node = empty_map();
  add(node, "name", scalar(load.name));
  add(node, "foil", scalar(load.foil));
  if (const auto* wind = std::get_if<WindLoad>(&load.kind)) {
    add(node, "wind", quantity(wind->pressure, "Pa"));
  } else if (const auto* snow = std::get_if<SnowLoad>(&load.kind)) {
    add(node, "snow", quantity(snow->weight, "Pa"));
  } else {
    const auto& patch = std::get<PatchLoad>(load.kind);
    Node item = empty_map();
    add(item, "center", lengths(patch.center.x(), patch.center.y()));
    add(item, "size", lengths(patch.size.x(), patch.size.y()));
    Node force = empty_list();
    for (int i = 0; i < 3; ++i) force.items.push_back(quantity(patch.force[i], "N"));
    add(item, "force", force);
    add(node, "patch", item);
  }
  add(node, "region", region_node(load.region));
  return node;
}

void add_settings(Node& node, const WindSettings& settings) {
  Node gas = empty_map();
  for (const auto& [name, law] : settings.gas) add(gas, name, gas_node(law));
  add(node, "gas", gas);
  Node loads = empty_list(), factors = empty_map();
  for (const Load& load : settings.loads) {
    loads.items.push_back(load_node(load));
    add(factors, load.name, plain(load.factor));
  }
  for (const auto& [name, factor] : settings.carried) add(factors, name, plain(factor));
  add(node, "loads", loads);
  add(node, "factors", factors);
  add_path(node, settings.contact_stops, settings.control);
}

void add_settings(Node&, const MeshSettings&) {} // stands at the top level

Node stage_node(const StageSettings& stage) {
  Node node = empty_map();
  add(node, "run", scalar(stage.run));
  add(node, "from", scalar(stage.from));
  add(node, "from_run", scalar(stage.from_run));
  std::visit([&](const auto& settings) { add_settings(node, settings); }, stage.settings);
  Node options = empty_map();
  if (stage.options.tolerance) add(options, "tolerance", plain(*stage.options.tolerance));
  if (stage.options.max_iterations) add(options, "max_iterations", plain(*stage.options.max_iterations));
  if (stage.options.max_steps) add(options, "max_steps", plain(*stage.options.max_steps));
  if (stage.options.plastic_step) add(options, "plastic_step", plain(*stage.options.plastic_step));
  add(node, "options", options);
  return node;
}

void add_settings_of(Node& node, const Workflow& workflow, const StageSettings& stage) {
  add(node, "site", site_node(workflow.site));
  Node materials = empty_map();
  for (const auto& [name, material] : workflow.materials) add(materials, name, material_node(material));
  add(node, "materials", materials);
  add(node, "cushion", cushion_node(workflow.cushion));
  if (const auto* mesh = std::get_if<MeshSettings>(&stage.settings)) {
    add(node, "mesh", mesh_node(*mesh));
  } else {
    Node stages = empty_map();
    add(stages, stage.id, stage_node(stage));
    add(node, "stages", stages);
  }
}

} // namespace

// The name of the project is left out: it changes no result.
std::string effective_settings(const Workflow& workflow, const StageSettings& stage) {
  Node node = empty_map();
  add_settings_of(node, workflow, stage);
  return schema::write_yaml(node);
}

std::string stage_yaml(const Workflow& workflow, const StageSettings& stage) {
  Node node = empty_map();
  add(node, "pneuma", scalar("1"));
  add(node, "name", scalar(workflow.name));
  add_settings_of(node, workflow, stage);
  // where the values come from; what is not listed is a default
  Node origin = empty_map();
  for (const auto& [path, leaf] : schema::leaves(node)) {
    const auto known = workflow.origins.find(path);
    if (known != workflow.origins.end()) add(origin, path, scalar(to_string(known->second)));
  }
  add(node, "origin", origin);
  return schema::write_yaml(node);
}

} // namespace pneuma::pipeline::workflow
