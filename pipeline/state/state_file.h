// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pipeline/state/state.h"

namespace pneuma::pipeline::state {

// Writes `state` to `path` (name ends in .hdf) as VTKHDF 1.0 UnstructuredGrid, what ParaView need not see in the group
// /pneuma of the same file. Written to a temporary file, flushed and renamed; the digest `<path>.sha256` first, then
// the state, so that a pair that does not match means "not done". Throws Error (exit code 1 or 3) with the path and the
// system's reason, e.g. a full disk; then neither file is changed. Equal states give equal bytes.
void write_state(const State& state, const std::filesystem::path& path);

// Reads what write_state wrote, bit for bit. The digest beside the file is verified before libhdf5 opens it; without a
// matching digest the file is first opened in a child process with limits of time and memory. Every length is checked.
// Throws StateError: missing, damaged, foreign, other schema version.
State read_state(const std::filesystem::path& path);

// Writes `state` as step `number` into the folder: steps/NNNN.hdf, and steps.hdf.series beside the folder (JSON, what
// ParaView opens as a series), with `time` as the step's time value.
class StepSeries {
public:
  explicit StepSeries(std::filesystem::path folder);
  void write(const State& state, double time);
  int count() const { return static_cast<int>(times_.size()); }

private:
  std::filesystem::path folder_;
  std::vector<double> times_;
};

} // namespace pneuma::pipeline::state
