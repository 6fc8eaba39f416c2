// SPDX-License-Identifier: GPL-3.0-or-later
// Foils of all laws through the programs: tables from test data, plastic foils, what is refused.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::HasSubstr;

class Materials : public InFolder {
protected:
  void file(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }

  void inflated(const std::string& material, const std::string& pressure, const std::string& site = "") const {
    write(foil_over_base(material, pressure, site));
  }

  // Points of a linear foil, E 900 MPa and nu 0.45, as a machine of strains and nominal stresses would give them.
  static std::string points(double stiffness = 900) {
    std::string text = "# of a formula\nstrain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
    for (int i = -2; i <= 10; ++i) {
      for (int j = -2; j <= 10; ++j) {
        const double e1 = 0.002 * i, e2 = 0.002 * j, E1 = e1 + e1 * e1 / 2, E2 = e2 + e2 * e2 / 2;
        const double c = stiffness / (1 - 0.45 * 0.45);
        text += fmt::format("{}, {}, {}, {}\n", 100 * e1, 100 * e2, (1 + e1) * c * (E1 + 0.45 * E2),
                            (1 + e2) * c * (E2 + 0.45 * E1));
      }
    }
    return text;
  }
};

constexpr const char* table = "law: pd_nurbs, data: tests.csv, net: [8, 8], nu: 0.45, source: a formula";

TEST_F(Materials, TableFromTestDataIsTheFoilThatWasTested) {
  file("tests.csv", points());
  inflated(table, "3 kPa");
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("table of `foil`: rms "));
  const json of_table = summary("up");
  EXPECT_LT(of_table["materials"]["foil"]["fit"]["max"].get<double>(),
            1e-4 * of_table["materials"]["foil"]["fit"]["largest_stress"].get<double>());
  EXPECT_TRUE(of_table["materials"]["foil"]["fit"]["monotone"].get<bool>());
  inflated("law: elastic, E: 900 MPa, nu: 0.45", "3 kPa");
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const json elastic = summary("up");
  const auto relative_difference = [&](const char* key) {
    const double exact = elastic["foils"]["foil"][key];
    return std::abs(of_table["foils"]["foil"][key].get<double>() / exact - 1);
  };
  EXPECT_LT(relative_difference("sag"), 1e-4); // as the fit
  // a table knows nu of the thickness for small strains only: squares of 2 %
  EXPECT_LT(relative_difference("thickness_min"), 1e-3);
}

TEST_F(Materials, TableWithoutAUniaxialTestIsAWarningOfCheckAndOfTheStage) {
  std::string text = "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
  for (const double e : {0.005, 0.01, 0.02}) { // strains 1:1 and 2:1 of a linear foil
    for (const double other : {e, 0.5 * e}) {
      const double c = 900 / (1 - 0.45 * 0.45);
      text += fmt::format("{}, {}, {}, {}\n", 100 * e, 100 * other, c * (e + 0.45 * other), c * (other + 0.45 * e));
    }
  }
  file("tests.csv", text);
  inflated(std::string(table) + ", outside: linear", "1 kPa");
  const Outcome check = pneuma("check w.yaml");
  EXPECT_EQ(check.code, 0);
  EXPECT_THAT(check.text, HasSubstr("w.yaml:2:41: warning: no test is near uniaxial stress"));
  const Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const json of_table = summary("up");
  EXPECT_THAT(of_table["warnings"].dump(), HasSubstr("table `foil`: no test is near uniaxial stress"));
  // (1 / 2 + nu) / (1 + nu / 2) of small strains; nominal stress over stretch: squares of 2 %
  EXPECT_NEAR(of_table["materials"]["foil"]["fit"]["least_stress_ratio"].get<double>(), 0.95 / 1.225, 0.02);
}

TEST_F(Materials, ChangedTestPointMakesTheStageStale) {
  file("tests.csv", points());
  inflated(table, "1 kPa");
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  file("tests.csv", "# moved by a line\n" + points());
  EXPECT_THAT(pneuma("status w.yaml").text, testing::Not(HasSubstr("stale")));
  file("tests.csv", points(901));
  EXPECT_THAT(pneuma("status w.yaml").text, HasSubstr("settings changed (materials.foil.points.0.2 "));
}

