// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/stage.h"

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/base/place.h"
#include "pipeline/command_line/command_line.h"
#include "pipeline/digest/digest.h"
#include "pipeline/state/state_file.h"
#include "pipeline/yaml/node.h"
#include "stages/common/local.h"

namespace pneuma::stages::common {

namespace command_line = pipeline::command_line;

namespace {

std::string program_of(const std::string& kind) {
  return "pneuma-" + kind;
}

bool needs_input(const std::string& kind) {
  return kind != "mesh";
}

void check_arguments(const Arguments& arguments, bool has_input) {
  if (arguments.out.empty() && !arguments.check) throw base::InputError("--out is missing");
  if (has_input && arguments.in.empty() && !arguments.check) throw base::InputError("--in is missing");
  if (!arguments.out.empty() && arguments.out.extension() != ".hdf") {
    throw base::InputError(
        fmt::format("--out must end in .hdf (ParaView opens it by that), not `{}`", arguments.out.string()));
  }
  const std::filesystem::path folder = arguments.out.parent_path();
  if (!folder.empty() && !arguments.check && !std::filesystem::is_directory(folder)) {
    throw base::InputError(fmt::format("--out: there is no folder `{}`", folder.string()));
  }
}

} // namespace

std::optional<Arguments> read_arguments(const std::string& kind, const std::string& purpose, int argc, char** argv) {
  using command_line::Words;
  Arguments arguments;
  command_line::Command command = {
      program_of(kind),
      purpose,
      {{"--config", "stage.yaml", "settings of the stage, as `pneuma run` writes them",
        [&](const Words& v) { arguments.config = v[0]; }, command_line::Times::once},
       {"--out", "state.hdf", "state to be written; other results go beside it; needed without --check",
        [&](const Words& v) { arguments.out = v[0]; }},
       {"--threads", "N", "that compute side by side [1]",
        [&](const Words& v) { arguments.threads = command_line::whole_number("--threads", v[0], 1); }},
       {"--check", "", "read and check everything, compute and write nothing",
        [&](const Words&) { arguments.check = true; }},
       {"--note", "TEXT", "a warning about the input, to stand among those of the stage; again for more",
        [&](const Words& v) { arguments.notes.push_back(v[0]); }, command_line::Times::any}},
      {},
      [&] { check_arguments(arguments, needs_input(kind)); },
      "`pneuma run WORKFLOW.yaml` writes the settings and calls this program."};
  if (needs_input(kind)) {
    command.options.insert(command.options.begin() + 1,
                           {"--in", "state.hdf", "state to start from; needed without --check",
                            [&](const Words& v) { arguments.in = v[0]; }});
  }
  if (!command_line::read(command, Words(argv + 1, argv + argc))) return std::nullopt;
  return arguments;
}

namespace {

// What of the cushion and its materials the state was made with differs from what the stage's settings say; empty:
// nothing.
std::string other_cushion(const State& state, const Start& start) {
  namespace yaml = pipeline::yaml;
  std::vector<yaml::Problem> ignored;
  for (const yaml::Difference& one : yaml::differences(yaml::parse_yaml(state.provenance.settings, "", ignored),
                                                       yaml::parse_yaml(start.settings, "", ignored))) {
    if (!one.path.starts_with("cushion.") && !one.path.starts_with("materials.")) continue;
    return fmt::format("the state was made with `{}` {}, the settings say {}", one.path, one.before.value_or("(none)"),
                       one.after.value_or("(none)"));
  }
  return {};
}

// Reads the input state and checks that it belongs to the stage.
void read_input(Start& start) {
  const pipeline::workflow::StageSettings& stage = start.stage();
  start.state = pipeline::state::read_state(start.arguments.in);
  const State& state = start.state;
  const auto refuse = [&](const std::string& what) {
    throw base::StateError(fmt::format("{}: {}; run the stage `{}` of this workflow again", start.arguments.in.string(),
                                       what, stage.from));
  };
  if (state.provenance.stage_kind != stage.from_run) {
    refuse(fmt::format("the state comes from a `{}` stage, `{}` wants one from `{}`", state.provenance.stage_kind,
                       stage.id, stage.from_run));
  }
  if (!state.provenance.converged) {
    refuse(fmt::format("the state is that of a stage that did not reach its end ({})", state.provenance.verdict));
  }
  const pipeline::workflow::Cushion& cushion = start.workflow.cushion;
  const std::size_t blocks = cushion.foils.size() + (cushion.rigid_base ? 1 : 0);
  bool same = state.mesh.blocks.size() == blocks && state.chambers.size() == cushion.chambers.size();
  for (std::size_t i = 0; same && i < cushion.foils.size(); ++i)
    same = state.mesh.blocks[i].name == cushion.foils[i].name;
  for (std::size_t i = 0; same && i < cushion.chambers.size(); ++i)
    same = state.chambers[i].name == cushion.chambers[i].name;
  if (!same) refuse("the state holds other foils or chambers than the workflow");
  const std::string other = other_cushion(state, start);
  if (!other.empty()) refuse(other);
}

} // namespace

Start read_start(const std::string& kind, Arguments arguments) {
  Start start;
  start.program = program_of(kind);
  start.arguments = std::move(arguments);
  start.workflow = pipeline::workflow::read_stage(start.arguments.config);
  if (const pipeline::workflow::StageSettings& stage = start.stage(); stage.run != kind) {
    throw base::InputError(fmt::format("{}: this is a stage of kind `{}`; {} runs `{}`",
                                       start.arguments.config.string(), stage.run, start.program, kind));
  }
  start.settings = pipeline::workflow::effective_settings(start.workflow, start.stage());
  start.frame = geometry::LocalFrame(start.workflow.cushion.plan);
  start.workflow = to_local(std::move(start.workflow), start.frame);
  base::tell_places_from(origin_of(start));
  check_laws(start.workflow.materials, start.workflow.site.temperature);
  if (needs_input(kind) && !(start.arguments.check && start.arguments.in.empty())) start.laws = laws_of(start.workflow);
  if (needs_input(kind) && !start.arguments.in.empty()) read_input(start);
  for (const std::string& note : start.arguments.notes) base::warn(note);
  if (!start.arguments.check) {
    start.outputs = std::make_unique<pipeline::files::Outputs>(start.arguments.out, start.arguments.in);
  }
  return start;
}

pipeline::state::Provenance provenance(const Start& start) {
  pipeline::state::Provenance p;
  p.program = fmt::format("{} {}", start.program, command_line::version());
  p.stage_kind = start.stage().run;
  p.stage_id = start.stage().id;
  if (!start.arguments.in.empty()) p.inputs["state"] = pipeline::digest::sha256_of_file(start.arguments.in);
  // values only: where they stand in the user's file must not change the state
  p.settings = start.settings;
  return p;
}

int stage_main(const char* kind, const char* purpose, void (*body)(const Start&), int argc, char** argv) {
  return base::guarded_main(program_of(kind).c_str(), [&] {
    std::optional<Arguments> arguments = read_arguments(kind, purpose, argc, argv);
    if (arguments) body(read_start(kind, std::move(*arguments)));
    return 0;
  });
}

Vec3 origin_of(const Start& start) {
  const base::Vec2 origin = start.frame.origin();
  return {origin.x(), origin.y(), 0};
}

std::string number(double value) {
  return fmt::format("{:.5g}", value);
}

std::string place(const Workflow& workflow, const std::string& key) {
  const auto found = workflow.origins.find(key);
  return found == workflow.origins.end() ? "" : to_string(found->second) + ": ";
}

std::string place_of_foil(const Workflow& workflow, std::size_t foil) {
  return place(workflow, fmt::format("cushion.foils.{}.name", foil));
}

} // namespace pneuma::stages::common
