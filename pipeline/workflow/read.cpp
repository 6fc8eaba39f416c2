// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <tuple>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/schema/json_schema.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/materials.h"
#include "pipeline/workflow/settings.h"
#include "pipeline/workflow/stages.h"

namespace pneuma::pipeline::workflow {

namespace {

using yaml::Node;
using yaml::NodeKind;

constexpr int stage_format = 2;            // of stage.yaml
constexpr std::size_t most_problems = 200; // that are told

// A file as it stands: of a user, or (is_stage_file) of the runner.
struct File {
  int format = 0;
  std::string name;
  Site site;
  std::variant<std::vector<std::string>, Materials> materials; // files of them, or in place
  Cushion cushion;
  std::optional<MeshSettings> mesh;
  std::map<std::string, StageSettings> stages;

  static void declare(schema::Keys<File>& keys, bool is_stage_file);
};

void File::declare(schema::Keys<File>& keys, bool is_stage_file) {
  const auto version = [](int number) {
    return integer().between(number, number, fmt::format("{}, the version this program reads", number));
  };
  const auto in_place = schema::as<decltype(materials)>(table(material().named("NAME", "a material")));
  if (is_stage_file) {
    keys("format", &File::format, version(stage_format), "version of the format of stage.yaml");
    keys("name", &File::name, text().otherwise("\"\""), "of the project");
    keys("site", &File::site, group<Site>(), "where the cushion is");
    keys("materials", &File::materials, in_place, "of the foils");
  } else {
    const auto file = text().named("file", "a file of materials");
    const auto one = mapped<decltype(materials)>(
        file, [](const std::string& path) { return std::vector{path}; }, [](const auto&) { return std::string(); });
    const auto several = schema::as<decltype(materials)>(list(file).named("files", "files of materials"));
    keys("pneuma", &File::format, version(1), "version of the format");
    keys("name", &File::name, text().otherwise("\"\""), "of the project");
    keys("materials", &File::materials,
         either<decltype(materials)>({one, several, in_place.named("in_place", "materials in place")},
                                     [](const auto&) { return 0; }),
         "where the materials of the foils are");
    keys("site", &File::site, group<Site>().otherwise("{}"), "where the cushion is");
  }
  keys("cushion", &File::cushion, group<Cushion>(), "what is built");
  auto& mesh = keys("mesh", &File::mesh, group<MeshSettings>(), "the mesh all foils get");
  mesh.form.option.is_required = !is_stage_file;
  const auto stages_by_id = table(stage_form(is_stage_file).named("ID", "a stage"));
  keys("stages", &File::stages, is_stage_file ? stages_by_id : stages_by_id.otherwise("{}"), "the stages by their IDs")
      .or_another();
  if (is_stage_file) return;
  const char* stage = "loads stand in a wind stage";
  keys.unavailable("loads", stage);
  keys.unavailable("combinations", stage);
  keys.unavailable("accuracy", "choose the mesh size by hand");
  keys.is("workflow", "From form to wind for ETFE cushions");
}

const Form<File>& file_form(bool is_stage_file) {
  const auto make = [](bool of_stage) {
    schema::Keys<File> keys;
    File::declare(keys, of_stage);
    return group(keys);
  };
  static const Form<File> user = make(false), stage = make(true);
  return is_stage_file ? stage : user;
}

bool has_errors(const std::vector<Problem>& problems) {
  return std::any_of(problems.begin(), problems.end(), [](const Problem& problem) { return problem.error; });
}

// In the order of the files and in each from top to bottom; the same once.
std::vector<Problem> in_order(Reader& reader, const std::filesystem::path& first_file) {
  std::vector<Problem> problems = std::move(reader.problems);
  const auto key = [first = first_file.generic_string()](const Problem& p) {
    return std::tuple(p.mark.file != first, p.mark.file, p.mark.line, p.mark.column);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return key(a) < key(b); });
  const auto same = [](const Problem& a, const Problem& b) {
    return to_string(a.mark) == to_string(b.mark) && a.message == b.message;
  };
  problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
  if (problems.size() <= most_problems) return problems;
  const std::vector<Problem> more(problems.begin() + static_cast<std::ptrdiff_t>(most_problems), problems.end());
  problems.resize(most_problems);
  problems.push_back(
      {problems.back().mark, fmt::format("and {} more problems behind this one", more.size()), has_errors(more)});
  return problems;
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
                                  [](const yaml::Entry& entry) { return entry.key == "origin"; });
  if (found == tree.entries.end()) return origins;
  for (const yaml::Entry& entry : found->value.entries) {
    if (const auto mark = parse_mark(entry.value.text)) origins[entry.key] = *mark;
  }
  tree.entries.erase(found);
  return origins;
}

