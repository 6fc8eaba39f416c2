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
constexpr double far = 0.01; // of the span: beyond, the middle of a step is looked at, too

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

} // namespace

Look look_at(Newton& newton, const Configuration& at) {
  Tangent& tangent = newton.tangent();
  Look look;
  if (!tangent.factorize(at, Tangent::Repair::indefinite) || tangent.artificial_tension() > 0) return look;
  look.count = tangent.count(at, nullptr).load_held;
  const std::optional<Change> way = tangent.along(at);
  constexpr double no_load = 1e-12;
  if (way && std::abs(way->load_factor) > no_load) look.way = (1 / way->load_factor) * *way;
  return look;
}

std::string hidden_between(System& system, Newton& newton, const Stretch& step, const Objection& objection,
                           const std::function<bool()>& halves_agree) {
  if (step.begin.count.value_or(0) == 0 && step.end.count.value_or(0) > 0) return "the state found is not stable";
  if (!step.begin.way || !step.end.way) return {};
  const double load = step.to.load_factor - step.from.load_factor;
  const Change chord = difference(system, step.from, step.to);
  const double length = std::sqrt(dot_u(chord, chord)), span = span_of(step.from);
  constexpr double still = 1e-9; // of the span
  if (load == 0 || largest_move(chord) <= still * span) return {};

  Change off = chord, bend = *step.end.way;
  off += (-load / 2) * *step.begin.way;
  off += (-load / 2) * *step.end.way;
  bend += -1.0 * *step.begin.way;
  const double deviation = std::sqrt(dot_u(off, off));
  const double kink = std::abs(load) * std::sqrt(dot_u(bend, bend)) / 2;
  if (deviation > smooth * length && (deviation > one_kink * kink || !halves_agree())) {
    return "the cushion jumps on the way";
  }
  if (largest_move(chord) <= far * span) return {};
  for (const double t : {0.25, 0.5, 0.75}) {
    const std::string fault = objection ? objection(on_the_way(system, step, t)) : "";
    if (!fault.empty()) return fault;
  }
  Configuration middle = on_the_way(system, step, 0.5);
  if (!system.evaluate(middle, true).possible) return {};
  const Look half = look_at(newton, middle);
  return half.count.value_or(0) > step.begin.count.value_or(0) ? "the cushion is not stable on the way" : "";
}

} // namespace pneuma::solver::path
