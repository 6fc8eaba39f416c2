// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/base/errors.h"
#include "tests/places.h"
#include "tests/unit/pipeline/workflow/example.h"

namespace pneuma::pipeline::workflow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

std::string lines_of(const ReadResult& result) {
  std::string lines;
  for (const Problem& problem : result.problems) lines += to_string(problem) + "\n";
  return lines;
}

Workflow read_good(const std::string& text) {
  const Folder folder;
  ReadResult result = read_workflow(folder.write("w.yaml", text));
  EXPECT_EQ(lines_of(result), "");
  return std::move(result.workflow);
}

// All warnings, without the name of the file.
std::string warnings_of(const std::string& text) {
  const Folder folder;
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  std::string lines;
  for (const Problem& problem : result.problems) {
    EXPECT_FALSE(problem.error);
    lines +=
        std::to_string(problem.mark.line) + ":" + std::to_string(problem.mark.column) + ": " + problem.message + "\n";
  }
  return lines;
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

const ElasticLaw& elastic_of(const Workflow& workflow, const std::string& material) {
  return std::get<ElasticLaw>(workflow.materials.at(material).law);
}

TEST(GoodWorkflow, ValuesAreInSi) {
  const Workflow workflow = read_good(example);
  EXPECT_EQ(workflow.name, "Test cushion");
  const auto plan = std::get<geometry::Rectangle>(workflow.cushion.plan);
  EXPECT_EQ(plan.length, 6);
  EXPECT_EQ(plan.width, 3);
  ASSERT_EQ(workflow.cushion.foils.size(), 3U);
  EXPECT_EQ(workflow.cushion.foils[0].thickness, 0.00025);
  EXPECT_EQ(elastic_of(workflow, "etfe").E, 9e8);
  EXPECT_EQ(workflow.materials.at("etfe").density, 1750);
  ASSERT_EQ(workflow.cushion.chambers.size(), 2U);
  EXPECT_THAT(workflow.cushion.chambers[1].between, ElementsAre("middle", "lower"));
  ASSERT_EQ(workflow.stages.size(), 4U);
  EXPECT_EQ(workflow.stages[0].id, "mesh");
  const auto& form = std::get<FormfindSettings>(workflow.stages[1].settings);
  EXPECT_THAT(form.prestress, ElementsAre(Pair("lower", 890), Pair("middle", 890), Pair("upper", 890)));
  const auto& gust = std::get<WindSettings>(workflow.stages[3].settings);
  EXPECT_EQ(std::get<ClosedGas>(gust.gas.at("top")).kappa, 1.4);
  EXPECT_TRUE(std::holds_alternative<RegulatedGas>(gust.gas.at("bottom")));
  EXPECT_EQ(std::get<WindLoad>(gust.loads.at(0).kind).pressure, -600);
  EXPECT_EQ(workflow.stages[3].from_run, "inflate");
}

TEST(GoodWorkflow, DefaultsAreThoseOfTheContract) {
  const Workflow workflow = read_good(example);
  EXPECT_EQ(workflow.site.ambient_pressure.pascal, 101325);
  EXPECT_EQ(workflow.site.temperature, 296.15);
  EXPECT_TRUE(workflow.site.gravity);
  EXPECT_EQ(workflow.site.up, Vec3(0, 0, 1));
  EXPECT_THAT(workflow.cushion.edges, ElementsAre(Pair("east", "clamped"), Pair("north", "clamped"),
                                                  Pair("south", "clamped"), Pair("west", "clamped")));
  EXPECT_EQ(workflow.cushion.foils[0].warp, 0);
  EXPECT_EQ(workflow.cushion.chambers[0].dead_volume, 0);
  const auto& mesh = std::get<MeshSettings>(workflow.stages[0].settings);
  EXPECT_EQ(mesh.element, geometry::ElementType::T6);
  EXPECT_FALSE(mesh.pattern);
  EXPECT_EQ(mesh.stress_rule, geometry::StressRule::full);
  const auto& gust = std::get<WindSettings>(workflow.stages[3].settings);
  EXPECT_TRUE(gust.contact_stops);
  EXPECT_TRUE(std::holds_alternative<LoadControl>(gust.control));
  EXPECT_FALSE(steps_of(gust.control));
  EXPECT_FALSE(gust.options.max_steps);
  EXPECT_FALSE(workflow.materials.at("etfe").tension_field);
  EXPECT_FALSE(workflow.cushion.chambers[1].connected_to);
  EXPECT_THAT(gust.factors, ElementsAre(Pair("suction", 1)));
}

// The example with such a control of its wind stage, in which the upper chamber is closed.
std::string with_control(const std::string& control) {
  return replaced(example, "    loads:", "    control: " + control + "\n    loads:");
}

Control wind_control(const std::string& control) {
  return std::get<WindSettings>(read_good(with_control(control)).stages.at(3).settings).control;
}

TEST(GoodWorkflow, LoadControlIsSaidInAWordOrWithParts) {
  const Control word = wind_control("load");
  EXPECT_TRUE(std::holds_alternative<LoadControl>(word));
  EXPECT_FALSE(steps_of(word));
  EXPECT_EQ(steps_of(wind_control("{type: load, steps: 7}")), 7);
}

TEST(GoodWorkflow, DisplacementIsControlledAtAPlaceOrTheLargest) {
  const auto at = [](const std::string& control) { return std::get<DisplacementControl>(wind_control(control)); };
  const DisplacementControl place =
      at("{type: displacement, at: [1 m, -50 cm], foil: lower, direction: [0, 3, -4], until: -10 cm, steps: 5}");
  EXPECT_EQ(place.at, base::Vec2(1, -0.5));
  EXPECT_EQ(place.foil, "lower");
  EXPECT_EQ(place.direction, Vec3(0, 0.6, -0.8));
  EXPECT_EQ(place.until, -0.1);
  EXPECT_FALSE(at("{type: displacement, at: [1 m, -50 cm], foil: lower, until: -10 cm}").direction);
  EXPECT_FALSE(at("{type: displacement, foil: upper, until: 10 cm}").at);
  EXPECT_FALSE(at("{type: displacement, at: max, foil: upper, until: 10 cm}").at);
}

TEST(GoodWorkflow, VolumeOfRegulatedAirIsControlled) {
  const Control control = wind_control("{type: volume, chamber: bottom, until: 5000 l, steps: 2}");
  EXPECT_EQ(std::get<VolumeControl>(control).chamber, "bottom");
  EXPECT_DOUBLE_EQ(std::get<VolumeControl>(control).until, 5);
  EXPECT_EQ(steps_of(control), 2);
}

TEST(GoodWorkflow, ArcLengthEndsAtTheFirstOfSeveral) {
  const auto arc = [](const std::string& keys) {
    return std::get<ArcLengthControl>(wind_control("{type: arc_length, " + keys + "}"));
  };
  const ArcLengthControl all = arc("until: {load_factor: 1.5, pressure: 30 kPa, volume: 9 m3, displacement: 20 cm, "
                                   "after_peak: 0.8}, chamber: top, foil: middle");
  EXPECT_EQ(all.until.load_factor, 1.5);
  EXPECT_EQ(all.until.pressure, 30e3);
  EXPECT_EQ(all.until.volume, 9);
  EXPECT_EQ(all.until.displacement, 0.2);
  EXPECT_EQ(all.until.after_peak, 0.8);
  EXPECT_EQ(all.chamber, "top");
  EXPECT_EQ(all.foil, "middle");
  const ArcLengthControl any_foil = arc("until: {displacement: 20 cm}");
  EXPECT_FALSE(any_foil.foil);
  EXPECT_FALSE(any_foil.chamber);
  const ArcTargets& until = any_foil.until;
  EXPECT_FALSE(until.load_factor || until.pressure || until.volume || until.after_peak);
}

// One foil over a base.
const std::string single_foil = R"(pneuma: 1
materials:
  rubber: {law: neo_hooke, C1: 200 kPa, density: 1100 kg/m3}
cushion:
  plan: {shape: circle, radius: 0.1 m}
  base: rigid
  foils: [{name: skin, material: rubber, thickness: 1 mm}]
  chambers: [{name: main, between: [skin, base]}]
mesh: {size: 0.02 m}
stages:
  burst:
    run: inflate
    from: mesh
    gauge_pressure: {main: 1 kPa}
    control: {type: arc_length, until: {pressure: 30 kPa, displacement: 0.2 m}}
  pushed:
    run: inflate
    from: mesh
    gauge_pressure: {main: 1 kPa}
    control: {type: displacement, until: 5 cm}
  filled:
    run: inflate
    from: mesh
    gauge_pressure: {main: 1 kPa}
    control: {type: volume, until: 1 l}
    options: {max_steps: 40}
)";

