// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pipeline/files/outputs.h"
#include "pipeline/state/state.h"

namespace pneuma::pipeline::state {

// Writes `state` to `path` (name ends in .hdf) as VTKHDF 1.0 UnstructuredGrid, what ParaView need not see in the group
// /pneuma of the same file. Written to a temporary file, flushed and renamed; the digest `<path>.sha256` first, then
// the state, so that a pair that does not match means "not done". Equal states give equal bytes. The folder must exist.
// Throws MachineError with the path and the system's reason, e.g. a full disk, and Error (exit code 1) for a state
// whose parts do not fit together; then neither file is changed.
void write_state(const State& state, const std::filesystem::path& path);
void write_state(const State& state, files::Outputs& outputs, const std::string& name); // among a stage's outputs

// Reads what write_state wrote, bit for bit. The digest beside the file is verified before libhdf5 parses its bytes;
// without a digest a child process with limits of time and memory parses them first. Every length is checked. Throws
// StateError: missing, digest of something else, damaged, foreign, other schema version. Call it while no other thread
// is inside libhdf5.
State read_state(const std::filesystem::path& path);

// Writes states as steps: steps/0000.hdf and so on, and steps.hdf.series (JSON, what ParaView opens as a series) with
// `time` as the step's time value.
class StepSeries {
public:
  explicit StepSeries(files::Outputs& outputs);
  void write(const State& state, double time);
  int count() const { return static_cast<int>(times_.size()); }

private:
  files::Outputs& outputs_;
  std::vector<double> times_;
};

} // namespace pneuma::pipeline::state
