// SPDX-License-Identifier: GPL-3.0-or-later
// The programs themselves, chained by the runner and one by one, on small cushions.
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "pipeline/state/state_file.h"
#include "tests/unit/pipeline/state/temporary_folder.h"
#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::HasSubstr;

using Stages = InFolder;

// The cushion of example B12 on a coarse mesh, with room for more stages.
std::string cushion(const std::string& element, const std::string& more) {
  return R"(pneuma: 1
name: Small cushion
materials: {foil: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}}
cushion:
  plan: {shape: rectangle, length: 6 m, width: 3 m}
  foils:
    - {name: upper, material: foil, thickness: 200 um}
    - {name: lower, material: foil, thickness: 200 um}
  chambers: [{name: main, between: [upper, lower]}]
mesh: {element: )" +
         element +
         R"(, divisions: [16, 8]}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {main: 400 Pa}, prestress: {all: 0.89 kN/m}}
  inflated: {run: inflate, from: form, reference: prestressed, gauge_pressure: {main: 400 Pa}}
)" + more;
}

TEST_F(Stages, CushionGoesFromOutlineToWindWithEveryElement) {
  for (const std::string element : {"T3", "T6", "Q4", "Q9"}) {
    write(cushion(
        element,
        R"(  regulated: {run: wind, from: inflated, gas: {main: {law: regulated}}, loads: [{name: s, foil: upper, wind: -0.6 kPa}]}
  closed: {run: wind, from: inflated, gas: {main: {law: closed, kappa: 1.4}}, loads: [{name: s, foil: upper, wind: -0.6 kPa}]}
)"));
    const Outcome run = pneuma("run w.yaml");
    ASSERT_EQ(run.code, 0) << element << '\n' << run.text;
    const json form = summary("form"), inflated = summary("inflated"), regulated = summary("regulated"),
               closed = summary("closed");
    // soap film of B12: 9.195 m3; linear elements on 16 x 8 hold 2 to 3 % less (tests/verification)
    const double film = form["chambers"]["main"]["volume"];
    EXPECT_NEAR(film, 9.195, element[1] == '6' || element[1] == '9' ? 0.005 : 0.3) << element;
    EXPECT_TRUE(form["self_check"]["upper"]["passed"].get<bool>() || element == "T3" || element == "Q4") << element;
    // the weight is all that moves the prestressed cushion
    EXPECT_LT(inflated["foils"]["upper"]["max_deflection"].get<double>(), 2e-3) << element;
    // vertical balance: weight of two foils, less 600 Pa on the plan
    const double weight = inflated["reactions"]["sum"][2];
    EXPECT_NEAR(weight, 1750 * 9.80665 * 200e-6 * 2 * form["foils"]["upper"]["area"].get<double>(), 0.01 * weight)
        << element;
    EXPECT_NEAR(regulated["reactions"]["sum"][2].get<double>(), weight - 600 * 18, 1e-6 * 600 * 18) << element;
    // regulated air keeps its pressure; shut in it gives way, and its own law holds
    EXPECT_EQ(regulated["chambers"]["main"]["gauge_pressure"], 400.0);
    const double p = closed["chambers"]["main"]["gauge_pressure"], V = closed["chambers"]["main"]["volume"];
    const double V0 = inflated["chambers"]["main"]["volume"];
    EXPECT_LT(p, 250);
    EXPECT_NEAR((101325 + p) * std::pow(V, 1.4), 101725 * std::pow(V0, 1.4), 1e-9 * 101725 * std::pow(V0, 1.4));
    EXPECT_LT(closed["foils"]["upper"]["max_deflection"], regulated["foils"]["upper"]["max_deflection"]);
    EXPECT_EQ(closed["stability"]["load_held"], 0);
  }
}

TEST_F(Stages, SecondRunDoesNothingAndAChangeRunsOnlyWhatDependsOnIt) {
  const std::string wind = "  gust: {run: wind, from: inflated, loads: [{name: s, foil: upper, wind: -0.6 kPa}]}\n";
  write(cushion("T3", wind));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const Outcome again = pneuma("run w.yaml");
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.text, HasSubstr("gust: up to date"));
  std::string changed = wind;
  changed.replace(changed.find("-0.6"), 4, "-0.5");
  write(cushion("T3", changed));
  const Outcome third = pneuma("run w.yaml");
  EXPECT_THAT(third.text, HasSubstr("inflated: up to date"));
  EXPECT_THAT(third.text, HasSubstr("gust: runs: settings changed"));
}

