// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::Keys;

// Between two temperatures branch changes into branch.
void check_branches(Reader& reader, const At<Material>& material) {
  const auto* own = std::get_if<J2Law>(&material->law);
  for (std::size_t i = 0; own != nullptr && i < material->other.size(); ++i) {
    const std::string entry = schema::below(material.path, fmt::format("temperature.{}", i));
    const auto hardening = At<J2Law>{std::get<J2Law>(material->other[i].law), entry}[&J2Law::hardening];
    if (hardening->size() == own->hardening.size()) continue;
    reader.fail(hardening.path, fmt::format("{} must have {} branches as the law itself, not {}: between two "
                                            "temperatures branch changes into branch",
                                            schema::name(&J2Law::hardening), own->hardening.size(), hardening->size()));
  }
}

// The law at another temperature: what changes with it; what it leaves out is as in the law itself.
template <class L>
void add_temperatures(Keys<Material>& keys) {
  using Entry = Material::AtTemperature;
  Keys<Entry> entry;
  entry("at", &Entry::at, quantity("K").positive(), "the temperature");
  Keys<L> varying;
  if constexpr (requires { L::declare_varying(varying); }) {
    L::declare_varying(varying);
  } else {
    varying.list = schema::keys_of<L>().list;
  }
  for (schema::Key<L>& key : varying.list) key.form.option.is_required = false;
  entry.include(
      varying, [](auto& one) -> auto& { return std::get<L>(one.law); });
  const Form<Entry> item =
      group(entry).named("temperature", "what the law has there; the rest is as in the law itself");
  const auto read = [item](const schema::Source& source, Material& material) {
    const auto& [reader, option, node, path, variant] = source;
    bool complete = reader.items(source);
    for (std::size_t i = 0; complete && i < node.items.size(); ++i) {
      const std::string place = schema::below(path, std::to_string(i));
      Entry one{0, material.law};
      complete = item.read(reader, node.items[i], place, one);
      const bool is_second =
          one.at == material.at || std::any_of(material.other.begin(), material.other.end(),
                                               [&](const Entry& other) { return other.at == one.at; });
      material.other.push_back(one);
      if (!complete || !is_second) continue;
      reader.fail(schema::below(place, "at"),
                  fmt::format("a second law at {:.6g} degC; `at` of the law itself is {:.6g} degC",
                              schema::celsius(one.at), schema::celsius(material.at)));
      return false;
    }
    return complete;
  };
  const auto all = list(item).items(1, 1000);
  const auto write = [all](const Material& material) {
    return material.other.empty() ? std::optional<yaml::Node>() : all.write(material.other);
  };
  keys("temperature", Form<Material>{all.option, read, write},
       "the law at other temperatures; linear between neighbours, an error outside");
}

// The keys of one law in a material.
template <class L>
Keys<Material> material_of(const Keys<L>& law, bool has_temperatures = false) {
  Keys<Material> keys;
  keys.alternative(law, &Material::law);
  if (has_temperatures) {
    keys("at", &Material::at, quantity("K").positive().otherwise("23 degC"),
         "temperature at which the law's own values hold")
        .where([](const Material& material) { return !material.other.empty(); }, "");
    add_temperatures<L>(keys);
  }
  keys.include(schema::keys_of<Material>(), std::identity());
  keys.rule(check_branches);
  return keys;
}

Keys<Material> material_of_table(TableLaw::Kind kind) {
  Keys<TableLaw> law;
  TableLaw::declare(law, kind);
  law.rule(TableLaw::check);
  Keys<Material> keys = material_of(law);
  keys.begin = [kind](Material& material) { material.law.emplace<TableLaw>().kind = kind; };
  keys.is_written = [kind](const Material& material) {
    const auto* table = std::get_if<TableLaw>(&material.law);
    return table != nullptr && table->kind == kind;
  };
  return keys;
}

} // namespace

Form<Material> material() {
  using schema::keys_of;
  Keys<MooneyRivlinLaw> neo_hooke;
  MooneyRivlinLaw::declare_neo_hooke(neo_hooke);
  return schema::tagged<Material>( // neo-Hooke is written as what it is, the first of its type
      "law", {material_of(keys_of<ElasticLaw>(), true), material_of(keys_of<OrthotropicLaw>(), true),
              material_of(keys_of<J2Law>(), true), material_of(keys_of<OgdenLaw>()),
              material_of(keys_of<MooneyRivlinLaw>()), material_of(neo_hooke),
              material_of_table(TableLaw::Kind::pd_nurbs), material_of_table(TableLaw::Kind::le_nurbs)});
}

void TableLaw::check(Reader& reader, const At<TableLaw>& law) {
  const auto net_at = law[&TableLaw::net];
  for (std::size_t i = 0; i < 2; ++i) {
    if (law->net[i] > law->degree) continue;
    reader.fail(net_at.at(i, std::to_string(i)).path,
                fmt::format("a net of degree {} needs at least {} control points, not {}", law->degree, law->degree + 1,
                            law->net[i]));
  }
  if (law->kind == Kind::pd_nurbs && law->net[0] != law->net[1]) {
    reader.fail(net_at.path, fmt::format("the net of an isotropic table is the same along both principal strains, not "
                                         "{} x {}",
                                         law->net[0], law->net[1]));
  }
  const std::string range_at = law[&TableLaw::range].path;
  if (law->range && !((*law->range)[0] <= 0 && (*law->range)[1] > 0)) {
    reader.fail(range_at, fmt::format("{} must hold the strain 0, from which the foil starts, and end above it: [{}, "
                                      "{}] does not",
                                      schema::name(&TableLaw::range), (*law->range)[0], (*law->range)[1]));
  }
  const bool has_weight =
      std::any_of(law->points.begin(), law->points.end(), [](const Point& point) { return point.weight > 0; });
  if (!law->points.empty() && !has_weight) reader.fail(law[&TableLaw::points].path, "no point has a weight above 0");
  const bool has_shear = !law->shear_data.empty() || !law->shear_points.empty();
  if (law->fit_to && has_shear) {
    reader.fail_key(law->shear_data.empty() ? law[&TableLaw::shear_points].path : law[&TableLaw::shear_data].path,
                    fmt::format("shear cannot stand beside {}, which gives the shear too; leave it out",
                                schema::name(&TableLaw::fit_to)));
  }
  if (reader.is_stage_file() && (!law->data.empty() || !law->shear_data.empty())) {
    reader.fail_key(law->data.empty() ? law[&TableLaw::shear_data].path : law[&TableLaw::data].path,
                    "files of tests are not for stage.yaml, which has their points; leave them out");
  }
}

void Strength::check(Reader& reader, const At<Strength>& strength) {
  const auto entries = items(strength[&Strength::temperature]);
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i]->at > entries[i - 1]->at) continue;
    const auto at = entries[i][&AtTemperature::at];
    reader.fail(at.path, fmt::format("temperatures must rise from entry to entry; {:.6g} degC does not",
                                     schema::celsius(at.value)));
  }
}

} // namespace pneuma::pipeline::workflow