std::string folder_relative(const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (file.is_absolute() == folder.is_absolute()) {
    const auto relative = file.lexically_normal().lexically_relative((folder / "").lexically_normal());
    if (!relative.empty()) return relative.generic_string();
  }
  const auto base = std::filesystem::absolute(folder.empty() ? std::filesystem::path(".") : folder).lexically_normal();
  return std::filesystem::absolute(file).lexically_normal().lexically_relative(base).generic_string();
}

// The materials that the foils use, with the points of their tables.
void read_materials_of(Reader& reader, File& file, const Node& tree, Workflow& out) {
  const auto* files = std::get_if<std::vector<std::string>>(&file.materials);
  const Node* node = yaml::find(tree, "materials");
  if (node == nullptr || (node->kind != NodeKind::map && !reader.is_whole("materials"))) {
    reader.cannot_know("material");
  } else if (node->kind == NodeKind::map) {
    define_materials(reader, *node);
    if (auto* in_place = std::get_if<Materials>(&file.materials)) out.materials = std::move(*in_place);
  } else {
    const auto read = [&](const std::string& path, const Node& named) {
      read_materials_file(reader, (out.file.parent_path() / path).lexically_normal(), named.mark, out.materials);
    };
    for (std::size_t i = 0; i < files->size(); ++i) read((*files)[i], node->items.empty() ? *node : node->items[i]);
  }
  std::vector<std::string> of_foils;
  for (const FoilSettings& foil : out.cushion.foils) of_foils.push_back(foil.material);
  const std::set<std::string> used = settle_materials(reader, out.materials, of_foils, out.site.temperature);
  std::erase_if(out.materials, [&](const auto& item) { return !used.contains(item.first); });
}

void check_gravity(Reader& reader, const Workflow& workflow) {
  const auto has_weight = [](const StageSettings& stage) { return stage.run == "inflate" || stage.run == "wind"; };
  if (!workflow.site.gravity || std::none_of(workflow.stages.begin(), workflow.stages.end(), has_weight)) {
    return;
  }
  std::set<std::string> told;
  for (const At<FoilSettings>& foil : items(At<Cushion>{workflow.cushion, "cushion"}[&Cushion::foils])) {
    const auto found = workflow.materials.find(foil->material);
    if (found == workflow.materials.end() || found->second.density || !told.insert(foil->material).second) continue;
    reader.fail(foil[&FoilSettings::material].path,
                fmt::format("the material `{}` has no {}, which gravity needs; add it, or say `site: {{gravity: off}}`",
                            foil->material, schema::name(&Material::density)));
  }
}

// In the order of the file, `mesh` first.
void read_stages(File& file, const Node& tree, Workflow& out) {
  if (file.mesh) out.stages.push_back({"mesh", "mesh", "", "", *file.mesh});
  const Node* stages = yaml::find(tree, "stages");
  for (const yaml::Entry& entry : stages != nullptr ? stages->entries : std::vector<yaml::Entry>{}) {
    const auto found = file.stages.find(entry.key);
    if (found == file.stages.end()) continue;
    out.stages.push_back(std::move(found->second));
    out.stages.back().id = entry.key;
    out.stages.back().run = yaml::find(entry.value, "run")->text;
  }
}

// The tree of stage.yaml with these stages, without its origins.
Node stage_node(const Workflow& workflow, const std::vector<StageSettings>& stages) {
  File file;
  file.format = stage_format;
  file.name = workflow.name;
  file.site = workflow.site;
  file.cushion = workflow.cushion;
  file.materials = workflow.materials;
  for (const StageSettings& stage : stages) {
    if (const auto* mesh = std::get_if<MeshSettings>(&stage.settings)) {
      file.mesh = *mesh;
    } else {
      file.stages.emplace(stage.id, stage);
    }
  }
  return file_form(true).write(file);
}

// What decides a result: not the format and the name of the project.
Node settings_node(const Workflow& workflow, const std::vector<StageSettings>& stages) {
  Node node = stage_node(workflow, stages);
  std::erase_if(node.entries, [](const yaml::Entry& entry) { return entry.key == "format" || entry.key == "name"; });
  return node;
}

void find_origins(const Reader& reader, Workflow& out) {
  std::map<std::string, std::string> relative; // of each file
  const Node node = settings_node(out, out.stages);
  for (const auto& [path, leaf] : yaml::leaves(node)) {
    std::optional<Mark> mark = reader.origin(path);
    if (!mark) continue;
    const auto [known, is_new] = relative.try_emplace(mark->file);
    if (is_new) known->second = folder_relative(mark->file, out.file.parent_path());
    mark->file = known->second;
    out.origins[path] = *mark;
  }
}

