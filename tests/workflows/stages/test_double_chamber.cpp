// SPDX-License-Identifier: GPL-3.0-or-later
// What projects/double_chamber says of itself (example B13 of the thesis), on a coarser mesh.
#include <array>
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

constexpr double plan = 18; // m2

// Runs workflow files of projects on 12 x 6 squares of T6 a foil.
class DoubleChamber : public InFolder {
protected:
  using Edits = std::vector<std::pair<std::string, std::string>>; // before, after
  void run(const std::string& project, const std::string& file, const Edits& edits = {}) const {
    std::ostringstream text;
    text << std::ifstream(fs::path(source_folder) / "projects" / project / (file + ".yaml")).rdbuf();
    std::string coarse = text.str();
    const auto replace = [&](const std::string& before, const std::string& after) {
      ASSERT_NE(coarse.find(before), std::string::npos);
      coarse.replace(coarse.find(before), before.size(), after);
    };
    replace("../../configs", (fs::path(source_folder) / "configs").string());
    replace("[28, 14]", "[12, 6]");
    for (const auto& [before, after] : edits) replace(before, after);
    std::ofstream(folder / (project + ".yaml")) << coarse;
    const Outcome outcome = pneuma("run " + project + ".yaml");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
  }
  json summary_of(const std::string& project, const std::string& stage) const {
    return json::parse(std::ifstream(folder / "out" / project / stage / "summary.json"));
  }
  // A column of history.csv.
  std::vector<double> history(const std::string& project, const std::string& stage, const std::string& column) const {
    std::ifstream file(folder / "out" / project / stage / "history.csv");
    std::string line, cell;
    std::getline(file, line);
    std::istringstream head(line);
    std::size_t at = 0;
    while (std::getline(head, cell, ',') && cell != column) ++at;
    EXPECT_EQ(cell, column);
    std::vector<double> values;
    while (std::getline(file, line)) {
      std::istringstream row(line);
      for (std::size_t i = 0; i <= at; ++i) std::getline(row, cell, ',');
      values.push_back(std::stod(cell));
    }
    return values;
  }
};

double deflection(const json& summary, const std::string& foil) {
  return summary["foils"][foil]["max_deflection"];
}

// A foil whose equations do not change keeps its place: positions of metres are rounded to 1e-15 m.
constexpr double still = 1e-12; // m

TEST_F(DoubleChamber, UncoupledIsTheSingleChamberAndTheMiddleFoilStaysStill) {
  run("double_chamber", "thesis");
  run("single_chamber", "thesis");
  for (const char* stage : {"patch_regulated", "suction_regulated", "pressure_regulated"}) {
    const json two = summary_of("double_chamber", stage), one = summary_of("single_chamber", stage);
    EXPECT_LT(deflection(two, "middle"), still) << stage;
    EXPECT_LT(deflection(two, "lower"), still) << stage;
    // the upper foil cannot know what lies below it: the residual at which a step is accepted is all between the two
    EXPECT_NEAR(deflection(two, "upper"), deflection(one, "upper"), 1e-6 * deflection(one, "upper")) << stage;
  }
  const json form = summary_of("double_chamber", "form");
  EXPECT_NEAR(form["chambers"]["top"]["volume"], form["chambers"]["bottom"]["volume"], 1e-9);
}

TEST_F(DoubleChamber, CoupledTheMiddleFoilMovesPressureTwoFollowsOneAndTheCushionGivesWayLess) {
  run("double_chamber", "thesis");
  run("single_chamber", "thesis");
  const auto top = history("double_chamber", "patch_closed", "chambers.top.gauge_pressure");
  const auto bottom = history("double_chamber", "patch_closed", "chambers.bottom.gauge_pressure");
  const auto middle = history("double_chamber", "patch_closed", "foils.middle.max_deflection");
  const auto two = history("double_chamber", "patch_closed", "foils.upper.max_deflection");
  const auto one = history("single_chamber", "patch_closed", "foils.upper.max_deflection");
  ASSERT_EQ(top.size(), 10U);
  ASSERT_EQ(one.size(), 10U);
  for (std::size_t i = 0; i < top.size(); ++i) {
    EXPECT_GT(bottom[i], i > 0 ? bottom[i - 1] : 400) << i;
    EXPECT_GT(top[i], bottom[i]) << i; // the middle foil is curved downwards: its tension carries the difference
    EXPECT_GT(middle[i], i > 0 ? middle[i - 1] : 0) << i;
    EXPECT_LT(two[i], one[i]) << i;
  }
  EXPECT_GT(middle.back(), 0.02);
  // each foil hands the frame its net pressure on the plan, and its load; a step is accepted at 1e-9 of the forces (14
  // kN)
  const json last = summary_of("double_chamber", "patch_closed");
  const auto balance = [&](const char* foil) { return last["foils"][foil]["balance"]["load"][2].get<double>(); };
  EXPECT_NEAR(balance("upper"), top.back() * plan - 2380, 1e-4);
  EXPECT_NEAR(balance("middle"), (bottom.back() - top.back()) * plan, 1e-4);
  EXPECT_NEAR(balance("lower"), -bottom.back() * plan, 1e-4);
  for (const char* foil : {"upper", "middle", "lower"}) {
    EXPECT_LT(last["foils"][foil]["balance"]["error"].get<double>(), 1e-4) << foil;
  }
  // each chamber keeps the air it had: its own gas law with an ambient pressure of 0
  const json start = summary_of("double_chamber", "inflated"), end = summary_of("double_chamber", "patch_closed");
  for (const char* chamber : {"top", "bottom"}) {
    const json &a = start["chambers"][chamber], &b = end["chambers"][chamber];
    const double pV = a["gauge_pressure"].get<double>() * a["volume"].get<double>();
    EXPECT_NEAR(b["gauge_pressure"].get<double>() * b["volume"].get<double>(), pV, 1e-8 * pV) << chamber;
  }
}

