// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>

#include "tests/verification/examples/strip.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

constexpr double mm = 1e-3;

TEST(PlasticStrip, Explore) {
  for (const double hardening : {strip_hardening, 0.0}) {
    for (const int parts : {20, 1}) {
      const PulledStrip s(perforated_strip, material::J2{strip_elasticity, strip_flow(hardening)}, 0.2 * mm, parts);
      std::printf("K %g parts %d: %d steps, %d iterations, reached %d %s\n", hardening, parts, s.steps, s.iterations(),
                  s.reached(), s.path.reason.c_str());
      for (const StripPoint& p : s.points) std::printf("   %.4f mm %.6f kN\n", p.displacement / mm, p.force / 1e3);
    }
  }
  for (const double step : {0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.008, 0.01, 0.02}) {
    assembly::System system(pulled_strip(perforated_strip, material::J2{strip_elasticity, strip_flow()}, 0.2 * mm), 1);
    assembly::Configuration at = start_of(system.model());
    int total = 0;
    int i = 0;
    for (i = 1; i * step <= 0.2 + 1e-9; ++i) {
      at.load_factor = i * step / 0.2;
      const PlainNewton n = plain_newton(system, at, 1e-10, 25);
      total += static_cast<int>(n.norms.size());
      if (!n.converged) break;
      system.accept_history();
    }
    std::printf("plain %g mm: to %g mm, %d iterations\n", step, (i - 1) * step, total);
  }
}

} // namespace

} // namespace pneuma::tests
