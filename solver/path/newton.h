// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "solver/path/control.h"

namespace pneuma::solver::path {

struct NewtonOptions {
  double tolerance = 1e-9;    // |residual| / force scale; gas laws to the same relative error
  int max_iterations = 240;   // slack foils need many damped ones; taut cushions three to six
  int patience = 120;         // after so many only while the residual falls tenfold in twenty
  int max_line_searches = 12; // evaluations in one line search
};

// One iteration, as it is reported.
struct Iteration {
  double load_factor = 0;
  int number = 0;         // within the step
  double residual = 0;    // relative to the force scale, before the iteration
  double gas = 0;         // relative error of the gas laws, before
  double step_length = 1; // of the line search
  double shift = 0;       // N/m, largest artificial tension that acted in the tangent (0: none)
};

// Newton's method for a cushion in equilibrium, on its bordered tangent.
class Newton {
public:
  Newton(System& system, NewtonOptions options);

  struct Outcome {
    bool converged = false;
    std::string reason; // why not
    int iterations = 0;
    double residual = 0; // relative, at the end
  };
  // Solves at configuration.load_factor, starting from the configuration; on failure it is left where it got to.
  // Steps go down in energy: an artificial tension acts in the tangent where it must (never in the residual, so that an
  // accepted state is in equilibrium without it), and a line search guards each step.
  Outcome solve(Configuration& configuration, const std::function<void(const Iteration&)>& report = {});

  // Solves with the load factor unknown and a quantity held at `wanted` instead, by plain steps with the tangent as it
  // is: stable or not, from a start nearby. At most `max_iterations` of its own, since a path is better cut.
  Outcome solve(Configuration& configuration, const Held& held, double wanted, int max_iterations,
                const std::function<void(const Iteration&)>& report = {});

  // Whether a start is in equilibrium already.
  bool stands_at(const assembly::Balance& balance) const;

  Tangent& tangent() { return tangent_; }
  const NewtonOptions& options() const { return options_; }
  const Work& work() const { return work_; }

private:
  assembly::Balance evaluate(Configuration& configuration, bool with_tangent);
  double slope(const Change& direction) const;

  System& system_;
  NewtonOptions options_;
  Work work_;
  Tangent tangent_;
};

} // namespace pneuma::solver::path
