// SPDX-License-Identifier: GPL-3.0-or-later
// README.md says what each case must come to, and what it took.
#include <cmath>

#include <fmt/format.h>

#include "solver/analytical/circular_membrane.h"
#include "solver/path/controlled_path.h"
#include "tests/unit/solver/cushions.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::Vec3;
using base::VecX;
using geometry::ElementType;
using tests::Cushion;
using tests::model_of;
using tests::Solved;

void record(const char* what, const Solved& s) {
  std::printf("| %s | %s | %d | %d | %d |\n", what, s.converged() ? "converged" : s.path.reason.c_str(), s.path.steps,
              s.iterations(), s.newton.work().factorizations);
}

// 6 m x 3 m, two foils of 250 um, flat enough to be realistic, free of stress at 0.4 m of rise
Cushion large(ElementType element = ElementType::T6) {
  Cushion c;
  c.plan = geometry::Rectangle{6, 3};
  c.element = element;
  c.divisions = geometry::is_quadratic(element) ? std::array{8, 4} : std::array{16, 8};
  c.heights = {0.4, -0.4};
  return c;
}

assembly::Model pressed(const Cushion& cushion, double pressure) {
  assembly::Model model = model_of(cushion, 0);
  for (assembly::Chamber& c : model.chambers) c.gas = chamber::Regulated{0, pressure};
  return model;
}

// the disc of example B8, flat and without stress, on a rigid base
Cushion disc(ElementType element) {
  Cushion c;
  c.plan = geometry::Circle{0.1425};
  c.element = element;
  c.divisions = geometry::is_quadratic(element) ? std::array{4, 4} : std::array{12, 12};
  c.heights = {0};
  c.base = true;
  c.thickness = {1e-3};
  c.law = {311.488e6, 0.34};
  return c;
}

class EveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(HardCases, EveryElement, tests::every_element, tests::element_name);

TEST_P(EveryElement, FlatUnstressedFoilTakesOnePascalAndAMillionFromTheSameStart) {
  const analytical::CircularMembrane exact{0.1425, 311488, 0.34, 0};
  for (const double pressure : {1.0, 1e3, 1e6}) {
    Solved s(pressed(disc(GetParam()), pressure));
    record(fmt::format("flat start, {:.0e} Pa, {}", pressure, name_of(GetParam())).c_str(), s);
    ASSERT_TRUE(s.converged()) << pressure << " " << s.path.reason;
    EXPECT_EQ(s.path.steps, 1);
    const double wanted = analytical::inflate(exact, pressure)->deflection;
    EXPECT_NEAR(s.highest(), wanted, (geometry::is_quadratic(GetParam()) ? 0.002 : 0.01) * wanted) << pressure;
  }
}

TEST(HardCases, ReducedQ9InflatesFromFlatAndShowsNoHourglass) {
  Cushion c = disc(ElementType::Q9);
  Solved full(pressed(c, 100e3));
  c.rule = geometry::StressRule::reduced;
  Solved reduced(pressed(c, 100e3));
  record("flat start, 1e+05 Pa, Q9 reduced", reduced);
  ASSERT_TRUE(reduced.converged()) << reduced.path.reason;
  EXPECT_NEAR(reduced.highest(), full.highest(), 1e-3 * full.highest());
}

TEST(HardCases, OneStepAndManyGiveTheSameState) {
  for (const double pressure : {300.0, 30e3}) { // 100 times a cushion's pressure
    for (const bool flat : {false, true}) {
      Cushion c = large();
      if (flat) {
        c.heights = {0};
        c.base = true;
      }
      Solved one(pressed(c, pressure));
      Solved many(pressed(c, pressure), 20);
      record(fmt::format("{} in one step to {:.0f} Pa", flat ? "flat foil" : "cushion", pressure).c_str(), one);
      record(fmt::format("{} in 20 parts to {:.0f} Pa", flat ? "flat foil" : "cushion", pressure).c_str(), many);
      ASSERT_TRUE(one.converged() && many.converged()) << one.path.reason << many.path.reason;
      for (std::size_t i = 0; i < one.at.positions.size(); ++i) {
        ASSERT_LT((one.at.positions[i] - many.at.positions[i]).norm(), 1e-7) << i;
      }
    }
  }
}