TEST(GoodWorkflow, TheOnlyFoilAndTheOnlyChamberNeedNotBeNamed) {
  const Workflow workflow = read_good(single_foil);
  const auto control = [&](std::size_t i) { return std::get<InflateSettings>(workflow.stages.at(i).settings).control; };
  EXPECT_EQ(std::get<ArcLengthControl>(control(1)).chamber, "main");
  EXPECT_EQ(std::get<DisplacementControl>(control(2)).foil, "skin");
  EXPECT_EQ(std::get<VolumeControl>(control(3)).chamber, "main");
  EXPECT_EQ(std::get<InflateSettings>(workflow.stages.at(3).settings).options.max_steps, 40);
}

TEST(GoodWorkflow, NeoHookeIsMooneyRivlinWithoutItsSecondTerm) {
  const auto law = [](const std::string& keys) {
    const Workflow workflow = read_good(replaced(example, "law: elastic, E: 900 MPa, nu: 0.45", keys));
    return std::get<MooneyRivlinLaw>(workflow.materials.at("etfe").law);
  };
  EXPECT_EQ(law("law: mooney_rivlin, C1: 25 MPa, C2: 7 MPa").C1, 25e6);
  EXPECT_EQ(law("law: mooney_rivlin, C1: 25 MPa, C2: 7 MPa").C2, 7e6);
  EXPECT_EQ(law("law: neo_hooke, C1: 25 MPa").C1, 25e6);
  EXPECT_EQ(law("law: neo_hooke, C1: 25 MPa").C2, 0);
}

TEST(GoodWorkflow, TensionFieldGoesWithEveryLaw) {
  for (const char* law : {"law: elastic, E: 900 MPa, nu: 0.45", "law: mooney_rivlin, C1: 25 MPa, C2: 7 MPa",
                          "law: neo_hooke, C1: 25 MPa"}) {
    const Workflow workflow =
        read_good(replaced(example, "law: elastic, E: 900 MPa, nu: 0.45", std::string(law) + ", tension_field: on"));
    EXPECT_TRUE(workflow.materials.at("etfe").tension_field);
  }
}

// The example with the lower chamber connected to the upper one; of the lower one's pressure it says this.
std::string connected(const std::string& bottom_pressure) {
  return replaced(
      replaced(replaced(example, "between: [middle, lower]}", "between: [middle, lower], connected_to: top}"),
               ", bottom: 400 Pa", bottom_pressure),
      ", bottom: 300 Pa", bottom_pressure);
}

