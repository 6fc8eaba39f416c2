// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/path/load_path.h"

namespace pneuma::solver::path {

// Displacement of a point along a direction, to `until`.
struct DisplacementPath {
  HeldDisplacement point;
  double until = 0; // m
};
// The largest displacement of a block (-1: of all), whichever node and direction it has, to `until`.
struct LargestDisplacementPath {
  Index block = -1;
  double until = 0; // m
};
struct VolumePath {
  Index chamber = 0;
  double until = 0; // m3
};
// Cylindrical arc length, to the first of what is given.
struct ArcLengthPath {
  std::optional<double> load_factor, pressure, volume, displacement; // -, Pa, m3, m: value that is crossed
  std::optional<double> after_peak;                                  // the load fell to this part of its peak
  Index chamber = 0;                                                 // of pressure and volume
  Index block = -1;                                                  // of the largest displacement
};
using PathControl = std::variant<DisplacementPath, LargestDisplacementPath, VolumePath, ArcLengthPath>;

struct ControlledPathOptions {
  // The way to the goal is reported at so many equal parts; arc length: to the first of displacement, volume, pressure
  // and load factor that is given. Where only the fall behind a peak ends an arc, every step ends a part.
  int parts = 1;
  double first_step = 0.1; // of the way; arc length: of the load
  int max_steps = 500;
  int max_iterations = 15;     // of one step: beyond, it is better cut
  double smallest_step = 1e-6; // of the first step
  bool only_looking = false;   // for limit points: bifurcations are not located
  FlowLimits flow;             // as in LoadPathOptions
  Objection objection;         // as in LoadPathOptions
};

// Follows the path with the load factor unknown, through limit points: the model's ramps are direction and scale of the
// load. Steps are predicted along the tangent; the way goes on in the direction it came from; the length of a step
// follows the iterations of the last one (sqrt(4 / iterations), Ramm 1981) and is cut by four on any failure. From a
// state without stiffness (flat, slack) the first step is one of load control. Where the load turns, the limit point is
// found and made a step of its own, unless the step ends beside it; where the count of negative eigenvalues changes
// otherwise, the bifurcation. A path that is at its goal already takes no step; where a held displacement or volume
// turns back it is stuck. `configuration` is brought into equilibrium at its load factor first, and ends as the last
// accepted one. No time passes (System::set_time_step).
PathResult follow_control(System& system, Newton& newton, Configuration& configuration, const PathControl& control,
                          const ControlledPathOptions& options, const Accept& accepted, const Report& report = {});

} // namespace pneuma::solver::path
