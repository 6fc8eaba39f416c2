// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/command_line/command_line.h"
#include "pipeline/runner/check.h"
#include "pipeline/runner/process.h"
#include "pipeline/runner/run.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

namespace {

using base::ExitCode;
using base::say;

using command_line::Command;
using command_line::Option;
using command_line::Words;
using schema::is_among;

const Words own_words = {"run", "check", "status", "schema", "keys"};
const Words program_words = {"picture", "material"};
const Words later_words = {"study", "report", "audit"};

// Reads the file and prints warnings; throws with all errors at once.
workflow::Workflow read(const std::string& file) {
  workflow::ReadResult result = workflow::read_workflow(file);
  std::string errors;
  for (const workflow::Problem& problem : result.problems) {
    if (problem.error) {
      errors += fmt::format("{}{}", errors.empty() ? "" : "\n", to_string(problem));
    } else {
      fmt::print(stderr, "{}\n", to_string(problem));
    }
  }
  if (!errors.empty()) throw base::InputError(errors);
  return std::move(result.workflow);
}

std::string counted(std::size_t count, const char* thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

void check(const std::string& file) {
  const workflow::Workflow workflow = read(file);
  check_by_stages(workflow, MeshCheck::made);
  std::string ids;
  for (const auto& stage : workflow.stages) ids += (ids.empty() ? "" : ", ") + stage.id;
  say(fmt::format("{}: ok: {} ({}), {}, {}", file, counted(workflow.stages.size(), "stage"), ids,
                  counted(workflow.cushion.foils.size(), "foil"),
                  counted(workflow.cushion.chambers.size(), "chamber")));
}

// Becomes a program of its own beside this one.
int forward(const std::string& word, const Words& rest) {
  const auto program = runner::program_folder() / ("pneuma-" + word);
  check_program(program);
  runner::become(program, rest);
  return static_cast<int>(ExitCode::bug);
}

bool is_workflow_file(const std::string& word) {
  const std::filesystem::path path(word);
  std::error_code ignored;
  return path.extension() == ".yaml" || path.extension() == ".yml" || std::filesystem::is_regular_file(path, ignored);
}

// What the command line asks for.
struct Asked {
  std::string file;
  RunOptions options;
};

Option with_id(const std::string& name, const std::string& text, const std::function<void(const std::string&)>& set,
               command_line::Times times = command_line::Times::at_most_once) {
  return {name, "ID", text,
          [=](const Words& values) { // an empty one would stand for none
            if (values[0].empty()) throw base::InputError(fmt::format("{}: the name of the stage is empty", name));
            set(values[0]);
          },
          times};
}

Command program(Asked& asked) {
  RunOptions& options = asked.options;
  const Option file = {"WORKFLOW.yaml", "", "the workflow file", [&](const Words& v) { asked.file = v[0]; },
                       command_line::Times::once};
  const Option out = {"--out", "DIR", "folder of the results [out/<name> beside the workflow file]",
                      [&](const Words& v) { options.out = v[0]; }};
  const Option only = with_id("--only", "this stage alone, if it is out of date, from its input as that is",
                              [&](const std::string& id) { options.only = id; });
  const Option from = with_id("--from", "this stage and all that depends on it, anew; what it needs, if out of date",
                              [&](const std::string& id) { options.from = id; });
  const Option force = with_id(
      "--force", "this stage anew; again for more", [&](const std::string& id) { options.force.push_back(id); },
      command_line::Times::any);
  const Option jobs = {"--jobs", "N", "stages side by side, 1 to 1024 [number of cores]",
                       [&](const Words& v) { options.jobs = command_line::whole_number("--jobs", v[0], 1, 1024); }};
  const auto exclude = [&] {
    if (options.only.empty() || options.from.empty()) return;
    throw base::InputError("--only runs a stage alone, --from all that depends on it too; leave one of them away");
  };
  return {"pneuma",
          "from form to wind for ETFE cushions: runs the stages of a workflow file",
          {},
          {{"run", "runs what is out of date, and says why", {file, out, only, from, force, jobs}, {}, exclude},
           {"check", "finds all errors without running", {file}},
           {"status", "which stages are fresh, and key results", {file, out}},
           {"schema", "the JSON schema of workflow files, for editors"},
           {"keys", "the reference of all keys of a workflow file"},
           {"picture", "a PNG of a state: pneuma picture STATE.hdf --field NAME --out PICTURE.png"},
           {"material", "curves of materials: pneuma material MATERIALS.yaml"}},
          {},
          "A workflow file as first word means `run`."};
}

int body(int argc, char** argv) {
  Words words(argv + 1, argv + argc);
  const std::string first = words.empty() ? "" : words.front();
  if (is_among(first, program_words)) return forward(first, {words.begin() + 1, words.end()});
  if (is_among(first, later_words)) throw base::InputError(fmt::format("`pneuma {}` is not available yet", first));
  if (!is_among(first, own_words) && is_workflow_file(first)) words.insert(words.begin(), "run");

  Asked asked;
  const std::optional<std::string> command = command_line::read(program(asked), words);
  if (command == "run") {
    const workflow::Workflow workflow = read(asked.file);
    check_by_stages(workflow, MeshCheck::left_out);
    return runner::run(workflow, asked.options);
  }
  if (command == "check") check(asked.file);
  if (command == "status") show_status(read(asked.file), asked.options.out);
  if (command == "schema") fmt::print("{}", workflow::workflow_json_schema());
  if (command == "keys") fmt::print("{}", workflow::workflow_reference());
  return static_cast<int>(ExitCode::done);
}

} // namespace

} // namespace pneuma::pipeline::runner

int main(int argc, char** argv) {
  return pneuma::base::guarded_main("pneuma", [&] { return pneuma::pipeline::runner::body(argc, argv); });
}