TEST_F(Stages, SameWorkflowGivesTheSameBytesWithOneThreadAndTwo) {
  write(cushion("T6", "  gust: {run: wind, from: inflated, gas: {main: {law: closed}}, loads: [{name: s, foil: upper, "
                      "wind: -0.6 kPa}]}\n"));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  for (const auto& [id, run, from] : {std::array{"form", "formfind", "mesh"}, std::array{"inflated", "inflate", "form"},
                                      std::array{"gust", "wind", "inflated"}}) {
    std::array<std::string, 2> bytes;
    for (const int threads : {1, 2}) {
      const fs::path file = folder / "o.hdf";
      const Outcome outcome = call((programs / "pneuma-").string() + run + " --config " +
                                   (out(id) / "stage.yaml").string() + " --in " + (out(from) / "state.hdf").string() +
                                   " --out " + file.string() + " --threads " + std::to_string(threads));
      ASSERT_EQ(outcome.code, 0) << outcome.text;
      bytes[static_cast<std::size_t>(threads - 1)] = bytes_of(file);
    }
    EXPECT_FALSE(bytes[0].empty());
    EXPECT_TRUE(bytes[0] == bytes[1]) << id;
  }
}

TEST_F(Stages, StressFreeFormInflatesAndStretches) {
  write(cushion("T6", "  soft: {run: inflate, from: form, reference: stress_free, gauge_pressure: {main: 300 Pa}}\n"));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const json soft = summary("soft");
  EXPECT_GT(soft["chambers"]["main"]["volume"], summary("form")["chambers"]["main"]["volume"]);
  EXPECT_GT(soft["foils"]["upper"]["principal_stress_1"]["max"].get<double>(), 1e6);
}

