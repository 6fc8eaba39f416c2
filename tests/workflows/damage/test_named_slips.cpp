// SPDX-License-Identifier: GPL-3.0-or-later
// Slips that ended a program once, or kept it for ever: each is told at its place, in one message.
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/workflows/damage/corpus.h"

namespace pneuma::tests::damage {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NamedSlips : public testing::Test {
protected:
  NamedSlips() {
    std::string name = (fs::temp_directory_path() / "pneuma-slips-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~NamedSlips() override { fs::remove_all(folder); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }

  Ending check(const std::string& text) const {
    write("w.yaml", text);
    return run_limited({program("pneuma"), "check", "w.yaml"}, folder);
  }

  // One error, in the line where `slip` stands, which names `word`.
  void expect_refused(const std::string& text, const std::string& slip, const std::string& word) const {
    ASSERT_NE(text.find(slip), std::string::npos) << slip;
    const Ending ending = check(text);
    EXPECT_EQ(ending.code, 2) << ending.words() << '\n' << ending.text;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(slip)), '\n');
    std::vector<std::string> errors;
    std::istringstream lines(ending.text);
    for (std::string one; std::getline(lines, one);) {
      if (one.find(": warning: ") == std::string::npos) errors.push_back(one);
    }
    ASSERT_EQ(errors.size(), 1u) << ending.text;
    EXPECT_THAT(errors.front(), testing::StartsWith(fmt::format("w.yaml:{}:", line)));
    EXPECT_THAT(errors.front(), HasSubstr(word));
  }

  fs::path folder;
};

// `material`: of the foil; `loads`: of a wind stage called `id`.
std::string cushion(const std::string& material, const std::string& loads, const std::string& id = "loaded") {
  return fmt::format(R"(pneuma: 1
materials:
  foil: {{{}}}
site: {{gravity: off}}
cushion:
  plan: {{shape: circle, radius: 0.5 m}}
  foils: [{{name: foil, material: foil, thickness: 200 um}}]
  base: rigid
  chambers: [{{name: air, between: [foil, base]}}]
mesh: {{size: 0.12 m}}
stages:
  up: {{run: inflate, from: mesh, gauge_pressure: {{air: 300 Pa}}}}
  {}:
    run: wind
    from: up
    loads: [{}]
)",
                     material, id, loads);
}

const std::string elastic = "law: elastic, E: 900 MPa, nu: 0.45";
const std::string suction = "{name: suction, foil: foil, wind: -600 Pa}";

std::string patch(const std::string& center, const std::string& force) {
  return fmt::format("{{name: p, foil: foil, patch: {{center: {}, size: [0.1 m, 0.1 m], force: {}}}}}", center, force);
}

std::string j2(const std::string& branch) {
  return "law: j2, E: 900 MPa, nu: 0.45, hardening: [" + branch + "]";
}

TEST_F(NamedSlips, TheCushionsOfTheseTestsAreFine) {
  const std::string force = "[0 N, 0 N, -100 N]";
  for (const std::string& text : {cushion(elastic, suction), cushion(elastic, patch("[0 m, 0 m]", force)),
                                  cushion(j2("{stress: 30 MPa, modulus: 80 MPa}"), suction)}) {
    const Ending ending = check(text);
    EXPECT_EQ(ending.code, 0) << ending.words() << '\n' << ending.text;
  }
}

TEST_F(NamedSlips, PatchWithACenterWithoutUnits) {
  const Ending ending = check(cushion(elastic, patch("[0, 0]", "[0 N, 0 N, -100 N]")));
  EXPECT_EQ(ending.code, 2) << ending.words();
  EXPECT_THAT(ending.text, testing::StartsWith("w.yaml:16:"));
  EXPECT_THAT(ending.text, HasSubstr("`center`"));
  EXPECT_LE(std::count(ending.text.begin(), ending.text.end(), '\n'), 2); // one for each of the two
}

