// SPDX-License-Identifier: GPL-3.0-or-later
// Where paths begin, end and turn: goals at the start, beside limit points and at zero, flat starts, quantities that
// turn back; several chambers under control.
#include "solver/path/controlled_path.h"
#include "tests/verification/pyramid.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::Vec3;
using geometry::ElementType;
using tests::Cushion;
using tests::model_of;
using tests::Pyramid;

const Pyramid pyramid;
const double down_to_limit = pyramid.z0 - pyramid.z0 / std::numbers::sqrt3; // of its apex, m

assembly::Model pressed_pyramid() {
  return pyramid.model(pyramid.limit());
}

Index apex_of(const assembly::Model& model, std::size_t block = 0) {
  for (const Index node : model.mesh.blocks[block].connectivity) {
    const auto i = static_cast<std::size_t>(node);
    if (model.fixed[3 * i] == 0 && model.mesh.nodes[i].head<2>().norm() < 1e-9) return node;
  }
  return -1;
}

path::DisplacementPath down(const assembly::Model& model, double until) {
  return {path::displacement_of(apex_of(model), Vec3(0, 0, -1)), until};
}

struct Followed {
  assembly::System system;
  path::Newton newton;
  assembly::Configuration at;
  path::PathResult path;
  std::vector<assembly::Configuration> states;
  int ends_of_parts = 0;

  Followed(const assembly::Model& model, const path::PathControl& control, int parts = 1,
           const assembly::Configuration* from = nullptr, const path::Objection& objection = {})
      : system(model, 1), newton(system, {}), at(from != nullptr ? *from : tests::start_of(model)) {
    path::ControlledPathOptions options;
    options.parts = parts;
    options.max_steps = 120;
    options.objection = objection;
    path = path::follow_control(
        system, newton, at, control, options,
        [&](const path::Step& step, const assembly::Configuration& c) {
          states.push_back(c);
          ends_of_parts += step.end_of_part ? 1 : 0;
        },
        tests::tell);
  }
  bool reached() const { return path.end == path::PathEnd::reached; }
  double height(std::size_t block = 0) const {
    return at.positions[static_cast<std::size_t>(apex_of(system.model(), block))].z();
  }
  int limits() const {
    return static_cast<int>(std::count_if(path.critical.begin(), path.critical.end(), [](const path::CriticalPoint& c) {
      return c.kind == path::CriticalPoint::Kind::limit;
    }));
  }
};

assembly::Model flat_foil() {
  Cushion c;
  c.plan = geometry::Rectangle{1, 1};
  c.divisions = {4, 4};
  c.heights = {0};
  c.base = true;
  assembly::Model model = model_of(c, 0);
  model.face_pressure = {{0, 400}, {0, 0}};
  return model;
}

TEST(PathEnds, AGoalWhereThePathStandsIsReachedWithoutAStep) {
  const assembly::Model model = pressed_pyramid();
  assembly::System system(model, 1);
  assembly::Configuration start = tests::start_of(model);
  system.evaluate(start, true);
  for (const path::PathControl& control :
       {path::PathControl(down(model, 0)), path::PathControl(path::VolumePath{0, system.chamber_volume(0)})}) {
    const Followed f(model, control);
    EXPECT_TRUE(f.reached()) << f.path.reason;
    EXPECT_EQ(f.path.steps, 0);
  }
}

TEST(PathEnds, AFlatFoilMeetsEveryPartHoweverSmall) {
  for (const int parts : {1, 5, 40}) { // parts shorter than the first step too
    const Followed f(flat_foil(), path::LargestDisplacementPath{0, 0.05}, parts);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    EXPECT_EQ(f.ends_of_parts, parts);
    EXPECT_NEAR(f.height(), 0.05, 1e-10);
  }
}

TEST(PathEnds, AnArcFromAFlatFoilEndsWithinItsFirstStep) {
  path::ArcLengthPath load, move;
  load.load_factor = 0.05;
  move.displacement = 0.005;
  const Followed by_load(flat_foil(), load), by_move(flat_foil(), move);
  ASSERT_TRUE(by_load.reached()) << by_load.path.reason;
  EXPECT_NEAR(by_load.at.load_factor, 0.05, 1e-10);
  ASSERT_TRUE(by_move.reached()) << by_move.path.reason;
  EXPECT_NEAR(by_move.height(), 0.005, 1e-11);
}

