// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/path/between.h"

namespace pneuma::solver::path {

// An accepted step.
struct Step {
  int number = 0;
  double load_factor = 0;
  int iterations = 0;
  bool end_of_part = false;
  double time = 0; // s, since the start of the path
};

enum class PathEnd : std::uint8_t { reached, stopped, stuck };

// A point of the path where the tangent is singular.
struct CriticalPoint {
  enum class Kind : std::uint8_t {
    limit,       // the load has an extreme: nothing nearby carries more (or less)
    bifurcation, // another path crosses
  };
  Kind kind = Kind::limit;
  double load_factor = 0;
  VecX pressures; // gauge, of each chamber, Pa
  int step = 0;   // a limit point is a step of its own; a bifurcation lies before this step
};

struct PathResult {
  PathEnd end = PathEnd::stuck;
  std::string reason; // why stuck or stopped
  int steps = 0;
  double load_factor = 0;              // of the last good state
  std::vector<CriticalPoint> critical; // in their order
  struct Snap {
    double from = 0, to = 0; // load factors
  };
  std::vector<Snap> snaps;  // that load control took, in their order
  std::optional<Held> held; // what the control held last, for the count of what is stable under it
};

using Accept = std::function<void(const Step&, const Configuration&)>;
using Report = std::function<void(int step, const Iteration&)>;

// How far foils may flow in one step, as equivalent plastic strain: the directions of flow are those of its end.
struct FlowLimits {
  double growth = 0.02; // at any point
  double error = 1e-5;  // of what flows with time

  // How many times too long a step is, in which they flowed so far.
  double excess(const System::Flow& flow) const;
  // What the length of the next step is at most.
  static double factor(double excess);
};

// What part of the load acts when, s; linear between two of them.
struct Moment {
  double time = 0;
  double load_factor = 0;
};

struct LoadPathOptions {
  // The way of the load: time does not fall, and does not stand still without a change of the load.
  std::vector<Moment> schedule = {{0, 0}, {0, 1}};
  int parts = 1;               // each stretch is reported at `parts` equal parts; between them steps are automatic
  double smallest_step = 1e-5; // of a stretch of the schedule
  FlowLimits flow;
  int max_steps = 100000;
  bool snaps = false;  // where the cushion jumps, go on to the state that it jumps to
  Objection objection; // is answered by shorter steps; the path ends `stopped` a thousandth of the load before it
};

// Load control: along the schedule, whole parts first, cut back by four on any failure and where a jump lies hidden
// between two states (between.h), doubled after easy success;
// foils that yield shorten its steps, too (FlowLimits); where edges move, a step starts along the
// tangent of the last one. `accepted` sees every accepted step, with the system evaluated there; `configuration` ends
// as the last accepted one. Where it gets stuck it looks for a limit point just ahead and names it.
PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const Accept& accepted, const Report& report = {});

// No element may turn by more than a right angle in one step: it would have been turned inside out on the way.
bool turned_over(const System& system, const Configuration& before, const Configuration& after);

} // namespace pneuma::solver::path
