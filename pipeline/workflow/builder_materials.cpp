// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/test_data/test_data.h"
#include "pipeline/workflow/builder.h"
#include "pipeline/workflow/options.h"

namespace pneuma::pipeline::workflow {

using schema::celsius;
using schema::Node;
using schema::NodeKind;
using schema::number_of;
using schema::optional_number;
using schema::suggestion;
using schema::text_of;

namespace {

// stage.yaml carries the points of a table.
constexpr std::size_t most_points = 10'000;

// A key of a law at a temperature: of its entry, or where that leaves it out of the material.
const Value* key_of(const Value& material, const Value* entry, const std::string& key) {
  const Value* own = entry != nullptr ? (*entry)[key] : nullptr;
  return own != nullptr ? own : material[key];
}

double number_at(const Value& material, const Value* entry, const std::string& key) {
  const Value* value = key_of(material, entry, key);
  return value != nullptr ? value->number : 0;
}

// d stress / d plastic strain of a branch.
double plastic_modulus(const HardeningBranch& branch, const J2Law& law) {
  if (law.modulus == ModulusKind::plastic) return branch.modulus;
  return law.E * branch.modulus / (law.E - branch.modulus);
}

std::vector<std::string> files_of(const Value& data) {
  if (data.items.empty()) return {data.text};
  std::vector<std::string> files;
  for (const Value& item : data.items) files.push_back(item.text);
  return files;
}

} // namespace

MaterialsResult Builder::build_materials(const std::vector<std::string>& names) {
  read_materials_file(workflow_.file, {workflow_.file.generic_string(), 1, 1});
  check_fits();
  MaterialsResult result;
  result.names = material_names_;
  const std::vector<std::string>& asked = names.empty() ? material_names_ : names;
  for (const std::string& name : with_fits(asked)) read_points(name, std::nullopt);
  for (const std::string& name : material_names_) {
    const auto found = workflow_.materials.find(name);
    const bool is_asked = std::find(asked.begin(), asked.end(), name) != asked.end();
    if (is_asked && found != workflow_.materials.end()) result.materials.push_back(found->second);
  }
  result.known = std::move(workflow_.materials);
  return result;
}

void Builder::read_materials(const Value& root) {
  const Value* materials = root.find("materials");
  if (materials == nullptr) return;
  if (materials->read_as != nullptr && materials->read_as->type == schema::Type::table) {
    for (const auto& [name, value] : materials->members) add_material(name, value);
    return;
  }
  materials_known_ = materials->valid;
  if (!materials->valid || materials->read_as == nullptr) return;
  const auto read = [this](const Value& path) {
    read_materials_file((workflow_.file.parent_path() / path.text).lexically_normal(), path.mark);
  };
  if (materials->read_as->type == schema::Type::text) return read(*materials);
  for (const Value& item : materials->items) read(item);
}

void Builder::read_materials_file(const std::filesystem::path& file, const Mark& named) {
  const std::size_t before = problems.size();
  const std::string text = schema::read_text(file, named, problems);
  const Node tree = schema::parse_yaml(text, file.generic_string(), problems);
  if (problems.size() > before && tree.kind == NodeKind::null) {
    materials_known_ = false;
    return;
  }
  if (tree.kind != NodeKind::map) {
    materials_known_ = false;
    return fail(tree.mark, "a file of materials is a map: NAME: {law: elastic, E: 900 MPa, nu: 0.45}");
  }
  for (const schema::Entry& entry : tree.entries) {
    if (std::find(material_names_.begin(), material_names_.end(), entry.key) != material_names_.end()) {
      fail(entry.mark, fmt::format("the material `{}` is also in another file of materials; keep one", entry.key));
      continue;
    }
    Node one;
    one.kind = NodeKind::map;
    one.entries = {entry};
    schema::Check context{problems, workflow_.origins};
    const Value table = schema::check(materials_file_options(), one, "materials", context);
    for (const auto& [name, value] : table.members) add_material(name, value);
  }
}

void Builder::add_material(const std::string& name, const Value& value) {
  material_names_.push_back(name);
  if (value.valid) workflow_.materials[name] = material_of(name, value);
}

void Builder::need(const Value& material, const std::string& key, const std::string& why) {
  if (material.find(key) == nullptr) fail(material.mark, fmt::format("the key `{}` is missing: {}", key, why));
}

Material Builder::material_of(const std::string& name, const Value& value) {
  Material material;
  material.name = name;
  material.mark = is_stage_file_ ? value.mark : value.key; // of keys stage.yaml does not say where the user has them
  material.law = law_of(value, nullptr);
  material.at = number_of(value, "at", material.at);
  if (std::holds_alternative<TableLaw>(material.law)) tables_[name] = value;
  if (const Value* temperature = value["temperature"]) {
    for (const Value& entry : temperature->items) {
      const double at = number_of(entry, "at");
      if (at == material.at || material.other.contains(at)) {
        fail(entry["at"]->mark, fmt::format("a second law at {}; `at` of the law itself is {:.6g} degC",
                                            text_of(entry, "at"), celsius(material.at)));
      }
      material.other[at] = law_of(value, &entry);
    }
  }
  if (const Value* tension_field = value["tension_field"]) material.tension_field = tension_field->flag;
  material.density = optional_number(value, "density");
  material.thermal_expansion = optional_number(value, "thermal_expansion");
  material.strength = strength_of(value);
  material.source = text_of(value, "source");
  return material;
}

MaterialLaw Builder::law_of(const Value& material, const Value* entry) {
  if (material.text == "elastic") return elastic_of(material, entry);
  if (material.text == "j2") return j2_of(material, entry);
  if (material.text == "ogden") return material["terms"] != nullptr ? ogden_of(*material["terms"]) : OgdenLaw{};
  if (material.text == "pd_nurbs" || material.text == "le_nurbs") return table_of(material);
  return MooneyRivlinLaw{number_of(material, "C1"), number_of(material, "C2")};
}

MaterialLaw Builder::elastic_of(const Value& material, const Value* entry) {
  const Value& stated = entry != nullptr ? *entry : material;
  if (material.find("E") != nullptr) {
    for (const char* key : {"E1", "E2", "nu12", "G12"}) {
      refuse(stated, key, "belongs to an orthotropic foil (E1, E2, nu12, G12); this one has `E`");
    }
    need(material, "nu", "an isotropic foil has `E` and `nu`");
    return ElasticLaw{number_at(material, entry, "E"), number_at(material, entry, "nu")};
  }
  for (const char* key : {"E", "nu"}) refuse(stated, key, "belongs to an isotropic foil (E, nu); this one has `E1`");
  for (const char* key : {"E2", "nu12", "G12"}) {
    need(material, key, "an orthotropic foil has `E1`, `E2`, `nu12` and `G12`");
  }
  const OrthotropicLaw law{number_at(material, entry, "E1"), number_at(material, entry, "E2"),
                           number_at(material, entry, "nu12"), number_at(material, entry, "G12")};
  if (law.E1 > 0 && law.E2 > 0 && !(law.nu12 * law.nu12 < law.E1 / law.E2)) {
    fail(key_of(material, entry, "nu12")->mark,
         fmt::format("`nu12` must be between -{0:.4g} and {0:.4g}, the square root of E1 / E2, not {1}: otherwise some "
                     "strain has no positive energy; is it meant for tension along the other axis, nu21?",
                     std::sqrt(law.E1 / law.E2), law.nu12));
  }
  return law;
}

J2Law Builder::j2_of(const Value& material, const Value* entry) {
  J2Law law;
  law.E = number_at(material, entry, "E");
  law.nu = number_at(material, entry, "nu");
  law.modulus = text_of(material, "modulus") == "tangent" ? ModulusKind::tangent : ModulusKind::plastic;
  law.logarithmic = text_of(material, "strain") == "logarithmic";
  if (const Value* softening = material["softening"]) law.softening = softening->flag;
  const Value* hardening = key_of(material, entry, "hardening");
  if (hardening == nullptr || !(law.E > 0)) return law;
  for (const Value& branch : hardening->items) {
    law.hardening.push_back({number_of(branch, "stress"), number_of(branch, "modulus")});
  }
  check_hardening(*hardening, law);
  const Value* own = material["hardening"];
  if (own != nullptr && own->items.size() != hardening->items.size()) {
    fail(hardening->mark, fmt::format("`hardening` must have {} branches as the law itself, not {}: between two "
                                      "temperatures branch changes into branch",
                                      own->items.size(), hardening->items.size()));
  }
  if (const Value* viscosity = material["viscosity"]) law.viscosity = viscosity_of(*viscosity, law);
  return law;
}

void Builder::check_hardening(const Value& hardening, const J2Law& law) {
  const std::vector<HardeningBranch>& branches = law.hardening;
  for (std::size_t i = 0; i < branches.size(); ++i) {
    const Value& modulus = *hardening.items[i]["modulus"];
    const HardeningBranch& branch = branches[i];
    const bool is_last = i + 1 == branches.size();
    if (law.modulus == ModulusKind::tangent && branch.modulus >= law.E) {
      fail(modulus.mark,
           fmt::format("a tangent modulus must be below E, {:g} MPa, not {}; is it a plastic modulus? then "
                       "say `modulus: plastic`",
                       law.E / 1e6, modulus.text));
      continue;
    }
    if (branch.modulus < 0 && !law.softening) {
      fail(modulus.mark, fmt::format("a modulus of {} means softening: strains then gather in one row of elements and "
                                     "results depend on the mesh; say `softening: on` if it is meant",
                                     modulus.text));
      continue;
    }
    // the return to the yield surface has one solution only above
    const double steepest = -std::min(0.5 * law.E / (1 - law.nu), 1.5 * law.E / (1 + law.nu));
    if (plastic_modulus(branch, law) <= steepest) {
      fail(modulus.mark,
           fmt::format("the yield stress falls too steeply: as a plastic modulus {:.4g} MPa, which must be "
                       "above {:.4g} MPa",
                       plastic_modulus(branch, law) / 1e6, steepest / 1e6));
    }
    if (is_last) {
      if (branch.modulus < 0) {
        fail(modulus.mark, "the last branch must not soften: it would end below a yield stress of zero; add one with "
                           "`modulus: 0 MPa` where the softening ends");
      }
      continue;
    }
    const Value& next = *hardening.items[i + 1]["stress"];
    const Value& stress = *hardening.items[i]["stress"];
    if (branch.modulus == 0) {
      fail(modulus.mark, fmt::format("a branch of modulus {} never comes to the next one's yield stress, {}; only the "
                                     "last branch may be level",
                                     modulus.text, next.text));
    } else if (branch.modulus > 0 && branches[i + 1].stress <= branch.stress) {
      fail(next.mark,
           fmt::format("yield stresses must rise from branch to branch: {} after {}", next.text, stress.text));
    } else if (branch.modulus < 0 && branches[i + 1].stress >= branch.stress) {
      fail(next.mark, fmt::format("after a branch that softens the yield stress must be lower: {} after {}", next.text,
                                  stress.text));
    }
  }
}

ViscositySettings Builder::viscosity_of(const Value& viscosity, const J2Law& law) {
  ViscositySettings out;
  out.model =
      text_of(viscosity, "model") == "perzyna" ? ViscositySettings::Model::perzyna : ViscositySettings::Model::peric;
  out.mu = number_of(viscosity, "mu");
  out.epsilon = number_of(viscosity, "epsilon");
  out.threshold = optional_number(viscosity, "threshold");
  if (out.threshold && !law.hardening.empty() && *out.threshold > law.hardening.front().stress) {
    fail(viscosity["threshold"]->mark,
         fmt::format("`threshold` must be at most the first yield stress, {:g} MPa, not {}: without it the foil flows "
                     "from there on",
                     law.hardening.front().stress / 1e6, text_of(viscosity, "threshold")));
  }
  // the flow stress falls from the threshold on as the yield stress does
  double fall = 0;
  for (const HardeningBranch& branch : law.hardening) fall = std::max(fall, law.hardening[0].stress - branch.stress);
  if (out.threshold && fall > 0 && *out.threshold <= fall) {
    fail(viscosity["threshold"]->mark,
         fmt::format("`threshold` must be above {:g} MPa, by which the softening lowers the yield stress, not {}: "
                     "the foil would flow without stress",
                     fall / 1e6, text_of(viscosity, "threshold")));
  }
  return out;
}

OgdenLaw Builder::ogden_of(const Value& terms) {
  OgdenLaw law;
  double twice_shear_modulus = 0;
  for (const Value& item : terms.items) {
    law.terms.push_back({number_of(item, "mu"), number_of(item, "alpha")});
    twice_shear_modulus += law.terms.back().mu * law.terms.back().alpha;
  }
  if (twice_shear_modulus <= 0) {
    fail(terms.mark, fmt::format("the shear modulus, half the sum of mu alpha, must be positive, not {:.4g} MPa",
                                 twice_shear_modulus / 2e6));
    return law;
  }
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const OgdenLaw::Term& term = law.terms[i];
    const Value& item = terms.items[i];
    if (term.alpha == 0) {
      fail(item["alpha"]->mark, "`alpha` must not be 0: the term would have no meaning");
    } else if (term.mu == 0) {
      fail(item["mu"]->mark, "`mu` must not be 0: the term would have no effect");
    } else if (term.mu * term.alpha < 0) {
      warn(item.mark, fmt::format("`mu` {} and `alpha` {} have different signs: such a term may make the foil unstable "
                                  "in some range of stretch; the stage looks for one before it starts",
                                  text_of(item, "mu"), term.alpha));
    }
  }
  return law;
}

