// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/materials.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/workflow/circles.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::celsius;
using yaml::NodeKind;

// stage.yaml carries the points of a table.
constexpr std::size_t most_points = 10'000;

std::string path_of(const std::string& name) {
  return "materials." + name;
}

const TableLaw* table_of(const Materials& materials, const std::string& name) {
  const auto found = materials.find(name);
  return found != materials.end() ? std::get_if<TableLaw>(&found->second.law) : nullptr;
}

// What a table is fitted to; empty: nothing, or it is no table.
std::string fit_of(const Materials& materials, const std::string& name) {
  const TableLaw* table = table_of(materials, name);
  return table != nullptr && table->fit_to ? *table->fit_to : "";
}

} // namespace

const yaml::Node& read_file(Reader& reader, const std::filesystem::path& file, const Mark& named) {
  const std::string text = yaml::read_text(file, named, reader.problems);
  yaml::Node tree = yaml::parse_yaml(text, file.generic_string(), reader.problems);
  yaml::drop_templates(tree);
  return reader.keep(std::move(tree));
}

void define_materials(Reader& reader, const yaml::Node& map) {
  for (const yaml::Entry& entry : map.entries) reader.define("material", entry.key, entry.mark);
}

void read_materials_file(Reader& reader, const std::filesystem::path& file, const Mark& named, Materials& out) {
  const std::size_t before = reader.problems.size();
  const yaml::Node& tree = read_file(reader, file, named);
  if (reader.problems.size() > before && tree.kind == NodeKind::null) return reader.cannot_know("material");
  if (tree.kind != NodeKind::map) {
    reader.cannot_know("material");
    return reader.fail(tree.mark, "a file of materials is a map: NAME: {law: elastic, E: 900 MPa, nu: 0.45}");
  }
  define_materials(reader, tree);
  static const Form<Materials> form = table(material());
  Materials read;
  form.read(reader, tree, "materials", read);
  out.merge(read);
}

namespace {

// It exists, has no rate and no axes of its own, and does not go in a circle.
void check_fits(Reader& reader, const Materials& materials) {
  std::map<std::string, std::string> fits;
  for (const std::string& name : reader.names("material")) fits[name] = fit_of(materials, name);
  std::set<std::string> in_circle;
  for (const std::vector<std::string>& circle : circles(reader.names("material"), fits)) {
    in_circle.insert(circle.begin(), circle.end());
    reader.fail(path_of(circle.front()) + ".fit_to",
                fmt::format("`fit_to` goes in a circle: {}", fmt::join(circle, " <- ")));
  }
  for (const auto& [name, target] : fits) {
    if (target.empty() || in_circle.contains(name)) continue;
    const Mark mark = reader.mark(path_of(name) + ".fit_to");
    const auto found = materials.find(target);
    if (found == materials.end()) {
      reader.refer("material", target, mark);
      continue;
    }
    const auto* j2 = std::get_if<J2Law>(&found->second.law);
    if (j2 != nullptr && j2->viscosity) {
      reader.fail(mark, fmt::format("`{}` flows with time, and a table knows no rate; fit to a material without "
                                    "`viscosity`",
                                    target));
    }
    const TableLaw* table = table_of(materials, target);
    const bool has_axes = std::holds_alternative<OrthotropicLaw>(found->second.law) ||
                          (table != nullptr && table->kind == TableLaw::Kind::le_nurbs);
    if (has_axes && table_of(materials, name)->kind == TableLaw::Kind::pd_nurbs) {
      reader.fail(mark, fmt::format("`{}` differs along its axes, and a table of principal strains does not; take "
                                    "`le_nurbs`",
                                    target));
    }
  }
}

} // namespace

std::set<std::string> with_fits(const Materials& materials, const std::vector<std::string>& names) {
  std::set<std::string> found;
  for (const std::string& first : names) {
    for (std::string name = first; !name.empty() && found.insert(name).second;) name = fit_of(materials, name);
  }
  return found;
}

