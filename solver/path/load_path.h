// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/path/newton.h"

namespace pneuma::solver::path {

struct LoadPathOptions {
  int parts = 1;               // the path is reported at `parts` equal parts; between them steps are automatic
  double smallest_step = 1e-5; // of the load factor
};

// An accepted step.
struct Step {
  int number = 0;
  double load_factor = 0;
  int iterations = 0;
  bool end_of_part = false;
};

enum class Verdict : std::uint8_t { go_on, stop };

enum class PathEnd : std::uint8_t { reached, stopped, stuck };

struct PathResult {
  PathEnd end = PathEnd::stuck;
  std::string reason; // why stuck
  int steps = 0;
  double load_factor = 0; // of the last good state
};

// Load control: from load factor 0 to 1, whole parts first, cut back by four on any failure, doubled after easy
// success. `accepted` sees every accepted step, with the system evaluated there, and may stop the path; `configuration`
// ends as the last accepted one.
PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const std::function<Verdict(const Step&, const Configuration&)>& accepted,
                       const std::function<void(int step, const Iteration&)>& report = {});

} // namespace pneuma::solver::path
