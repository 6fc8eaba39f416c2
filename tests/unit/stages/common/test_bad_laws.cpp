// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with the law of a material is told at its place in the user's file, though a stage sees stage.yaml
// only.
#include "geometry/base/errors.h"
#include "stages/common/law.h"
#include "tests/unit/message_of.h"
#include "tests/unit/pipeline/workflow/messages.h"

namespace pneuma::stages::common {
namespace {

namespace workflow = pipeline::workflow;
using testing::HasSubstr;

// The example with the law of its material replaced.
std::string with_law(const std::string& law) {
  return workflow::replaced(workflow::example, "law: elastic, E: 900 MPa, nu: 0.45", law);
}

// What check_laws tells of this workflow file as the stage programs read it; both streams of it.
std::string told_of(const std::string& text) {
  const workflow::Folder folder;
  const workflow::ReadResult read = workflow::read_workflow(folder.write("w.yaml", text));
  for (const workflow::Problem& problem : read.problems) ADD_FAILURE() << to_string(problem);
  if (testing::Test::HasFailure()) return "";
  const auto file = folder.write("stage.yaml", workflow::stage_yaml(read.workflow, read.workflow.stages.back()));
  const workflow::Workflow stage = workflow::read_stage(file);
  testing::internal::CaptureStderr();
  const std::string errors =
      tests::message_of<base::InputError>([&] { check_laws(stage.materials, stage.site.temperature); });
  return testing::internal::GetCapturedStderr() + errors;
}

struct BadLawCase {
  const char* claim;
  const char* law; // `@` marks the place of the message
  const char* message;
};

std::ostream& operator<<(std::ostream& out, const BadLawCase& bad) {
  return out << bad.claim;
}

class BadLaw : public testing::TestWithParam<BadLawCase> {};

TEST_P(BadLaw, IsToldAtItsPlaceInTheUsersFile) {
  std::string text = with_law(GetParam().law);
  const std::vector<std::string> places = workflow::take_places(text);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(told_of(text).find("w.yaml:" + places[0] + ": material `etfe`: " + GetParam().message), 0u)
      << places[0] << '\n'
      << told_of(text);
}

const BadLawCase cases[] = {
    {"OrthotropicWithoutEnergy", "law: elastic, E1: 400 MPa, E2: 900 MPa, nu12: @0.7, G12: 300 MPa",
     "`nu12` must be between -0.6667 and 0.6667, the square root of E1 / E2, not 0.7"},
    {"YieldStressesThatDoNotRise",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 21 MPa, modulus: 72 MPa}, {stress: @15 MPa, modulus: 40 MPa}]",
     "yield stresses must rise from branch to branch: 15 MPa after 21 MPa"},
    {"EqualYieldStresses",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: @15 MPa, modulus: 40 MPa}]",
     "yield stresses must rise from branch to branch: 15 MPa after 15 MPa"},
    {"LevelBranchBeforeAnother",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: @0 MPa}, {stress: 21 MPa, modulus: 40 MPa}]",
     "a branch of modulus 0 MPa never comes to the next one's yield stress, 21 MPa"},
    {"UnannouncedSoftening",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: @-20 MPa}, {stress: 12 MPa, modulus: 0 MPa}]",
     "a modulus of -20 MPa means softening: strains then gather in one row of elements and results depend on the "
     "mesh; say `softening: on` if it is meant"},
    {"SofteningWithoutEnd",
     "law: j2, E: 1 GPa, nu: 0.4, softening: on, hardening: [{stress: 15 MPa, modulus: @-20 MPa}]",
     "the last branch must not soften: it would end below a yield stress of zero"},
    {"SofteningThatRises",
     "law: j2, E: 1 GPa, nu: 0.4, softening: on, hardening: [{stress: 15 MPa, modulus: -20 MPa}, {stress: @16 MPa, "
     "modulus: 0 MPa}]",
     "after a branch that softens the yield stress must be lower: 16 MPa after 15 MPa"},
    {"SofteningTooSteep", // E / (2 (1 - nu)) = 833.3 MPa
     "law: j2, E: 1 GPa, nu: 0.4, softening: on, hardening: [{stress: 15 MPa, modulus: @-900 MPa}, {stress: 12 MPa, "
     "modulus: 0 MPa}]",
     "the yield stress falls too steeply: as a plastic modulus -900 MPa, which must be above -833.3 MPa"},
    {"SofteningBelowWhereFlowBegins",
     "law: j2, E: 1 GPa, nu: 0.4, softening: on, hardening: [{stress: 15 MPa, modulus: -90 MPa}, {stress: 5 MPa, "
     "modulus: 0 MPa}], viscosity: {model: peric, mu: 1 s, epsilon: 1, threshold: @10 MPa}",
     "`threshold` must be above 10 MPa, by which the softening lowers the yield stress, not 10 MPa"},
    {"TangentModulusAboveE",
     "law: j2, E: 1 GPa, nu: 0.4, modulus: tangent, hardening: [{stress: 15 MPa, modulus: @1 GPa}]",
     "a tangent modulus must be below E, 1000 MPa, not 1000 MPa; is it a plastic modulus? then say `modulus: plastic`"},
    {"ThresholdAboveYield",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 1 MPa}], viscosity: {model: peric, mu: 1 s, "
     "epsilon: 1, threshold: @16 MPa}",
     "`threshold` must be at most the first yield stress, 15 MPa, not 16 MPa"},
    {"OgdenWithoutStiffness", "law: ogden, terms: [{mu: @-1 MPa, alpha: 2}]",
     "the shear modulus, half the sum of mu alpha, must be positive, not -1 MPa"},
    {"OgdenWithoutExponent", "law: ogden, terms: [{mu: 1 MPa, alpha: 2}, {mu: 1 MPa, alpha: @0}]",
     "`alpha` must not be 0"},
    {"OgdenThatIsUnstable", "law: ogden, terms: [{alpha: @2, mu: 6 MPa}, {mu: -1 MPa, alpha: 4}]",
     "its Ogden constants are unstable"},
    {"FaultAtAnotherTemperature",
     "law: j2, E: 1 GPa, nu: 0.4, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: 21 MPa, modulus: 40 MPa}], "
     "temperature: [{at: 50 degC, E: 900 MPa}, {at: 0 degC, hardening: [{stress: 20 MPa, modulus: 72 MPa}, {stress: "
     "@19 MPa, modulus: 40 MPa}]}]",
     "at 0 degC: yield stresses must rise from branch to branch: 19 MPa after 20 MPa"},
    {"FaultThatAnotherTemperatureBringsAbout", // of the law's own value
     "law: elastic, E1: 900 MPa, E2: 900 MPa, nu12: @0.7, G12: 300 MPa, temperature: [{at: 50 degC, E1: 400 MPa}]",
     "at 50 degC: `nu12` must be between -0.6667 and 0.6667"}};