TableLaw Builder::table_of(const Value& material) {
  TableLaw law;
  law.kind = material.text == "le_nurbs" ? TableLaw::Kind::le_nurbs : TableLaw::Kind::pd_nurbs;
  law.fit_to = text_of(material, "fit_to");
  law.degree = static_cast<int>(number_of(material, "degree", law.degree));
  law.goes_on = text_of(material, "outside") == "linear";
  law.smoothing = optional_number(material, "smoothing");
  law.nu = number_of(material, "nu", law.nu);
  if (const Value* potential = material["potential"]) law.potential = potential->flag;
  if (const Value* net = material["net"]) {
    for (std::size_t i = 0; i < 2; ++i) {
      law.net[i] = static_cast<int>(net->items[i].number);
      if (law.net[i] > law.degree) continue;
      fail(net->items[i].mark, fmt::format("a net of degree {} needs at least {} control points, not {}", law.degree,
                                           law.degree + 1, law.net[i]));
    }
    if (law.kind == TableLaw::Kind::pd_nurbs && law.net[0] != law.net[1]) {
      fail(net->mark, fmt::format("the net of an isotropic table is the same along both principal strains, not {} x {}",
                                  law.net[0], law.net[1]));
    }
  }
  if (const Value* range = material["range"]) {
    const double least = range->items[0].number, most = range->items[1].number;
    if (least <= 0 && most > 0) {
      law.range = {least, most};
    } else {
      fail(range->mark, fmt::format("`range` must hold the strain 0, from which the foil starts, and end above it: "
                                    "[{}, {}] does not",
                                    range->items[0].text, range->items[1].text));
    }
  } else if (!law.fit_to.empty() && material.find("range") == nullptr) {
    fail(material.mark, "`range` is missing: another material has strains without end; say which the table shall hold");
  }
  if (const Value* points = material["points"]) {
    for (const Value& row : points->items) {
      const auto at = [&](std::size_t i) { return row.items[i].number; };
      law.points.push_back({at(0), at(1), at(2), at(3), at(4)});
    }
    if (std::none_of(law.points.begin(), law.points.end(), [](const TableLaw::Point& p) { return p.weight > 0; })) {
      fail(points->mark, "no point has a weight above 0");
    }
  }
  if (const Value* points = material["shear_points"]) {
    for (const Value& row : points->items) {
      law.shear_points.push_back({row.items[0].number, row.items[1].number, row.items[2].number});
    }
  }
  if (law.kind == TableLaw::Kind::le_nurbs) {
    const bool has_points = material.find("data") != nullptr || material.find("points") != nullptr;
    const bool has_shear = material.find("shear_data") != nullptr || material.find("shear_points") != nullptr;
    if (has_points && !has_shear) need(material, "shear_data", "points along the axes say nothing about shear");
    if (!law.fit_to.empty()) {
      for (const char* key : {"shear_data", "shear_points"}) {
        refuse(material, key, "cannot stand beside `fit_to`, which gives the shear too");
      }
    }
  }
  if (is_stage_file_) {
    for (const char* key : {"data", "shear_data"}) refuse(material, key, "is not for stage.yaml, which has `points`");
  }
  return law;
}