TEST_F(NamedSlips, PatchWithAForceOfTwoEntries) {
  expect_refused(cushion(elastic, patch("[0 m, 0 m]", "[0 N, -100 N]")), "force", "`force`");
}

TEST_F(NamedSlips, BranchWithAStressWithoutUnit) {
  expect_refused(cushion(j2("{stress: 15 MPa, modulus: 72 MPa}, {stress: 30, modulus: 40 MPa}"), suction), "hardening",
                 "`stress`");
}

TEST_F(NamedSlips, BranchWithAModulusWithoutUnit) {
  expect_refused(cushion(j2("{stress: 15 MPa, modulus: 80}, {stress: 30 MPa, modulus: 40 MPa}"), suction), "hardening",
                 "`modulus`");
}

TEST_F(NamedSlips, LawAtATemperatureWithoutUnit) {
  for (const char* others : {"{at: 50, E: 800 MPa}", "{at: 50, E: 800 MPa}, {at: 0 degC, E: 950 MPa}",
                             "{at: 0 degC, E: 950 MPa}, {at: 50, E: 800 MPa}"}) {
    const std::string material = fmt::format("{}, temperature: [{}]", elastic, others);
    expect_refused(cushion(material, suction), "temperature", "`at`");
  }
}

TEST_F(NamedSlips, StrengthAtATemperatureWithoutUnit) {
  const std::string material =
      elastic + ", strength: {characteristic: 21 MPa, temperature: [{at: 0 degC, factor: 0.7}, {at: 23, factor: 1}]}";
  expect_refused(cushion(material, suction), "strength", "`at`");
}

TEST_F(NamedSlips, StageIdsOfDigitsAreNames) {
  for (const std::string id : {"99999999999", "7"}) {
    const Ending fine = check(cushion(elastic, suction, id));
    EXPECT_EQ(fine.code, 0) << fine.words() << '\n' << fine.text;
    EXPECT_THAT(fine.text, HasSubstr(id));
    // in a message too, which says the name of the stage and not an entry of a list
    std::string text = cushion(elastic, suction, id);
    text.replace(text.find("    from: up\n"), std::string("    from: up\n").size(), "");
    const Ending ending = check(text);
    EXPECT_EQ(ending.code, 2) << ending.words() << '\n' << ending.text;
    EXPECT_THAT(ending.text, HasSubstr("`" + id + "` lacks the key `from`"));
  }
}

TEST_F(NamedSlips, StageIdOf300Letters) { // the folder of its results could not be made
  const std::string id(300, 'a');
  expect_refused(cushion(elastic, suction, id), "  " + id + ":", "aaa");
}

TEST_F(NamedSlips, TestDataAtAStrainOf100000Percent) {
  write("m.yaml", "foil: {law: elastic, E: 900 MPa, nu: 0.45}\n"
                  "plastic: {law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}]}\n"
                  "rubber: {law: mooney_rivlin, C1: 0.4 MPa, C2: 0.1 MPa}\n");
  write("t.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n100000, 18\n");
  const Ending ending = run_limited({program("pneuma-material"), "m.yaml", "--data", "t.csv"}, folder, {10, 8});
  EXPECT_EQ(ending.code, 2) << ending.words() << '\n' << ending.text;
  EXPECT_THAT(ending.text, HasSubstr("t.csv:3:1: a strain of 1e+05 %"));
}

TEST_F(NamedSlips, TestDataFarBeyondTheCurvesAreComparedAtOnce) { // in parts that are not too many
  write("m.yaml", "plastic: {law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}]}\n");
  write("t.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n500, 18\n");
  const Ending ending =
      run_limited({program("pneuma-material"), "m.yaml", "--strain", "1e-12", "--data", "t.csv"}, folder, {10, 8});
  EXPECT_EQ(ending.code, 0) << ending.words() << '\n' << ending.text;
  EXPECT_THAT(ending.text, HasSubstr("against test t"));
}

} // namespace
} // namespace pneuma::tests::damage