INSTANTIATE_TEST_SUITE_P(Cases, BadLaw, testing::ValuesIn(cases),
                         [](const auto& used) { return std::string(used.param.claim); });

TEST(BadLaws, OgdenTermOfTwoSignsIsAWarning) {
  std::string text = with_law("law: ogden, terms: [{mu: 6 MPa, alpha: 2}, {mu: @-1 MPa, alpha: 2}]");
  const std::string place = workflow::take_places(text)[0];
  EXPECT_THAT(told_of(text), HasSubstr("w.yaml:" + place +
                                       ": warning: material `etfe`: `mu` -1 MPa and `alpha` 2 have different signs"));
  EXPECT_THAT(told_of(text), HasSubstr("nothing was thrown"));
}

TEST(BadLaws, ATemperatureOfTheSiteOutsideTheTableIsTold) {
  const std::string text =
      workflow::replaced(with_law("law: elastic, E: 900 MPa, nu: 0.45, temperature: [{at: 0 degC, E: 1 GPa}]"),
                         "cushion:", "site: {temperature: 31 degC}\ncushion:");
  EXPECT_THAT(told_of(text), HasSubstr("material `etfe`: its values are for 0 to 23 degC, not 31 degC"));
}

TEST(BadLaws, AreToldInTheOrderOfTheFileAndInTheFileWhereTheyStand) {
  const workflow::Folder folder;
  folder.write("library/m.yaml", "zeta: {law: ogden, terms: [{mu: -1 MPa, alpha: 2}], density: 1750 kg/m3}\n"
                                 "etfe: {law: ogden, terms: [{mu: -2 MPa, alpha: 2}], density: 1750 kg/m3}\n");
  const std::string text = workflow::replaced(
      workflow::replaced(workflow::example,
                         "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
                         "materials: library/m.yaml\n"),
      "{name: lower, material: etfe", "{name: lower, material: zeta");
  const workflow::ReadResult read = workflow::read_workflow(folder.write("w.yaml", text));
  const auto file = folder.write("out/stage.yaml", workflow::stage_yaml(read.workflow, read.workflow.stages.back()));
  const std::string told = tests::message_of<base::InputError>(
      [&] { check_laws(workflow::read_stage(file).materials, workflow::read_stage(file).site.temperature); });
  EXPECT_THAT(told, testing::StartsWith("library/m.yaml:1:33: material `zeta`: "));
  EXPECT_THAT(told, HasSubstr("\nlibrary/m.yaml:2:33: material `etfe`: "));
}

} // namespace
} // namespace pneuma::stages::common