TEST(PathEnds, TheFirstStepFromAFlatFoilTurnsNoElementOver) {
  assembly::Model model = flat_foil();
  model.face_pressure = {{0, 100e6}, {0, 0}}; // a tenth of it blows the foil up to more than a hemisphere
  assembly::System system(model, 1);
  path::Newton newton(system, {});
  assembly::Configuration at_once = tests::start_of(model);
  at_once.load_factor = 0.1;
  ASSERT_TRUE(newton.solve(at_once).converged);
  EXPECT_TRUE(path::turned_over(system, tests::start_of(model), at_once));
  path::ArcLengthPath arc;
  arc.load_factor = 0.1;
  const Followed f(model, arc);
  ASSERT_TRUE(f.reached()) << f.path.reason;
  assembly::Configuration before = tests::start_of(model);
  for (const assembly::Configuration& state : f.states) {
    EXPECT_FALSE(path::turned_over(f.system, before, state)) << state.load_factor;
    before = state;
  }
}

TEST(PathEnds, AVolumeThatTheFirstLoadStepWouldPassIsMet) {
  for (const int parts : {1, 4}) {
    const Followed f(flat_foil(), path::VolumePath{0, 1e-3}, parts);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    EXPECT_EQ(f.ends_of_parts, parts);
    EXPECT_NEAR(f.system.chamber_volume(0), 1e-3, 1e-12);
  }
}

TEST(PathEnds, AnArcMeetsEqualPartsOfTheWayToItsGoal) {
  path::ArcLengthPath arc;
  arc.displacement = 0.15;
  arc.after_peak = 0.01; // not the first goal: behind it
  const assembly::Model model = pressed_pyramid();
  const Followed f(model, arc, 5);
  EXPECT_EQ(f.ends_of_parts, 4); // 0.03, 0.06, 0.09 m and the fall
  int met = 0;
  for (const assembly::Configuration& c : f.states) {
    const double way = (pyramid.z0 - c.positions[static_cast<std::size_t>(apex_of(model))].z()) / 0.03;
    met += std::abs(way - std::round(way)) < 1e-8 ? 1 : 0;
  }
  EXPECT_EQ(met, 3);
}

TEST(PathEnds, WhatIsObjectedToIsApproachedAndNotAccepted) {
  const assembly::Model model = pressed_pyramid();
  const Index apex = apex_of(model);
  for (const double lowest : {0.08, 0.03}) { // before and behind the limit point
    const path::Objection objection = [&](const assembly::Configuration& c) -> std::string {
      return c.positions[static_cast<std::size_t>(apex)].z() < lowest ? "too low" : "";
    };
    path::ArcLengthPath arc;
    arc.displacement = 0.15;
    for (const path::PathControl& control : {path::PathControl(down(model, 0.15)), path::PathControl(arc)}) {
      const Followed f(model, control, 1, nullptr, objection);
      EXPECT_EQ(f.path.end, path::PathEnd::stopped);
      EXPECT_EQ(f.path.reason, "too low");
      EXPECT_GE(f.height(), lowest);
      EXPECT_LT(f.height(), lowest + 2e-3);
    }
    assembly::System system(pyramid.model(1.25 * pyramid.limit()), 1);
    path::Newton newton(system, {});
    assembly::Configuration at = tests::start_of(model);
    path::LoadPathOptions options;
    options.objection = objection;
    const path::PathResult result = path::follow_load(system, newton, at, options, {});
    EXPECT_EQ(result.end, path::PathEnd::stopped);
    EXPECT_NE(result.reason.find("too low"), std::string::npos) << result.reason;
    const double z = at.positions[static_cast<std::size_t>(apex)].z();
    EXPECT_GE(z, lowest);
    EXPECT_NEAR(-pyramid.pressure(z) / (1.25 * pyramid.limit()), result.load_factor, 1e-7);
    if (lowest > pyramid.z0 / std::numbers::sqrt3) {
      EXPECT_NEAR(result.load_factor, -pyramid.pressure(lowest) / (1.25 * pyramid.limit()), 2e-3);
    } else { // what lies behind the limit point is a snap-through, and is said to be
      EXPECT_NE(result.reason.find("limit point at load factor 0.8 "), std::string::npos) << result.reason;
    }
  }
}

