// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>

#include "geometry/base/errors.h"
#include "pipeline/workflow/options.h"
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

TEST(GoodWorkflow, ValuesAreInSi) {
  const Workflow workflow = read_good(example);
  EXPECT_EQ(workflow.name, "Test cushion");
  const auto plan = std::get<geometry::Rectangle>(workflow.cushion.plan);
  EXPECT_EQ(plan.length, 6);
  EXPECT_EQ(plan.width, 3);
  ASSERT_EQ(workflow.cushion.foils.size(), 3U);
  EXPECT_EQ(workflow.cushion.foils[0].thickness, 0.00025);
  EXPECT_EQ(workflow.materials.at("etfe").law.E, 9e8);
  EXPECT_EQ(workflow.materials.at("etfe").density, 1750);
  ASSERT_EQ(workflow.cushion.chambers.size(), 2U);
  EXPECT_EQ(workflow.cushion.chambers[1].outer, "middle");
  EXPECT_EQ(workflow.cushion.chambers[1].inner, "lower");
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
  EXPECT_EQ(mesh.pattern, MeshPattern::automatic);
  EXPECT_EQ(mesh.stress_rule, geometry::StressRule::full);
  const auto& gust = std::get<WindSettings>(workflow.stages[3].settings);
  EXPECT_TRUE(gust.contact_stops);
  EXPECT_FALSE(gust.control.steps);
  EXPECT_EQ(gust.loads.at(0).factor, 1);
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
  const std::string file = std::string(PNEUMA_SOURCE_DIR) + "/configs/materials/etfe.yaml";
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
  EXPECT_EQ(strips.compensation.kind, Compensation::Kind::elastic);
  EXPECT_EQ(workflow.stages[3].from_run, "pattern");
  EXPECT_FALSE(std::get<InflateSettings>(workflow.stages[3].settings).reference);
}

TEST(GoodWorkflow, PatternDefaultsAreThoseOfTheContract) {
  const PatternSettings pattern = pattern_of("strips_per_foil: 6");
  EXPECT_EQ(pattern.strips_per_foil, 6);
  EXPECT_FALSE(pattern.roll_given);
  EXPECT_TRUE(pattern.curves.empty());
  EXPECT_EQ(pattern.lines, CuttingLines::geodesic);
  EXPECT_FALSE(pattern.direction);
  EXPECT_EQ(pattern.chosen_by, ChosenBy::distortion);
  EXPECT_EQ(pattern.compensation.kind, Compensation::Kind::none);
  EXPECT_EQ(pattern.compensation.creep, 0);
  EXPECT_EQ(pattern.decompensation, 0);
  EXPECT_TRUE(pattern.foils.empty());
  EXPECT_EQ(pattern.clamp_allowance, 0.03);
  EXPECT_EQ(pattern.notch_spacing, 0.5);
}

TEST(GoodWorkflow, PatternIsDecidedByANumberTheRollOrCurves) {
  const PatternSettings roll = pattern_of("roll: {width: 1.6 m, weld: 12 mm, selvedge: 1 cm}, chosen_by: waste");
  EXPECT_FALSE(roll.strips_per_foil);
  EXPECT_TRUE(roll.roll_given);
  EXPECT_EQ(roll.roll.width, 1.6);
  EXPECT_EQ(roll.roll.weld, 0.012);
  EXPECT_EQ(roll.roll.selvedge, 0.01);
  EXPECT_EQ(roll.chosen_by, ChosenBy::waste);

  const PatternSettings both = pattern_of("strips_per_foil: 4, roll: {width: 1.6 m, weld: 12 mm, selvedge: 1 cm}, "
                                          "lines: straight, direction: 90 deg, foils: [lower, upper]");
  EXPECT_EQ(both.strips_per_foil, 4);
  EXPECT_TRUE(both.roll_given);
  EXPECT_EQ(both.lines, CuttingLines::straight);
  EXPECT_DOUBLE_EQ(both.direction.value(), std::acos(0.0));
  EXPECT_THAT(both.foils, ElementsAre("lower", "upper"));

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
  EXPECT_EQ(elastic.compensation.kind, Compensation::Kind::elastic);
  EXPECT_DOUBLE_EQ(elastic.compensation.creep, 0.001);
  EXPECT_DOUBLE_EQ(elastic.decompensation, 0.3);
  const PatternSettings given = pattern_of("strips_per_foil: 6, compensation: {warp: 0.3 %, weft: 0.2 %}, "
                                           "decompensation: 30 cm, allowance: {clamp: 4 cm, notches: 25 cm}");
  EXPECT_EQ(given.compensation.kind, Compensation::Kind::given);
  EXPECT_DOUBLE_EQ(given.compensation.warp, 0.003);
  EXPECT_DOUBLE_EQ(given.compensation.weft, 0.002);
  EXPECT_DOUBLE_EQ(given.decompensation, 0.3);
  EXPECT_DOUBLE_EQ(given.clamp_allowance, 0.04);
  EXPECT_DOUBLE_EQ(given.notch_spacing, 0.25);
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
  folder.write("m/a.yaml",
               "etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\nlater: {law: j2, E: 1 MPa}\n");
  folder.write("m/b.yaml", "other: {law: elastic, E: 1 GPa, nu: 0.4}\n");
  const std::string text =
      replaced(example, "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
               "materials: [../m/a.yaml, ../m/b.yaml]\n");
  const ReadResult result = read_workflow(folder.write("p/w.yaml", text));
  EXPECT_EQ(lines_of(result), "");
  EXPECT_EQ(result.workflow.materials.size(), 1U); // those the foils use
  EXPECT_EQ(result.workflow.materials.at("etfe").law.nu, 0.45);
  EXPECT_EQ(to_string(result.workflow.origins.at("materials.etfe.nu")), "../m/a.yaml:1:38");
}

