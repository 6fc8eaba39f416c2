// SPDX-License-Identifier: GPL-3.0-or-later
// Histories along paths: what steps that are cut, looked into or only looked at leave behind.
#include "solver/path/controlled_path.h"
#include "tests/unit/solver/cushions.h"
#include "tests/unit/solver/histories.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;

// A foil over a rigid base that yields at 1 to 2 kPa, or creeps from zero on.
assembly::Model foil(double pressure, bool creeps) {
  tests::Cushion cushion;
  cushion.divisions = {4, 2};
  cushion.heights = {0.1};
  cushion.base = true;
  assembly::Model model = tests::model_of(cushion, 0);
  model.chambers[0].gas = chamber::Regulated{0, pressure};
  const material::Viscosity creep{material::Overstress::perzyna, 1e4, 0.3, 0.0};
  model.foils[0]->law =
      material::Logarithmic{tests::etfe_elasticity, {tests::etfe_hardening(), creeps ? creep : material::Viscosity{}}};
  return model;
}

struct Walked {
  assembly::System system;
  path::Newton newton{system, {}};
  assembly::Configuration at;

  explicit Walked(assembly::Model model) : system(std::move(model), 1), at(tests::start_of(system.model())) {}

  std::vector<double> history() const { return {system.history(0).begin(), system.history(0).end()}; }
  double largest_alpha() const {
    double largest = 0;
    for (std::size_t i = 3; i < history().size(); i += 5) largest = std::max(largest, history()[i]);
    return largest;
  }
};

path::LoadPathOptions in_time(std::vector<path::Moment> schedule) {
  path::LoadPathOptions options;
  options.schedule = std::move(schedule);
  return options;
}

TEST(PathHistory, AcceptedTwiceIsAcceptedOnce) {
  Walked w(foil(8e3, false));
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, {}, {}).end, path::PathEnd::reached);
  EXPECT_GT(w.largest_alpha(), 1e-3);
  w.system.evaluate(w.at, true);
  w.system.accept_history();
  const std::vector<double> once = w.history();
  w.system.accept_history();
  EXPECT_EQ(w.history(), once);
  EXPECT_EQ(w.system.flow().growth, 0);
}

TEST(PathHistory, AcceptedTwiceTheLastStepIsStillRepeatedFromTheHistoryBeforeIt) {
  Walked w(foil(8e3, false));
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, {}, {}).end, path::PathEnd::reached);
  const std::vector<double> tangent = w.system.foils()[0].tangent;
  w.system.accept_history();
  w.system.evaluate_accepted(w.at, true);
  EXPECT_EQ(w.system.foils()[0].tangent, tangent);
  w.system.accept_history(); // of that repetition
  w.system.evaluate_accepted(w.at, true);
  EXPECT_EQ(w.system.foils()[0].tangent, tangent);
  w.system.evaluate(w.at, true); // a step of no length: it yields no more
  EXPECT_NE(w.system.foils()[0].tangent, tangent);
}

TEST(PathHistory, WhatCannotBeIsNotAccepted) {
  Walked w(foil(8e3, false));
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, {}, {}).end, path::PathEnd::reached);
  const std::vector<double> accepted = w.history();
  assembly::Configuration flown = w.at;
  for (base::Vec3& x : flown.positions) x *= 1e200;
  ASSERT_FALSE(w.system.evaluate(flown, false).possible);
  w.system.accept_history();
  EXPECT_EQ(w.history(), accepted);
}

TEST(PathHistory, StepsThatAreCutLeaveNoTrace) {
  // the path that objections cut is the one that steps to where they let it
  Walked cut(foil(8e3, false));
  std::vector<path::Moment> stood = {{0, 0}};
  path::LoadPathOptions options;
  options.flow.growth = 1;
  int asked = 0;
  options.objection = [&](const assembly::Configuration&) { return asked++ < 2 ? "no" : ""; };
  ASSERT_EQ(path::follow_load(cut.system, cut.newton, cut.at, options,
                              [&](const path::Step& s, const assembly::Configuration&) {
                                stood.push_back({0, s.load_factor});
                              })
                .end,
            path::PathEnd::reached);
  ASSERT_GT(stood.size(), 3U);
  Walked told(foil(8e3, false));
  path::LoadPathOptions straight = in_time(stood);
  straight.flow.growth = 1;
  ASSERT_EQ(path::follow_load(told.system, told.newton, told.at, straight, {}).end, path::PathEnd::reached);
  ASSERT_GT(told.largest_alpha(), 1e-3);
  const std::vector<double> a = cut.history();
  const std::vector<double> b = told.history();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-9 * (1 + std::abs(b[i]))); // Newton's tolerance
}

