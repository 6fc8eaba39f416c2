// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <tuple>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/workflow/builder.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

using schema::Node;
using schema::NodeKind;

namespace {

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

MaterialsResult read_materials(const std::filesystem::path& file, const std::vector<std::string>& names) {
  Builder builder(file, false);
  MaterialsResult result = builder.build_materials(names);
  result.problems = std::move(builder.problems);
  put_in_order(result.problems, file.generic_string());
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
  std::vector<std::string> errors;
  for (const Problem& problem : builder.problems) {
    if (problem.error) errors.push_back(to_string(problem));
  }
  if (!errors.empty()) throw base::InputError(fmt::format("{}", fmt::join(errors, "\n")));
  return workflow;
}

} // namespace pneuma::pipeline::workflow
