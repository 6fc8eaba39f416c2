// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of all laws: what is read, what is refused and where, what stage.yaml carries.
#include <sstream>

#include <fmt/format.h>

#include "tests/unit/pipeline/workflow/messages.h"

namespace pneuma::pipeline::workflow {
namespace {

using testing::HasSubstr;

constexpr const char* elastic = "law: elastic, E: 900 MPa, nu: 0.45";
constexpr const char* j2 = "law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: 21 "
                           "MPa, modulus: 40 MPa}]";

std::string lines_of(const std::vector<Problem>& problems) {
  std::string lines;
  for (const Problem& problem : problems) lines += to_string(problem) + "\n";
  return lines;
}

// The example with its material replaced, and files beside it.
Workflow read_good(const std::string& keys, const std::map<std::string, std::string>& others = {}) {
  const Folder folder;
  for (const auto& [name, content] : others) folder.write(name, content);
  ReadResult result = read_workflow(folder.write("w.yaml", replaced(example, elastic, keys)));
  EXPECT_EQ(lines_of(result.problems), "");
  return std::move(result.workflow);
}

template <class L>
L law_of(const std::string& keys) {
  return std::get<L>(read_good(keys).materials.at("etfe").law);
}

TEST(Materials, OrthotropicFoilHasFourValues) {
  const auto law = law_of<OrthotropicLaw>("law: elastic, E1: 900 MPa, E2: 0.8 GPa, nu12: 0.4, G12: 300 MPa");
  EXPECT_EQ(law.E1, 9e8);
  EXPECT_EQ(law.E2, 8e8);
  EXPECT_EQ(law.nu12, 0.4);
  EXPECT_EQ(law.G12, 3e8);
}

TEST(Materials, NarrowingAcrossMayExceedOneHalfWhereTheOtherModulusAllowsIt) {
  EXPECT_EQ(law_of<OrthotropicLaw>("law: elastic, E1: 900 MPa, E2: 100 MPa, nu12: 2.9, G12: 300 MPa").nu12, 2.9);
}

TEST(Materials, PlasticFoilIsLogarithmicWithPlasticModuliUnlessItSaysOtherwise) {
  const auto law = law_of<J2Law>(j2);
  ASSERT_EQ(law.hardening.size(), 2u);
  EXPECT_EQ(law.hardening[1].stress, 21e6);
  EXPECT_EQ(law.hardening[1].modulus, 40e6);
  EXPECT_TRUE(law.logarithmic);
  EXPECT_EQ(law.modulus, ModulusKind::plastic);
  EXPECT_FALSE(law.softening);
  EXPECT_FALSE(law.viscosity);
  const auto other = law_of<J2Law>(std::string(j2) + ", strain: small, modulus: tangent");
  EXPECT_FALSE(other.logarithmic);
  EXPECT_EQ(other.modulus, ModulusKind::tangent);
}

TEST(Materials, ViscosityHasAThresholdOfItsOwnOrFirstYield) {
  const std::string viscosity = ", viscosity: {model: peric, mu: 5 min, epsilon: 0.1";
  const auto law = law_of<J2Law>(j2 + viscosity + ", threshold: 1.5 MPa}");
  EXPECT_EQ(law.viscosity->model, ViscositySettings::Model::peric);
  EXPECT_EQ(law.viscosity->mu, 300);
  EXPECT_EQ(law.viscosity->epsilon, 0.1);
  EXPECT_EQ(law.viscosity->threshold, 1.5e6);
  EXPECT_FALSE(law_of<J2Law>(j2 + viscosity + "}").viscosity->threshold);
}

TEST(Materials, AnnouncedSofteningFallsFromBranchToBranch) {
  const auto law = law_of<J2Law>("law: j2, E: 900 MPa, nu: 0.45, softening: on, hardening: [{stress: 15 MPa, modulus: "
                                 "-20 MPa}, {stress: 12 MPa, modulus: 0 MPa}]");
  EXPECT_TRUE(law.softening);
  EXPECT_EQ(law.hardening[0].modulus, -20e6);
}

TEST(Materials, OgdenHasUpToEightTerms) {
  const auto law = law_of<OgdenLaw>(
      "law: ogden, terms: [{mu: 630 kPa, alpha: 1.3}, {mu: 1.2 kPa, alpha: 5}, {mu: -10 kPa, alpha: -2}]");
  ASSERT_EQ(law.terms.size(), 3u);
  EXPECT_EQ(law.terms[2].mu, -1e4);
  EXPECT_EQ(law.terms[2].alpha, -2);
}

// Two uniaxial points with an engineering strain of 1 % and one of equal stresses at 10 %.
const std::string tests =
    "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n1, 0, 9, 0\n10, 10, 22, 22\n0, 1, 0, 9\n";

TEST(Materials, TablesTakeTheirPointsFromTestData) {
  const Workflow workflow = read_good("law: pd_nurbs, data: tests/a.csv", {{"tests/a.csv", tests}});
  const auto law = std::get<TableLaw>(workflow.materials.at("etfe").law);
  EXPECT_EQ(law.kind, TableLaw::Kind::pd_nurbs);
  ASSERT_EQ(law.points.size(), 3u);
  EXPECT_DOUBLE_EQ(law.points[1].strain_1, 0.105); // (1.1^2 - 1) / 2
  EXPECT_DOUBLE_EQ(law.points[1].stress_2, 20e6);  // 22 MPa / 1.1
  EXPECT_EQ(law.points[0].weight, 1);
  EXPECT_EQ(law.net, (std::array{25, 25}));
  EXPECT_EQ(law.degree, 3);
  EXPECT_TRUE(law.potential);
  EXPECT_FALSE(law.goes_on);
  EXPECT_EQ(to_string(workflow.origins.at("materials.etfe.points.1.0")), "tests/a.csv:3:1");
}

TEST(Materials, TestDataMayBeGreenLagrangeAlready) {
  const Workflow workflow =
      read_good("law: pd_nurbs, measure: green_lagrange, data: [a.csv, a.csv]", {{"a.csv", tests}});
  const auto law = std::get<TableLaw>(workflow.materials.at("etfe").law);
  ASSERT_EQ(law.points.size(), 6u); // the points of several files
  EXPECT_EQ(law.points[4].strain_1, 0.1);
  EXPECT_EQ(law.points[4].stress_1, 22e6);
}

TEST(Materials, TestDataLieBesideTheFileThatNamesThem) {
  const Folder folder;
  folder.write("library/tests/a.csv", tests);
  folder.write("library/m.yaml", "etfe: {law: pd_nurbs, data: tests/a.csv, density: 1750 kg/m3}\n");
  const ReadResult result =
      read_workflow(folder.write("p/w.yaml", replaced(example,
                                                      "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, "
                                                      "density: 1750 kg/m3}\n",
                                                      "materials: ../library/m.yaml\n")));
  EXPECT_EQ(lines_of(result.problems), "");
  EXPECT_EQ(std::get<TableLaw>(result.workflow.materials.at("etfe").law).points.size(), 3u);
}

TEST(Materials, ShearOfATableAlongAxesHasDataOfItsOwn) {
  const Workflow workflow = read_good("law: le_nurbs, data: a.csv, shear_data: s.csv",
                                      {{"a.csv", tests}, {"s.csv", "shear_strain [-], shear_stress [MPa]\n0.1, 3\n"}});
  const auto law = std::get<TableLaw>(workflow.materials.at("etfe").law);
  ASSERT_EQ(law.shear_points.size(), 1u);
  EXPECT_EQ(law.shear_points[0].strain, 0.1);
  EXPECT_EQ(law.shear_points[0].stress, 3e6);
}

constexpr const char* two = "law: pd_nurbs, fit_to: foil, range: [-0.05, 0.3], density: 1750 kg/m3}\n  foil: {law: j2, "
                            "E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}]";

TEST(Materials, WhatATableIsFittedToStaysWithIt) {
  const Folder folder;
  const ReadResult result =
      read_workflow(folder.write("w.yaml", replaced(example, std::string(elastic) + ", density: 1750 kg/m3", two)));
  EXPECT_EQ(lines_of(result.problems), "");
  EXPECT_TRUE(result.workflow.materials.contains("foil"));
  const StageSettings& stage = result.workflow.stages.back();
  const Workflow again = read_stage(folder.write("stage.yaml", stage_yaml(result.workflow, stage)));
  EXPECT_EQ(std::get<TableLaw>(again.materials.at("etfe").law).fit_to, "foil");
  EXPECT_TRUE(std::holds_alternative<J2Law>(again.materials.at("foil").law));
}

constexpr const char* warm =
    ", temperature: [{at: 0 degC, E: 1 GPa, hardening: [{stress: 20 MPa, modulus: 80 MPa}, {stress: 27 MPa, modulus: "
    "40 MPa}]}, {at: 53 degC, E: 600 MPa}]";

TEST(Materials, StrengthHasItsFactors) {
  const Material material =
      read_good(std::string(elastic) + ", strength: {characteristic: 21 MPa, weld: 30 MPa, factors: {gamma_M: 1.1, "
                                       "k_age: 1.05}, temperature: [{at: 0 degC, factor: 0.7}, {at: 23 degC, factor: "
                                       "1}], source: somewhere}")
          .materials.at("etfe");
  EXPECT_EQ(material.strength->characteristic, 21e6);
  EXPECT_EQ(material.strength->weld, 30e6);
  EXPECT_FALSE(material.strength->ultimate);
  EXPECT_EQ(material.strength->factors.at("k_age"), 1.05);
  EXPECT_EQ(material.strength->temperature[0].factor, 0.7);
  EXPECT_EQ(material.strength->source, "somewhere");
}

TEST(Materials, StageFileReadsBackToTheSameBytes) {
  const std::map<std::string, std::string> files = {{"a.csv", tests},
                                                    {"s.csv", "shear_strain [%], shear_stress [MPa]\n0.37, 3.3\n"}};
  const std::string varied[] = {
      "law: elastic, E1: 901 MPa, E2: 0.83 GPa, nu12: 0.41, G12: 301 MPa, temperature: [{at: 41.7 degC, E2: 0.7 GPa}]",
      std::string(elastic) + ", at: 21.3 degC, temperature: [{at: 41.7 degC, E: 0.7 GPa}, {at: 0 degC, nu: 0.43}]",
      j2,
      std::string(j2) + warm +
          ", strain: small, modulus: tangent, tension_field: on, thermal_expansion: 9.1e-5 K-1, "
          "viscosity: {model: perzyna, mu: 3.3 min, epsilon: 0.13, threshold: 1.5 MPa}",
      std::string(j2) + ", viscosity: {model: peric, mu: 3.3 min, epsilon: 0.13}",
      ("law: j2, E: 900 MPa, nu: 0.45, softening: on, hardening: [{stress: 15 MPa, modulus: -20.3 MPa}, {stress: 12 "
       "MPa, modulus: 0 MPa}]"),
      "law: ogden, terms: [{mu: 630.1 kPa, alpha: 1.3}, {mu: -10.3 kPa, alpha: -2.1}]",
      ("law: neo_hooke, C1: 3.3 MPa, strength: {characteristic: 21.1 MPa, weld: 30.3 MPa, ultimate: 47.1 MPa, factors: "
       "{gamma_M: 1.1}, temperature: [{at: 0.3 degC, factor: 0.7}], source: a book}"),
      ("law: pd_nurbs, data: a.csv, net: [13, 13], degree: 4, range: [-0.07, 0.33], outside: linear, potential: off, "
       "smoothing: 1e-5, nu: 0.43"),
      "law: le_nurbs, data: [a.csv, a.csv], shear_data: s.csv, net: [13, 7]",
      "law: le_nurbs, points: [[0.1, 0, 3e6, 0, 1], [0, 0.1, 0, 3e6, 1]], shear_points: [[0.1, 1e6, 1]], net: [13, 7]"};
  for (const std::string& keys : varied) {
    const Workflow workflow = read_good(keys, files);
    const Folder folder;
    for (const StageSettings& stage : workflow.stages) {
      const std::string written = stage_yaml(workflow, stage);
      const Workflow again = read_stage(folder.write("stage.yaml", written)); // no CSV lies here
      ASSERT_EQ(again.stages.size(), 1u) << keys;
      EXPECT_EQ(stage_yaml(again, again.stages[0]), written);
    }
  }
}

TEST(Materials, AChangedTestPointMakesOtherSettings) {
  const Workflow before = read_good("law: pd_nurbs, data: a.csv", {{"a.csv", tests}});
  const Workflow after = read_good("law: pd_nurbs, data: a.csv", {{"a.csv", replaced(tests, "22, 22", "22, 22.1")}});
  const Workflow laid_out = read_good("law: pd_nurbs, data: a.csv", {{"a.csv", "# a comment\n\n" + tests}});
  const StageSettings& stage = before.stages.back();
  EXPECT_NE(effective_settings(before, stage), effective_settings(after, stage));
  EXPECT_EQ(effective_settings(before, stage), effective_settings(laid_out, stage));
}

TEST(MaterialsFile, IsReadOnItsOwn) {
  const Folder folder;
  folder.write("a.csv", tests);
  const auto file = folder.write("m.yaml", "b: {law: pd_nurbs, data: a.csv}\na: {law: elastic, E: 1 GPa, nu: 0.4}\n"
                                           "c: {law: pd_nurbs, data: none.csv}\n");
  const MaterialsResult some = read_materials(file, {"a", "b", "other"});
  EXPECT_EQ(lines_of(some.problems), ""); // the data of `c` are not looked for
  EXPECT_EQ(some.names, (std::vector<std::string>{"b", "a", "c"}));
  ASSERT_EQ(some.materials.size(), 2u);
  EXPECT_EQ(some.materials[0].name, "b");
  EXPECT_EQ(std::get<TableLaw>(some.materials[0].law).points.size(), 3u);
  EXPECT_THAT(lines_of(read_materials(file, {}).problems), HasSubstr("none.csv` cannot be read"));
  EXPECT_THAT(lines_of(read_materials(folder.path() / "none.yaml", {}).problems), HasSubstr("cannot be read"));
  EXPECT_THAT(lines_of(read_materials(folder.write("empty.yaml", ""), {}).problems),
              HasSubstr("empty.yaml:1:1: a file of materials is a map"));
}

class BadMaterial : public testing::TestWithParam<Bad> {};

TEST_P(BadMaterial, IsToldWhatAndWhere) {
  expect_messages(GetParam().before, GetParam().after, GetParam().messages, {{"a.csv", tests}});
}

constexpr const char* braced = "{law: elastic, E: 900 MPa, nu: 0.45,";

const Bad cases[] = {
    {"PoissonsRatioMissing",
     braced,
     "@{law: elastic, E: 900 MPa,",
     {"`etfe` lacks the key `nu`: Poisson's ratio (a plain number)"}},
    {"NeitherIsotropicNorOrthotropic",
     braced,
     "@{law: elastic, nu: 0.45,",
     {"`etfe` lacks the key `E`: Young's modulus"}},
    {"BothIsotropicAndOrthotropic",
     braced,
     "{law: elastic, E: 900 MPa, nu: 0.45, @G12: 1 MPa,",
     {"it belongs to `law: elastic` with `E1`"}},
    {"OrthotropicWithoutShear",
     braced,
     "@{law: elastic, E1: 900 MPa, E2: 900 MPa, nu12: 0.4,",
     {"`etfe` lacks the key `G12`: shear modulus"}},
    {"PlasticPoissonsRatio",
     elastic,
     "law: j2, E: 1 GPa, nu: @0.51, hardening: [{stress: 15 MPa, modulus: 1 MPa}]",
     {"`nu` must be above -1, up to 0.5, not 0.51"}},
    {"NoBranch",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: @[]",
     {"`hardening` must have at least 1 entries, not 0"}},
    {"ZeroYieldStress",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: @0 MPa, modulus: 1 MPa}]",
     {"`stress` must be positive, not 0 MPa"}},
    {"OgdenOfNineTerms",
     elastic,
     "law: ogden, terms: @[{mu: 1 MPa, alpha: 1}, {mu: 1 MPa, alpha: 2}, {mu: 1 MPa, alpha: 3}, {mu: 1 MPa, alpha: 4}, "
     "{mu: 1 MPa, alpha: 5}, {mu: 1 MPa, alpha: 6}, {mu: 1 MPa, alpha: 7}, {mu: 1 MPa, alpha: 8}, {mu: 1 MPa, alpha: "
     "9}]",
     {"`terms` must have at most 8 entries, not 9"}},
    {"NetTooFine",
     elastic,
     "law: pd_nurbs, data: a.csv, net: [@201, 200]",
     {"entry 1 of `net` must be from 3 to 200, not 201"}},
    {"RangeBelowAllStrains",
     elastic,
     "law: pd_nurbs, fit_to: foil, range: [@-0.6, 0.2], density: 1 g/cm3}\n  foil: {law: elastic, E: 1 GPa, nu: 0.4",
     {"entry 1 of `range` must be above -0.5, up to 10, not -0.6"}},
    {"UnknownModulus",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, modulus: @secant, hardening: [{stress: 1 MPa, modulus: 1 MPa}]",
     {"`modulus` must be one of: plastic, tangent, not `secant`"}},
    {"NoTimeScale",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: peric, mu: @0 s, "
     "epsilon: 1}",
     {"`mu` must be positive, not 0 s"}},
    {"TimeScaleInPascalSeconds",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: peric, mu: @5 Pa "
     "s, "
     "epsilon: 1}",
     {"`mu`: `5 Pa s` has a unit of another kind; expected a time such as"}},
    {"NoSensitivity",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: perzyna, mu: 1 s, "
     "epsilon: @0}",
     {"`epsilon` must be above 0, up to 10, not 0"}},
    {"UnknownViscosity",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: @pertzyna, mu: 1 "
     "s, "
     "epsilon: 1}",
     {"`model` must be one of: peric, perzyna, not `pertzyna`; did you mean `perzyna`?"}},
    {"TableOfNothing", braced, "@{law: pd_nurbs,", {"`etfe` needs at least one of: data, points, fit_to; it has none"}},
    {"DataThatAreNotThere", elastic, "law: pd_nurbs, data: @none.csv", {"none.csv` cannot be read: No such file"}},
    {"NetTooSmall",
     elastic,
     "law: pd_nurbs, data: a.csv, degree: 4, net: [@4, @4]",
     {"a net of degree 4 needs at least 5 control points, not 4", "a net of degree 4 needs at least 5 control points"}},
    {"NetOfTwoSizes",
     elastic,
     "law: pd_nurbs, data: a.csv, net: @[10, 12]",
     {"the net of an isotropic table is the same along both principal strains, not 10 x 12"}},
    {"Degree", elastic, "law: pd_nurbs, data: a.csv, degree: @7", {"`degree` must be from 2 to 6, not 7"}},
    {"RangeWithoutZero",
     elastic,
     "law: pd_nurbs, data: a.csv, range: @[0.001, 0.2]",
     {"`range` must hold the strain 0, from which the foil starts, and end above it: [0.001, 0.2] does not"}},
    {"RangeOfPointsOutside",
     elastic,
     "law: pd_nurbs, data: a.csv, range: @[0, 0.1]",
     {"`range` [0, 0.1] leaves out points with strains 0.105 and 0.105 (Green-Lagrange)"}},
    {"TableAlongAxesWithoutShear",
     braced,
     "@{law: le_nurbs, data: a.csv,",
     {"`etfe` needs `shear_data` or `shear_points` beside `data`: points along the axes say nothing about shear"}},
    {"FitToAnUnknownMaterial",
     elastic,
     "law: pd_nurbs, fit_to: @foill, range: [0, 0.2], density: 1 g/cm3}\n  foil: {law: elastic, E: 1 GPa, nu: 0.4",
     {"there is no material `foill`; did you mean `foil`?; materials: etfe, foil"}},
    {"FitToItself",
     elastic,
     "law: pd_nurbs, fit_to: @etfe, range: [0, 0.2]",
     {"`fit_to` goes in a circle: etfe <- etfe"}},
    {"FitInACircle",
     elastic,
     "law: pd_nurbs, fit_to: @b, range: [0, 0.2], density: 1 g/cm3}\n  b: {law: pd_nurbs, fit_to: etfe, range: [0, "
     "0.2]",
     {"`fit_to` goes in a circle: etfe <- b <- etfe"}},
    {"FitWithoutRange",
     braced,
     "@{law: pd_nurbs, fit_to: foil, density: 1 g/cm3}\n  foil: {law: elastic, E: 1 GPa, nu: 0.4,",
     {"`etfe` needs `range` beside `fit_to`: another material has strains without end"}},
    {"FitToAFoilThatFlows",
     elastic,
     "law: pd_nurbs, fit_to: @foil, range: [0, 0.2], density: 1 g/cm3}\n  foil: {law: j2, E: 1 GPa, nu: 0.4, "
     "hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: peric, mu: 1 s, epsilon: 1}",
     {"`foil` flows with time, and a table knows no rate"}},
    {"IsotropicFitToAnOrthotropicFoil",
     elastic,
     "law: pd_nurbs, fit_to: @foil, range: [0, 0.2], density: 1 g/cm3}\n  foil: {law: elastic, E1: 1 GPa, E2: 1 GPa, "
     "nu12: 0.4, G12: 1 GPa",
     {"`foil` differs along its axes, and a table of principal strains does not; take `le_nurbs`"}},
    {"SameTemperatureTwice",
     elastic,
     "law: elastic, E: 900 MPa, nu: 0.45, temperature: [{at: @23 degC, E: 1 GPa}]",
     {"a second law at 23 degC; `at` of the law itself is 23 degC"}},
    {"PointsWithoutWeight",
     elastic,
     "law: pd_nurbs, points: @[[0.1, 0.1, 20e6, 20e6, 0], [0.1, -0.04, 20e6, 0, 0]]",
     {"no point has a weight above 0"}},
    {"OtherNumberOfBranches",
     elastic,
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], temperature: [{at: 0 degC, hardening: "
     "@[{stress: 15 MPa, modulus: 1 MPa}, {stress: 17 MPa, modulus: 1 MPa}]}]",
     {"`hardening` must have 1 branches as the law itself, not 2"}},
    {"OrthotropicValueAtAnotherTemperature",
     elastic,
     "law: elastic, E: 900 MPa, nu: 0.45, temperature: [{at: 0 degC, @E1: 1 GPa}]",
     {"unknown key `E1` in entry 1 of `temperature`; did you mean `E`?; known: at, E, nu"}},
    {"StrengthThatIsNone",
     elastic,
     "law: elastic, E: 900 MPa, nu: 0.45, strength: {characteristic: @0 MPa}",
     {"`characteristic` must be positive, not 0 MPa"}},
    {"StrengthsOfFallingTemperatures",
     elastic,
     "law: elastic, E: 900 MPa, nu: 0.45, strength: {characteristic: 21 MPa, temperature: [{at: 23 degC, factor: 1}, "
     "{at: @0 degC, factor: 0.7}]}",
     {"temperatures must rise from entry to entry; 0 degC does not"}}};

INSTANTIATE_TEST_SUITE_P(Cases, BadMaterial, testing::ValuesIn(cases),
                         [](const auto& used) { return std::string(used.param.claim); });

// Faults of the test data themselves have their place there.
TEST(BadTestDataOfAMaterial, AreToldInTheirFile) {
  const std::pair<const char*, const char*> faults[] = {
      {"hole.csv", "hole.csv:2:7: a hole: `stress_1` has no value here"},
      {"words.csv", "words.csv:2:10: `stress_2` must be a plain number, not `four`"},
      {"uniaxial.csv", "uniaxial.csv:1:1: the column `strain_2` is missing"}};
  for (const auto& [name, message] : faults) {
    const Folder folder;
    folder.write("d/hole.csv", replaced(tests, "9, 0", ", 0"));
    folder.write("d/words.csv", replaced(tests, "9, 0", "9, four"));
    folder.write("d/uniaxial.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n");
    const ReadResult result = read_workflow(
        folder.write("w.yaml", replaced(example, elastic, std::string("law: pd_nurbs, data: d/") + name)));
    EXPECT_THAT(lines_of(result.problems), HasSubstr(message));
  }
}

// Tests of a foil with stresses (1, ratio) and, where `both`, (ratio, 1).
std::string tests_with(std::initializer_list<double> ratios, bool both = false) {
  std::string text = "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
  for (const double ratio : ratios) {
    for (const double stress : {1.0, 10.0}) {
      text += fmt::format("{}, {}, {}, {}\n", stress / 9, ratio * stress / 9, stress, ratio * stress);
      if (both) text += fmt::format("{}, {}, {}, {}\n", ratio * stress / 9, stress / 9, ratio * stress, stress);
    }
  }
  return text;
}

std::string told_of(const std::string& keys, const std::string& data) {
  const Folder folder;
  folder.write("a.csv", data);
  folder.write("s.csv", "shear_strain [-], shear_stress [MPa]\n0.1, 3\n");
  return lines_of(read_workflow(folder.write("w.yaml", replaced(example, elastic, keys))).problems);
}

TEST(TableOfTests, WithoutAUniaxialOneIsAWarningWhereTheTestsAreNamed) {
  const std::string told = told_of("law: pd_nurbs, data: a.csv", tests_with({1, 0.5}));
  EXPECT_THAT(told, HasSubstr("w.yaml:4:31: warning: no test is near uniaxial stress, the smaller stress is at least "
                              "0.5 of the larger: a table ends at its uniaxial-stress curve"));
  EXPECT_THAT(told, HasSubstr("add a uniaxial test, or `fit_to` a law that fills what tests leave open"));
  EXPECT_EQ(told_of("law: pd_nurbs, data: a.csv", tests_with({1, 0.5, 0.05})), "");
  EXPECT_EQ(told_of("law: pd_nurbs, data: a.csv", tests_with({1, -0.2})), ""); // beyond uniaxial stress
  EXPECT_THAT(told_of("law: pd_nurbs, points: [[0.1, 0.1, 20e6, 20e6, 1], [0.1, 0.02, 20e6, 10e6, 1]]", ""),
              HasSubstr("w.yaml:4:33: warning: no test is near uniaxial stress"));
}

TEST(TableOfTests, OfTheFirstPartOfTheStressAloneDoesNotCountAsUniaxial) {
  // 0.1 of the largest stress; noise about zero stress has any ratio
  EXPECT_THAT(told_of("law: pd_nurbs, data: a.csv", tests_with({1, 0.5}) + "0.11, -0.05, 1, 0\n"),
              HasSubstr("no test is near uniaxial stress"));
}

TEST(TableOfTests, OfEqualStressesAloneIsRefused) {
  EXPECT_THAT(told_of("law: pd_nurbs, data: a.csv", tests_with({1, 0.97})),
              HasSubstr("w.yaml:4:31: all tests are near equal stresses, the smaller at least 0.97 of the larger"));
}

TEST(TableOfTests, IsFilledByALawWithoutAWord) {
  const std::string filled =
      "law: pd_nurbs, data: a.csv, fit_to: foil, range: [-0.05, 0.3], density: 1750 kg/m3}\n  foil: {law: elastic, E: "
      "900 MPa, nu: 0.45";
  EXPECT_EQ(told_of(filled, tests_with({1})), "");
}

TEST(TableOfTests, KnowsNoTemperatureAndSaysSoWhereTheTestsDo) {
  const auto at = [](double first, double second) {
    return fmt::format("strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa], temperature [degC]\n"
                       "1, 0, 9, 0, {}\n1, 1, 16, 16, {}\n",
                       first, second);
  };
  const std::string keys = "law: pd_nurbs, data: a.csv";
  EXPECT_EQ(told_of(keys, at(21, 24)), "");
  EXPECT_THAT(told_of(keys, at(20, 50)), HasSubstr("w.yaml:4:31: warning: the tests were taken at 20 to 50 degC"));
  EXPECT_THAT(told_of(keys, at(50, 52)),
              HasSubstr("w.yaml:4:31: warning: the tests were taken at 51 degC and the site has 23 degC"));
}

TEST(TableOfTests, AlongAxesNeedsAUniaxialOneAlongEach) {
  const std::string keys = "law: le_nurbs, data: a.csv, shear_data: s.csv";
  EXPECT_EQ(told_of(keys, tests_with({1, 0.5, 0}, true)), "");
  EXPECT_THAT(told_of(keys, tests_with({1, 0.5, 0})),
              HasSubstr("w.yaml:4:31: warning: no test is near uniaxial stress along axis 2, the smaller stress is at "
                        "least 1 of the larger: "));
  EXPECT_THAT(told_of(keys, tests_with({0.5, 0})), HasSubstr("along axis 2, where no stress is the larger: "));
}

} // namespace
} // namespace pneuma::pipeline::workflow
