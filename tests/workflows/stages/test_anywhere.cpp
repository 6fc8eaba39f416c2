// SPDX-License-Identifier: GPL-3.0-or-later
// A cushion is the same cushion wherever its plan lies.
#include <cstring>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/state/state_file.h"
#include "tests/unit/pipeline/state/temporary_folder.h"
#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using base::Vec2;
using base::Vec3;
using pipeline::state::State;

class Anywhere : public InFolder {
protected:
  // A cushion on an L-shaped plan around `at`, cut along a curve and loaded in every way that has a place.
  void write_around(const Vec2& at) const {
    const auto point = [&](double x, double y) { return fmt::format("[{} m, {} m]", at.x() + x, at.y() + y); };
    const std::string curve = "[" + point(2, 0) + ", " + point(2, 2) + "]";
    const std::string part =
        fmt::format("{{x: [{} m, {} m], y: [{} m, {} m]}}", at.x(), at.x() + 1, at.y(), at.y() + 1);
    write(
        "pneuma: 1\nmaterials: {foil: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}}\n"
        "cushion:\n  plan: {shape: polygon, points: [" +
        point(0, 0) + ", " + point(4, 0) + ", " + point(4, 1) + ", " + point(2.5, 1) + ", " + point(2.5, 2) + ", " +
        point(0, 2) +
        "]}\n  foils: [{name: upper, material: foil, thickness: 200 um}, {name: lower, material: foil, thickness: 200 "
        "um}]\n  chambers: [{name: main, between: [upper, lower]}]\nmesh: {element: T6, size: 0.3 m}\nstages:\n"
        "  form: {run: formfind, from: mesh, gauge_pressure: {main: 300 Pa}, prestress: {all: 0.8 kN/m}}\n"
        "  strips: {run: pattern, from: form, curves: {all: [" +
        curve + "]}}\n" +
        "  up: {run: inflate, from: strips, gauge_pressure: {main: 300 Pa}}\n"
        "  gust: {run: wind, from: up, loads: [{name: suction, foil: upper, wind: -0.2 kPa, region: " +
        part + "}, {name: snow, foil: upper, snow: 0.1 kPa, region: {polygon: [" + point(0.5, 0.5) + ", " +
        point(2, 0.5) + ", " + point(1, 1.5) + "]}}, {name: boot, foil: upper, patch: {center: " + point(1, 1) +
        ", size: [0.5 m, 0.5 m], force: [0 N, 0 N, -100 N]}}]}\n" +
        "  pulled: {run: wind, from: up, loads: [{name: suction, foil: upper, wind: -1 kPa}], control: {type: "
        "displacement, at: " +
        point(1, 1) + ", foil: upper, until: 20 mm}}\n");
  }

  void run_around(const Vec2& at) const {
    write_around(at);
    const Outcome outcome = pneuma("run w.yaml");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
  }
};

const std::vector<std::string> stages = {"mesh", "form", "strips", "up", "gust", "pulled"};
const std::vector<std::string> drawings = {"upper.dxf", "upper.svg", "upper_strips.csv", "lower.dxf"};

TEST_F(Anywhere, ACushionIsTheSameToTheBitWhereTheOffsetIsExact) {
  run_around({0, 0});
  std::map<std::string, State> here;
  std::map<std::string, std::string> drawn;
  for (const std::string& stage : stages) here[stage] = pipeline::state::read_state(out(stage) / "state.hdf");
  for (const std::string& name : drawings) drawn[name] = bytes_of(out("strips") / name);
  const json near = summary("gust");
  const Vec2 offset(524288, -4194304);
  run_around(offset);
  for (const std::string& stage : stages) {
    SCOPED_TRACE(stage);
    const State there = pipeline::state::read_state(out(stage) / "state.hdf");
    ASSERT_EQ(there.mesh.nodes.size(), here[stage].mesh.nodes.size());
    EXPECT_TRUE(there.mesh.nodes == here[stage].mesh.nodes);
    ASSERT_EQ(there.fields.size(), here[stage].fields.size());
    for (std::size_t f = 0; f < there.fields.size(); ++f) {
      const auto& ours = here[stage].fields[f].values;
      const auto& theirs = there.fields[f].values;
      ASSERT_EQ(theirs.size(), ours.size());
      EXPECT_EQ(std::memcmp(theirs.data(), ours.data(), ours.size() * sizeof(double)), 0) << there.fields[f].name;
    }
    const Vec3 moved = there.origin - here[stage].origin;
    EXPECT_NEAR((moved - Vec3(offset.x(), offset.y(), 0)).norm(), 0, 1e-8);
  }
  const std::regex centre("PLAN CENTRE AT [-0-9., ]+ m"); // the offset stands in their text, and nowhere else
  for (const std::string& name : drawings) {
    const std::string far = bytes_of(out("strips") / name);
    EXPECT_EQ(std::regex_replace(far, centre, ""), std::regex_replace(drawn[name], centre, "")) << name;
    if (name.ends_with(".csv")) continue;
    EXPECT_THAT(far, testing::HasSubstr("PLAN CENTRE AT 524290.167, -4194303.000 m")) << name;
  }
  const json place = near["foils"]["upper"]["von_mises"]["at"],
             far = summary("gust")["foils"]["upper"]["von_mises"]["at"];
  EXPECT_NEAR(far[0].get<double>() - place[0].get<double>(), offset.x(), 1e-6);
  EXPECT_NEAR(far[1].get<double>() - place[1].get<double>(), offset.y(), 1e-6);
  EXPECT_GT(place[0].get<double>(), 0); // the user's coordinates, in which the plan has none below
}

TEST_F(Anywhere, InSurveyCoordinatesResultsAgreeToAMillionth) {
  run_around({0, 0});
  const json near = summary("gust"), near_strips = summary("strips");
  run_around({568120.3, 5934210.7});
  const json far = summary("gust"), far_strips = summary("strips");
  const auto expect_same = [](const json& a, const json& b) {
    EXPECT_NEAR(b.get<double>(), a.get<double>(), 1e-6 * std::abs(a.get<double>()));
  };
  for (const char* foil : {"upper", "lower"}) {
    for (const char* key : {"area", "sag", "max_deflection"})
      expect_same(near["foils"][foil][key], far["foils"][foil][key]);
    for (const char* key : {"von_mises", "principal_stress_1"}) {
      expect_same(near["foils"][foil][key]["max"], far["foils"][foil][key]["max"]);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      for (const char* key : {"width", "length", "area"}) {
        expect_same(near_strips["patterns"][foil]["strips"][i][key], far_strips["patterns"][foil]["strips"][i][key]);
      }
    }
  }
  expect_same(near["chambers"]["main"]["volume"], far["chambers"]["main"]["volume"]);
}

TEST_F(Anywhere, MessagesTellPlacesInTheUsersCoordinates) {
  write(R"(pneuma: 1
materials: {etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}}
cushion:
  plan: {shape: polygon, points: [[568100 m, 0 m], [568106 m, 0 m], [568100 m, 0.35 m]]}
  foils: [{name: upper, material: etfe, thickness: 200 um}]
  base: rigid
  chambers: [{name: air, between: [upper, base]}]
mesh: {element: T3, divisions: 30}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {air: 300 Pa}, prestress: {all: 0.9 kN/m}}
)");
  const Outcome check = pneuma("check w.yaml");
  EXPECT_EQ(check.code, 0);
  EXPECT_THAT(check.text, testing::ContainsRegex("is a needle: .* at \\(568105\\.[0-9]+, 0\\.0[0-9]*, 0\\)"));
}

} // namespace
} // namespace pneuma::tests
