// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "solver/assembly/system.h"
#include "solver/linear/ldlt.h"

namespace pneuma::solver::path {

using assembly::Configuration;
using assembly::System;
using base::Index;
using base::MatX;
using base::Vec3;
using base::VecX;

// A change of everything unknown, or a linear form on it.
struct Change {
  std::vector<VecX> u;    // per foil, over its unknowns: m
  VecX p;                 // per chamber, Pa; 0 where no law makes it unknown
  double load_factor = 0; // -
};

Change operator*(double factor, Change change);
Change& operator+=(Change& to, const Change& change);
double dot(const Change& a, const Change& b);
double dot_u(const Change& a, const Change& b); // of the displacements alone

// The configuration moved by a change.
Configuration moved(const System& system, const Configuration& from, const Change& change);

// The change from one configuration to another.
Change difference(const System& system, const Configuration& from, const Configuration& to);

// The line that a control adds to the equations: row . change = -residual, in units of its own.
struct Row {
  Change form;
  double residual = 0;
};

// Numbers of negative eigenvalues; none where the count is not safe: a pivot within 1e-10 of zero (relative).
struct Stability {
  std::optional<int> load_held;    // gas borders only; 0: stable, 1: past a limit or bifurcation point
  std::optional<int> control_held; // all borders
};

// Work and time of everything a solver object did.
struct Work {
  int iterations = 0;
  int factorizations = 0; // of one foil's tangent, or of all with their borders at once
  int line_searches = 0;
  double assembly = 0, factorization = 0, solve = 0; // s of wall time
  double analysis = 0;
};

// The tangent of a cushion as borders around one sparse symmetric matrix a foil,
//   [ K   -Q ] [du]   [ -R ]   [ F ]
//   [ -Q' -D ] [dp] = [ r  ] + [ G ] dlambda,   row . (du, dp, dlambda) = -residual,
// K of all foils, Q = dV/du, D = -dV/dp of the gas, F and G what the load factor drives. K is factorised foil by foil
// side by side: CHOLMOD first, MUMPS' LDLt where it is not positive definite. Borders by block elimination with
// iterative refinement (of closed air alone: Sherman-Morrison-Woodbury); where a nearly singular K costs it digits, at
// a limit point, the bordered matrix [A, -f; -f', 0] is factorised as a whole (MUMPS), which is regular there.
class Tangent {
public:
  Tangent(System& system, Work& work);

  // What to do where K is not positive definite.
  enum class Repair : std::uint8_t {
    // Make the coupled tangent positive definite, so that its steps go down in energy: as it is if the air's stiffness
    // does so, otherwise by an artificial tension mu int grad N . grad N, as small as serves.
    descent,
    // Take it as it is: along a path, through limit points. An artificial tension only against a null space larger than
    // one border mends (slack foils).
    indefinite,
  };
  // Factorises the tangent of the last evaluation. False if no repair helps.
  bool factorize(const Configuration& configuration, Repair repair);
  double artificial_tension() const; // N/m, the largest in the last factors; 0: none
  void forget_artificial_tension();  // start the search for the smallest anew
  // What a line search made of the last step decides about the artificial tension of the next.
  void step_taken(double length) { taken_ = length; }

  // Newton's step at constant load factor.
  Change step(const Configuration& configuration);
  // Newton's step with the load factor unknown; none if the bordered matrix is singular.
  std::optional<Change> step(const Configuration& configuration, const Row& row);
  // Where the path goes on: the change that leaves every residual zero, of unit length in u; its sign is arbitrary.
  std::optional<Change> along(const Configuration& configuration);

  // Negative eigenvalues of the coupled tangent at the last evaluation, without artificial tension (numerics 7):
  // neg(K + Q D^-1 Q') = neg(K) + neg(-D - Q' K^-1 Q) - m. `held`: what a control holds beside the air.
  Stability stability(const Configuration& configuration, const Row* held);
  // The same from the last factors; none if they are unsafe or an artificial tension acts in them.
  Stability count(const Configuration& configuration, const Row* held);

private:
  struct Factor {
    linear::Cholesky cholesky;
    std::optional<linear::Ldlt> ldlt; // made when first needed
    bool indefinite = false;          // the last one is LDLt
    bool singular = false;            // with null pivots
    double shift = 0;                 // N/m, artificial tension in the last one
  };
  void factorize_indefinite(std::size_t foil, std::span<const double> values);
  void take_gradients(std::size_t foil);
  MatX solve(std::size_t foil, const MatX& right);
  double reference_tension(const Configuration& configuration) const;
  bool add_tension(std::size_t foil, int& factorizations);
  std::optional<int> coupled_negative(const Configuration& configuration, const Row* held);
  Change zero() const;
  Change residual(const Configuration& configuration) const; // right side: -R, r
  Change drive(const Configuration& configuration) const;    // F, G
  Change times(const Configuration& configuration, const Change& x) const;
  std::vector<Change> eliminate(const Configuration& configuration, const std::vector<Change>& right);
  bool factorize_whole(const Configuration& configuration, const Change& f);
  std::vector<Change> solve_whole(const std::vector<Change>& right);
  std::optional<Change> combine(const Change& at, const Change& way, const Row& row) const;

  System& system_;
  Work& work_;
  std::vector<Factor> factors_;
  std::vector<MatX> gradients_; // Q per foil, of the last factorisation; one column an unknown pressure
  std::vector<MatX> solved_;    // K^-1 Q
  // all foils with the borders as one matrix: foils, then airs with a law, then the load factor
  linear::SymmetricPattern whole_pattern_;
  std::optional<linear::Ldlt> whole_;
  VecX border_scale_;       // of its borders
  std::vector<Index> laws_; // chambers whose pressure is unknown
  bool whole_is_needed_ = false;
  double taken_ = 1; // part of the last step
};

// Adds the seconds of its life to a sum.
class Stopwatch {
public:
  explicit Stopwatch(double& total);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

private:
  double& total_;
  double start_;
};

} // namespace pneuma::solver::path
