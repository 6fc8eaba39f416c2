// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "solver/assembly/system.h"

namespace pneuma::solver::path {

using assembly::Configuration;
using assembly::System;
using base::Index;
using base::MatX;
using base::Vec3;
using base::VecX;

struct NewtonOptions {
  double tolerance = 1e-9;    // |residual| / force scale; gas laws to the same relative error
  int max_iterations = 80;    // slack foils need many damped ones; taut cushions three to six
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

// Work and time of everything a solver object did.
struct Work {
  int iterations = 0;
  int factorizations = 0; // of one foil's tangent
  int line_searches = 0;
  double assembly = 0, factorization = 0, solve = 0; // s of wall time
  double analysis = 0;
};

// Newton's method on the bordered system of a cushion: one Cholesky factor per foil, side by side; the chambers are a
// few rows and columns around them (block elimination, Sherman-Morrison-Woodbury in the case of closed air).
//
// Where a tangent is not positive definite (flat or slack foils) an artificial tension is added to it,
// mu int grad N . grad N, as small as makes it so. It acts on the way only: the residual knows nothing of it, so that
// an accepted state is in equilibrium without it.
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
  Outcome solve(Configuration& configuration, const std::function<void(const Iteration&)>& report = {});

  // Negative eigenvalues of the tangent at the last evaluated configuration, counted without shift; none if the count
  // is not safe (a foil is not positive definite, or has a pivot within 1e-10 of zero).
  struct Stability {
    std::optional<int> load_held;    // gas borders only
    std::optional<int> control_held; // all borders; load control: the same
  };
  Stability stability(const Configuration& configuration);

  const Work& work() const { return work_; }

private:
  struct Direction {
    std::vector<VecX> du; // per foil
    VecX dp;              // per chamber, 0 where prescribed
    double shift = 0;     // largest of all foils
  };
  bool factorize(const Configuration& configuration);
  Direction direction(const Configuration& configuration);
  double slope(const Direction& direction) const;
  Configuration moved(const Configuration& from, const Direction& direction, double length) const;
  MatX borders(std::size_t foil) const; // d volume of chamber / d unknowns of the foil, one column a chamber
  double reference_tension(const Configuration& configuration) const;

  System& system_;
  NewtonOptions options_;
  std::vector<linear::Cholesky> factors_;
  std::vector<double> shift_; // per foil, N/m
  Work work_;
};

} // namespace pneuma::solver::path