TEST_F(Stages, PatchLoadIsTheSameForceOnEveryMeshAndEndsInTheReactions) {
  for (const std::string element : {"T3", "Q9"}) {
    write(cushion(element, R"(  patch:
    run: wind
    from: inflated
    loads: [{name: middle, foil: upper, patch: {center: [0.2 m, 0.1 m], size: [0.75 m, 0.75 m], force: [0 kN, 0.1 kN, -0.5 kN]}}]
    control: {type: load, steps: 2}
)"));
    const Outcome run = pneuma("run w.yaml");
    ASSERT_EQ(run.code, 0) << run.text;
    const double weight = summary("inflated")["reactions"]["sum"][2];
    EXPECT_NEAR(summary("patch")["reactions"]["sum"][2].get<double>(), weight + 500, 1e-5) << element;
    EXPECT_NEAR(summary("patch")["reactions"]["sum"][1].get<double>(), -100, 1e-5) << element;
    EXPECT_TRUE(fs::exists(out("patch") / "steps" / "0001.hdf"));
    EXPECT_EQ(json::parse(std::ifstream(out("patch") / "steps.hdf.series"))["files"].size(), 2u);
  }
}

TEST_F(Stages, SnowWeighsOnThePlanAndRegionsTakeTheirShare) {
  write(cushion("T6", R"(  snow: {run: wind, from: inflated, loads: [{name: snow, foil: upper, snow: 100 Pa}]}
  half: {run: wind, from: inflated, loads: [{name: snow, foil: upper, snow: 100 Pa, region: {x: [0 m, 3 m], y: [-1.5 m, 1.5 m]}}]}
  east: {run: wind, from: inflated, loads: [{name: snow, foil: upper, snow: 100 Pa, region: {x: [0 m, 3 m]}}]}
  north: {run: wind, from: inflated, loads: [{name: snow, foil: upper, snow: 100 Pa, region: {y: [0 m, 1.5 m]}}]}
)"));
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const double weight = summary("inflated")["reactions"]["sum"][2];
  EXPECT_NEAR(summary("snow")["reactions"]["sum"][2].get<double>(), weight + 1800, 1e-5);
  for (const char* part : {"half", "east", "north"}) { // a side left out goes from end to end
    EXPECT_NEAR(summary(part)["reactions"]["sum"][2].get<double>(), weight + 900, 0.01) << part;
  }
}

TEST_F(Stages, FilmWithTooMuchPressureEndsWithFiveAndSaysWhatWouldDo) {
  std::string text = cushion("T3", "");
  text.replace(text.find("0.89"), 4, "0.35"); // 400 Pa on 18 m2 are more than 0.35 kN/m on 18 m of edge hold
  write(text);
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 5);
  EXPECT_THAT(run.text, HasSubstr("no equilibrium exists for foil `upper`"));
  EXPECT_THAT(run.text, HasSubstr("The largest pressure that has a film here is"));
  EXPECT_THAT(run.text, HasSubstr("inflated: not run"));
  EXPECT_FALSE(summary("form")["converged"].get<bool>());
}

TEST_F(Stages, ContactStopsAndIgnoredContactGoesOnMarked) {
  // the wind overcomes the air and turns the upper foil inside out, through the lower one
  const auto wind = [](const std::string& how) {
    return "  down: {run: wind, from: inflated, " + how + "loads: [{name: p, foil: upper, wind: 1.5 kPa}]}\n";
  };
  write(cushion("T3", wind("")));
  const Outcome limited = pneuma("run w.yaml");
  EXPECT_EQ(limited.code, 5) << limited.text;
  EXPECT_THAT(summary("down")["verdict"].get<std::string>(), HasSubstr("limit point at load factor 0.26"));
  write(cushion("T3", wind("after_limit: snap, ")));
  const Outcome stopped = pneuma("run w.yaml");
  EXPECT_EQ(stopped.code, 5) << stopped.text;
  const json contact = summary("down");
  const std::string verdict = contact["verdict"];
  ASSERT_THAT(verdict, HasSubstr("contact at load factor "));
  // the state that is written lies just before it, the foils apart
  const std::string number = "contact at load factor ";
  const double found = std::stod(verdict.substr(verdict.find(number) + number.size()));
  EXPECT_LT(contact["load_factor"].get<double>(), found);
  EXPECT_NEAR(contact["load_factor"].get<double>(), found, 5e-3);
  write(cushion("T3", wind("after_limit: snap, contact: ignore, ")));
  const Outcome ignored = pneuma("run w.yaml");
  EXPECT_EQ(ignored.code, 0) << ignored.text;
  EXPECT_THAT(summary("down")["warnings"].dump(), HasSubstr("contact at load factor"));
  EXPECT_THAT(summary("down")["warnings"].dump(), HasSubstr("the cushion loses its shape at load factor 0.26"));
  EXPECT_THAT(summary("down")["verdict"].get<std::string>(),
              HasSubstr("converged after the cushion lost its shape at load factor 0.26"));
}

TEST_F(Stages, CircleOverABaseInflatesFromFlatAndFromPrestressedFlat) {
  write(R"(pneuma: 1
name: Circle
materials: {foil: {law: elastic, E: 311.488 MPa, nu: 0.34}}
site: {ambient_pressure: 0 Pa, gravity: off}
cushion:
  plan: {shape: circle, radius: 0.1425 m}
  foils: [{name: membrane, material: foil, thickness: 1 mm}]
  base: rigid
  chambers: [{name: main, between: [membrane, base]}]
mesh: {element: Q9, divisions: [4, 4]}
stages:
  free: {run: inflate, from: mesh, gauge_pressure: {main: 400 kPa}}
  taut: {run: inflate, from: mesh, prestress: {all: 10 kN/m}, gauge_pressure: {main: 400 kPa}}
  coupled: {run: wind, from: free, gas: {main: {law: closed}}, loads: [{name: w, foil: membrane, wind: 300 kPa}]}
  held: {run: wind, from: free, gas: {main: {law: volume, volume: 1.5 l}}}
)");
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const double V = summary("free")["chambers"]["main"]["volume"];
  EXPECT_NEAR(V, 0.00188641, 5e-4 * V); // exact axisymmetric solution, tests/verification
  EXPECT_NEAR(summary("free")["foils"]["membrane"]["sag"].get<double>(), 0.05355272, 1e-4 * 0.0536);
  const double taut = summary("taut")["chambers"]["main"]["volume"];
  EXPECT_NEAR(taut / V, 0.90, 0.02); // the thesis: about 10 % less
  const double p = summary("coupled")["chambers"]["main"]["gauge_pressure"];
  EXPECT_NEAR(p * summary("coupled")["chambers"]["main"]["volume"].get<double>(), 400e3 * V, 1e-6 * 400e3 * V);
  EXPECT_NEAR(summary("held")["chambers"]["main"]["volume"].get<double>(), 1.5e-3, 1e-10);
}

// A skin of rubber over a rigid base, flat and without stress, with more stages.
std::string balloon(const std::string& more, const std::string& tension_field = "off") {
  return R"(pneuma: 1
name: Balloon
materials: {rubber: {law: neo_hooke, C1: 200 kPa, tension_field: )" +
         tension_field + R"(}}
site: {gravity: off}
cushion:
  plan: {shape: circle, radius: 0.1 m}
  foils: [{name: skin, material: rubber, thickness: 1 mm}]
  base: rigid
  chambers: [{name: main, between: [skin, base]}]
mesh: {element: T6, divisions: 4}
stages:
)" + more;
}

std::string inflated_by(const std::string& name, const std::string& control) {
  return "  " + name + ": {run: inflate, from: mesh, gauge_pressure: {main: 1 kPa}, control: " + control + "}\n";
}

TEST_F(Stages, ControlsEndWhereTheyAreTold) {
  for (const std::string tension_field : {"off", "on"}) {
    SCOPED_TRACE(tension_field);
    write(balloon(inflated_by("place", "{type: displacement, at: [0 m, 0 m], until: 3 cm, steps: 3}") +
                      inflated_by("largest", "{type: displacement, until: 3 cm}") +
                      inflated_by("volume", "{type: volume, until: 1 l}") +
                      inflated_by("pressure", "{type: arc_length, until: {pressure: 3 kPa, volume: 1 m3}}") +
                      inflated_by("peak", "{type: arc_length, until: {after_peak: 0.9}}"),
                  tension_field));
    const Outcome run = pneuma("run w.yaml");
    ASSERT_EQ(run.code, 0) << run.text;
    EXPECT_NEAR(summary("place")["foils"]["skin"]["max_deflection"].get<double>(), 0.03, 1e-9);
    EXPECT_NEAR(summary("largest")["foils"]["skin"]["max_deflection"].get<double>(), 0.03, 1e-9);
    EXPECT_EQ(json::parse(std::ifstream(out("place") / "steps.hdf.series"))["files"].size(), 3U);
    EXPECT_NEAR(summary("volume")["chambers"]["main"]["volume"].get<double>(), 1e-3, 1e-12);
    EXPECT_NEAR(summary("pressure")["chambers"]["main"]["gauge_pressure"].get<double>(), 3000, 1e-3);
    // the load is 1 kPa times the load factor; past the limit point a held pressure would not stay
    const json peak = summary("peak");
    EXPECT_EQ(peak["peak"]["quantity"], "gauge_pressure");
    EXPECT_NEAR(peak["load_factor"].get<double>(), 0.9 * peak["peak"]["value"].get<double>() / 1000, 1e-6);
    EXPECT_EQ(peak["stability"]["load_held"], 1);
  }
}

TEST_F(Stages, PressureBeyondTheLimitPointEndsWithFiveAndNamesIt) {
  // the exact disc carries 3.758 C1 h / R = 7517 Pa (tests/hard_cases)
  write(balloon("  up: {run: inflate, from: mesh, gauge_pressure: {main: 10 kPa}}\n"));
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 5) << run.text;
  EXPECT_THAT(run.text, HasSubstr("limit point at load factor 0.75"));
  const json up = summary("up");
  EXPECT_FALSE(up["converged"].get<bool>());
  EXPECT_NEAR(up["load_factor"].get<double>(), 0.7517, 2e-3);
  EXPECT_GT(pipeline::state::read_state(out("up") / "state.hdf").chambers[0].volume, 0);
}