TEST(PathEnds, APathStartsInEquilibriumWhateverItIsGiven) {
  // the load of the start is not in the geometry of the start (strips just welded are like this)
  assembly::Model model = pressed_pyramid();
  model.face_pressure[0] = {-0.3 * pyramid.limit(), -pyramid.limit()};
  path::ArcLengthPath arc;
  arc.load_factor = 0.5;
  const Followed f(model, arc);
  ASSERT_TRUE(f.reached()) << f.path.reason;
  EXPECT_NEAR(pyramid.pressure(f.height()), -0.65 * pyramid.limit(), 1e-7 * pyramid.limit());
}

TEST(PathEnds, AnArcTurnsTowardsALoadBelowItsStart) {
  path::ArcLengthPath arc;
  arc.load_factor = -0.5; // the pressure lifts the apex
  const Followed f(pressed_pyramid(), arc);
  ASSERT_TRUE(f.reached()) << f.path.reason;
  EXPECT_EQ(f.limits(), 0);
  EXPECT_GT(f.height(), pyramid.z0);
  EXPECT_NEAR(pyramid.pressure(f.height()), 0.5 * pyramid.limit(), 1e-7 * pyramid.limit());
}

TEST(PathEnds, PathsThatLeadNowhereSaySo) {
  assembly::Model still = pressed_pyramid();
  still.face_pressure[0] = {0, 0};
  path::ArcLengthPath far;
  far.load_factor = 1e30;
  const Followed unmoved(still, far);
  EXPECT_NE(unmoved.path.reason.find("nothing drives the path"), std::string::npos) << unmoved.path.reason;
  const Followed runs(pressed_pyramid(), far);
  EXPECT_NE(runs.path.reason.find("runs away"), std::string::npos) << runs.path.reason;
  const Followed up(pressed_pyramid(), down(pressed_pyramid(), -0.05));
  EXPECT_NE(up.path.reason.find("away from the goal"), std::string::npos) << up.path.reason;
  EXPECT_EQ(up.path.steps, 0);
}

TEST(PathEnds, ALoadJustBelowTheLimitIsMetBeforeTheLimitPoint) {
  for (const double below : {1e-2, 1e-4, 1e-6, 1e-8}) {
    path::ArcLengthPath arc;
    arc.load_factor = 1 - below;
    const Followed f(pressed_pyramid(), arc);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    EXPECT_NEAR(f.at.load_factor, 1 - below, 1e-9);
    EXPECT_EQ(f.limits(), 0) << below;
    EXPECT_NEAR(pyramid.pressure(f.height()), -(1 - below) * pyramid.limit(), 1e-8 * pyramid.limit());
  }
}

TEST(PathEnds, ALimitPointBesideTheEndOfAPartIsFoundOnce) {
  const assembly::Model model = pressed_pyramid();
  for (const double beside : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6}) {
    const Followed f(model, down(model, 2 * (down_to_limit + beside)), 2);
    ASSERT_TRUE(f.reached()) << beside << ": " << f.path.reason;
    EXPECT_EQ(f.ends_of_parts, 2);
    ASSERT_EQ(f.limits(), 1) << beside;
    EXPECT_NEAR(f.path.critical[0].load_factor, 1, 1e-9);
  }
}

TEST(PathEnds, AnArcStartsFromALimitPoint) {
  const assembly::Model model = pressed_pyramid();
  for (const double beside : {0.0, 1e-9, -1e-9, 1e-5, -1e-5}) {
    const Followed at_limit(model, down(model, down_to_limit + beside));
    path::ArcLengthPath arc;
    arc.load_factor = -0.5; // lies ahead whichever way it goes
    const Followed f(model, arc, 1, &at_limit.at);
    ASSERT_TRUE(f.reached()) << beside << ": " << f.path.reason;
    EXPECT_NEAR(pyramid.pressure(f.height()), 0.5 * pyramid.limit(), 1e-7 * pyramid.limit());
    EXPECT_LT(std::abs(f.height()), 1.5 * pyramid.z0); // no branch but the nearest
  }
}

