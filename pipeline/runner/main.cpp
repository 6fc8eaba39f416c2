// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/runner/check.h"
#include "pipeline/runner/process.h"
#include "pipeline/runner/run.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

namespace {

using base::ExitCode;
using base::say;

const std::vector<std::string> own_words = {"run", "check", "status", "schema", "keys"};
const std::vector<std::string> program_words = {"picture", "material"};
const std::vector<std::string> later_words = {"study", "report", "audit"};

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Reads the file and prints warnings; throws with all errors at once.
workflow::Workflow read(const std::string& file) {
  workflow::ReadResult result = workflow::read_workflow(file);
  std::string errors;
  for (const workflow::Problem& problem : result.problems) {
    if (problem.error) {
      errors += (errors.empty() ? "" : "\n") + to_string(problem);
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

// A program of its own beside this one.
int forward(const std::string& word, const std::vector<std::string>& rest) {
  const auto program = runner::program_folder() / ("pneuma-" + word);
  check_program(program);
  runner::become(program, rest);
  return static_cast<int>(ExitCode::bug);
}

// What no command line library says: the word that was meant.
void check_word(const std::string& word) {
  if (contains(later_words, word)) throw base::InputError(fmt::format("`pneuma {}` is not available yet", word));
  if (word.empty() || word.front() == '-' || contains(own_words, word)) return;
  std::vector<std::string> known = own_words;
  known.insert(known.end(), program_words.begin(), program_words.end());
  throw base::InputError(fmt::format("there is no command `{}`{}; commands: {}; or a workflow file", word,
                                     schema::suggestion(word, known), schema::joined(known)));
}

bool is_workflow_file(const std::string& word) {
  const std::filesystem::path path(word);
  std::error_code ignored;
  return path.extension() == ".yaml" || path.extension() == ".yml" || std::filesystem::is_regular_file(path, ignored);
}

int body(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && contains(program_words, words.front())) {
    return forward(words.front(), {words.begin() + 1, words.end()});
  }
  if (!words.empty() && !contains(own_words, words.front()) && is_workflow_file(words.front())) {
    words.insert(words.begin(), "run");
  }
  if (!words.empty()) check_word(words.front());

  CLI::App app("From form to wind for ETFE cushions: runs the stages of a workflow file.", "pneuma");
  app.footer("A workflow file as first word means `run`. Also: pneuma picture STATE --field F --out P.png, pneuma "
             "material M.yaml.");
  app.set_version_flag("--version", "pneuma " PNEUMA_VERSION);
  app.require_subcommand(1);

  std::string file, out;
  runner::RunOptions options;
  const auto with_file = [&](CLI::App* command) {
    command->add_option("workflow", file, "the workflow file")->required();
    return command;
  };
  const auto with_out = [&](CLI::App* command) {
    command->add_option("--out", out, "folder of the results [out/<name> beside the workflow file]");
    return command;
  };
  CLI::App* run = with_out(with_file(app.add_subcommand("run", "run what is out of date, and say why")));
  auto* only = run->add_option("--only", options.only, "this stage alone");
  run->add_option("--from", options.from, "this stage and all that depends on it, anew")->excludes(only);
  run->add_option("--force", options.force, "this stage anew")->take_all();
  run->add_option("--jobs", options.jobs, "stages side by side [number of cores]")->check(CLI::Range(1, 1024));
  CLI::App* check_command = with_file(app.add_subcommand("check", "find all errors without running"));
  CLI::App* status = with_out(with_file(app.add_subcommand("status", "which stages are fresh, and key results")));
  CLI::App* schema_command = app.add_subcommand("schema", "the JSON schema of workflow files, for editors");
  CLI::App* keys = app.add_subcommand("keys", "the reference of all keys of a workflow file");

  try {
    std::reverse(words.begin(), words.end()); // what CLI11 takes
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  options.out = out;
  if (run->parsed()) {
    const workflow::Workflow workflow = read(file);
    check_by_stages(workflow, MeshCheck::left_out);
    return runner::run(workflow, options);
  }
  if (check_command->parsed()) check(file);
  if (status->parsed()) runner::show_status(read(file), out);
  if (schema_command->parsed()) fmt::print("{}", workflow::workflow_json_schema());
  if (keys->parsed()) fmt::print("{}", workflow::workflow_reference());
  return static_cast<int>(ExitCode::done);
}

} // namespace

} // namespace pneuma::pipeline::runner

int main(int argc, char** argv) {
  return pneuma::base::guarded_main("pneuma", [&] { return pneuma::pipeline::runner::body(argc, argv); });
}