TEST(GoodWorkflow, ConnectedChamberHasThePressureOfTheOneItIsConnectedTo) {
  for (const char* pressure : {"", ", bottom: 0.4 kPa"}) {
    const Workflow workflow = read_good(connected(pressure));
    EXPECT_FALSE(workflow.cushion.chambers[0].connected_to);
    EXPECT_EQ(workflow.cushion.chambers[1].connected_to, "top");
    const auto& form = std::get<FormfindSettings>(workflow.stages[1].settings);
    EXPECT_THAT(form.gauge_pressure, ElementsAre(Pair("bottom", 400), Pair("top", 400)));
    const auto& inflated = std::get<InflateSettings>(workflow.stages[2].settings);
    EXPECT_THAT(inflated.gauge_pressure, ElementsAre(Pair("bottom", 400), Pair("top", 400)));
  }
}

TEST(GoodWorkflow, GasStandsAtTheChambersThatHaveAnAirOfTheirOwn) {
  const Workflow workflow = read_good(connected(""));
  const auto& gust = std::get<WindSettings>(workflow.stages[3].settings);
  ASSERT_EQ(gust.gas.size(), 1U);
  EXPECT_EQ(std::get<ClosedGas>(gust.gas.at("top")).kappa, 1.4);
}

TEST(GoodWorkflow, ConnectedChambersAreOneWhereAControlNeedsOne) {
  const Workflow workflow = read_good(
      replaced(connected(""), "    loads:", "    control: {type: arc_length, until: {pressure: 1 kPa}}\n    loads:"));
  const auto& gust = std::get<WindSettings>(workflow.stages[3].settings);
  EXPECT_EQ(std::get<ArcLengthControl>(gust.control).chamber, "top");
}

// The example with a pattern stage of these keys.
std::string with_pattern(const std::string& keys) {
  return replaced(example, "  gust:", "  strips: {run: pattern, from: form, " + keys + "}\n  gust:");
}

PatternSettings pattern_of(const std::string& keys) {
  const Workflow workflow = read_good(with_pattern(keys));
  return std::get<PatternSettings>(workflow.stages.at(3).settings);
}

TEST(GoodWorkflow, FromFormOverStripsToWindIsTheContractsExample) {
  const std::string file = std::string(tests::source_folder) + "/configs/materials/etfe.yaml";
  const Workflow workflow = read_good("pneuma: 1\nname: Single-chamber cushion, 6 m x 3 m\nmaterials: " + file + R"(
site: {ambient_pressure: 101325 Pa, temperature: 23 degC, up: [0, 0, 1], gravity: on}
cushion:
  plan: {shape: rectangle, length: 6 m, width: 3 m}
  edges: {all: clamped}
  foils:
    - {name: upper, material: etfe_elastic, thickness: 250 um}
    - {name: lower, material: etfe_elastic, thickness: 250 um}
  chambers:
    - {name: main, between: [upper, lower]}
mesh: {element: T6, size: 0.15 m}
stages:
  form:     {run: formfind, from: mesh, gauge_pressure: {main: 400 Pa}, prestress: {all: 0.89 kN/m}}
  strips:   {run: pattern, from: form, strips_per_foil: 6, compensation: elastic}
  inflated: {run: inflate, from: strips, gauge_pressure: {main: 400 Pa}}
  gust:
    run: wind
    from: inflated
    gas: {main: {law: closed, kappa: 1.4}}
    loads: [{name: suction, foil: upper, wind: -0.6 kPa}]
  slow:
    run: wind
    from: inflated
    gas: {main: {law: regulated}}
    loads: [{name: suction, foil: upper, wind: -0.6 kPa}]
)");
  ASSERT_EQ(workflow.stages.size(), 6U);
  EXPECT_EQ(workflow.stages[2].run, "pattern");
  const auto& strips = std::get<PatternSettings>(workflow.stages[2].settings);
  EXPECT_EQ(strips.strips_per_foil, 6);
  EXPECT_TRUE(strips.by_strain());
  EXPECT_EQ(workflow.stages[3].from_run, "pattern");
  EXPECT_FALSE(std::get<InflateSettings>(workflow.stages[3].settings).reference);
}

TEST(GoodWorkflow, PatternDefaultsAreThoseOfTheContract) {
  const PatternSettings pattern = pattern_of("strips_per_foil: 6");
  EXPECT_EQ(pattern.strips_per_foil, 6);
  EXPECT_FALSE(pattern.roll);
  EXPECT_TRUE(pattern.curves.empty());
  EXPECT_EQ(pattern.lines, CuttingLines::geodesic);
  EXPECT_FALSE(pattern.direction);
  EXPECT_EQ(pattern.chosen_by, ChosenBy::distortion);
  EXPECT_FALSE(pattern.compensates());
  EXPECT_EQ(pattern.creep, 0);
  EXPECT_EQ(pattern.decompensation, 0);
  EXPECT_FALSE(pattern.foils);
  EXPECT_EQ(pattern.allowance.clamp, 0.03);
  EXPECT_EQ(pattern.allowance.notches, 0.5);
}