TEST(PathEnds, QuantitiesEndAtZeroToo) {
  const assembly::Model model = pressed_pyramid();
  const Followed flat(model, path::VolumePath{0, 0});
  ASSERT_TRUE(flat.reached()) << flat.path.reason;
  EXPECT_NEAR(flat.height(), 0, 1e-12);
  const Followed bent(model, down(model, 0.02));
  const Followed back(model, path::LargestDisplacementPath{0, 0}, 1, &bent.at);
  ASSERT_TRUE(back.reached()) << back.path.reason;
  EXPECT_NEAR(back.height(), pyramid.z0, 1e-12);
  EXPECT_NEAR(back.at.load_factor, 0, 1e-9);
}

TEST(PathEnds, ADisplacementThatTheLoadDoesNotMoveIsRefused) {
  const assembly::Model model = pressed_pyramid();
  const Followed f(model, path::DisplacementPath{path::displacement_of(apex_of(model), Vec3(1, 0, 0)), 0.01});
  EXPECT_EQ(f.path.end, path::PathEnd::stuck);
  EXPECT_NE(f.path.reason.find("does not move with the load"), std::string::npos) << f.path.reason;
}

TEST(PathEnds, AnArcHoldsWhatTheLoadDoesNot) {
  path::ArcLengthPath arc;
  arc.displacement = 0.07; // between the limit points
  Followed f(pressed_pyramid(), arc);
  ASSERT_TRUE(f.reached() && f.path.held);
  const path::Row row = path::row_of(*f.path.held, 0, f.system, f.at);
  const path::Stability count = f.newton.tangent().stability(f.at, &row);
  EXPECT_EQ(count.load_held, 1);
  EXPECT_EQ(count.control_held, 0);
}

// Von Mises' truss behind a spring: a soft pyramid is pushed onto thin air above a stiff one. With p of the stiff one
// at the height z, Boyle's law (p + p_amb) 4/3 (upper - z) = p_amb V0 gives the upper apex, which goes back while the
// stiff one snaps through.
TEST(PathEnds, AQuantityThatSnapsBackIsNamedAndAnArcPasses) {
  constexpr double ambient = 500, gap = 0.2, softer = 1e5;
  Cushion c;
  c.plan = geometry::Rectangle{2, 2};
  c.element = ElementType::T3;
  c.divisions = {2, 2};
  c.heights = {pyramid.z0 + gap, pyramid.z0};
  assembly::Model model = model_of(c, 0);
  model.foils[0]->law = material::StVenantKirchhoff{pyramid.E / softer, pyramid.nu};
  const double volume = 4.0 / 3 * gap;
  model.chambers[0].gas = chamber::Closed{1, ambient, volume, 1, 1, ambient, ambient};
  model.face_pressure = {{0, -pyramid.limit()}, {0, 0}};

  const Followed held(model, down(model, 0.3));
  EXPECT_EQ(held.path.end, path::PathEnd::stuck);
  EXPECT_NE(held.path.reason.find("the controlled quantity turns back near"), std::string::npos) << held.path.reason;
  path::ArcLengthPath arc;
  arc.displacement = 0.22;
  arc.block = 1;
  const Followed f(model, arc);
  ASSERT_TRUE(f.reached()) << f.path.reason;
  EXPECT_EQ(f.limits(), 2);
  double back = 0, lowest = 1; // of the upper apex
  for (const assembly::Configuration& s : f.states) {
    const double upper = s.positions[static_cast<std::size_t>(apex_of(model, 0))].z();
    const double lower = s.positions[static_cast<std::size_t>(apex_of(model, 1))].z();
    const double p = -pyramid.pressure(lower);
    EXPECT_NEAR(s.pressures[0], p, 1e-7 * pyramid.limit());
    EXPECT_NEAR(upper, lower + 3.0 / 4 * ambient * volume / (ambient + p), 1e-9);
    lowest = std::min(lowest, upper);
    back = std::max(back, upper - lowest);
  }
  EXPECT_GT(back, 0.01);
}

TEST(PathEnds, SizesFrom1mmTo100mTakeTheSameSteps) {
  for (const double size : {1e-3, 1.0, 100.0}) {
    Pyramid scaled;
    scaled.a *= size;
    scaled.z0 *= size;
    scaled.h *= size;
    path::ArcLengthPath arc;
    arc.load_factor = 1.3;
    const Followed f(scaled.model(scaled.limit()), arc);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    EXPECT_EQ(f.path.steps, 9) << size;
    EXPECT_EQ(f.limits(), 2);
    double lowest = 0;
    for (const Vec3& x : f.at.positions) lowest = std::min(lowest, x.z());
    EXPECT_NEAR(scaled.pressure(lowest), -1.3 * scaled.limit(), 1e-7 * scaled.limit());
  }
}

