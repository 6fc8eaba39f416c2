// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

// The files of one stage in its output folder.
struct StageFiles {
  explicit StageFiles(std::filesystem::path stage_folder);
  std::filesystem::path folder, config, state, digest, summary, log, provenance;
};

// What a stage that ended was made from and what it made, as sha256; kept in provenance.json.
struct Provenance {
  std::string settings;                       // effective values of stage.yaml: not its layout, not where they stand
  std::string input;                          // state it started from; empty: none
  std::string executable;                     // program of the stage
  std::map<std::string, std::string> outputs; // files by their names from the folder, the state and the log among them
  int exit_code = 0;
  std::string verdict; // as the stage called its end; empty: it said none

  std::string state() const; // digest of the result; empty: none
};
std::optional<Provenance> read_provenance(const std::filesystem::path& file);
void write_provenance(const std::filesystem::path& file, const Provenance& provenance);

// Digests of all that the last run of the stage left.
std::map<std::string, std::string> digests_of_outputs(const StageFiles& files);

// Removes all that the last run left, its log and provenance too; what else lies in the folder stays.
void remove_results(const StageFiles& files);

// What a summary calls the end of its stage; empty: it says nothing.
std::string verdict_in(const std::filesystem::path& summary);

// sha256 of a state whose digest file says the same; empty: missing, damaged or not done.
std::string good_state(const StageFiles& files);

// Whether a stage has to run, and why.
struct Verdict {
  bool fresh = false;
  std::string reason; // of a stale one: "settings changed (mesh.size 0.15 m -> 0.1 m)"
};

// Compares what the stage would be made from now with what its result was made from, and its files with their digests.
Verdict examine(const StageFiles& files, const Provenance& wanted, const std::string& stage_yaml);

// What `stage.yaml` in the folder and the new text differ in, the first keys by name; empty: nothing.
std::string changed_keys(const std::string& before, const std::string& after);

} // namespace pneuma::pipeline::runner