TEST(HardCases, GasAsStiffAsWaterKeepsTheVolume) {
  Cushion c = large();
  c.prestress = 900;
  Solved from(pressed(c, 1000));
  ASSERT_TRUE(from.converged());
  assembly::Model model = model_of(c, 1000);
  model.face_pressure = {{0, -600}, {0, 0}};
  Solved regulated(model, from.at);
  ASSERT_TRUE(regulated.converged());
  for (const double ambient : {101325.0, 1e7, 2.2e9}) { // the last: bulk modulus of water
    model.chambers[0].gas = tests::closed_now(from, 0, ambient);
    Solved s(model, from.at);
    record(fmt::format("closed, ambient {:.3g} Pa", ambient).c_str(), s);
    ASSERT_TRUE(s.converged()) << s.path.reason;
    EXPECT_LE(s.iterations(), regulated.iterations() + 2);
    const double lost = 1 - s.system.chamber_volume(0) / from.system.chamber_volume(0);
    EXPECT_LT(lost, 1000 / ambient);
    EXPECT_GT(s.at.pressures[0], 1000);
  }
}

TEST(HardCases, NearlyFlatClosedChamber) {
  // two foils 2 um apart in the middle of 6 m x 3 m, the air between them at rest; suction on the upper one: the little
  // air must stretch, the foils go up together and the chamber keeps a positive volume
  Cushion c = large();
  c.heights = {1e-6, -1e-6};
  assembly::Model model = model_of(c, 0);
  {
    assembly::System system(model, 1);
    assembly::Configuration at = tests::start_of(model);
    system.evaluate(at, false);
    chamber::Closed gas;
    gas.absolute0 = gas.ambient_from = gas.ambient_to = 101325;
    gas.volume0 = system.chamber_volume(0);
    model.chambers[0].gas = gas;
  }
  model.face_pressure = {{0, 500}, {0, 0}};
  Solved s(model);
  record("nearly flat closed chamber, 500 Pa suction", s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_GT(s.system.chamber_volume(0), 0);
  EXPECT_GT(s.highest(0), 0.03);
  EXPECT_NEAR(s.at.pressures[0], -250, 25); // equal foils share the load
}

// half of the elements a thousand times smaller than the others along x
void jump(Vec3& x) {
  const double u = x.x() / 3; // -1 .. 1
  const double small = 1e-3;
  const double t = std::abs(u);
  const double v = t < 0.5 ? 2 * t / (1 + small) : (1 + (2 * t - 1) * small) / (1 + small);
  x.x() = 3 * std::copysign(v, u);
}

TEST_P(EveryElement, NeedleElementsAndSizeJumpsConvergeLikeGoodMeshes) {
  Cushion good = large(GetParam());
  Solved reference(pressed(good, 400));
  Cushion needles = good;
  needles.divisions = {good.divisions[0], good.divisions[1] * 32}; // 0.75 m x 0.023 m (quadratic), 0.375 x 0.012
  Cushion sizes = good;
  sizes.divisions = {2 * good.divisions[0], good.divisions[1]};
  sizes.distort = jump;
  Solved thin(pressed(needles, 400));
  Solved jumped(pressed(sizes, 400));
  record(fmt::format("good mesh, {}", name_of(GetParam())).c_str(), reference);
  record(fmt::format("needles 1:32, {}", name_of(GetParam())).c_str(), thin);
  record(fmt::format("size jump 1:1000, {}", name_of(GetParam())).c_str(), jumped);
  ASSERT_TRUE(reference.converged() && thin.converged() && jumped.converged());
  EXPECT_NEAR(thin.highest(), reference.highest(), 0.02 * reference.highest());
  EXPECT_NEAR(jumped.highest(), reference.highest(), 0.02 * reference.highest());
  EXPECT_LE(jumped.iterations(), 3 * reference.iterations());
  EXPECT_LE(thin.iterations(), 3 * reference.iterations());
}

TEST(HardCases, ThinFoilBesideAThickOne) {
  Cushion c = large();
  c.thickness = {50e-6, 300e-6};
  Solved both(pressed(c, 400));
  record("50 um beside 300 um", both);
  ASSERT_TRUE(both.converged()) << both.path.reason;
  c.thickness = {300e-6, 50e-6};
  Solved turned(pressed(c, 400));
  ASSERT_TRUE(turned.converged());
  EXPECT_NEAR(both.highest(0), -turned.lowest(1), 1e-7);
  EXPECT_NEAR(-both.lowest(1), turned.highest(0), 1e-7);
}

TEST(HardCases, OneMillimetreAndAHundredMetresGiveTheSameScaledResults) {
  const auto inflated = [](double scale) {
    Cushion c;
    c.plan = geometry::Rectangle{2 * scale, 1 * scale};
    c.heights = {0.12 * scale, -0.12 * scale};
    c.thickness = {250e-6 * scale};
    return c;
  };
  const Cushion one = inflated(1);
  Solved base_state(pressed(one, 500));
  assembly::Model windy = model_of(one, 500);
  windy.face_pressure = {{0, -200}, {0, 0}};
  windy.chambers[0].gas = tests::closed_now(base_state, 0, 101325);
  Solved base_wind(windy, base_state.at);
  record("closed, wind, 2 m", base_wind);
  ASSERT_TRUE(base_wind.converged());
  for (const double scale : {0.5e-3, 50.0}) { // 1 mm and 100 m long
    const Cushion c = inflated(scale);
    Solved state(pressed(c, 500));
    ASSERT_TRUE(state.converged()) << scale << state.path.reason;
    assembly::Model model = model_of(c, 500);
    model.face_pressure = {{0, -200}, {0, 0}};
    model.chambers[0].gas = tests::closed_now(state, 0, 101325);
    Solved wind(model, state.at);
    record(fmt::format("closed, wind, {} m", 2 * scale).c_str(), wind);
    ASSERT_TRUE(wind.converged()) << scale << wind.path.reason;
    EXPECT_NEAR(state.highest() / scale, base_state.highest(), 1e-8 * base_state.highest());
    EXPECT_NEAR(wind.highest() / scale, base_wind.highest(), 1e-8 * base_wind.highest());
    EXPECT_NEAR(wind.at.pressures[0], base_wind.at.pressures[0], 1e-7 * base_wind.at.pressures[0]);
    EXPECT_LE(std::abs(wind.iterations() - base_wind.iterations()), 1);
    EXPECT_LE(std::abs(state.iterations() - base_state.iterations()), 2);
  }
}

TEST(HardCases, TwoChambersAtPressuresOneToAThousand) {
  Cushion c = large();
  c.heights = {0.4, 0, -0.4};
  assembly::Model model = model_of(c, 0);
  model.chambers[0].gas = chamber::Regulated{0, 1000};
  model.chambers[1].gas = chamber::Regulated{0, 1};
  Solved s(model);
  record("chambers at 1000 Pa and 1 Pa, regulated", s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_LT(s.lowest(1), -0.05); // the middle foil bulges into the second chamber
  // then both closed, wind on the upper foil
  model.chambers[0].gas = tests::closed_now(s, 0, 101325);
  model.chambers[1].gas = tests::closed_now(s, 1, 101325);
  model.face_pressure = {{0, -300}, {0, 0}, {0, 0}};
  Solved closed(model, s.at);
  record("the same closed, 300 Pa on the upper foil", closed);
  ASSERT_TRUE(closed.converged()) << closed.path.reason;
  EXPECT_GT(closed.at.pressures[0], 1000);
  EXPECT_GT(closed.at.pressures[1], 1);
}

TEST(HardCases, LowerFoilGoesSlackUnderStrongSuction) {
  // closed air, 300 Pa gauge, 1.5 kPa uplift: the air stretches, its gauge pressure falls, the lower foil loses its
  // tension (spec/thesis 3, gas law). Elastic foils without a tension field carry compression instead of wrinkling.
  Cushion c = large();
  Solved from(pressed(c, 300));
  ASSERT_TRUE(from.converged());
  assembly::Model model = model_of(c, 300);
  model.chambers[0].gas = tests::closed_now(from, 0, 101325);
  model.face_pressure = {{0, 1500}, {0, 0}};
  Solved s(model, from.at);
  record("closed air, 1.5 kPa uplift, slack lower foil", s);
  std::printf("  gauge pressure %.3f Pa at load factor %.4f, lowest %.4f m\n", s.at.pressures[0], s.path.load_factor,
              s.lowest(1));
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_LT(s.at.pressures[0], 30);
  // what was found is in equilibrium without any artificial tension
  assembly::Configuration again = s.at;
  const assembly::Balance balance = s.system.evaluate(again, true);
  EXPECT_LT(balance.residual, 1e-9 * balance.force_scale + balance.rounding);
}

TEST_P(EveryElement, SlackMiddleFoilBetweenEqualPressuresIsFound) {
  // plane, without stress and without a net load: nothing holds it across its plane but itself
  Cushion c = large(GetParam());
  c.heights = {0.4, 0, -0.4};
  assembly::Model model = pressed(c, 300);
  Solved s(model);
  record(fmt::format("slack middle foil, regulated, {}", name_of(GetParam())).c_str(), s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_LT(std::abs(s.highest(1)), 1e-6);
  // closed, 500 Pa of suction: it moves up, and the second pressure follows the first
  model.chambers[0].gas = tests::closed_now(s, 0, 101325);
  model.chambers[1].gas = tests::closed_now(s, 1, 101325);
  model.face_pressure = {{0, 500}, {0, 0}, {0, 0}};
  Solved windy(model, s.at);
  record(fmt::format("the same closed, 500 Pa suction, {}", name_of(GetParam())).c_str(), windy);
  ASSERT_TRUE(windy.converged()) << windy.path.reason;
  EXPECT_GT(windy.highest(1), 0.01);
  EXPECT_LT(windy.at.pressures[0], windy.at.pressures[1]);
  EXPECT_LT(windy.at.pressures[1], 300);
}

TEST_P(EveryElement, FineMeshGoesSlackToo) {
  Cushion c = large(GetParam());
  c.divisions = {2 * c.divisions[0], 2 * c.divisions[1]};
  Solved from(pressed(c, 300));
  assembly::Model model = model_of(c, 300);
  model.chambers[0].gas = tests::closed_now(from, 0, 101325);
  model.face_pressure = {{0, 1500}, {0, 0}};
  Solved s(model, from.at);
  record(fmt::format("1.5 kPa uplift, slack lower foil, fine, {}", name_of(GetParam())).c_str(), s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_LT(s.at.pressures[0], 30);
}

TEST(HardCases, AirHeatedByHalfAtOnce) {
  // far beyond any weather: the law starts 50 % away from equilibrium
  Cushion c = large();
  Solved from(pressed(c, 300));
  for (const double ambient : {0.0, 101325.0}) {
    assembly::Model model = model_of(c, 300);
    chamber::Closed gas = tests::closed_now(from, 0, ambient);
    gas.temperature0 = 290;
    gas.temperature = 435;
    model.chambers[0].gas = gas;
    Solved s(model, from.at);
    record(fmt::format("air heated by half, ambient {:.0f} Pa", ambient).c_str(), s);
    ASSERT_TRUE(s.converged()) << s.path.reason;
    EXPECT_NEAR((s.at.pressures[0] + ambient) * s.system.chamber_volume(0), 1.5 * gas.absolute0 * gas.volume0,
                1e-8 * gas.absolute0 * gas.volume0);
  }
}

// one curved foil, free of stress at a rise of 0.4 m, pushed down by 300 Pa
assembly::Model free_dome() {
  Cushion c = large();
  c.heights = {0.4};
  c.base = true;
  assembly::Model model = model_of(c, 0);
  model.face_pressure = {{0, -300}, {0, 0}};
  return model;
}

TEST(HardCases, CushionPushedInsideOutStandsOnTheOtherSide) {
  // snaps through to its mirror image, where it may
  assembly::Model model = free_dome();
  const Solved stopped(model);
  EXPECT_FALSE(stopped.converged());
  EXPECT_NE(stopped.path.reason.find("limit point at load factor 0.02"), std::string::npos) << stopped.path.reason;
  Solved s(model, tests::AtLimit::snap);
  EXPECT_FALSE(s.path.snaps.empty());
  record("pushed inside out", s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  model.face_pressure = {{0, 300}, {0, 0}};
  Solved up(model);
  EXPECT_NEAR(-s.lowest(0), up.highest(0), 1e-5 * up.highest(0));
}

TEST(HardCases, FreeDomePushedDownByItsMiddleStopsWithAReasonAndTheLastGoodState) {
  // a foil free of stress cannot carry compression at all: as soon as it is pushed it wrinkles, as finely as the mesh
  // can, and its middle comes up again (arcs go on there). The control must end where it turns, in equilibrium.
  assembly::Model model = free_dome();
  assembly::System system(model, 1);
  path::Newton newton(system, {});
  assembly::Configuration at = tests::start_of(model);
  Index middle = -1;
  for (std::size_t i = 0; i < at.positions.size(); ++i) {
    if (std::abs(at.positions[i].z() - 0.4) < 1e-9) middle = static_cast<Index>(i);
  }
  ASSERT_GE(middle, 0);
  const path::PathResult result = path::follow_control(
      system, newton, at, path::DisplacementPath{path::displacement_of(middle, Vec3(0, 0, -1)), 0.8}, {}, {},
      tests::tell);
  std::printf("| free dome pushed down | %s | %d | %d | %d |\n", result.reason.c_str(), result.steps,
              newton.work().iterations, newton.work().factorizations);
  EXPECT_EQ(result.end, path::PathEnd::stuck);
  EXPECT_NE(result.reason.find("the controlled quantity turns back near"), std::string::npos) << result.reason;
  const assembly::Balance balance = system.evaluate(at, true);
  EXPECT_LT(balance.residual, 1e-9 * balance.force_scale + balance.rounding);
}

TEST(HardCases, AirPressedIntoAHundredthOfItsVolume) {
  // the thesis' gas law (gauge pressure, ambient 0): 300 Pa inside, 30 kPa on both faces
  Cushion c = large();
  Solved from(pressed(c, 300));
  ASSERT_TRUE(from.converged());
  assembly::Model model = model_of(c, 300);
  model.chambers[0].gas = tests::closed_now(from, 0, 0);
  model.face_pressure = {{0, -30e3}, {0, 30e3}};
  Solved s(model, from.at, 1, tests::AtLimit::snap); // folds of the slack foils on the way
  record("air pressed into a hundredth", s);
  ASSERT_TRUE(s.converged()) << s.path.reason;
  EXPECT_GT(s.system.chamber_volume(0), 0);
  EXPECT_NEAR(s.at.pressures[0] * s.system.chamber_volume(0), 300 * from.system.chamber_volume(0),
              1e-8 * 300 * from.system.chamber_volume(0));
  EXPECT_NEAR(s.at.pressures[0], 30e3, 3e3); // the foils are slack: the air carries it all but for their stretch
}

TEST(HardCases, ImpossibleGasStopsWithAReasonNotWithNumbers) {
  // more air is drawn out than there is: ambient pressure falls below what the closed law can follow
  Cushion c = large();
  assembly::Model model = model_of(c, 0);
  chamber::Closed gas; // no air at the start
  model.chambers[0].gas = gas;
  Solved s(model);
  EXPECT_FALSE(s.converged());
  EXPECT_NE(s.path.reason.find("chamber"), std::string::npos) << s.path.reason;
  for (const Vec3& x : s.at.positions) EXPECT_TRUE(x.allFinite());
}

} // namespace