TEST_F(Materials, TableThatEndsStopsTheStageOrGoesOnAndSaysSo) {
  file("tests.csv", points());
  inflated(table, "100 kPa");
  const Outcome stopped = pneuma("run w.yaml");
  EXPECT_EQ(stopped.code, 5) << stopped.text;
  EXPECT_THAT(stopped.text, HasSubstr("no data at"));
  inflated(std::string(table) + ", outside: linear", "100 kPa");
  const Outcome went_on = pneuma("run w.yaml");
  ASSERT_EQ(went_on.code, 0) << went_on.text;
  EXPECT_THAT(went_on.text, HasSubstr("of foil `foil` are outside the data of its table, which goes on linearly"));
  EXPECT_GT(summary("up")["foils"]["foil"]["outside_data_area_fraction"].get<double>(), 0.5);
}

TEST_F(Materials, HoleInTestDataIsToldInItsFile) {
  file("tests.csv", "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n1, 1, , 9\n");
  inflated(table, "1 kPa");
  const Outcome run = pneuma("check w.yaml");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.text, HasSubstr("tests.csv:2:7: a hole: `stress_1` has no value here"));
}

TEST_F(Materials, PlasticFoilYieldsAndItsTableFollowsItUpwards) {
  const std::string j2 = "law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: 21 "
                         "MPa, modulus: 40 MPa}]";
  inflated(j2, "10 kPa");
  Outcome run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  const json plastic = summary("up");
  EXPECT_GT(plastic["foils"]["foil"]["plastic_strain"]["max"].get<double>(), 0.01);
  EXPECT_GT(plastic["foils"]["foil"]["energy"]["dissipated"].get<double>(), 0);
  inflated("law: pd_nurbs, fit_to: model, net: [60, 60], degree: 2, range: [-0.03, 0.3], tension_field: on}, model: {" +
               j2,
           "10 kPa");
  run = pneuma("run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  // the paths of the points of a disc that only grows are nearly proportional: deformation theory is near flow theory
  const double sag = plastic["foils"]["foil"]["sag"];
  EXPECT_NEAR(summary("up")["foils"]["foil"]["sag"].get<double>(), sag, 0.01 * sag);
}

TEST_F(Materials, TemperatureOfTheSiteDecidesTheStiffness) {
  const std::string material = "law: elastic, E: 900 MPa, nu: 0.45, temperature: [{at: 43 degC, E: 700 MPa}]";
  inflated(material, "3 kPa", ", temperature: 33 degC");
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  const double between = summary("up")["foils"]["foil"]["sag"];
  inflated("law: elastic, E: 800 MPa, nu: 0.45", "3 kPa");
  ASSERT_EQ(pneuma("run w.yaml").code, 0);
  EXPECT_DOUBLE_EQ(summary("up")["foils"]["foil"]["sag"].get<double>(), between);
}

TEST_F(Materials, UnstableOgdenFoilIsRefusedWithWhereItIsUnstable) {
  inflated("law: ogden, terms: [{mu: 6 MPa, alpha: 2}, {mu: -1 MPa, alpha: 4}]", "1 kPa");
  const Outcome run = pneuma("run w.yaml");
  EXPECT_EQ(run.code, 2) << run.text;
  EXPECT_THAT(run.text, HasSubstr("w.yaml:2:45: material `foil`: its Ogden constants are unstable"));
}

TEST_F(Materials, FoilsOfEveryOtherLawInflate) {
  for (const char* material :
       {"law: elastic, E1: 900 MPa, E2: 800 MPa, nu12: 0.4, G12: 300 MPa, tension_field: on",
        "law: ogden, terms: [{mu: 100 MPa, alpha: 2}, {mu: -10 MPa, alpha: -2}]",
        "law: le_nurbs, fit_to: model, range: [-0.05, 0.2], tension_field: on}, model: {law: elastic, E1: 900 MPa, E2: "
        "800 MPa, nu12: 0.4, G12: 300 MPa",
        "law: j2, E: 900 MPa, nu: 0.45, strain: small, hardening: [{stress: 15 MPa, modulus: 72 MPa}], viscosity: "
        "{model: perzyna, mu: 1 h, epsilon: 0.5, threshold: 2 MPa}"}) {
    inflated(material, "3 kPa");
    const Outcome run = pneuma("run w.yaml");
    ASSERT_EQ(run.code, 0) << material << '\n' << run.text;
    EXPECT_GT(summary("up")["foils"]["foil"]["sag"].get<double>(), 0.01) << material;
  }
}

} // namespace
} // namespace pneuma::tests