TEST(GoodWorkflow, PatternIsDecidedByANumberTheRollOrCurves) {
  const PatternSettings roll = pattern_of("roll: {width: 1.6 m, weld: 12 mm, selvedge: 1 cm}, chosen_by: waste");
  EXPECT_FALSE(roll.strips_per_foil);
  ASSERT_TRUE(roll.roll);
  EXPECT_EQ(roll.roll->width, 1.6);
  EXPECT_EQ(roll.roll->weld, 0.012);
  EXPECT_EQ(roll.roll->selvedge, 0.01);
  EXPECT_EQ(roll.chosen_by, ChosenBy::waste);

  const PatternSettings both = pattern_of("strips_per_foil: 4, roll: {width: 1.6 m, weld: 12 mm, selvedge: 1 cm}, "
                                          "lines: straight, direction: 90 deg, foils: [lower, upper]");
  EXPECT_EQ(both.strips_per_foil, 4);
  EXPECT_TRUE(both.roll);
  EXPECT_EQ(both.lines, CuttingLines::straight);
  EXPECT_DOUBLE_EQ(both.direction.value(), std::acos(0.0));
  EXPECT_THAT(both.foils.value(), ElementsAre("lower", "upper"));

  const PatternSettings curves = pattern_of("foils: [upper, lower], curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]], "
                                            "lower: [[[-1 m, -1.5 m], [-1 m, 1.5 m]], [[1 m, -1.5 m], [110 cm, 0 m], "
                                            "[1 m, 1.5 m]]]}");
  ASSERT_EQ(curves.curves.size(), 2U);
  EXPECT_EQ(curves.curves.at("upper").size(), 1U);
  EXPECT_EQ(curves.curves.at("upper")[0][0], base::Vec2(0, -1.5));
  ASSERT_EQ(curves.curves.at("lower").size(), 2U);
  EXPECT_EQ(curves.curves.at("lower")[1].size(), 3U);
}

TEST(GoodWorkflow, PatternIsCompensatedByTheFormOrAsGiven) {
  const PatternSettings elastic =
      pattern_of("strips_per_foil: 6, compensation: elastic, creep: 0.1 %, decompensation: 30 cm");
  EXPECT_TRUE(elastic.by_strain());
  EXPECT_DOUBLE_EQ(elastic.creep, 0.001);
  EXPECT_DOUBLE_EQ(elastic.decompensation, 0.3);
  const PatternSettings given = pattern_of("strips_per_foil: 6, compensation: {warp: 0.3 %, weft: 0.2 %}, "
                                           "decompensation: 30 cm, allowance: {clamp: 4 cm, notches: 25 cm}");
  EXPECT_DOUBLE_EQ(std::get<GivenCompensation>(given.compensation).warp, 0.003);
  EXPECT_DOUBLE_EQ(std::get<GivenCompensation>(given.compensation).weft, 0.002);
  EXPECT_DOUBLE_EQ(given.decompensation, 0.3);
  EXPECT_DOUBLE_EQ(given.allowance.clamp, 0.04);
  EXPECT_DOUBLE_EQ(given.allowance.notches, 0.25);
}

TEST(GoodWorkflow, ImplausiblePatternsAreWarnings) {
  const auto warnings = [](const std::string& keys) { return warnings_of(with_pattern(keys)); };
  EXPECT_EQ(warnings("strips_per_foil: 51"),
            "19:55: `strips_per_foil` 51 is unusual (usually 2 to 50); is it meant?\n");
  EXPECT_THAT(warnings("roll: {width: 0.4 m, weld: 4 mm, selvedge: 0 m}"),
              testing::AllOf(HasSubstr("`width` 0.4 m is unusual (rolls are 0.5 to 3 m wide)"),
                             HasSubstr("`weld` 4 mm is unusual (usually 5 to 30 mm)")));
  EXPECT_THAT(warnings("roll: {width: 3.1 m, weld: 31 mm, selvedge: 0 m}"),
              testing::AllOf(HasSubstr("`width` 3.1 m is unusual"), HasSubstr("`weld` 31 mm is unusual")));
  EXPECT_EQ(warnings("strips_per_foil: 50, roll: {width: 0.5 m, weld: 5 mm, selvedge: 0 m}"), "");
  EXPECT_EQ(warnings("strips_per_foil: 2, roll: {width: 3 m, weld: 30 mm, selvedge: 0 m}"), "");
  EXPECT_THAT(warnings("strips_per_foil: 6, compensation: {warp: 2.1 %, weft: 2 %}"),
              HasSubstr("`warp` 2.1 % is unusual (usually up to 2 %)"));
  EXPECT_THAT(warnings("strips_per_foil: 6, compensation: elastic, creep: 3 %"), HasSubstr("`creep` 3 % is unusual"));
  EXPECT_THAT(warnings("strips_per_foil: 6, compensation: elastic, decompensation: 3 m"),
              HasSubstr("`decompensation` 3 m is unusual"));
  EXPECT_THAT(warnings("strips_per_foil: 6, allowance: {clamp: 1 m, notches: 1 mm}"),
              testing::AllOf(HasSubstr("`clamp` 1 m is unusual"), HasSubstr("`notches` 1 mm is unusual")));
}

TEST(GoodWorkflow, PolygonHasItsPointsAsTheyStandAndAnEdgeASide) {
  const Workflow workflow = read_good(replaced(
      replaced(example, "{shape: rectangle, length: 6 m, width: 3 m}",
               "{shape: polygon, points: [[0 m, 0 m], [0 m, 3 m], [100 cm, 3 m], [1 m, 1 m], [4 m, 1 m], [4 m, 0 m]]}"),
      "size: 0.15 m", "divisions: 12, pattern: unstructured"));
  const auto& polygon = std::get<geometry::Polygon>(workflow.cushion.plan);
  ASSERT_EQ(polygon.points.size(), 6U);
  EXPECT_EQ(polygon.points[2], base::Vec2(1, 3));
  EXPECT_EQ(workflow.cushion.edges.size(), 6U);
  EXPECT_EQ(workflow.cushion.edges.at("e6"), "clamped");
}