TEST(PathHistory, EveryStepIsRepeatedFromTheHistoryBeforeIt) {
  Walked w(foil(8e3, false));
  double worst = 0;
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, {},
                              [&](const path::Step&, const assembly::Configuration& at) {
                                assembly::Configuration c = at;
                                const std::vector<double> tangent = w.system.foils()[0].tangent;
                                w.system.evaluate_accepted(c, true);
                                for (std::size_t i = 0; i < tangent.size(); ++i) {
                                  worst = std::max(worst, std::abs(w.system.foils()[0].tangent[i] - tangent[i]));
                                }
                              })
                .end,
            path::PathEnd::reached);
  EXPECT_EQ(worst, 0);
}

TEST(PathHistory, AClosedCushionThatHoldsStillCreepsAndItsAirExpands) {
  Walked w(foil(600, true));
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, in_time({{0, 0}, {1, 1}}), {}).end, path::PathEnd::reached);
  assembly::Model model = foil(600, true);
  const double ambient = 1e5;
  chamber::Closed gas;
  gas.kappa = 1;
  gas.ambient_from = gas.ambient_to = ambient;
  gas.absolute0 = w.at.pressures[0] + ambient;
  gas.volume0 = w.system.chamber_volume(0);
  model.chambers[0].gas = gas;
  model.foils[0]->history = w.history();
  Walked held(std::move(model));
  held.at.positions = w.at.positions;
  held.at.pressures = w.at.pressures;
  double alpha = w.largest_alpha();
  double volume = gas.volume0;
  ASSERT_EQ(path::follow_load(held.system, held.newton, held.at, in_time({{0, 0}, {1e4, 0}}),
                              [&](const path::Step&, const assembly::Configuration& at) {
                                const double now = held.system.chamber_volume(0);
                                EXPECT_GT(now, volume);
                                EXPECT_NEAR((at.pressures[0] + ambient) * now, gas.absolute0 * gas.volume0,
                                            1e-8 * ambient * now);
                                EXPECT_GT(held.largest_alpha(), alpha);
                                volume = now;
                                alpha = held.largest_alpha();
                              })
                .end,
            path::PathEnd::reached);
  // found again from what it accepted, without time
  assembly::Configuration again = held.at;
  held.system.set_time_step(0);
  const assembly::Balance balance = held.system.evaluate(again, false);
  EXPECT_LT(balance.residual, 1e-8 * balance.force_scale);
}

TEST(PathHistory, AControlledPathTakesNoTimeWhateverStepTheSystemHad) {
  Walked w(foil(600, true));
  ASSERT_EQ(path::follow_load(w.system, w.newton, w.at, in_time({{0, 0}, {1e3, 0.5}}), {}).end, path::PathEnd::reached);
  ASSERT_GT(w.system.time_step(), 0);
  const std::vector<double> before = w.history();
  path::ArcLengthPath arc;
  arc.load_factor = 1;
  const path::PathResult path = path::follow_control(w.system, w.newton, w.at, arc, {}, {});
  ASSERT_EQ(path.end, path::PathEnd::reached) << path.reason;
  EXPECT_EQ(w.history(), before); // what creeps from zero stress on flows in time alone
}

TEST(PathHistory, WhatFlowsOnTheWayToTheStartOfAPathIsAccepted) {
  Walked w(foil(5e3, false));
  w.at.load_factor = 1; // not in balance there
  path::ArcLengthPath arc;
  arc.load_factor = 0.2;
  const path::PathResult path = path::follow_control(w.system, w.newton, w.at, arc, {}, {});
  ASSERT_EQ(path.end, path::PathEnd::reached) << path.reason;
  Walked loaded(foil(5e3, false));
  path::LoadPathOptions one_step;
  one_step.flow.growth = 1;
  ASSERT_EQ(path::follow_load(loaded.system, loaded.newton, loaded.at, one_step, {}).end, path::PathEnd::reached);
  EXPECT_GT(loaded.largest_alpha(), 1e-3);
  EXPECT_NEAR(w.largest_alpha(), loaded.largest_alpha(), 1e-7); // unloaded since
}

TEST(PathHistory, TheFirstStepFromAFlatFoilFlowsNoFurtherThanOthers) {
  tests::Cushion cushion;
  cushion.heights = {0.0};
  cushion.base = true;
  assembly::Model model = tests::model_of(cushion, 0);
  model.chambers[0].gas = chamber::Regulated{0, 120e3};
  model.foils[0]->law = material::Logarithmic{tests::etfe_elasticity, {tests::etfe_hardening(), {}}};
  Walked w(std::move(model));
  path::ArcLengthPath arc;
  arc.load_factor = 0.1;
  path::ControlledPathOptions options;
  std::vector<double> grown;
  double last = 0;
  const path::PathResult path = path::follow_control(w.system, w.newton, w.at, arc, options,
                                                     [&](const path::Step&, const assembly::Configuration&) {
                                                       grown.push_back(w.largest_alpha() - last);
                                                       last = w.largest_alpha();
                                                     });
  ASSERT_EQ(path.end, path::PathEnd::reached) << path.reason;
  EXPECT_GT(last, options.flow.growth);
  for (const double g : grown) EXPECT_LE(g, options.flow.growth);
}

} // namespace
