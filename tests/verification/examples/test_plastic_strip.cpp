// SPDX-License-Identifier: GPL-3.0-or-later
// Examples B1 to B3 (Coelho 2012, sec. 3.1.3, 3.2.3, 3.4.1): the perforated strip, plastic, viscoplastic and at large
// strain.
#include <cmath>

#include <fmt/format.h>

#include "tests/verification/examples/strip.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

constexpr double mm = 1e-3;
constexpr double kN = 1e3;
const char* const mesh = "480 Q4, 531 nodes";

PerforatedSheet finer(int times) {
  PerforatedSheet sheet = perforated_strip;
  for (int* divisions : {&sheet.radial, &sheet.side, &sheet.above}) *divisions *= times;
  return sheet;
}

material::J2 small_strain() {
  return {strip_elasticity, strip_flow()};
}
material::Logarithmic large_strain() {
  return {strip_elasticity, strip_flow()};
}
material::J2 viscous(material::Overstress model, double epsilon) {
  material::J2 law = small_strain();
  law.flow.viscosity = {model, 500, epsilon, {}}; // mu = 500 s
  return law;
}

TEST(PlasticStrip, HasTheMeshOfTheThesis) {
  const geometry::Mesh m = mesh_of(perforated_strip);
  EXPECT_EQ(m.nodes.size(), 531u);
  EXPECT_EQ(m.element_count(m.blocks[0]), 480);
}

TEST(PlasticStrip, LimitLoadIsThatOfTheNetSection) {
  // Without hardening and at strains so small that shapes stay, the limit load of a strip in plane stress is its net
  // section times the yield stress: a column of uniaxial stress beside the hole from below, a neck across the net
  // section from above.
  const double scale = 1e-4; // of the yield stress, and so of all strains
  const material::HardeningBranch branch{scale * strip_yield, 0};
  const material::J2 law{strip_elasticity, {material::piecewise_linear({&branch, 1}).value(), {}}};
  const double net_section = (perforated_strip.width - perforated_strip.radius) * strip_thickness;
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    const PulledStrip s(finer(k + 1), law, 0.2 * mm * scale, 10);
    ASSERT_TRUE(s.reached()) << s.path.reason;
    const double force = s.points.back().force / scale;
    errors[k] = force / (net_section * strip_yield) - 1;
    if (k > 0) break;
    expect({"B1", "limit load of the quarter, no hardening, kN", "1.215 (net section)", "net section x yield stress",
            net_section * strip_yield / kN, force / kN, 0.02,
            "an element of 14 across the net section cannot neck: the error falls with h", mesh, s.iterations(),
            "twice as many elements each way halve the error"});
  }
  EXPECT_GT(errors[0], 0); // displacement elements are too stiff
  EXPECT_NEAR(errors[1] / errors[0], 0.5, 0.05);
}

TEST(PlasticStrip, ForcesAreThoseOfAFinerMesh) {
  const PulledStrip s(perforated_strip, small_strain(), 0.2 * mm, 20);
  const PulledStrip fine(finer(2), small_strain(), 0.2 * mm, 20);
  ASSERT_TRUE(s.reached() && fine.reached()) << s.path.reason << fine.path.reason;
  for (const std::size_t i : {std::size_t{1}, std::size_t{5}, std::size_t{9}, std::size_t{19}}) {
    expect({"B1", fmt::format("force at {:.2f} mm, kN", s.points[i].displacement / mm), "figure 3.5",
            "four times the elements", fine.points[i].force / kN, s.points[i].force / kN, 0.01,
            "the finer mesh has half the error or less; the limit load's is 1 %", mesh, s.iterations()});
  }
  // after it all flows the force grows with hardening alone
  EXPECT_LT(s.points[19].force - s.points[9].force, 0.08 * s.points[9].force);
}

TEST(PlasticStrip, IsPulledInOneStepWherePlainNewtonNeedsMany) {
  const double displacement = 0.2 * mm;
  const PulledStrip many(perforated_strip, small_strain(), displacement, 20);
  const PulledStrip one(perforated_strip, small_strain(), displacement, 1);
  ASSERT_TRUE(one.reached()) << one.path.reason;
  expect({"B1", "force at 0.20 mm in one step, kN", "", "the same in 20 steps", many.points.back().force / kN,
          one.points.back().force / kN, 0.003, "plastic strain in one backward Euler step turns with the path", mesh,
          one.iterations(), fmt::format("steps taken: {}", one.steps)});
  // without a predictor the elements beside the end take all its move, and yield
  const auto pulls = [&](double step, bool along_the_tangent) {
    assembly::System system(pulled_strip(perforated_strip, small_strain(), displacement), 1);
    assembly::Configuration at = start_of(system.model());
    for (double u = step; u <= displacement * (1 + 1e-9); u += step) {
      if (along_the_tangent) {
        predict(system, at, u / displacement);
      } else {
        at.load_factor = u / displacement;
      }
      if (!plain_newton(system, at, 1e-10, 25).converged) return false;
      system.accept_history();
    }
    return true;
  };
  EXPECT_FALSE(pulls(0.004 * mm, false));
  EXPECT_TRUE(pulls(0.02 * mm, true));
  EXPECT_FALSE(pulls(0.05 * mm, true));
}