TEST(GoodWorkflow, ThesisGasLawIsAnAmbientPressureOfZero) {
  const Workflow workflow =
      read_good(replaced(example, "cushion:\n", "site: {ambient_pressure: 0 Pa, gravity: off}\ncushion:\n"));
  EXPECT_EQ(workflow.site.ambient_pressure.pascal, 0);
  EXPECT_FALSE(workflow.site.gravity);
}

TEST(GoodWorkflow, DensityIsNeededOnlyWhereGravityActs) {
  const std::string light = replaced(example, ", density: 1750 kg/m3", "");
  read_good(replaced(light, "cushion:\n", "site: {gravity: off}\ncushion:\n"));
  const std::string form_only = light.substr(0, light.find("  inflated:"));
  read_good(form_only);
}

TEST(GoodWorkflow, StressIsPrestressOverThickness) {
  const Workflow workflow =
      read_good(replaced(example, "prestress: {all: 0.89 kN/m}", "stress: {all: 4 MPa, middle: 1 MPa}"));
  const auto& form = std::get<FormfindSettings>(workflow.stages[1].settings);
  EXPECT_DOUBLE_EQ(form.prestress.at("upper"), 1000);
  EXPECT_DOUBLE_EQ(form.prestress.at("middle"), 100);
}

TEST(GoodWorkflow, MaterialsComeFromFilesBesideIt) {
  const Folder folder;
  folder.write(
      "m/a.yaml",
      "etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\nrubber: {law: neo_hooke, C1: 1 MPa}\n");
  folder.write("m/b.yaml", "other: {law: elastic, E: 1 GPa, nu: 0.4}\n");
  const std::string text =
      replaced(example, "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
               "materials: [../m/a.yaml, ../m/b.yaml]\n");
  const ReadResult result = read_workflow(folder.write("p/w.yaml", text));
  EXPECT_EQ(lines_of(result), "");
  EXPECT_EQ(result.workflow.materials.size(), 1U); // those the foils use
  EXPECT_EQ(elastic_of(result.workflow, "etfe").nu, 0.45);
  EXPECT_EQ(to_string(result.workflow.origins.at("materials.etfe.nu")), "../m/a.yaml:1:38");
}

TEST(GoodWorkflow, MaterialsOfThisRepositoryAreGood) {
  const std::string file = std::string(tests::source_folder) + "/configs/materials/etfe.yaml";
  std::string text =
      replaced(example, "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
               "materials: " + file + "\n");
  for (int i = 0; i < 3; ++i) text = replaced(text, "material: etfe,", "material: etfe_elastic,");
  EXPECT_EQ(elastic_of(read_good(text), "etfe_elastic").E, 9e8);
}

TEST(GoodWorkflow, ImplausibleValuesAreWarnings) {
  EXPECT_EQ(warnings_of(replaced(example, "thickness: 250 um", "thickness: 0.25 m")),
            "9:48: `thickness` 0.25 m is unusual (foils are 10 um .. 1 mm thick); is it meant?\n");
  EXPECT_THAT(warnings_of(replaced(example, "{top: 400 Pa, bottom: 400 Pa}", "{top: 400 kPa, bottom: 400 Pa}")),
              testing::AllOf(HasSubstr("17:59: `top` 400 kPa is unusual (cushions hold 200 to 800 Pa"),
                             HasSubstr("), taken as 400000 Pa; is it meant?")));
  EXPECT_THAT(warnings_of(replaced(example, "cushion:\n", "site: {temperature: 23 K}\ncushion:\n")),
              HasSubstr("`temperature` 23 K is unusual"));
  EXPECT_THAT(warnings_of(replaced(example, "cushion:\n", "site: {ambient_pressure: 1 kPa}\ncushion:\n")),
              HasSubstr("`ambient_pressure` 1000 Pa is unusual"));
  EXPECT_THAT(warnings_of(replaced(example, "size: 0.15 m", "size: 15 m")), HasSubstr("larger than the cushion"));
  EXPECT_EQ(warnings_of(replaced(example, "element: T6, size: 0.15 m", "element: T3, size: 8 mm")),
            "15:27: `size` 8 mm is unusual (usually 1 cm to 100 m), taken as 0.008 m; is it meant?\n"
            "15:27: `size` 0.008 m makes about 5.6e+05 elements a foil; is it meant?\n");
}

TEST(GoodWorkflow, TemplatesAndMergeKeysSaveRepeating) {
  const std::string text = replaced(
      replaced(example, "pneuma: 1\n",
               "pneuma: 1\nx-air: &air {law: closed, kappa: 1.4}\nx-gust: &gust\n  run: wind\n"
               "  from: inflated\n  gas: {top: *air}\n"),
      "  gust:\n    run: wind\n    from: inflated\n    gas: {top: {law: closed, kappa: 1.4}}\n    loads:",
      "  gust: {<<: *gust, loads: [{name: push, foil: upper, wind: 0.6 kPa}]}\n"
      "  slow: {<<: *gust, gas: {top: {<<: *air, kappa: 1, temperature: 0 degC}}}\n  lull:\n    <<: *gust\n    loads:");
  const Workflow workflow = read_good(text);
  ASSERT_EQ(workflow.stages.size(), 6U);
  const auto wind = [&](std::size_t i) { return std::get<WindSettings>(workflow.stages[i].settings); };
  EXPECT_EQ(std::get<ClosedGas>(wind(3).gas.at("top")).kappa, 1.4);
  EXPECT_EQ(std::get<WindLoad>(wind(3).loads.at(0).kind).pressure, 600);
  EXPECT_EQ(std::get<ClosedGas>(wind(4).gas.at("top")).kappa, 1);              // the explicit key wins
  EXPECT_EQ(to_string(workflow.origins.at("stages.gust.from")), "w.yaml:5:9"); // where it was written
  EXPECT_EQ(to_string(workflow.origins.at("stages.lull.gas.top.kappa")), "w.yaml:2:34");
}

