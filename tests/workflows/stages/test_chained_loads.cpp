// SPDX-License-Identifier: GPL-3.0-or-later
// A wind stage from a wind stage: what acted stays, or goes to the part of it that is stated.
#include <cmath>

#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::HasSubstr;

class ChainedLoads : public InFolder {
protected:
  void inflated(const std::string& material, const std::string& stages) const {
    write(foil_over_base(material, "3 kPa", "", stages));
  }
  double foil(const std::string& stage, const std::string& key) const {
    return summary(stage)["foils"]["foil"].at(json::json_pointer(key)).get<double>();
  }
};

constexpr const char* elastic = "law: elastic, E: 900 MPa, nu: 0.45";
constexpr const char* snow = "{name: snow, foil: foil, snow: 400 Pa, region: {x: [0 m, 0.5 m]}}";
constexpr const char* part = "{name: part, foil: foil, wind: -300 Pa, region: {x: [-0.5 m, 0.2 m]}}";
constexpr const char* gust = "{name: gust, foil: foil, wind: -500 Pa}";

TEST_F(ChainedLoads, OneAfterTheOtherEndsWhereAllAtOnceDo) {
  inflated(elastic, std::string("  both: {run: wind, from: up, loads: [") + snow + ", " + part + ", " + gust + "]}\n" +
                        "  first: {run: wind, from: up, loads: [" + snow + ", " + part + "]}\n" +
                        "  second: {run: wind, from: first, loads: [" + gust + "]}\n" +
                        "  back: {run: wind, from: second, factors: {snow: 0, part: 0, gust: 0}}\n" +
                        "  half: {run: wind, from: second, factors: {gust: 0.5}}\n" +
                        "  all: {run: wind, from: half, factors: {gust: 2}}\n");
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  for (const char* key : {"/sag", "/von_mises/max", "/principal_stress_1/max"}) {
    EXPECT_NEAR(foil("second", key) / foil("both", key), 1, 1e-8) << key;
    EXPECT_NEAR(foil("all", key) / foil("both", key), 1, 1e-8) << key;
    EXPECT_NEAR(foil("back", key) / foil("up", key), 1, 1e-8) << key;
  }
  EXPECT_GT(std::abs(foil("half", "/sag") / foil("both", "/sag") - 1), 1e-3);
  EXPECT_GT(std::abs(foil("first", "/sag") / foil("up", "/sag") - 1), 1e-3);
  EXPECT_THAT(summary("half")["modelled"].dump(),
              HasSubstr("load gust: of the state before, goes to 0.5 of what it was"));
  EXPECT_THAT(summary("half")["modelled"].dump(), HasSubstr("load snow: of the state before, stays as it is"));
}

TEST_F(ChainedLoads, ShutInAirGoesOnFromWhereItWas) {
  const std::string closed = "gas: {air: {law: closed}}, ";
  inflated(elastic, "  both: {run: wind, from: up, " + closed + "loads: [" + snow + ", " + gust + "]}\n" +
                        "  first: {run: wind, from: up, " + closed + "loads: [" + snow + "]}\n" +
                        "  second: {run: wind, from: first, " + closed + "loads: [" + gust + "]}\n" +
                        "  held: {run: wind, from: first, factors: {snow: 1.000000000001}}\n");
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const auto pressure = [&](const char* stage) {
    return summary(stage)["chambers"]["air"]["gauge_pressure"].get<double>();
  };
  EXPECT_NEAR(pressure("second") / pressure("both"), 1, 1e-8);
  EXPECT_NEAR(foil("second", "/sag") / foil("both", "/sag"), 1, 1e-8);
  EXPECT_GT(pressure("first"), 3001); // and stays there, regulated, unless told otherwise
  EXPECT_NEAR(pressure("held") / pressure("first"), 1, 1e-12);
  EXPECT_NEAR(foil("held", "/sag") / foil("first", "/sag"), 1, 1e-9);
}

TEST_F(ChainedLoads, FoilThatFlowsGoesOnFlowing) {
  // snow for 3 d and a gust of 5 s; the snow in two stages is the snow in one
  inflated("law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: 21 MPa, modulus: 40 "
           "MPa}], viscosity: {model: perzyna, mu: 1e7 s, epsilon: 0.5, threshold: 1.5 MPa}",
           std::string("  once: {run: wind, from: up, loads: [") + snow +
               "], history: [{time: 1 h, factor: 1}, {time: 3 d, factor: 1}]}\n" +
               "  rises: {run: wind, from: up, loads: [" + snow + "], duration: 1 h}\n" +
               "  stays: {run: wind, from: rises, duration: 71 h}\n" + "  blows: {run: wind, from: stays, loads: [" +
               gust + "], duration: 5 s}\n");
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const char* key = "/plastic_strain/max";
  EXPECT_GT(foil("once", key), 2 * foil("rises", key));
  // both follow the flow to 1e-5 of strain
  EXPECT_NEAR(foil("stays", key), foil("once", key), 5e-5);
  EXPECT_GT(foil("stays", key), 1e-3);
  EXPECT_NEAR(foil("blows", key), foil("stays", key), 5e-5); // no time to flow
  EXPECT_GT(foil("blows", "/von_mises/max"), 1.02 * foil("stays", "/von_mises/max"));
}

TEST_F(ChainedLoads, StageOfItsOwnKnowsTheNamesOfItsState) {
  inflated(elastic, std::string("  first: {run: wind, from: up, loads: [") + snow + "]}\n" +
                        "  second: {run: wind, from: first, factors: {snow: 2}}\n");
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const auto stage = [&](const std::string& from) {
    return call("sed -i 's/snow: 2/" + from + ": 2/' " + (out("second") / "stage.yaml").string() + " && " +
                (programs / "pneuma-wind").string() + " --config " + (out("second") / "stage.yaml").string() +
                " --in " + (out("first") / "state.hdf").string() + " --out " + (folder / "again.hdf").string());
  };
  EXPECT_EQ(stage("snow").code, 0);
  const Outcome wrong = stage("snwo");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.text,
              HasSubstr("`factors` names load `snwo`, which does not act in the state that the stage starts "
                        "from; there act: snow"));
}

} // namespace
} // namespace pneuma::tests