// --- several chambers
// -------------------------------------------------------------------------------------------------

assembly::Model three_foils() {
  Cushion c;
  c.plan = geometry::Rectangle{2, 2};
  c.divisions = {4, 4};
  c.heights = {0.15, 0.03, -0.1};
  assembly::Model model = model_of(c, 0);
  for (assembly::Chamber& chamber : model.chambers) chamber.gas = chamber::Regulated{0, 300};
  model.face_pressure = {{0, 0}, {0, 20}, {0, 0}}; // keeps the middle foil taut
  return model;
}

TEST(PathEnds, ConnectedChambersUnderVolumeControlStandWhereLoadControlLeads) {
  assembly::Model model = three_foils();
  const tests::Solved blown(model);
  ASSERT_TRUE(blown.converged()) << blown.path.reason;
  chamber::Closed gas = tests::closed_now(blown, 0, 101325, 1.4);
  gas.volume0 += blown.system.chamber_volume(1);
  for (assembly::Chamber& chamber : model.chambers) chamber.gas = gas;
  model.chambers[1].connected_to = 0;
  model.face_pressure = {{0, -500}, {20, 20}, {0, 0}};
  assembly::Configuration from = blown.at;
  from.load_factor = 0;
  for (const auto& [chamber, part] : {std::pair<Index, double>{0, 0.98}, {1, 1.02}}) {
    const Followed f(model, path::VolumePath{chamber, part * blown.system.chamber_volume(chamber)}, 1, &from);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    model.face_pressure[0][1] = -500 * f.at.load_factor;
    const tests::Solved same(model, from);
    model.face_pressure[0][1] = -500;
    ASSERT_TRUE(same.converged()) << same.path.reason;
    EXPECT_EQ(f.at.pressures[0], f.at.pressures[1]);
    EXPECT_NEAR(f.at.pressures[0], same.at.pressures[0], 1e-6 * same.at.pressures[0]);
    EXPECT_NEAR(f.system.chamber_volume(1 - chamber), same.system.chamber_volume(1 - chamber), 1e-8);
  }
}

TEST(PathEnds, ThreadsChangeNoBitOfAPath) {
  const assembly::Model model = three_foils();
  std::vector<assembly::Configuration> ends;
  for (const int threads : {1, 3}) {
    assembly::System system(model, threads);
    path::Newton newton(system, {});
    ends.push_back(tests::start_of(model));
    path::ArcLengthPath arc;
    arc.load_factor = 1;
    const path::PathResult path = path::follow_control(system, newton, ends.back(), arc, {}, {}, tests::tell);
    ASSERT_EQ(path.end, path::PathEnd::reached) << path.reason;
  }
  for (std::size_t i = 0; i < ends[0].positions.size(); ++i) EXPECT_EQ(ends[0].positions[i], ends[1].positions[i]);
}

TEST(PathEnds, APrescribedVolumeIsDrivenByArcAndByItsOwnControlAlike) {
  Cushion c;
  c.plan = geometry::Rectangle{2, 2};
  c.divisions = {4, 4};
  c.heights = {0.1, -0.1};
  assembly::Model model = model_of(c, 0);
  model.chambers[0].gas = chamber::Regulated{0, 300};
  const tests::Solved blown(model);
  ASSERT_TRUE(blown.converged()) << blown.path.reason;
  const double volume = blown.system.chamber_volume(0);
  model.chambers[0].gas = chamber::PrescribedVolume{volume, 1.02 * volume};
  assembly::Configuration from = blown.at;
  from.load_factor = 0;
  path::ArcLengthPath arc;
  arc.load_factor = 1;
  const tests::Solved by_load(model, from);
  const Followed by_arc(model, arc, 1, &from), by_volume(model, path::VolumePath{0, 1.02 * volume}, 1, &from);
  ASSERT_TRUE(by_load.converged() && by_arc.reached() && by_volume.reached());
  EXPECT_NEAR(by_arc.at.pressures[0], by_load.at.pressures[0], 1e-6 * by_load.at.pressures[0]);
  EXPECT_NEAR(by_volume.at.pressures[0], by_load.at.pressures[0], 1e-6 * by_load.at.pressures[0]);
}

} // namespace