constexpr const char* inflated =
    "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed}";
constexpr const char* inflated_strips = "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}";

// Every kind of setting that a stage can have.
std::vector<std::string> varied() {
  return {
      example,
      replaced(example, "{shape: rectangle, length: 6 m, width: 3 m}", "{shape: circle, radius: 123.4 cm}"),
      replaced(example, "{shape: rectangle, length: 6 m, width: 3 m}", "{shape: triangle, side: 3.3 m}"),
      replaced(example, "{shape: rectangle, length: 6 m, width: 3 m}",
               "{shape: polygon, points: [[0 m, 0 m], [0 m, 33 dm], [123.4 cm, 3.3 m], [1234 mm, 1 m], [6 m, 1 m], [6 "
               "m, 0 m]]}"),
      replaced(example, "{element: T6, size: 0.15 m}",
               "{element: Q9, divisions: [12, 7], stress_rule: reduced, pattern: structured}"),
      replaced(example, "{element: T6, size: 0.15 m}", "{element: T3, divisions: 9, pattern: unstructured}"),
      replaced(example, "from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed",
               "from: mesh, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, prestress: {upper: 1 kN/m, all: 333 N/m}, "
               "control: {type: load, steps: 4}, contact: ignore, options: {tolerance: 1e-9, max_iterations: 33}"),
      replaced(example, "law: closed, kappa: 1.4}", "law: closed, temperature: 31.7 degC, ambient_pressure: 98.7 kPa}"),
      replaced(example, "law: closed, kappa: 1.4}", "law: volume, volume: 3.21 m3}"),
      replaced(example, "law: closed, kappa: 1.4}", "law: regulated, gauge_pressure: 432.1 Pa}"),
      replaced(
          example, "loads: [{name: suction, foil: upper, wind: -0.6 kPa}]",
          "loads: [{name: a, foil: upper, snow: 0.7 kPa, region: {x: [-1 m, 0.1 m], y: [-50 cm, 50 cm]}},"
          " {name: b, foil: lower, patch: {center: [0.1 m, 0 m], size: [30 cm, 0.3 m], force: [0 N, 0 N, -1.1 kN]}},"
          " {name: c, foil: lower, wind: 0.1 kPa, region: {polygon: [[0 m, 0 m], [1 m, 0 m], [1 m, 1 ft]]}}]\n"
          "    factors: {a: 1.5, b: 0.1}"),
      replaced(replaced(example, "cushion:\n",
                        "site: {up: [0.1, 0.2, 0.97], temperature: 11.3 degC, gravity: on}\ncushion:\n"),
               "thickness: 250 um", "thickness: 250 um, warp: 33 deg"),
      replaced(replaced(example, "  chambers:\n", "  base: rigid\n  chambers:\n"), "between: [middle, lower]",
               "between: [base, lower], dead_volume: 12 l"),
      with_control("load"),
      with_control("{type: displacement, at: [0.1 m, -50 cm], foil: lower, direction: [0.1, 0.2, 0.97], until: -11.1 "
                   "cm, steps: 5}"),
      with_control("{type: displacement, at: [0.1 m, 1 ft], foil: upper, until: 3 in}"),
      with_control("{type: displacement, foil: upper, until: 3 in}"),
      with_control("{type: volume, chamber: bottom, until: 4321 l}"),
      with_control("{type: arc_length, until: {load_factor: 1.3, pressure: 33.3 kPa, volume: 9.1 m3, displacement: "
                   "20.1 cm, after_peak: 0.83}, chamber: top, foil: middle, steps: 3}"),
      with_control("{type: arc_length, until: {after_peak: 0.83}}\n    options: {max_steps: 33}"),
      single_foil,
      replaced(example, "law: elastic, E: 900 MPa, nu: 0.45",
               "law: mooney_rivlin, C1: 25.1 MPa, C2: 7.3 MPa, tension_field: on"),
      connected(""),
      connected(", bottom: 0.4 kPa"),
      replaced(with_pattern("strips_per_foil: 6"), inflated, inflated_strips),
      with_pattern("roll: {width: 1.55 m, weld: 12 mm, selvedge: 1.3 cm}, lines: straight, chosen_by: waste, "
                   "compensation: {warp: 0.37 %, weft: 0.21 %}, decompensation: 0.33 m, "
                   "allowance: {clamp: 41 mm, notches: 0.37 m}, options: {tolerance: 1e-9}"),
      with_pattern("strips_per_foil: 3, direction: 33 deg, compensation: elastic, creep: 0.07 %, "
                   "foils: [lower, upper]"),
      with_pattern(
          "roll: {width: 1.55 m, weld: 12 mm, selvedge: 1.3 cm}, foils: [lower, upper], compensation: elastic, "
          "curves: {all: [[[0 m, -1.5 m], [0.1 m, 0.3 m], [0 m, 1.5 m]]], upper: [[[-1.1 m, -1.5 m], [-1.1 m, "
          "1.5 m]], [[1 m, -150 cm], [12 dm, 0.1 m], [1 m, 1.5 m]], [[2 m, -150 cm], [2 m, 1.5 m]]]}"),
  };
}