TEST_F(Stages, ControlledPointThatCannotMoveIsRefusedAtItsPlace) {
  write(balloon(inflated_by("far", "{type: displacement, at: [1 m, 0 m], until: 3 cm}") +
                inflated_by("rim", "{type: displacement, at: [0.1 m, 0 m], until: 3 cm}")));
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.text, HasSubstr("w.yaml:12:100: the place (1, 0) m lies beside the plan"));
  EXPECT_THAT(run.text, HasSubstr("w.yaml:13:100: the place (0.1, 0) m lies on the clamped edge"));
}

TEST_F(Stages, StepsThatRunOutEndWithFiveAndTheLastGoodState) {
  std::string few = inflated_by("few", "{type: volume, until: 1 l}");
  few.insert(few.find(", control"), ", options: {max_steps: 2}");
  write(balloon(few));
  EXPECT_EQ(pneuma("run w.yaml").code, 5);
  EXPECT_FALSE(summary("few")["converged"].get<bool>());
  EXPECT_EQ(summary("few")["steps"], 2);
  EXPECT_GT(pipeline::state::read_state(out("few") / "state.hdf").chambers[0].volume, 0);
}

TEST_F(Stages, EquilateralTriangleGoesThroughTheWholeChain) {
  std::string text = cushion("T6", "  gust: {run: wind, from: inflated, gas: {main: {law: closed}}, loads: [{name: s, "
                                   "foil: lower, wind: 0.2 kPa}]}\n");
  text.replace(text.find("{shape: rectangle, length: 6 m, width: 3 m}"), 43, "{shape: triangle, side: 3.75 m}");
  text.replace(text.find("divisions: [16, 8]"), 18, "size: 0.4 m, pattern: unstructured");
  write(text);
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  // wind on the last foil pushes against its room face: up, with 200 Pa on the plan
  const double plan = std::sqrt(3.0) / 4 * 3.75 * 3.75;
  const double weight = summary("inflated")["reactions"]["sum"][2];
  EXPECT_NEAR(summary("gust")["reactions"]["sum"][2].get<double>(), weight - 200 * plan, 1e-6 * 200 * plan);
}