std::optional<Strength> Builder::strength_of(const Value& material) {
  const Value* strength = material["strength"];
  if (strength == nullptr) return std::nullopt;
  Strength out;
  out.characteristic = number_of(*strength, "characteristic");
  out.weld = optional_number(*strength, "weld");
  out.ultimate = optional_number(*strength, "ultimate");
  out.source = text_of(*strength, "source");
  if (const Value* factors = (*strength)["factors"]) {
    for (const auto& [name, factor] : factors->members) out.factors[name] = factor.number;
  }
  if (const Value* temperature = (*strength)["temperature"]) {
    for (const Value& entry : temperature->items) {
      const double at = number_of(entry, "at");
      if (!out.temperature.empty() && at <= out.temperature.back()[0]) {
        fail(entry["at"]->mark,
             fmt::format("temperatures must rise from entry to entry; {} does not", text_of(entry, "at")));
      }
      out.temperature.push_back({at, number_of(entry, "factor")});
    }
  }
  return out;
}

void Builder::finish_materials() {
  check_fits();
  std::vector<std::string> of_foils;
  for (const FoilSettings& foil : workflow_.cushion.foils) of_foils.push_back(foil.material);
  const std::set<std::string> used = with_fits(of_foils);
  for (const std::string& name : used) {
    read_points(name, workflow_.site.temperature);
    if (const auto found = workflow_.materials.find(name); found != workflow_.materials.end()) {
      check_temperature(found->second);
    }
  }
  std::erase_if(workflow_.materials, [&](const auto& item) { return !used.contains(item.first); });
}

