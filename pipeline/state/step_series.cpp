// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/state/state_file.h"
#include "pipeline/state/whole_file.h"

namespace pneuma::pipeline::state {

namespace {

namespace fs = std::filesystem;

// "0007.hdf"
std::string step_name(std::size_t number) {
  return fmt::format("{:04}.hdf", number);
}

bool is_step_file(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t digits = name.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string::npos && name.substr(digits).starts_with(".hdf");
}

// Only what a series has written: the user may keep other things there.
void remove_old_steps(const fs::path& folder) {
  fs::remove(folder / "steps.hdf.series");
  const fs::path steps = folder / "steps";
  if (!fs::is_directory(steps)) return;
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(steps)) {
    if (entry.is_regular_file() && is_step_file(entry.path())) old.push_back(entry.path());
  }
  for (const fs::path& file : old) fs::remove(file);
}

std::string series_text(const std::vector<double>& times) {
  std::string files;
  for (std::size_t i = 0; i < times.size(); ++i) {
    files += fmt::format("{}\n    {{\"name\": \"steps/{}\", \"time\": {}}}", i == 0 ? "" : ",", step_name(i), times[i]);
  }
  return fmt::format("{{\n  \"file-series-version\": \"1.0\",\n  \"files\": [{}\n  ]\n}}\n", files);
}

} // namespace

StepSeries::StepSeries(fs::path folder) : folder_(std::move(folder)) {}

void StepSeries::write(const State& state, double time) {
  if (!std::isfinite(time)) {
    throw base::Error(base::ExitCode::bug, fmt::format("{}: a step without a finite time", folder_.string()));
  }
  try {
    if (times_.empty()) remove_old_steps(folder_);
    fs::create_directories(folder_ / "steps");
  } catch (const fs::filesystem_error& error) {
    throw base::StateError(fmt::format("{}: {}", folder_.string(), error.what()));
  }
  write_state(state, folder_ / "steps" / step_name(times_.size()));
  times_.push_back(time);
  PendingFile(folder_ / "steps.hdf.series", series_text(times_)).publish();
}

} // namespace pneuma::pipeline::state