TEST_F(Stages, LShapedPolygonGoesThroughTheWholeChain) {
  std::string text = cushion("T6", "  gust: {run: wind, from: inflated, gas: {main: {law: closed}}, loads: [{name: s, "
                                   "foil: lower, wind: 0.2 kPa}]}\n");
  text.replace(text.find("{shape: rectangle, length: 6 m, width: 3 m}"), 43,
               "{shape: polygon, points: [[0 m, 0 m], [0 m, 4 m], [2 m, 4 m], [2 m, 2 m], [4 m, 2 m], [4 m, 0 m]]}");
  text.replace(text.find("divisions: [16, 8]"), 18, "size: 0.4 m");
  write(text);
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const double weight = summary("inflated")["reactions"]["sum"][2];
  EXPECT_NEAR(summary("gust")["reactions"]["sum"][2].get<double>(), weight - 200 * 12, 1e-6 * 200 * 12);
}

TEST_F(Stages, EachStageRunsAloneAndRefusesADamagedOrWrongState) {
  write(cushion("T3", ""));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const auto inflate = [&](const fs::path& in) {
    return call((programs / "pneuma-inflate").string() + " --config " + (out("inflated") / "stage.yaml").string() +
                " --in " + in.string() + " --out " + (folder / "alone.hdf").string());
  };
  ASSERT_EQ(inflate(out("form") / "state.hdf").code, 0);
  const auto alone = pipeline::state::read_state(folder / "alone.hdf");
  const auto chained = pipeline::state::read_state(out("inflated") / "state.hdf");
  EXPECT_EQ(alone.mesh.nodes, chained.mesh.nodes);

  const Outcome wrong = inflate(out("mesh") / "state.hdf");
  EXPECT_EQ(wrong.code, 3);
  EXPECT_THAT(wrong.text, HasSubstr("comes from a `mesh` stage"));
  EXPECT_EQ(inflate(folder / "none.hdf").code, 3);
  fs::resize_file(out("form") / "state.hdf", 5000);
  EXPECT_EQ(inflate(out("form") / "state.hdf").code, 3);
  EXPECT_EQ(call((programs / "pneuma-inflate").string() + " --nonsense").code, 2);
}

TEST_F(Stages, AStateOfAnotherCushionIsRefusedWithBothValues) {
  write(cushion("T3", ""));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  fs::copy_file(out("form") / "state.hdf", folder / "old.hdf");
  const std::pair<std::string, std::string> changes[] = {
      {"thickness: 200 um", "`cushion.foils.0.thickness` 0.0002 m, the settings say 0.0001 m"},
      {"E: 900 MPa", "`materials.foil.E` 900000000 Pa, the settings say 800000000 Pa"},
      {"length: 6 m", "`cushion.plan.length` 6 m, the settings say 7 m"}};
  const char* others[] = {"thickness: 100 um", "E: 800 MPa", "length: 7 m"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::string text = cushion("T3", "");
    text.replace(text.find(changes[i].first), changes[i].first.size(), others[i]);
    write(text);
    ASSERT_EQ(pneuma("run w.yaml").code, 0);
    const Outcome outcome =
        call((programs / "pneuma-inflate").string() + " --config " + (out("inflated") / "stage.yaml").string() +
             " --in " + (folder / "old.hdf").string() + " --out " + (folder / "x.hdf").string());
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.text, HasSubstr(changes[i].second));
    EXPECT_FALSE(fs::exists(folder / "x.hdf"));
  }
}