void Builder::check_fits() {
  const auto fit_to = [this](const std::string& name) {
    const auto found = workflow_.materials.find(name);
    const auto* table = found != workflow_.materials.end() ? std::get_if<TableLaw>(&found->second.law) : nullptr;
    return table != nullptr ? table->fit_to : std::string();
  };
  std::set<std::string> told; // in circles
  for (const std::string& name : material_names_) {
    const std::string target = fit_to(name);
    if (target.empty()) continue;
    const Value& value = tables_.at(name);
    const Mark& mark = value["fit_to"]->mark;
    if (std::find(material_names_.begin(), material_names_.end(), target) == material_names_.end()) {
      fail(mark, fmt::format("there is no material `{}`{}; known: {}", target, suggestion(target, material_names_),
                             schema::joined(material_names_)));
      continue;
    }
    std::vector<std::string> chain = {name};
    for (std::string next = target; !next.empty(); next = fit_to(next)) {
      const bool known = std::find(chain.begin(), chain.end(), next) != chain.end();
      chain.push_back(next);
      if (known) break;
    }
    if (chain.size() > 2 ? chain.back() == name : target == name) {
      if (told.insert(name).second) fail(mark, fmt::format("`fit_to` goes in a circle: {}", fmt::join(chain, " <- ")));
      told.insert(chain.begin(), chain.end());
      continue;
    }
    const auto found = workflow_.materials.find(target);
    if (found == workflow_.materials.end()) continue; // its fault is told
    const MaterialLaw& law = found->second.law;
    const auto* j2 = std::get_if<J2Law>(&law);
    if (j2 != nullptr && j2->viscosity) {
      fail(mark, fmt::format("`{}` flows with time, and a table knows no rate; fit to a material without `viscosity`",
                             target));
    }
    const auto* table = std::get_if<TableLaw>(&law);
    const bool has_axes =
        std::holds_alternative<OrthotropicLaw>(law) || (table != nullptr && table->kind == TableLaw::Kind::le_nurbs);
    if (value.text == "pd_nurbs" && has_axes) {
      fail(mark, fmt::format("`{}` differs along its axes, and a table of principal strains does not; take `le_nurbs`",
                             target));
    }
  }
}