TEST(GoodWorkflow, MaterialsOfThisRepositoryAreGood) {
  const std::string file = std::string(PNEUMA_SOURCE_DIR) + "/configs/materials/etfe.yaml";
  std::string text =
      replaced(example, "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
               "materials: " + file + "\n");
  for (int i = 0; i < 3; ++i) text = replaced(text, "material: etfe,", "material: etfe_elastic,");
  EXPECT_EQ(read_good(text).materials.at("etfe_elastic").law.E, 9e8);
}

TEST(GoodWorkflow, ImplausibleValuesAreWarnings) {
  EXPECT_EQ(warnings_of(replaced(example, "thickness: 250 um", "thickness: 0.25 m")),
            "9:48: `thickness` 0.25 m is unusual (foils are 10 um .. 1 mm thick); is it meant?\n");
  EXPECT_THAT(warnings_of(replaced(example, "{top: 400 Pa, bottom: 400 Pa}", "{top: 400 kPa, bottom: 400 Pa}")),
              HasSubstr("17:59: `top` 400 kPa is unusual (cushions hold 200 to 800 Pa"));
  EXPECT_THAT(warnings_of(replaced(example, "cushion:\n", "site: {temperature: 23 K}\ncushion:\n")),
              HasSubstr("`temperature` 23 K is unusual"));
  EXPECT_THAT(warnings_of(replaced(example, "cushion:\n", "site: {ambient_pressure: 1 kPa}\ncushion:\n")),
              HasSubstr("`ambient_pressure` 1000 Pa is unusual"));
  EXPECT_THAT(warnings_of(replaced(example, "size: 0.15 m", "size: 15 m")), HasSubstr("larger than the cushion"));
  EXPECT_EQ(warnings_of(replaced(example, "size: 0.15 m", "size: 0.15 mm")),
            "15:27: `size` 0.15 mm is unusual (usually 1 cm to 100 m); is it meant?\n"
            "15:27: `size` 0.00015 m makes about 8e+08 elements a foil; is it meant?\n");
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
          " {name: b, foil: lower, patch: {center: [0.1 m, 0 m], size: [30 cm, 0.3 m], force: [0 N, 0 N, -1.1 kN]},"
          " region: {polygon: [[0 m, 0 m], [1 m, 0 m], [1 m, 1 ft]]}}]\n    factors: {a: 1.5, b: 0.1}"),
      replaced(replaced(example, "cushion:\n",
                        "site: {up: [0.1, 0.2, 0.97], temperature: 11.3 degC, gravity: on}\ncushion:\n"),
               "thickness: 250 um", "thickness: 250 um, warp: 33 deg"),
      replaced(replaced(example, "  chambers:\n", "  base: rigid\n  chambers:\n"), "between: [middle, lower]",
               "between: [base, lower], dead_volume: 12 l"),
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

TEST(JsonSchema, CommittedFileIsTheGeneratedOne) {
  EXPECT_EQ(text_of(std::filesystem::path(PNEUMA_SOURCE_DIR) / "configs" / "workflow.schema.json"),
            workflow_json_schema())
      << "write it anew: pneuma schema > configs/workflow.schema.json";
}

TEST(Reference, NamesEveryKeyWithUnitAndDefault) {
  const std::string text = workflow_reference();
  EXPECT_THAT(text, HasSubstr("thickness: as rolled, unstressed; a length with its unit, positive; required"));
  EXPECT_THAT(text, HasSubstr("contact: what happens when foils meet; one of: stop, ignore [stop]"));
}

} // namespace
} // namespace pneuma::pipeline::workflow