Workflow build(Reader& reader, const Node& tree, const std::filesystem::path& path) {
  Workflow out;
  out.file = path;
  File file;
  file_form(reader.is_stage_file()).read(reader, tree, "", file);
  if (tree.kind != NodeKind::map) return out;
  out.name = file.name;
  out.site = file.site;
  out.cushion = file.cushion;
  read_stages(file, tree, out);
  read_materials_of(reader, file, tree, out);
  const Node* stages = yaml::find(tree, "stages");
  if (stages != nullptr && stages->kind == NodeKind::map) link(reader, *stages, out.stages);
  reader.check_references();
  if (reader.is_whole("site")) check_gravity(reader, out);
  settle(reader, out);
  if (!has_errors(reader.problems) && !reader.is_stage_file()) find_origins(reader, out);
  return out;
}

} // namespace

ReadResult read_workflow(const std::filesystem::path& file) {
  Reader reader;
  const Node& tree = read_file(reader, file, {file.generic_string(), 1, 1});
  ReadResult result;
  result.workflow.file = file;
  if (tree.kind != NodeKind::null) {
    result.workflow = build(reader, tree, file);
  } else if (reader.problems.empty()) {
    reader.fail(tree.mark, "the file is empty; a workflow begins with `pneuma: 1`");
  }
  result.problems = in_order(reader, file);
  return result;
}

MaterialsResult read_materials(const std::filesystem::path& file, const std::vector<std::string>& names) {
  Reader reader;
  MaterialsResult result;
  read_materials_file(reader, file, {file.generic_string(), 1, 1}, result.known);
  result.names = reader.names("material");
  const std::vector<std::string>& asked = names.empty() ? result.names : names;
  settle_materials(reader, result.known, asked, std::nullopt);
  reader.check_references();
  for (const std::string& name : result.names) {
    const auto found = result.known.find(name);
    if (schema::is_among(name, asked) && found != result.known.end()) result.materials.push_back(found->second);
  }
  result.problems = in_order(reader, file);
  return result;
}

Workflow read_stage(const std::filesystem::path& file) {
  Reader reader(true);
  const std::string name = file.generic_string();
  const std::string text = yaml::read_text(file, {name, 1, 1}, reader.problems);
  Node tree = yaml::parse_yaml(text, name, reader.problems);
  const std::map<std::string, Mark> origins = take_origins(tree);
  if (yaml::find(tree, "pneuma") != nullptr && yaml::find(tree, "format") == nullptr) {
    const char* what = origins.empty()
                           ? "this is a workflow file, not the stage.yaml of a stage; run it with `pneuma run`"
                           : "this stage.yaml was written by an older version; run the workflow again";
    throw base::InputError(to_string(Problem{tree.mark, what}));
  }
  yaml::replace_marks(tree, origins);
  Workflow workflow;
  if (tree.kind != NodeKind::null) workflow = build(reader, reader.keep(std::move(tree)), file);
  workflow.origins = origins;
  if (!has_errors(reader.problems) && workflow.stages.size() != 1) {
    reader.fail(Mark{name, 1, 1}, fmt::format("a stage file holds one stage, not {}", workflow.stages.size()));
  }
  std::vector<std::string> errors;
  for (const Problem& problem : in_order(reader, file)) {
    if (problem.error) errors.push_back(to_string(problem));
  }
  if (!errors.empty()) throw base::InputError(fmt::format("{}", fmt::join(errors, "\n")));
  return workflow;
}

std::string effective_settings(const Workflow& workflow, const StageSettings& stage) {
  Workflow computed = workflow; // without what changes no result
  for (auto& [name, material] : computed.materials) {
    material.strength.reset();
    material.source.reset();
  }
  return yaml::write_yaml(settings_node(computed, {stage}));
}

std::string stage_yaml(const Workflow& workflow, const StageSettings& stage) {
  Node node = stage_node(workflow, {stage});
  // where the values come from; what is not listed is a default
  Node origin;
  origin.kind = NodeKind::map;
  for (const auto& [path, leaf] : yaml::leaves(node)) {
    const auto known = workflow.origins.find(path);
    if (known != workflow.origins.end()) add(origin, path, yaml::scalar(to_string(known->second)));
  }
  add(node, "origin", std::move(origin));
  return yaml::write_yaml(node);
}

std::string workflow_json_schema() {
  return schema::json_schema(file_form(false).option, "Pneuma workflow");
}

std::string workflow_reference() {
  return schema::reference(file_form(false).option);
}

} // namespace pneuma::pipeline::workflow