TEST_F(Stages, AnInputThatOnlyTakesAsItIsIsWarnedOfInSummaryAndLog) {
  write(cushion("T3", ""));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  std::string text = cushion("T3", "");
  text.replace(text.find("0.89 kN/m"), 9, "0.95 kN/m");
  write(text);
  EXPECT_EQ(pneuma("run w.yaml --only inflated --force inflated").code, 0);
  const std::string said = "`form` is used as it is, although settings changed";
  EXPECT_THAT(summary("inflated")["warnings"].dump(), HasSubstr(said));
  EXPECT_THAT(bytes_of(out("inflated") / "log.txt"), HasSubstr(said));
}

TEST_F(Stages, CheckOptionComputesAndWritesNothing) {
  write(cushion("T3", "  gust: {run: wind, from: inflated, loads: [{name: w, foil: upper, wind: -100 Pa}]}\n"));
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const std::array<std::array<const char*, 2>, 3> chain = {
      {{"form", "mesh"}, {"inflated", "form"}, {"gust", "inflated"}}};
  const std::array<const char*, 3> kinds = {"formfind", "inflate", "wind"};
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Outcome outcome = call((programs / "pneuma-").string() + kinds[i] + " --check --config " +
                                 (out(chain[i][0]) / "stage.yaml").string() + " --in " +
                                 (out(chain[i][1]) / "state.hdf").string() + " --out " + (folder / "x.hdf").string());
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(outcome.text, "");
    EXPECT_FALSE(fs::exists(folder / "x.hdf"));
  }
}

TEST_F(Stages, RegionThatMissesTheFoilIsRefusedAtItsPlace) {
  write(cushion(
      "T3",
      R"(  gust: {run: wind, from: inflated, loads: [{name: far, foil: upper, wind: -100 Pa, region: {x: [9 m, 10 m], y: [0 m, 1 m]}}]}
)"));
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.text,
              testing::ContainsRegex(
                  "w.yaml:14:[0-9]+: the region of load `far` reaches from x = 9 to 10 m, the plan only from -3"));
}

TEST_F(Stages, FormWhoseFoilsPassThroughEachOtherIsRefused) {
  std::string text = cushion("T3", "");
  text.replace(text.find("400 Pa"), 6, "-400 Pa");
  write(text);
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 4);
  EXPECT_THAT(run.text, HasSubstr("the foils of chamber `main` pass through each other"));
}

TEST_F(Stages, MeshTooCoarseToCheckItsCurvatureSaysSo) {
  std::string text = cushion("T6", "");
  text.replace(text.find("divisions: [16, 8]"), 18, "size: 25 m");
  write(text);
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.text, HasSubstr("Laplace-Young not checked (mesh too coarse)"));
}

TEST_F(Stages, MeshOfTooManyElementsIsRefusedAtItsPlace) {
  std::string text = cushion("T6", "");
  text.replace(text.find("divisions: [16, 8]"), 18, "size: 1 mm");
  write(text);
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.text,
              testing::ContainsRegex(
                  "w.yaml:10:[0-9]+: `size` 0.001 m makes about 3.6e.07 elements a foil; 5e.06 are the most"));
}

// Measured: 0.3 s for the slowest; asserted far above, as machines differ.
TEST(Check, OfEveryProjectIsQuick) {
  double slowest = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(source_folder) / "projects")) {
    if (entry.path().extension() != ".yaml") continue;
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = call((programs / "pneuma").string() + " check " + entry.path().string());
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::printf("check of the slowest project: %.2f s\n", slowest);
  constexpr double measured = 0.3;
  EXPECT_LT(slowest, 10 * measured);
}

TEST_F(Stages, InterruptedChainKeepsWhatIsComputed) {
  std::string text = cushion("T6", "");
  text.replace(text.find("[16, 8]"), 7, "[160, 80]"); // form finding takes seconds on this mesh
  write(text);
  const std::string command =
      "cd " + folder.string() + " && { " + (programs / "pneuma").string() +
      " run w.yaml & pid=$!; while [ ! -f out/w/form/stage.yaml ]; do sleep 0.05; done; sleep 0.2; "
      "kill -INT $pid; wait $pid; }";
  EXPECT_EQ(call("bash -c 'set -m; " + command + "'").code, 130);
  EXPECT_THAT(pneuma("status w.yaml").text, testing::ContainsRegex("mesh +mesh +fresh"));
  EXPECT_TRUE(fs::exists(out("mesh") / "state.hdf"));
  EXPECT_FALSE(fs::exists(out("form") / "state.hdf"));
}

} // namespace
} // namespace pneuma::tests
