// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/between.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuma::solver::path {

namespace {

// Measured on cushions of 6 x 3 m under wind: smooth steps have a deviation up to 0.07, jumps 0.73 to 0.99; where areas
// go slack the kink is 0.2 to 1.4, at jumps 40 to 50.
constexpr double smooth = 0.1;
constexpr double one_kink = 0.5;
constexpr double far = 0.01; // of the span: what deviates less is a fold of the mesh, not of the cushion

// The cubic through both states along both tangents (Hermite), a part of the way along.
Configuration on_the_way(const System& system, const Stretch& step, double t) {
  const double load = step.to.load_factor - step.from.load_factor;
  const Change chord = difference(system, step.from, step.to);
  Change move = (t * t * (3 - 2 * t)) * chord;
  move += (load * t * (1 - t) * (1 - t)) * *step.begin.way;
  move += (-load * t * t * (1 - t)) * *step.end.way;
  move.load_factor = t * load;
  return moved(system, step.from, move);
}

double largest_move(const Change& change) {
  double largest = 0;
  for (const VecX& u : change.u) largest = std::max(largest, u.cwiseAbs().maxCoeff());
  return largest;
}

double length_of(const Change& change) {
  return std::sqrt(dot_u(change, change));
}

// Whether the cushion grows stiffer as it leaves the begin of a step, as a flat one does: then its first tangent leads
// too far, and no jump is needed to fall short of it. Leaves the system evaluated at the end of the step again.
bool stiffens(System& system, Newton& newton, const Stretch& step, double length) {
  constexpr double probe = 0.01; // of the step's length
  const Change& way = *step.begin.way;
  const double load = step.to.load_factor - step.from.load_factor;
  Configuration near = moved(system, step.from, std::copysign(probe * length / length_of(way), load) * way);
  const Look there = system.evaluate(near, true).possible ? look_at(newton, near) : Look{};
  Configuration end = step.to;
  system.evaluate(end, true);
  return there.way && length_of(*there.way) < length_of(way);
}

// Whether the chord of a step is that of a cushion that jumped.
bool jumped(System& system, Newton& newton, const Stretch& step) {
  const double load = step.to.load_factor - step.from.load_factor;
  const Change chord = difference(system, step.from, step.to);
  Change off = chord, bend = *step.end.way;
  off += (-load / 2) * *step.begin.way;
  off += (-load / 2) * *step.end.way;
  bend += -1.0 * *step.begin.way;
  const double length = length_of(chord), deviation = length_of(off), kink = std::abs(load) * length_of(bend) / 2;
  if (deviation <= smooth * length || largest_move(off) <= far * span_of(step.from)) return false;
  if (deviation <= one_kink * kink) return false;
  constexpr double little = 1.05;
  const bool falls_short = length <= little * std::abs(load) * length_of(*step.begin.way);
  return !(falls_short && stiffens(system, newton, step, length));
}

} // namespace

Look look_at(Newton& newton, const Configuration& at) {
  Tangent& tangent = newton.tangent();
  Look look;
  if (!tangent.factorize(at, Tangent::Repair::indefinite) || tangent.artificial_tension() > 0) return look;
  const std::optional<Change> way = tangent.along(at);
  constexpr double no_load = 1e-12;
  if (way && std::abs(way->load_factor) > no_load) look.way = (1 / way->load_factor) * *way;
  return look;
}

std::string hidden_between(System& system, Newton& newton, const Stretch& step, const Objection& objection) {
  const Change chord = difference(system, step.from, step.to);
  if (!step.begin.way || !step.end.way || chord.load_factor == 0) return {};
  if (largest_move(chord) <= far * span_of(step.from)) return {};
  if (jumped(system, newton, step)) return "the cushion jumps on the way";
  for (const double t : {0.25, 0.5, 0.75}) {
    const std::string fault = objection ? objection(on_the_way(system, step, t)) : "";
    if (!fault.empty()) return fault;
  }
  return {};
}

} // namespace pneuma::solver::path
