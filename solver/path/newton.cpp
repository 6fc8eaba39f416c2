// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pneuma::solver::path {

namespace {

double relative(const assembly::Balance& b) {
  return b.residual == 0 ? 0.0 : b.residual / b.force_scale;
}

double largest(const Change& change) {
  double move = 0;
  for (const VecX& du : change.u) {
    if (du.size() > 0) move = std::max(move, du.cwiseAbs().maxCoeff());
  }
  return move;
}

// Where nothing acts (forces that cancel, moved edges, far from the origin, very fine meshes) rounding keeps the
// relative residual above the tolerance: then the residual, or a move, at rounding level decides.
bool is_balanced(const assembly::Balance& balance, double tolerance, double last_move, double span) {
  const bool at_rounding =
      balance.residual <= balance.rounding || (last_move < 1e-13 * span && relative(balance) < 1e3 * tolerance);
  return (relative(balance) <= tolerance || at_rounding) && balance.gas <= tolerance;
}

} // namespace

Newton::Newton(System& system, NewtonOptions options) : system_(system), options_(options), tangent_(system, work_) {}

bool Newton::stands_at(const assembly::Balance& balance) const {
  return balance.possible && is_balanced(balance, options_.tolerance, 1, 1);
}

assembly::Balance Newton::evaluate(Configuration& configuration, bool with_tangent) {
  const Stopwatch watch(work_.assembly);
  return system_.evaluate(configuration, with_tangent);
}

double Newton::slope(const Change& direction) const {
  double sum = 0;
  for (std::size_t i = 0; i < direction.u.size(); ++i) sum += direction.u[i].dot(system_.foils()[i].residual);
  return sum;
}

Newton::Outcome Newton::solve(Configuration& configuration, const std::function<void(const Iteration&)>& report) {
  const double span = span_of(configuration);
  tangent_.forget_artificial_tension();
  Outcome outcome;
  assembly::Balance balance = evaluate(configuration, true);
  if (!balance.possible) {
    outcome.reason = balance.reason;
    return outcome;
  }
  double last_move = span; // largest displacement of the last iteration's whole step, if no artificial tension acted
  constexpr int round = 20;
  int allowed = std::min(options_.patience, options_.max_iterations);
  double best = std::numeric_limits<double>::infinity(); // residual so far, and when the round began
  double best_before = 0;
  for (int number = 0;; ++number) {
    outcome.iterations = number;
    outcome.residual = relative(balance);
    if (is_balanced(balance, options_.tolerance, last_move, span)) {
      outcome.converged = true;
      return outcome;
    }
    best = std::min(best, outcome.residual);
    if (number == allowed) { // more of them as long as they get somewhere
      if (best > 0.1 * best_before || allowed >= options_.max_iterations) {
        outcome.reason = "the iterations ran out";
        return outcome;
      }
      allowed = std::min(allowed + round, options_.max_iterations);
    }
    if ((allowed - number) % round == 0) best_before = best;
    if (!tangent_.factorize(configuration, Tangent::Repair::descent)) {
      outcome.reason = "no artificial tension makes the tangent positive definite";
      return outcome;
    }
    const Change step = tangent_.step(configuration);
    const double shift = tangent_.artificial_tension();
    ++work_.iterations;

    const double slope0 = slope(step);
    double length = 1;
    Configuration trial = moved(system_, configuration, length * step);
    assembly::Balance next = evaluate(trial, true);
    double slope1 = next.possible ? slope(step) : 0;
    const auto good = [&] {
      if (!next.possible) return false;
      if (slope0 >= 0) return true; // the step serves a gas law first: along it the residual is no measure
      if (std::abs(slope1) <= 0.8 * std::abs(slope0)) return true;
      return shift == 0 && relative(next) < 0.5 * relative(balance);
    };
    if (!good()) {
      // Find where the residual is orthogonal to the direction: shorten, or (only with an artificial tension, whose
      // size is a guess) lengthen, then regula falsi (Illinois).
      double low = 0, slope_low = slope0;
      double high = -1, slope_high = 0;
      for (int search = 0; search < options_.max_line_searches; ++search) {
        ++work_.line_searches;
        if (!next.possible) {
          high = -1;
          length = low + (length - low) / 4;
        } else if (slope1 * slope0 < 0) {
          if (high > 0) slope_low /= 2;
          high = length;
          slope_high = slope1;
          length = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.05, 0.95);
        } else {
          low = length;
          slope_low = slope1;
          if (high > 0) {
            slope_high /= 2;
            length = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.05, 0.95);
          } else if (shift > 0 && length < 1e4) {
            length *= 4;
          } else {
            break; // a plain Newton step that is too short is good enough
          }
        }
        trial = moved(system_, configuration, length * step);
        next = evaluate(trial, false);
        slope1 = next.possible ? slope(step) : 0;
        if (good()) break;
      }
      next = evaluate(trial, true);
    }
    if (report) {
      report({configuration.load_factor, number, relative(balance), balance.gas, length, shift});
    }
    if (!next.possible) {
      outcome.reason = next.reason;
      return outcome;
    }
    tangent_.step_taken(length);
    last_move = shift > 0 ? span : 0;
    last_move = std::max(last_move, largest(step));
    configuration = std::move(trial);
    balance = next;
  }
}

