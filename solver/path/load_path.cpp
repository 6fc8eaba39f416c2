// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/load_path.h"

#include <algorithm>

#include <fmt/format.h>

namespace pneuma::solver::path {

PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const std::function<Verdict(const Step&, const Configuration&)>& accepted,
                       const std::function<void(int, const Iteration&)>& report) {
  PathResult result;
  const double part = 1.0 / options.parts;
  double length = part;
  int part_number = 1; // the part being walked
  constexpr int easy_iterations = 8;
  while (part_number <= options.parts) {
    const double goal = part_number == options.parts ? 1.0 : part * part_number;
    const double left = goal - result.load_factor;
    // no sliver of a step at the end of a part
    const bool to_goal = length > 0.999 * left;
    Configuration trial = configuration;
    trial.load_factor = to_goal ? goal : result.load_factor + (length > 0.6 * left ? 0.5 * left : length);
    const Newton::Outcome outcome = newton.solve(trial, [&](const Iteration& i) {
      if (report) report(result.steps + 1, i);
    });
    if (!outcome.converged) {
      length = (trial.load_factor - result.load_factor) / 4;
      if (length < options.smallest_step) {
        system.evaluate(configuration, true);
        result.reason =
            fmt::format("no equilibrium found beyond load factor {:.6g}: {}", result.load_factor, outcome.reason);
        return result;
      }
      continue;
    }
    system.accept_history();
    configuration = std::move(trial);
    result.load_factor = configuration.load_factor;
    ++result.steps;
    if (to_goal) ++part_number;
    if (outcome.iterations <= easy_iterations) length = std::min(2 * length, part);
    const Step step{result.steps, result.load_factor, outcome.iterations, to_goal};
    if (accepted && accepted(step, configuration) == Verdict::stop) {
      result.end = PathEnd::stopped;
      return result;
    }
  }
  result.end = PathEnd::reached;
  return result;
}

} // namespace pneuma::solver::path
