// SPDX-License-Identifier: GPL-3.0-or-later
// The perforated strip of Simo and Taylor (1986), examples B1 to B3 and B7 (Coelho 2012, sec. 3.1.3, 3.2.3, 3.4.1,
// 4.5.3; a reading: the print gives no sizes in text): a quarter of 20 mm x 36 mm with a hole of radius 5 mm, its end
// pulled along y and free to narrow.
#pragma once

#include "tests/verification/examples/sheets.h"

namespace pneuma::tests {

inline constexpr PerforatedSheet perforated_strip{10e-3, 18e-3, 5e-3, 14, 12, 12}; // 531 nodes, 480 Q4
inline constexpr double strip_thickness = 1e-3;                                    // m
inline constexpr double strip_yield = 0.243e9;                                     // Pa
inline constexpr double strip_hardening = 0.2e9;                                   // Pa
inline constexpr solver::material::Elasticity strip_elasticity{70e9, 0.2};

inline solver::material::Flow strip_flow(double hardening = strip_hardening) {
  const solver::material::HardeningBranch branch{strip_yield, hardening};
  return {solver::material::piecewise_linear({&branch, 1}).value(), {}};
}

// Load factor 1: the end is pulled by `displacement`, m.
solver::assembly::Model pulled_strip(const PerforatedSheet& sheet, const solver::material::Law& law,
                                     double displacement);

struct StripPoint {
  double displacement = 0; // of the end, m
  double force = 0;        // of the quarter, N
};

// The strip pulled in `parts` equal parts, each cut where it must; time passes evenly, `duration` s (0: none), the
// flow followed to the tolerance.
struct PulledStrip {
  solver::assembly::System system;
  solver::path::Newton newton;
  solver::assembly::Configuration at;
  solver::path::PathResult path;
  std::vector<StripPoint> points; // at the ends of the parts
  int steps = 0;

  PulledStrip(const PerforatedSheet& sheet, const solver::material::Law& law, double displacement, int parts,
              double duration = 0, double flow_tolerance = 1e-4);
  bool reached() const { return path.end == solver::path::PathEnd::reached; }
  int iterations() const { return newton.work().iterations; }
};

} // namespace pneuma::tests
