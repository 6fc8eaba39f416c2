// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/state/state_file.h"

namespace pneuma::pipeline::state {

namespace {

// "0007.hdf"
std::string step_name(std::size_t number) {
  return fmt::format("{:04}.hdf", number);
}

std::string series_text(const std::vector<double>& times) {
  std::string files;
  for (std::size_t i = 0; i < times.size(); ++i) {
    files += fmt::format("{}\n    {{\"name\": \"steps/{}\", \"time\": {}}}", i == 0 ? "" : ",", step_name(i), times[i]);
  }
  return fmt::format("{{\n  \"file-series-version\": \"1.0\",\n  \"files\": [{}\n  ]\n}}\n", files);
}

} // namespace

StepSeries::StepSeries(files::Outputs& outputs) : outputs_(outputs) {}

void StepSeries::write(const State& state, double time) {
  if (!std::isfinite(time)) throw base::Error(base::ExitCode::bug, "a step without a finite time");
  write_state(state, outputs_, "steps/" + step_name(times_.size()));
  times_.push_back(time);
  files::write_file(outputs_.file("steps.hdf.series"), series_text(times_));
}

} // namespace pneuma::pipeline::state
