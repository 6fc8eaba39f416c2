// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

// The files of one stage in its output folder.
struct StageFiles {
  explicit StageFiles(std::filesystem::path stage_folder);
  std::filesystem::path folder, config, state, digest, summary, log, provenance;
};

// What a finished stage was made from and what it made, as sha256; kept in provenance.json.
struct Provenance {
  std::string settings;   // effective values of stage.yaml: not its layout, not the places in the user's file
  std::string input;      // state it started from; empty: none
  std::string executable; // program of the stage
  std::string state;      // result
};
std::optional<Provenance> read_provenance(const std::filesystem::path& file);
void write_provenance(const std::filesystem::path& file, const Provenance& provenance);

// sha256 of a state whose digest file says the same; empty: missing, damaged or not done.
std::string good_state(const StageFiles& files);

// Whether a stage has to run, and why.
struct Verdict {
  bool fresh = false;
  std::string reason; // of a stale one: "settings changed (mesh.size 0.15 m -> 0.1 m)"
};

// Compares what the stage would be made from now with what its result was made from. `wanted.state` is not used.
Verdict examine(const StageFiles& files, const Provenance& wanted, const std::string& stage_yaml);

// What `stage.yaml` in the folder and the new text differ in, the first keys by name; empty: nothing.
std::string changed_keys(const std::string& before, const std::string& after);

} // namespace pneuma::pipeline::runner