std::set<std::string> Builder::with_fits(const std::vector<std::string>& names) const {
  std::set<std::string> all;
  for (const std::string& first : names) {
    for (std::string name = first; !name.empty() && all.insert(name).second;) {
      const auto found = workflow_.materials.find(name);
      const auto* table = found != workflow_.materials.end() ? std::get_if<TableLaw>(&found->second.law) : nullptr;
      name = table != nullptr ? table->fit_to : "";
    }
  }
  return all;
}

void Builder::read_points(const std::string& name, std::optional<double> of_site) {
  const auto value = tables_.find(name);
  if (value == tables_.end() || is_stage_file_) return;
  auto& law = std::get<TableLaw>(workflow_.materials.at(name).law);
  const auto measure = text_of(value->second, "measure") == "green_lagrange" ? test_data::Measure::green_lagrange
                                                                             : test_data::Measure::engineering;
  const std::string path = "materials." + name;
  std::optional<std::array<double, 2>> temperatures; // of the tests, least and most
  const auto rows_of = [&](const char* key, const std::vector<std::string>& needed, const auto& take) {
    const Value* data = value->second[key];
    if (data == nullptr) return;
    for (const std::string& text : files_of(*data)) {
      const auto file = (std::filesystem::path(data->mark.file).parent_path() / text).lexically_normal();
      const std::size_t before = problems.size();
      const std::string content = schema::read_text(file, data->mark, problems);
      if (problems.size() > before) continue;
      for (const test_data::Row& row : test_data::parse(content, file.generic_string(), measure, needed, problems)) {
        take(test_data::converted(row, measure, test_data::Measure::green_lagrange),
             Mark{file.generic_string(), row.line, 1});
        if (std::isnan(row.temperature)) continue;
        const auto [least, most] = temperatures.value_or(std::array{row.temperature, row.temperature});
        temperatures = {std::min(least, row.temperature), std::max(most, row.temperature)};
      }
    }
  };
  rows_of("data", {"strain_1", "strain_2", "stress_1", "stress_2"}, [&](const test_data::Row& row, const Mark& mark) {
    workflow_.origins[fmt::format("{}.points.{}.0", path, law.points.size())] = mark;
    law.points.push_back({row.strain_1, row.strain_2, row.stress_1, row.stress_2, row.weight});
  });
  rows_of("shear_data", {"shear_strain", "shear_stress"}, [&](const test_data::Row& row, const Mark& mark) {
    workflow_.origins[fmt::format("{}.shear_points.{}.0", path, law.shear_points.size())] = mark;
    law.shear_points.push_back({row.shear_strain, row.shear_stress, row.weight});
  });
  if (law.points.size() + law.shear_points.size() > most_points) {
    fail(value->second.mark, fmt::format("{} points are more than a table takes ({}); thin them out",
                                         law.points.size() + law.shear_points.size(), most_points));
  }
  const Value* data = value->second["data"];
  if (temperatures)
    check_test_temperatures((data != nullptr ? data : value->second["shear_data"])->mark, *temperatures, of_site);
  if (const MissingTests missing = missing_tests(law); !missing.message.empty()) {
    problems.push_back({(data != nullptr ? data : value->second["points"])->mark, missing.message, missing.useless});
  }
  const Value* range = value->second["range"];
  for (const TableLaw::Point& point : law.points) {
    const auto [low, high] = std::minmax(point.strain_1, point.strain_2);
    if (!law.range || (low >= (*law.range)[0] && high <= (*law.range)[1])) continue;
    fail(range->mark, fmt::format("`range` [{}, {}] leaves out points with strains {:.4g} and {:.4g} (Green-Lagrange)",
                                  (*law.range)[0], (*law.range)[1], point.strain_1, point.strain_2));
    break;
  }
}

