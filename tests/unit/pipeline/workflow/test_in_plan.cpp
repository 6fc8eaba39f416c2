// SPDX-License-Identifier: GPL-3.0-or-later
// What needs no solution to be seen: places beside the foil, numbers beyond all measure, and what has no effect.
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "pipeline/workflow/limits.h"
#include "tests/unit/pipeline/workflow/messages.h"

namespace pneuma::pipeline::workflow {
namespace {

class BesideThePlan : public testing::TestWithParam<Bad> {};
TEST_P(BesideThePlan, IsToldWhatAndWhere) {
  expect_messages(GetParam().before, GetParam().after, GetParam().messages);
}

constexpr const char* load = "{name: suction, foil: upper, wind: -0.6 kPa}";
constexpr const char* plan = "{shape: rectangle, length: 6 m, width: 3 m}";
constexpr const char* mesh = "{element: T6, size: 0.15 m}";
constexpr const char* inflate =
    "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed}";

const Bad beside[] = {
    {"RegionBeside",
     load,
     "{name: far, foil: upper, wind: -0.6 kPa, region: {x: @[4 m, 5 m]}}",
     {"the region of load `far` reaches from x = 4 to 5 m, the plan only from -3 to 3 m: keep it on the foil, or leave "
      "`x` out for all of it"}},
    {"RegionHalfBeside",
     load,
     "{name: half, foil: upper, snow: 0.6 kPa, region: {x: [0 m, 1 m], y: @[1 m, 200 cm]}}",
     {"the region of load `half` reaches from y = 1 to 2 m, the plan only from -1.5 to 1.5 m"}},
    {"RegionOfASecondLoad",
     load,
     "{name: one, foil: upper, wind: -0.6 kPa}, {name: two, foil: upper, wind: 0.1 kPa, region: {y: @[-2 m, 0 m]}}",
     {"the region of load `two` reaches from y = -2 to 0 m"}},
    {"PolygonHalfBeside",
     load,
     "{name: a, foil: upper, wind: -0.6 kPa, region: {polygon: @[[0 m, 0 m], [4 m, 0 m], [0 m, 1 m]]}}",
     {"the region of load `a` reaches from x = 0 to 4 m"}},
    {"PolygonThatCrossesItself",
     load,
     "{name: a, foil: upper, wind: -0.6 kPa, region: {polygon: @[[0 m, 0 m], [1 m, 0 m], [0 m, 1 m], [1 m, 1 m]]}}",
     {"the outline crosses or touches itself: its sides e2 from (1, 0) and e4 from (1, 1) meet"}},
    {"PolygonWithADoubledPoint",
     load,
     "{name: a, foil: upper, wind: -0.6 kPa, region: {polygon: @[[0 m, 0 m], [1 m, 0 m], [1 m, 0 m], [1 m, 1 m]]}}",
     {"the side e2 has no length: the points 2 and 3 are the same, (1, 0); leave one out"}},
    {"PatchBeside",
     load,
     "{name: a, foil: upper, patch: {center: @[9 m, 0 m], size: [1 m, 1 m], force: [0 N, 0 N, -1 N]}}",
     {"only 0 of the 1 m2 of the patch `a` lie on the foil `upper`: move it, or make it smaller"}},
    {"PatchHalfBeside",
     load,
     "{name: a, foil: upper, patch: {center: @[3 m, 0 m], size: [1 m, 1 m], force: [0 N, 0 N, -1 N]}}",
     {"only 0.5 of the 1 m2 of the patch `a`"}},
    {"PatchWithARegion",
     load,
     "{name: a, foil: upper, patch: {center: [0 m, 0 m], size: [1 m, 1 m], force: [0 N, 0 N, -1 N]}, @region: {x: [0 "
     "m, 1 m]}}",
     {"`region` is not for a patch, which says its own place with `center` and `size`; leave it out"}},
    {"ControlledPlaceBeside",
     inflate,
     "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed, control: "
     "{type: "
     "displacement, at: @[0 m, 2 m], foil: upper, until: 1 cm}}",
     {"the place (0, 2) m lies beside the plan: take one inside"}},
    {"ControlledPlaceOnTheRim",
     inflate,
     "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed, control: "
     "{type: "
     "displacement, at: @[0 m, 1.5 m], foil: upper, until: 1 cm}}",
     {"the place (0, 1.5) m lies on the clamped edge, which does not move: take one inside"}},
    {"CurveThatEndsInside",
     inflate,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n  strips: {run: pattern, from: "
     "form, "
     "curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]], [[1 m, -1.5 m], @[1 m, 1 m]]]}}",
     {"this end (1, 1) m lies 0.5 m from it: end it at (1, 1.5) m"}},
    {"CurvesThatCross",
     inflate,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n  strips: {run: pattern, from: "
     "form, "
     "curves: {all: [[[-1 m, -1.5 m], [1 m, 1.5 m]], @[[1 m, -1.5 m], [-1 m, 1.5 m]]]}}",
     {"this curve crosses or touches curve 1 near (0, 0) m"}},
    {"CurveThatLeavesThePlan",
     inflate,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n  strips: {run: pattern, from: "
     "form, "
     "curves: {all: [[[0 m, -1.5 m], @[4 m, 0 m], [0 m, 1.5 m]]]}}",
     {"the point (4, 0) m of the curve lies beside the plan"}},
};
INSTANTIATE_TEST_SUITE_P(Places, BesideThePlan, testing::ValuesIn(beside),
                         [](const auto& one) { return one.param.claim; });

const Bad measures[] = {
    {"ShortEdgeOfAPolygon",
     plan,
     "{shape: polygon, points: @[[0 m, 0 m], [6 m, 0 m], [6 m, 3 m], [5.998 m, 3 m], [0 m, 3 m]]}",
     {"the edge e3 from (6, 3) to (5.998, 3) is 0.002 m long, less than a thousandth of the plan (6.71 m); leave one "
      "of "
      "its ends out"}},
    {"ShortEdgeOfARectangle",
     plan,
     "@{shape: rectangle, length: 60 m, width: 5 cm}",
     {"the edge east from (30, -0.025) to (30, 0.025) is 0.05 m long"}},
    {"FourCornersOfATriangle",
     plan,
     "{shape: triangle, points: @[[0 m, 0 m], [6 m, 0 m], [6 m, 3 m], [0 m, 3 m]]}",
     {"a triangle has 3 corners, not 4"}},
    {"TooManyDivisions",
     mesh,
     "{element: T3, divisions: @[4000, 2000]}",
     {"`divisions` makes about 1.6e+07 elements a foil; 5e+06 are the most"}},
    {"TooManyStrips",
     inflate,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n  strips: {run: pattern, from: "
     "form, "
     "strips_per_foil: @2000}",
     {"`strips_per_foil` must be from 2 to 200, not 2000"}},
    {"TooNarrowARoll",
     inflate,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n  strips: {run: pattern, from: "
     "form, "
     "roll: {width: @500 mm, weld: 5 mm, selvedge: 242.5 mm}}",
     {"0.01 m of the roll carry, of which a foil would need 300 strips at least; 200 are the most"}},
};
INSTANTIATE_TEST_SUITE_P(Measures, BesideThePlan, testing::ValuesIn(measures),
                         [](const auto& one) { return one.param.claim; });

constexpr const char* gust = "  gust:\n    run: wind\n    from: inflated\n    gas: {top: {law: closed, kappa: 1.4}}\n"
                             "    loads: [{name: suction, foil: upper, wind: -0.6 kPa}]\n";
const Bad without_effect[] = {
    {"WindStageThatChangesNothing",
     gust,
     "  @gust: {run: wind, from: inflated, gas: {top: {law: closed, kappa: 1.4}}}\n",
     {"`gust` changes nothing: no load acts, none of a stage before changes its factor, and every gas stays as it is"}},
    {"LoadsThatAreNothing",
     gust,
     "  gust: {run: wind, from: inflated, loads: [{name: a, foil: upper, @snow: 0 Pa}, {name: b, foil: upper, snow: 1 "
     "kPa}], factors: {b: 0}}\n",
     {"`gust` changes nothing"}},
    {"SecondStageThatChangesNothing",
     gust,
     "  gust: {run: wind, from: inflated, loads: [{name: a, foil: upper, snow: 1 kPa}]}\n"
     "  calm: {run: wind, from: gust, @factors: {a: 1}}\n",
     {"`calm` changes nothing"}},
    {"DurationWhereNothingFlows",
     gust,
     "  gust: {run: wind, from: inflated, loads: [{name: a, foil: upper, snow: 1 kPa}], @duration: 5 s}\n",
     {"`duration` has no effect: no foil flows with time (`law: j2` with `viscosity` does)"}},
    {"HistoryWhereNothingFlows",
     gust,
     "  gust: {run: wind, from: inflated, loads: [{name: a, foil: upper, snow: 1 kPa}], @history: [{time: 1 s, factor: "
     "1}, {time: 2 s, factor: 0}]}\n",
     {"`history` has no effect: the foils are elastic, and only what acts in the end counts"}},
    {"WarpThatStripsOverride",
     "thickness: 250 um}",
     "thickness: 250 um, @warp: 30 deg}",
     {"`warp` has no effect: the strips that `strips` cuts have their own, along the roll; leave it out"}},
};
class WithoutEffect : public testing::TestWithParam<Bad> {};
TEST_P(WithoutEffect, IsRefused) {
  const Bad& bad = GetParam();
  std::string before = bad.before, after = bad.after;
  if (std::string(bad.claim) == "WarpThatStripsOverride") { // the strips stand further down
    const std::string text = example;
    const std::size_t from = text.find(before), to = text.find(inflate);
    const std::string between = text.substr(from + before.size(), to - from - before.size());
    before += between + inflate;
    after += between + "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}\n"
                       "  strips: {run: pattern, from: form, strips_per_foil: 6, foils: [upper, lower]}";
  }
  expect_messages(before, after, bad.messages);
}
INSTANTIATE_TEST_SUITE_P(Cases, WithoutEffect, testing::ValuesIn(without_effect),
                         [](const auto& one) { return one.param.claim; });

std::string told(const std::string& text) {
  const Folder folder;
  std::string all;
  for (const Problem& problem : read_workflow(folder.write("w.yaml", text)).problems) all += problem.message + "\n";
  return all;
}

TEST(WithEffect, IsTaken) {
  const std::string flowing =
      "{law: j2, E: 900 MPa, nu: 0.45, density: 1750 kg/m3, hardening: [{stress: 16 MPa, modulus: 50 MPa}]";
  const std::string elastic = "{law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}";
  const std::string loaded = "  gust: {run: wind, from: inflated, loads: [{name: a, foil: upper, snow: 1 kPa}], ";
  const std::string history = replaced(example, gust,
                                       loaded + "history: [{time: 1 s, factor: 1}, {time: 2 s, factor: "
                                                "0}]}\n");
  EXPECT_EQ(told(replaced(history, elastic, flowing + "}")), "");
  const std::string viscous = flowing + ", viscosity: {model: peric, mu: 1000 s, epsilon: 0.1}}";
  EXPECT_EQ(told(replaced(replaced(example, gust, loaded + "duration: 5 s}\n"), elastic, viscous)), "");
  // creep under what acts already
  EXPECT_EQ(told(replaced(replaced(example, gust, "  gust: {run: wind, from: inflated, duration: 30 d}\n"), elastic,
                          viscous)),
            "");
  for (const char* gas : {"{law: closed, temperature: 0 degC}", "{law: volume, volume: 9 m3}",
                          "{law: regulated, gauge_pressure: 600 Pa}", "{law: closed, ambient_pressure: 95 kPa}"}) {
    EXPECT_EQ(
        told(replaced(example, gust, fmt::format("  gust: {{run: wind, from: inflated, gas: {{top: {}}}}}\n", gas))),
        "");
  }
  // the same foil uncut, beside the strips
  const std::string warp = replaced(example, "thickness: 250 um}", "thickness: 250 um, warp: 30 deg}");
  EXPECT_EQ(told(replaced(warp, "stages:\n", "stages:\n  strips: {run: pattern, from: form, strips_per_foil: 6}\n")),
            "");
}

std::string with_plan(const std::string& shape) {
  return replaced(example, plan, shape);
}

TEST(Ring, ThatRepeatsItsFirstPointIsTakenAsOneThatDoesNot) {
  const auto cushion = [](const std::string& shape) {
    const Folder folder;
    const ReadResult result = read_workflow(folder.write("w.yaml", with_plan(shape)));
    EXPECT_TRUE(result.problems.empty()) << to_string(result.problems.front());
    return effective_settings(result.workflow, result.workflow.stages.front());
  };
  const std::string corners = "[0 m, 0 m], [6 m, 0 m], [6 m, 3 m]";
  for (const std::string shape : {"triangle", "polygon"}) {
    EXPECT_EQ(cushion("{shape: " + shape + ", points: [" + corners + "]}"),
              cushion("{shape: " + shape + ", points: [" + corners + ", [0 mm, 0 mm]]}"));
  }
  const std::string region = "{name: a, foil: upper, snow: 1 kPa, region: {polygon: [" + corners.substr(0, 10) +
                             ", [1 m, 0 m], [1 m, 1 m]{}]}}";
  const auto stage = [&](const std::string& more) {
    const Folder folder;
    std::string text = region;
    text.replace(text.find("{}"), 2, more);
    const ReadResult result = read_workflow(folder.write("w.yaml", replaced(example, load, text)));
    EXPECT_TRUE(result.problems.empty()) << to_string(result.problems.front());
    return effective_settings(result.workflow, result.workflow.stages.back());
  };
  EXPECT_EQ(stage(""), stage(", [0 m, 0 m]"));
}

// Patches of random place and size on every kind of plan: refused where a fine raster finds a part beside the plan.
TEST(Patch, IsTakenWhereItLiesOnTheFoilWhateverThePlan) {
  struct Kind {
    const char* shape;
    std::function<bool(double, double)> inside;
  };
  const Kind kinds[] = {
      {"{shape: rectangle, length: 6 m, width: 3 m}",
       [](double x, double y) { return std::abs(x) <= 3 && std::abs(y) <= 1.5; }},
      {"{shape: circle, radius: 2 m}", [](double x, double y) { return std::hypot(x, y) <= 2; }},
      {"{shape: triangle, points: [[-3 m, -2 m], [3 m, -2 m], [-3 m, 2 m]]}",
       [](double x, double y) { return x >= -3 && y >= -2 && (x + 3) / 6 + (y + 2) / 4 <= 1; }},
      {"{shape: polygon, points: [[-2 m, -2 m], [2 m, -2 m], [2 m, 0 m], [0 m, 0 m], [0 m, 2 m], [-2 m, 2 m]]}",
       [](double x, double y) { return std::abs(x) <= 2 && std::abs(y) <= 2 && (x <= 0 || y <= 0); }},
  };
  std::mt19937 random(12);
  std::uniform_real_distribution<double> place(-3, 3), size(0.1, 2);
  int taken = 0, refused = 0;
  for (const Kind& kind : kinds) {
    for (int i = 0; i < 40; ++i) {
      const double x = place(random), y = place(random), a = size(random), b = size(random);
      bool inside = true;
      constexpr int raster = 40;
      for (int k = 0; k <= raster * raster + 2 * raster; ++k) {
        const double u = x + a * (k % (raster + 1) / double{raster} - 0.5);
        const double v = y + b * (k / (raster + 1) / double{raster} - 0.5);
        inside = inside && kind.inside(u, v);
      }
      const std::string patch =
          fmt::format("{{name: a, foil: upper, patch: {{center: [{} m, {} m], size: [{} m, {} m], "
                      "force: [0 N, 0 N, -1 N]}}}}",
                      x, y, a, b);
      EXPECT_EQ(told(replaced(with_plan(kind.shape), load, patch)).empty(), inside) << kind.shape << patch;
      ++(inside ? taken : refused);
    }
  }
  EXPECT_GT(taken, 15);
  EXPECT_GT(refused, 15);
}

TEST(Region, MayLieBesideTheFoilWithinTheReachOfThePlanAsLongAsAPartLiesOnIt) {
  const std::string corner = "{shape: triangle, points: [[0 m, 0 m], [4 m, 0 m], [0 m, 4 m]]}";
  const auto region = [&](const char* box) {
    return told(
        replaced(with_plan(corner), load, fmt::format("{{name: a, foil: upper, snow: 1 kPa, region: {}}}", box)));
  };
  EXPECT_EQ(region("{x: [0 m, 3 m], y: [0 m, 3 m]}"), "");
  EXPECT_EQ(region("{x: [3 m, 4 m]}"), "");
  EXPECT_EQ(region("{x: [3 m, 4 m], y: [3 m, 4 m]}"),
            "nothing of the region of load `a` lies on the foil `upper`: move "
            "it\n");
}

// The same plan, region and patch in survey coordinates: the same verdict.
TEST(Places, AreJudgedAlikeFarFromTheOrigin) {
  for (const double east : {0.0, 568120.0}) {
    const double north = 10 * east;
    const auto at = [&](double x, double y) { return fmt::format("[{:.4f} m, {:.4f} m]", east + x, north + y); };
    const std::string text =
        with_plan(fmt::format("{{shape: polygon, points: [{}, {}, {}, {}]}}", at(0, 0), at(6, 0), at(6, 3), at(0, 3)));
    const auto with = [&](double x) {
      const std::string patch = fmt::format(
          "{{name: a, foil: upper, patch: {{center: {}, size: [1 m, 1 m], force: [0 N, 0 N, -1 N]}}}}", at(x, 1));
      const std::string region = fmt::format(
          "{{name: b, foil: upper, snow: 1 kPa, region: {{x: [{:.4f} m, {:.4f} m]}}}}", east, east + x + 0.5);
      return told(replaced(text, load, patch + ", " + region));
    };
    EXPECT_EQ(with(5.5), "");
    EXPECT_THAT(with(5.5001),
                testing::AllOf(testing::HasSubstr("of the patch `a`"), testing::HasSubstr("the region of load `b`")));
  }
}

TEST(TooFineAMesh, IsRefusedByItsSize) {
  EXPECT_THAT(told(replaced(example, mesh, "{element: T3, size: 2 mm}")),
              testing::HasSubstr("`size` 0.002 m makes about 9e+06 elements a foil; 5e+06 are the most"));
}

// What the mesh stage makes lies within a third of the estimate: the numbers of nodes and elements are from meshes.
TEST(Estimate, OfAMeshIsNearWhatTheStageMakes) {
  using geometry::ElementType;
  MeshSettings fine;
  fine.element = ElementType::T6;
  fine.size = 0.03;
  const MeshEstimate one = estimate(geometry::Rectangle{6, 3}, fine); // 40000 elements of two foils, 160002 nodes
  EXPECT_NEAR(one.elements, 20000 * 2, 20000);
  EXPECT_NEAR(one.nodes, 80001, 80001 / 3.0);
}

} // namespace
} // namespace pneuma::pipeline::workflow