TEST(StageFile, ReadsBackToTheSameBytesAndSettings) {
  for (const std::string& text : varied()) {
    const Folder folder;
    const ReadResult result = read_workflow(folder.write("w.yaml", text));
    ASSERT_EQ(lines_of(result), "") << text;
    for (const StageSettings& stage : result.workflow.stages) {
      const std::string written = stage_yaml(result.workflow, stage);
      const Workflow again = read_stage(folder.write("out/stage.yaml", written));
      ASSERT_EQ(again.stages.size(), 1U);
      EXPECT_EQ(stage_yaml(again, again.stages[0]), written);
      EXPECT_EQ(again.stages[0].from_run, stage.from_run);
      EXPECT_EQ(again.cushion.foils[0].thickness, result.workflow.cushion.foils[0].thickness);
      EXPECT_EQ(again.cushion.foils[0].warp, result.workflow.cushion.foils[0].warp);
      EXPECT_EQ(again.site.temperature, result.workflow.site.temperature);
      EXPECT_EQ(again.site.up, result.workflow.site.up);
      EXPECT_EQ(written.find(folder.path().string()), std::string::npos) << "no path of the machine";
    }
  }
}

TEST(StageFile, CarriesThePlaceOfEachValue) {
  const Workflow workflow = read_good(example);
  const std::string text = stage_yaml(workflow, workflow.stages[1]);
  EXPECT_THAT(text, HasSubstr("cushion.foils.0.thickness: \"w.yaml:9:48\""));
  EXPECT_THAT(text, HasSubstr("stages.form.prestress.middle: \"w.yaml:17:101\""));
  EXPECT_THAT(text, testing::Not(HasSubstr("site.temperature: \""))); // a default
}

TEST(StageFile, OfAPatternHasEveryValueThatHasAnEffect) {
  const Workflow workflow = read_good(with_pattern("strips_per_foil: 6"));
  EXPECT_THAT(stage_yaml(workflow, workflow.stages[3]),
              HasSubstr("  strips:\n    run: pattern\n    from: form\n    from_run: formfind\n    strips_per_foil: 6\n"
                        "    lines: geodesic\n    direction: auto\n    chosen_by: distortion\n    compensation: none\n"
                        "    allowance: {clamp: 0.03 m, notches: 0.5 m}\n    options: {}\n"));
}

TEST(StageFile, SaysHowThePathIsFollowed) {
  const auto text = [](const std::string& control) {
    const Workflow workflow = read_good(with_control(control));
    return stage_yaml(workflow, workflow.stages[3]);
  };
  EXPECT_THAT(text("load"), HasSubstr("    control: {type: load}\n"));
  EXPECT_THAT(text("load"), HasSubstr("stages.gust.control.type: \"w.yaml:23:14\""));
  EXPECT_THAT(text("{type: displacement, foil: upper, until: 100 mm, steps: 4}"),
              HasSubstr("    control: {type: displacement, at: max, foil: upper, until: 0.1 m, steps: 4}\n"));
  EXPECT_THAT(
      text("{type: arc_length, until: {pressure: 1 kPa, after_peak: 0.5}, chamber: top}"),
      HasSubstr("      type: arc_length\n      until: {pressure: 1000 Pa, after_peak: 0.5}\n      chamber: top\n"));
}

TEST(StageFile, CarriesThePlaceOfThePressureThatAConnectedChamberTakes) {
  const Workflow workflow = read_good(connected(""));
  const std::string text = stage_yaml(workflow, workflow.stages[1]);
  EXPECT_THAT(text, HasSubstr("    gauge_pressure: {bottom: 400 Pa, top: 400 Pa}\n"));
  EXPECT_THAT(text, HasSubstr("stages.form.gauge_pressure.bottom: \"w.yaml:17:59\""));
  EXPECT_THAT(text, HasSubstr("connected_to: top"));
}

TEST(StageFile, CarriesThePlacesOfCurvesOfAllFoils) {
  const Workflow workflow = read_good(with_pattern("curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}"));
  EXPECT_THAT(stage_yaml(workflow, workflow.stages[3]),
              HasSubstr("stages.strips.curves.lower.0.1.0: \"w.yaml:19:70\""));
}

TEST(StageFile, WrongValueIsQuotedAtThePlaceInTheUsersFile) {
  const Workflow workflow = read_good(example);
  const std::string good = stage_yaml(workflow, workflow.stages[1]);
  const Folder folder;
  try {
    read_stage(folder.write("stage.yaml",
                            replaced(replaced(good, "thickness: 0.00025 m", "thickness: -1 m"), "nu: 0.45", "nu: 7")));
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(), "w.yaml:4:40: `nu` must be above -1, up to 0.5, not 7\n"
                               "w.yaml:9:48: `thickness` must be positive, not -1 m");
  }
}

TEST(StageFile, UnknownKeyIsQuotedInItself) {
  const Workflow workflow = read_good(example);
  const Folder folder;
  const auto file = folder.write("stage.yaml", "colour: red\n" + stage_yaml(workflow, workflow.stages[0]));
  try {
    read_stage(file);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("stage.yaml:1:1: unknown key `colour`"));
  }
}

TEST(StageFile, OfAnOlderVersionSaysSo) {
  const Workflow workflow = read_good(example);
  const Folder folder;
  const std::string old = replaced(stage_yaml(workflow, workflow.stages[0]), "format: 2\n", "pneuma: 1\n");
  try {
    read_stage(folder.write("stage.yaml", old));
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("stage.yaml:1:1: this stage.yaml was written by an older version; run "
                                                "the workflow again"));
  }
  try {
    read_stage(folder.write("w.yaml", example));
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("w.yaml:1:1: this is a workflow file, not the stage.yaml of a stage; "
                                                "run it with `pneuma run`"));
  }
}

TEST(StageFile, MissingFileIsBadInput) {
  EXPECT_THROW(read_stage("/nowhere/stage.yaml"), base::InputError);
}