void Builder::check_test_temperatures(const Mark& data, const std::array<double, 2>& tests,
                                      std::optional<double> of_site) {
  constexpr double steady = 5, near = 10; // K
  const auto [least, most] = tests;
  if (most - least > steady) {
    warn(data, fmt::format("the tests were taken at {:.4g} to {:.4g} degC; a table knows no temperature and takes them "
                           "as one: give each temperature a table of its own",
                           celsius(least), celsius(most)));
  } else if (of_site && (*of_site < least - near || *of_site > most + near)) {
    warn(data, fmt::format("the tests were taken at {:.4g} degC and the site has {:.4g} degC; a table knows no "
                           "temperature and keeps what it is fitted to",
                           celsius(0.5 * (least + most)), celsius(*of_site)));
  }
}

void Builder::check_temperature(const Material& material) {
  const auto range = temperatures_of(material);
  const double site = workflow_.site.temperature;
  if (!range || (site >= (*range)[0] && site <= (*range)[1])) return;
  const auto stated = workflow_.origins.find("site.temperature");
  fail(stated != workflow_.origins.end() ? stated->second : material.mark,
       fmt::format("the site's temperature, {:.4g} degC, is outside the table of the material `{}`: {:.4g} to {:.4g} "
                   "degC",
                   celsius(site), material.name, celsius((*range)[0]), celsius((*range)[1])));
}

} // namespace pneuma::pipeline::workflow