Newton::Outcome Newton::solve(Configuration& configuration, const Held& held, double wanted, int max_iterations,
                              const std::function<void(const Iteration&)>& report) {
  const double span = span_of(configuration);
  tangent_.forget_artificial_tension();
  Outcome outcome;
  assembly::Balance balance = evaluate(configuration, true);
  double smallest = std::numeric_limits<double>::infinity(); // residual so far
  double last_move = span;
  const double scale = std::max(std::abs(wanted), std::abs(value_of(held, system_, configuration)));
  for (int number = 0;; ++number) {
    if (!balance.possible) {
      outcome.reason = balance.reason;
      return outcome;
    }
    const Row row = row_of(held, wanted, system_, configuration);
    outcome.iterations = number;
    outcome.residual = relative(balance);
    // near 0 no better than moves at rounding level allow
    const double held_rounding = 1e-13 * span * std::sqrt(dot_u(row.form, row.form));
    if (is_balanced(balance, options_.tolerance, last_move, span) &&
        std::abs(row.residual) <= std::max(options_.tolerance * scale, held_rounding)) {
      outcome.converged = true;
      return outcome;
    }
    if (number == max_iterations) {
      outcome.reason = "the iterations ran out";
      return outcome;
    }
    constexpr double hopeless = 1e6; // a first correction may stretch the foils a lot, but comes back at once
    if (number > 2 && balance.residual > hopeless * smallest) {
      outcome.reason = "the iterations diverge";
      return outcome;
    }
    smallest = std::min(smallest, balance.residual);
    if (!tangent_.factorize(configuration, Tangent::Repair::indefinite)) {
      outcome.reason = "the tangent is singular";
      return outcome;
    }
    const std::optional<Change> step = tangent_.step(configuration, row);
    if (!step || !std::isfinite(dot(*step, *step))) {
      outcome.reason = "the tangent is singular with the control's border";
      return outcome;
    }
    ++work_.iterations;
    double length = 1;
    Configuration trial;
    for (int search = 0;; ++search) { // shorter only where the step leads to what cannot be
      trial = moved(system_, configuration, length * *step);
      balance = evaluate(trial, true);
      if (balance.possible || search == 6) break;
      ++work_.line_searches;
      length /= 4;
    }
    if (report) {
      report({configuration.load_factor, number, outcome.residual, balance.gas, length, tangent_.artificial_tension()});
    }
    last_move = tangent_.artificial_tension() > 0 ? span : largest(*step);
    configuration = std::move(trial);
  }
}

} // namespace pneuma::solver::path
