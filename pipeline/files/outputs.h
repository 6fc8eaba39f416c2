// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "pipeline/files/file.h"

namespace pneuma::pipeline::files {

// What one run of a stage writes beside its state DIR/a.hdf: every file is entered in the list DIR/.a.hdf.outputs
// before it is written, so that the next run, or the runner, can remove what it does not write again.
class Outputs {
public:
  // Removes what the last run left, but for the state it starts from. Throws MachineError.
  Outputs(const std::filesystem::path& state, const std::filesystem::path& input);
  // Enters a file, named from the folder ("steps/0001.hdf"), makes its folder, and returns its path.
  std::filesystem::path file(const std::string& name);
  const std::string& state_name() const { return state_name_; }

private:
  std::filesystem::path folder_;
  std::string state_name_;
  GrowingFile list_;
};

// Names of the files that the last run of a stage entered; those that lead out of the folder are left out.
std::set<std::string> outputs_of(const std::filesystem::path& state);

// Removes such files of the folder, where they are there. Throws MachineError.
void remove_outputs(const std::filesystem::path& folder, const std::set<std::string>& names);

} // namespace pneuma::pipeline::files