TEST(EffectiveSettings, DoNotChangeWithLayoutCommentsNamesOrSpellingOfUnits) {
  const Workflow before = read_good(example);
  std::string text = replaced(example, "name: Test cushion\n", "# a comment\n\nname: Another name\n");
  text = replaced(text, "thickness: 250 um", "thickness: 0.25 mm");
  text = replaced(text, "cushion:\n", "site: {temperature: 23 degC}\ncushion:\n");
  text =
      replaced(text, "prestress: {all: 0.89 kN/m}", "prestress: {lower: 890 N/m, upper: 890 N/m, middle: 0.89 kN/m}");
  const Workflow after = read_good(text);
  for (std::size_t i = 0; i < before.stages.size(); ++i) {
    EXPECT_EQ(effective_settings(before, before.stages[i]), effective_settings(after, after.stages[i]));
  }
}

TEST(EffectiveSettings, ChangeWithEachValue) {
  const Workflow before = read_good(example);
  const Workflow after = read_good(replaced(example, "0.89 kN/m", "0.9 kN/m"));
  EXPECT_EQ(effective_settings(before, before.stages[0]), effective_settings(after, after.stages[0]));
  EXPECT_NE(effective_settings(before, before.stages[1]), effective_settings(after, after.stages[1]));
  EXPECT_EQ(effective_settings(before, before.stages[2]), effective_settings(after, after.stages[2]));
}

TEST(ReadWorkflow, NeverThrowsForWhatIsNoWorkflow) {
  const Folder folder;
  EXPECT_THAT(lines_of(read_workflow(folder.path() / "none.yaml")),
              HasSubstr("none.yaml` cannot be read: No such file"));
  EXPECT_THAT(lines_of(read_workflow(folder.path())), HasSubstr("cannot be read: it is a folder"));
  EXPECT_THAT(lines_of(read_workflow(folder.write("empty.yaml", ""))), HasSubstr("empty.yaml:1:1: the file is empty"));
  EXPECT_THAT(lines_of(read_workflow(folder.write("list.yaml", "- a\n"))),
              HasSubstr("the file must be a map with the keys"));
  EXPECT_THAT(lines_of(read_workflow(folder.write("broken.yaml", "a: {b\nc: d"))), HasSubstr("not valid YAML"));
  EXPECT_THAT(lines_of(read_workflow(folder.write("binary.yaml", std::string("\x00\xff\x13", 3)))),
              HasSubstr("binary.yaml:"));
}

TEST(ReadWorkflow, EveryCutOffFileIsAnsweredWithoutACrash) {
  const Folder folder;
  for (std::size_t length = 0; length < example.size(); length += 7) {
    const ReadResult result = read_workflow(folder.write("w.yaml", example.substr(0, length)));
    EXPECT_FALSE(length < 500 && result.problems.empty()) << length;
  }
}

// Reads a text in a process of its own, which is ended after so much processor time: what is quadratic takes minutes.
void expect_read_at_once(const std::string& text) {
  const Folder folder;
  const auto file = folder.write("w.yaml", text);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{20, 20}; // s
    setrlimit(RLIMIT_CPU, &limit);
    read_workflow(file);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text.substr(0, 2000);
}

TEST(ReadWorkflow, TimeGrowsWithTheLengthOfTheFileAndNotWithItsSquare) {
  const std::string head = example.substr(0, example.find("stages:"));
  std::string chain, circle, lost, keys;
  for (int i = 0; i < 20000; ++i) {
    const std::string load = fmt::format("loads: [{{name: l{}, foil: upper, wind: 1 Pa}}]", i);
    const std::string before = i == 0 ? "inflated" : fmt::format("s{}", i - 1);
    chain += fmt::format("  s{}: {{run: wind, from: {}, {}, factors: {{l0: 1}}}}\n", i, before, load);
    circle += fmt::format("  s{}: {{run: wind, from: s{}, {}}}\n", i, (i + 1) % 20000, load);
    lost += fmt::format("  s{}: {{run: wind, from: z{}}}\n", i, i);
  }
  for (int i = 0; i < 100000; ++i) keys += fmt::format("key{}: 1\n", i);
  const std::string stages = example.substr(example.find("stages:"));
  for (const std::string& text : {chain, circle, lost}) expect_read_at_once(head + stages + text);
  expect_read_at_once(example + keys);
}

TEST(ReadWorkflow, OfManyFaultsTheFirstAreTold) {
  std::string text = example;
  for (int i = 0; i < 1000; ++i) text += fmt::format("key{}: 1\n", i);
  const Folder folder;
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  ASSERT_EQ(result.problems.size(), 201U);
  EXPECT_EQ(result.problems.back().message, "and 800 more problems behind this one");
  EXPECT_TRUE(result.problems.back().error);
}

TEST(JsonSchema, CommittedFileIsTheGeneratedOne) {
  EXPECT_EQ(text_of(std::filesystem::path(tests::source_folder) / "configs" / "workflow.schema.json"),
            workflow_json_schema())
      << "write it anew: pneuma schema > configs/workflow.schema.json";
}

TEST(Reference, NamesEveryKeyWithUnitAndDefault) {
  const std::string text = workflow_reference();
  EXPECT_THAT(text, HasSubstr("thickness: as rolled, unstressed; a length with its unit, positive; required"));
  EXPECT_THAT(text, HasSubstr("contact: what happens when foils meet; one of: stop, ignore [stop]"));
  EXPECT_THAT(text, HasSubstr("type arc_length: a length along the path grows, load and displacement follow"));
}

} // namespace
} // namespace pneuma::pipeline::workflow
