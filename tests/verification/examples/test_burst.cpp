// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>

#include "tests/verification/examples/burst.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

TEST(BurstTest, Explore) {
  const material::Logarithmic law{burst_elasticity, burst_flow()};
  for (const ElementType type : {ElementType::T3, ElementType::T6}) {
    for (const int divisions : {10, 20}) {
      const path::DisplacementPath up{path::displacement_of(0, Vec3(0, 0, 1)), 0.26};
      const path::VolumePath fill{0, 0.012};
      path::ArcLengthPath arc;
      arc.after_peak = 28.0 / 32.9;
      const path::PathControl controls[] = {up, fill, arc};
      for (const path::PathControl& control : controls) {
        if (type == ElementType::T6 && divisions == 20 && control.index() > 0) continue;
        const Burst b(burst_disc(type, divisions, law), control);
        std::printf("%s %d control %d: %d steps %d iterations %s", name_of(type), divisions, (int)control.index(),
                    b.path.steps, b.iterations(), b.path.reason.c_str());
        if (b.peak) std::printf(" peak %.4f kPa at %.4f R", b.peak->pressure / 1e3, b.peak->deflection / burst_radius);
        const auto& last = b.points.back();
        std::printf(" end %.4f kPa %.4f R %.6f m3; critical %d; time %.2f\n", last.pressure / 1e3,
                    last.deflection / burst_radius, last.volume, (int)b.path.critical.size(),
                    b.newton.work().assembly + b.newton.work().factorization + b.newton.work().solve);
      }
    }
  }
}

} // namespace

} // namespace pneuma::tests