TEST_F(DoubleChamber, RealAirHalvesTheDeflectionAndAHigherSetPointCarriesSnow) {
  run("double_chamber", "workflow");
  const json inflated = summary_of("double_chamber", "inflated"), closed = summary_of("double_chamber", "patch_closed");
  const double p1 = closed["chambers"]["top"]["gauge_pressure"], p2 = closed["chambers"]["bottom"]["gauge_pressure"];
  EXPECT_GT(p1, p2);
  EXPECT_GT(p2, 400);
  EXPECT_LT(deflection(closed, "upper"), 0.6 * deflection(summary_of("double_chamber", "patch_regulated"), "upper"));
  EXPECT_GT(deflection(closed, "middle"), 0.01);

  const json raised = summary_of("double_chamber", "raised"), snow = summary_of("double_chamber", "snow");
  EXPECT_EQ(raised["chambers"]["top"]["gauge_pressure"], 600.0);
  EXPECT_EQ(raised["chambers"]["bottom"]["gauge_pressure"], 400.0);
  EXPECT_LT(deflection(raised, "lower"), still);
  EXPECT_GT(deflection(raised, "middle"), 0.05);
  // snow on the upper foil changes nothing below it: the same equations, followed over other steps
  EXPECT_NEAR(snow["chambers"]["bottom"]["volume"], raised["chambers"]["bottom"]["volume"], 1e-6);
  const double weight = inflated["reactions"]["sum"][2];
  EXPECT_NEAR(raised["reactions"]["sum"][2].get<double>(), weight, 1e-5);
  EXPECT_NEAR(snow["reactions"]["sum"][2].get<double>(), weight + 500 * plan, 1e-5);
}

TEST_F(DoubleChamber, ConnectedIsTheSingleChamberWithAMiddleFoilThatStaysStill) {
  run("double_chamber", "connected");
  const auto inflated = summary_of("double_chamber", "inflated");
  std::array<json, 3> connected;
  const std::array<const char*, 3> stages = {"patch", "suction", "pressure"};
  for (std::size_t i = 0; i < stages.size(); ++i) connected[i] = summary_of("double_chamber", stages[i]);
  run("double_chamber", "connected",
      {{"    - {name: middle, material: etfe_elastic, thickness: 200 um}\n", ""},
       {"between: [upper, middle]}", "between: [upper, lower]}"},
       {"    - {name: bottom, between: [middle, lower], connected_to: top}\n", ""}});
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const json &two = connected[i], one = summary_of("double_chamber", stages[i]);
    const json &top = two["chambers"]["top"], &bottom = two["chambers"]["bottom"], &only = one["chambers"]["top"];
    const double p = only["gauge_pressure"], volume = only["volume"];
    // outer foils and air are the same equations: the residual at which a step is accepted is all between the two
    EXPECT_NEAR(top["gauge_pressure"].get<double>(), p, 1e-6 * p) << stages[i];
    EXPECT_NEAR(top["volume"].get<double>() + bottom["volume"].get<double>(), volume, 1e-8 * volume) << stages[i];
    EXPECT_NEAR(deflection(two, "upper"), deflection(one, "upper"), 1e-6 * deflection(one, "upper")) << stages[i];
    EXPECT_EQ(top["gauge_pressure"], bottom["gauge_pressure"]) << stages[i];
    EXPECT_EQ(bottom["law"], "closed") << stages[i];
    EXPECT_LT(deflection(two, "middle"), still) << stages[i];
    // what the upper foil takes from its chamber goes to the other one
    EXPECT_GT(std::abs(top["volume"].get<double>() - inflated["chambers"]["top"]["volume"].get<double>()), 0.01);
  }
}

} // namespace
} // namespace pneuma::tests