namespace {

void check_test_temperatures(Reader& reader, const std::string& path, const std::array<double, 2>& tests,
                             std::optional<double> of_site) {
  constexpr double steady = 5, near = 10; // K
  const auto [least, most] = tests;
  if (most - least > steady) {
    reader.warn(path, fmt::format("the tests were taken at {:.4g} to {:.4g} degC; a table knows no temperature and "
                                  "takes them as one: give each temperature a table of its own",
                                  celsius(least), celsius(most)));
  } else if (of_site && (*of_site < least - near || *of_site > most + near)) {
    reader.warn(path, fmt::format("the tests were taken at {:.4g} degC and the site has {:.4g} degC; a table knows no "
                                  "temperature and keeps what it is fitted to",
                                  celsius(0.5 * (least + most)), celsius(*of_site)));
  }
}

void check_range(Reader& reader, const TableLaw& law, const std::string& path) {
  for (const TableLaw::Point& point : law.points) {
    const auto [low, high] = std::minmax(point.strain_1, point.strain_2);
    if (!law.range || (low >= (*law.range)[0] && high <= (*law.range)[1])) continue;
    return reader.fail(path + ".range",
                       fmt::format("`range` [{}, {}] leaves out points with strains {:.4g} and {:.4g} (Green-Lagrange)",
                                   (*law.range)[0], (*law.range)[1], point.strain_1, point.strain_2));
  }
}

// Reads the points of a table's files of tests.
void read_tests(Reader& reader, Material& material, std::optional<double> of_site) {
  auto* law = std::get_if<TableLaw>(&material.law);
  if (law == nullptr || reader.is_stage_file()) return;
  const std::string path = path_of(material.name);
  const auto read = [&](const std::vector<std::string>& files, const char* key,
                        const std::vector<std::string>& needed) {
    return test_data::read_tests(files, reader.mark(path + key), law->measure, needed, reader.problems);
  };
  const auto tests = read(law->data, ".data", {"strain_1", "strain_2", "stress_1", "stress_2"});
  for (std::size_t i = 0; i < tests.rows.size(); ++i) {
    const test_data::Row& row = tests.rows[i];
    reader.came_from(fmt::format("{}.points.{}.0", path, i), tests.marks[i]);
    law->points.push_back({row.strain_1, row.strain_2, row.stress_1, row.stress_2, row.weight});
  }
  const auto shear = read(law->shear_data, ".shear_data", {"shear_strain", "shear_stress"});
  for (std::size_t i = 0; i < shear.rows.size(); ++i) {
    const test_data::Row& row = shear.rows[i];
    reader.came_from(fmt::format("{}.shear_points.{}.0", path, i), shear.marks[i]);
    law->shear_points.push_back({row.shear_strain, row.shear_stress, row.weight});
  }
  const std::size_t count = law->points.size() + law->shear_points.size();
  if (count > most_points) {
    reader.fail(path, fmt::format("{} points are more than a table takes ({}); thin them out", count, most_points));
  }
  if (tests.temperatures) check_test_temperatures(reader, path + ".data", *tests.temperatures, of_site);
  if (shear.temperatures) check_test_temperatures(reader, path + ".shear_data", *shear.temperatures, of_site);
  if (!law->fit_to) {
    const test_data::MissingTests missing = test_data::missing_tests(law->points, law->has_axes());
    const std::string where = path + (law->data.empty() ? ".points" : ".data");
    if (!missing.message.empty()) reader.problems.push_back({reader.mark(where), missing.message, missing.useless});
  }
  check_range(reader, *law, path);
  law->data.clear(); // stage.yaml has their points
  law->shear_data.clear();
}

// Fills in where the user has its values.
void find_places(const Reader& reader, Material& material) {
  static const Form<Material> form = workflow::material();
  const std::string path = path_of(material.name);
  // of keys stage.yaml does not say where the user has them
  material.places[""] = reader.is_stage_file() ? reader.mark(path) : reader.key_mark(path);
  const yaml::Node written = form.write(material);
  for (const auto& [key, leaf] : yaml::leaves(written)) {
    if (key.starts_with("points.") || key.starts_with("shear_points.")) continue;
    if (const std::optional<Mark> place = reader.origin(path + "." + key)) material.places[key] = *place;
  }
}

} // namespace

std::set<std::string> settle_materials(Reader& reader, Materials& materials, const std::vector<std::string>& names,
                                       std::optional<double> of_site) {
  for (auto& [name, material] : materials) material.name = name;
  check_fits(reader, materials);
  std::set<std::string> used = with_fits(materials, names);
  for (auto& [name, material] : materials) {
    if (used.contains(name)) read_tests(reader, material, of_site);
    find_places(reader, material);
  }
  return used;
}

} // namespace pneuma::pipeline::workflow