TEST(ViscoplasticStrip, ForceRisesWithTheRateAndTheSlowLimitIsPlastic) {
  const double displacement = 0.2 * mm;
  const PulledStrip plastic(perforated_strip, small_strain(), displacement, 20);
  for (const double epsilon : {1.0, 0.1}) {
    double last = 0;
    for (const double rate : {1e-7, 1e-4, 1e-2}) { // v / L, 1/s
      const PulledStrip s(perforated_strip, viscous(material::Overstress::peric, epsilon), displacement, 4,
                          displacement / perforated_strip.height / rate);
      ASSERT_TRUE(s.reached()) << s.path.reason;
      const double force = s.points.back().force;
      EXPECT_GT(force, 1.01 * last);
      last = force;
      std::printf("Peric, epsilon %g, v/L %g 1/s: %.5f kN, %d steps, %d iterations\n", epsilon, rate, force / kN,
                  s.steps, s.iterations());
      if (rate > 1e-7) continue;
      expect({"B2", fmt::format("force at 0.20 mm, Peric, epsilon {:g}, v/L 1e-7 1/s, kN", epsilon), "figure 3.7",
              "B1, 20 steps", plastic.points.back().force / kN, force / kN, 2e-3,
              "mu x rate of the neck is 1e-3 at most, so is the overstress; steps are other ones", mesh,
              s.iterations()});
    }
  }
}

TEST(ViscoplasticStrip, WithoutRateSensitivityPericsIsPlasticAndPerzynasFlowsAtTwiceTheYieldStress) {
  const double displacement = 0.2 * mm;
  const double rate = 1e-3; // v / L, 1/s: mu x rate = 0.5
  const double epsilon = 1e-3;
  for (const material::Overstress model : {material::Overstress::peric, material::Overstress::perzyna}) {
    const bool peric = model == material::Overstress::peric;
    const material::HardeningBranch twice{2 * strip_yield, 2 * strip_hardening};
    const material::J2 limit =
        peric ? small_strain() : material::J2{strip_elasticity, {material::piecewise_linear({&twice, 1}).value(), {}}};
    const PulledStrip plastic(perforated_strip, limit, displacement, 20);
    const PulledStrip s(perforated_strip, viscous(model, epsilon), displacement, 4,
                        displacement / perforated_strip.height / rate);
    ASSERT_TRUE(s.reached()) << s.path.reason;
    expect({"B2", fmt::format("force at 0.20 mm, {}, epsilon 1e-3, v/L 1e-3 1/s, kN", peric ? "Peric" : "Perzyna"), "",
            peric ? "B1" : "B1 with twice the yield stress and hardening", plastic.points.back().force / kN,
            s.points.back().force / kN, 5e-3,
            "z = mu x rate of the plastic strain is 0.01 to 50: z^0.001 and (1+z)^0.001 are 1 within 0.5 %", mesh,
            s.iterations()});
  }
}

TEST(LargeStrainStrip, NecksAndCarriesLessWhereTheSmallStrainLawOverestimates) {
  const double displacement = 2 * mm;
  const PulledStrip small(perforated_strip, small_strain(), displacement, 20);
  const PulledStrip large(perforated_strip, large_strain(), displacement, 20);
  const PulledStrip fine(finer(2), large_strain(), displacement / 10, 2);
  ASSERT_TRUE(small.reached() && large.reached() && fine.reached());
  for (std::size_t i = 0; i < 2; ++i) {
    expect({"B3", fmt::format("force at {:.1f} mm, large strain, kN", large.points[i].displacement / mm), "figure 3.11",
            "four times the elements", fine.points[i].force / kN, large.points[i].force / kN, 0.01, "as B1", mesh,
            large.iterations(),
            i == 0 ? "" : "the peak: behind it the neck is as wide as an element, and falls faster with finer ones"});
  }
  double last = 1;
  for (std::size_t i = 0; i < small.points.size(); ++i) {
    const double overestimate = small.points[i].force / large.points[i].force;
    EXPECT_GT(overestimate, last);
    last = overestimate;
    if (i % 5 == 4) std::printf("%.1f mm: small-strain force / large %.3f\n", small.points[i].displacement / mm, last);
  }
  // sigma_y > K: the engineering force of a column of this material falls from the first yield on (Considere 1885)
  EXPECT_LT(large.points.back().force, 0.7 * large.points[1].force);
  EXPECT_GT(small.points.back().force, 1.5 * small.points[1].force);
}

} // namespace

} // namespace pneuma::tests
