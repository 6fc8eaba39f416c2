// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/outline.h"
#include "pipeline/files/outputs.h"
#include "pipeline/state/state.h"
#include "pipeline/workflow/settings.h"
#include "stages/common/law.h"

namespace pneuma::stages::common {

using base::Index;
using base::Vec3;
using base::VecX;
using pipeline::state::State;
using pipeline::workflow::Workflow;

// The command line of every stage.
struct Arguments {
  std::filesystem::path config, in, out;
  int threads = 1;
  bool check = false;             // read and check everything, compute nothing
  std::vector<std::string> notes; // warnings about the input, to stand among those of the stage
};

// Reads the line of a stage of this kind ("mesh"); `purpose`: what it is for, for --help. nullopt: help or version was
// asked for and is printed. Throws InputError for a wrong line.
std::optional<Arguments> read_arguments(const std::string& kind, const std::string& purpose, int argc, char** argv);

// What a stage starts from.
struct Start {
  std::string program; // "pneuma-inflate"
  Arguments arguments;
  std::string settings;                              // effective values as the user has them
  geometry::LocalFrame frame;                        // of the plan; all that follows is in its coordinates
  Workflow workflow;                                 // one stage in it
  MaterialLaws laws;                                 // of the foils' materials; none for the mesh stage
  State state;                                       // of --in; empty for the mesh stage
  std::unique_ptr<pipeline::files::Outputs> outputs; // where everything is written; none with --check

  const pipeline::workflow::StageSettings& stage() const { return workflow.stages.front(); }
};

// Reads stage.yaml and the input state, and checks that they belong together: the stage is of this kind, the state
// holds the foils and chambers of the cushion, and comes from the kind of stage that `from` names. Throws InputError
// and StateError.
Start read_start(const std::string& kind, Arguments arguments);

// The whole of a stage's program: reads its line and its start, runs `body`, and tells errors; returns the exit code.
int stage_main(const char* kind, const char* purpose, void (*body)(const Start& start), int argc, char** argv);

// Where the state's coordinates begin, in the user's, m.
Vec3 origin_of(const Start& start);

// Provenance of the state that this stage writes, all but its verdict.
pipeline::state::Provenance provenance(const Start& start);

// "400 Pa" style number for messages: three to six significant digits.
std::string number(double value);

// Place of a key in the user's file, for messages: "cushion.yaml:14:22: ", or "" if the user did not write it.
std::string place(const Workflow& workflow, const std::string& key);
std::string place_of_foil(const Workflow& workflow, std::size_t foil);

} // namespace pneuma::stages::common
