// SPDX-License-Identifier: GPL-3.0-or-later
// `pneuma material` as its user meets it.
#include <cmath>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/unit/pipeline/drawing/well_formed.h"
#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

class MaterialBench : public InFolder {
protected:
  MaterialBench() {
    file("m.yaml",
         "foil: {law: elastic, E: 900 MPa, nu: 0.45}\nrubber: {law: mooney_rivlin, C1: 0.4 MPa, C2: 0.1 MPa}\n");
  }
  void file(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder / name).rdbuf();
    return text.str();
  }
};

// The number behind a word.
double number_after(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  EXPECT_NE(at, std::string::npos) << word << '\n' << text;
  return at == std::string::npos ? NAN : std::stod(text.substr(at + word.size()));
}

// Nominal stress of St. Venant-Kirchhoff, MPa.
double elastic(double e) {
  return 900 * (1 + e) * (e + 0.5 * e * e);
}

// Nominal stress of uniaxial J2 plasticity with logarithmic strain, MPa: the Kirchhoff stress is bilinear.
double bilinear(double e) {
  constexpr double E = 1100, yield = 16, K = 160;
  const double strain = std::log1p(e);
  const double tau = strain < yield / E ? E * strain : yield + E * K / (E + K) * (strain - yield / E);
  return tau / (1 + e);
}

TEST_F(MaterialBench, TableHoldsTheClosedFormAndTheWayBack) {
  const Outcome run = pneuma("material m.yaml foil --strain '20 %'");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_NEAR(number_after(run.text, "\n        10") / elastic(0.1), 1, 5e-4); // four digits are printed
  EXPECT_NEAR(number_after(run.text, "\n        20") / elastic(0.2), 1, 5e-4);
  EXPECT_EQ(number_after(run.text, "left, %"), 0);
  EXPECT_THAT(run.text, Not(HasSubstr("rubber")));
  EXPECT_THAT(pneuma("material m.yaml").text, HasSubstr("rubber"));
}

TEST_F(MaterialBench, TableOfALevelYieldStressGoesBackToItsStart) {
  file("level.yaml", "table: {law: pd_nurbs, fit_to: level, range: [-0.1, 0.2]}\n"
                     "level: {law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 0 MPa}]}\n");
  // in steps that jump over the rise of the stress
  const Outcome run = pneuma("material level.yaml table --strain '12 %' --steps 12 --ratios 1:1");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_EQ(number_after(run.text, "left, %"), 0);
}

TEST_F(MaterialBench, CsvHoldsEveryPointOfLoadingAndUnloading) {
  ASSERT_EQ(pneuma("material m.yaml rubber --strain 1 --steps 50 --ratios 1:0 --csv c.csv").code, 0);
  std::istringstream lines(text_of("c.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, HasSubstr("strain_1 [-], strain_2 [-], stress_1 [MPa]"));
  int loading = 0, unloading = 0;
  double last = -1;
  while (std::getline(lines, line)) {
    const std::regex row("rubber, uniaxial, , (loading|unloading), 0, ([^,]+), ([^,]+), ([^,]+), ([^,]+), .*");
    std::smatch cells;
    ASSERT_TRUE(std::regex_match(line, cells, row)) << line;
    ++(cells[1] == "loading" ? loading : unloading);
    const double a = 1 + std::stod(cells[2]);
    EXPECT_NEAR(std::stod(cells[4]), 2 * (a - 1 / (a * a)) * (0.4 + 0.1 / a), 1e-8);
    EXPECT_NEAR(std::stod(cells[3]), 1 / std::sqrt(a) - 1, 1e-8);
    last = a - 1;
  }
  EXPECT_EQ(loading, 51);
  EXPECT_EQ(unloading, 50);
  EXPECT_NEAR(last, 0, 1e-12);
}

TEST_F(MaterialBench, PictureIsWellFormedAndNamesItsCurves) {
  file("u.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n2, 18\n");
  ASSERT_EQ(pneuma("material m.yaml foil --data u.csv --svg p.svg").code, 0);
  const std::string svg = text_of("p.svg");
  EXPECT_TRUE(well_formed(svg));
  for (const char* name : {"uniaxial", "1:1", "2:1", "test u", "nominal stress, MPa"})
    EXPECT_THAT(svg, HasSubstr(name));
  ASSERT_EQ(pneuma("material m.yaml --true --svg all.svg").code, 0);
  EXPECT_TRUE(well_formed(text_of("all.svg")));
  EXPECT_THAT(text_of("all.svg"), HasSubstr("rubber, 2:1"));
}

TEST_F(MaterialBench, DataOfTheLawItselfHaveNoMisfit) {
  std::string uniaxial = "strain_1 [-], stress_1 [MPa]\n",
              biaxial = "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
  for (int i = 0; i <= 40; ++i) {
    const double e = 0.005 * (i <= 30 ? i : 60 - i); // and a way back
    uniaxial += fmt::format("{}, {}\n", e, elastic(e));
    // 1:1: S = E / (1 - nu) E11
    biaxial += fmt::format("{}, {}, {}, {}\n", 100 * e, 100 * e, elastic(e) / 0.55, elastic(e) / 0.55);
  }
  file("u.csv", uniaxial);
  file("b.csv", biaxial);
  const Outcome run = pneuma("material m.yaml foil --data u.csv --data b.csv");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_LT(number_after(run.text, "test u (uniaxial, 41 points): rms"), 1e-9) << run.text;
  EXPECT_LT(number_after(run.text, "test b (1:1, 41 points): rms"), 1e-9) << run.text;
}

TEST_F(MaterialBench, TestInShearIsComparedInShear) {
  // S12 = G 2 E12, along the axes of the foil or in a table of it
  file("s.yaml", "foil: {law: elastic, E1: 900 MPa, E2: 800 MPa, nu12: 0.4, G12: 300 MPa}\n"
                 "table: {law: le_nurbs, fit_to: foil, range: [-0.05, 0.2]}\n");
  file("s.csv", "shear_strain [%]; shear_stress [MPa]\n1; 3,0\n2; 6,1\n4; 12,0\n");
  const Outcome run = pneuma("material s.yaml --data s.csv --svg p.svg --csv c.csv");
  ASSERT_EQ(run.code, 0) << run.text;
  for (const char* name : {"\nfoil", "\ntable"}) {
    const std::string text = run.text.substr(("\n" + run.text).find(name));
    EXPECT_NEAR(number_after(text, "test s (shear, 3 points): rms"), 0.1 / std::sqrt(3), 1e-3) << text;
    EXPECT_NEAR(number_after(text, "at a strain of"), 2, 1e-9) << text;
  }
  EXPECT_THAT(text_of("p.svg"), HasSubstr("shear"));
  const std::string rows = text_of("c.csv");
  EXPECT_THAT(rows.substr(rows.find("foil, shear, , loading")), HasSubstr(", 0.01, 3\n"));
}

TEST_F(MaterialBench, TestsAreComparedAtTheirTemperature) {
  file("t.yaml", "foil: {law: elastic, E: 1000 MPa, nu: 0.45, temperature: [{at: 43 degC, E: 600 MPa}]}\n");
  const auto at = [&](const char* name, double celsius, double modulus) {
    std::string text = "strain_1 [%], stress_1 [MPa], temperature [degC]\n";
    for (const double e : {0.01, 0.05})
      text += fmt::format("{}, {}, {}\n", 100 * e, elastic(e) * modulus / 900, celsius);
    file(name, text);
  };
  at("warm.csv", 33, 800);
  at("cold.csv", 23, 1000);
  at("hot.csv", 60, 500);
  const Outcome one = pneuma("material t.yaml --ratios 1:0 --data warm.csv");
  ASSERT_EQ(one.code, 0) << one.text;
  EXPECT_THAT(one.text, HasSubstr("at 33 degC, as the tests"));
  EXPECT_NEAR(number_after(one.text, "\n        10") / (elastic(0.1) / 0.9 * 0.8), 1, 5e-4); // four digits
  EXPECT_LT(number_after(one.text, "test warm (uniaxial, 2 points, taken at 33 degC): rms"), 1e-9) << one.text;
  const Outcome all = pneuma("material t.yaml --ratios 1:0 --data warm.csv --data cold.csv --data hot.csv");
  ASSERT_EQ(all.code, 0) << all.text;
  EXPECT_NEAR(number_after(all.text, "\n        10") / (elastic(0.1) / 0.9), 1, 5e-4);
  for (const char* test : {"test warm", "test cold"}) {
    EXPECT_LT(number_after(all.text.substr(all.text.find(test)), "rms"), 1e-9) << all.text;
  }
  EXPECT_THAT(all.text, HasSubstr("test hot: not compared, 60 degC is outside the temperatures of the material"));
  const Outcome told = pneuma("material t.yaml --ratios 1:0 --data warm.csv --temperature '23 degC'");
  EXPECT_NEAR(number_after(told.text, "max") / (elastic(0.05) / 0.9 * 0.2), 1, 5e-3) << told.text; // three digits
  EXPECT_THAT(pneuma("material m.yaml foil --data warm.csv").text, HasSubstr("does not depend on the temperature"));
}

TEST_F(MaterialBench, OddTestDataAreComparedAndQuestioned) {
  file("odd.csv", "strain_1 [%], stress_1 [Pa]\n1, 9\n2, 18\n");
  const Outcome run = pneuma("material m.yaml foil --data odd.csv");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_THAT(pneuma("material m.yaml rubber --strain 10").text, HasSubstr("--strain: 10 is 1000 %; is `10 %` meant?"));
  EXPECT_THAT(run.text, HasSubstr("odd.csv:2:1: warning: 9e-06 MPa at a strain of 1 % mean a modulus of"));
  EXPECT_THAT(run.text, HasSubstr("test odd (uniaxial, 2 points)"));
}

TEST_F(MaterialBench, TableWithoutAUniaxialTestSaysSo) {
  std::string data = "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
  for (const double e : {0.01, 0.02, 0.05}) { // S2 / S1 of strains 1:1 and 2:1
    for (const double other : {e, 0.5 * e}) {
      const double c = 900 / (1 - 0.45 * 0.45);
      data += fmt::format("{}, {}, {}, {}\n", 100 * e, 100 * other, c * (e + 0.45 * other), c * (other + 0.45 * e));
    }
  }
  file("b.csv", data);
  file("t.yaml", "table:\n  law: pd_nurbs\n  data: b.csv\n");
  const Outcome run = pneuma("material t.yaml --ratios 1:1");
  EXPECT_EQ(run.code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("t.yaml:3:9: warning: no test is near uniaxial stress"));
  EXPECT_THAT(run.text, HasSubstr("; no test near uniaxial stress\n"));
}

TEST_F(MaterialBench, MisfitSaysHowFarAndWhere) {
  // 1 MPa too much at 3 % alone
  file("u.csv", fmt::format("strain_1 [%], stress_1 [MPa]\n1, {}\n2, {}\n3, {}\n4, {}\n", elastic(0.01), elastic(0.02),
                            elastic(0.03) + 1, elastic(0.04)));
  const Outcome run = pneuma("material m.yaml foil --data u.csv");
  EXPECT_NEAR(number_after(run.text, "rms"), 0.5, 1e-3);
  EXPECT_NEAR(number_after(run.text, "max"), 1, 1e-3);
  EXPECT_NEAR(number_after(run.text, "at a strain of"), 3, 1e-3);
}

TEST_F(MaterialBench, FitFindsAKnownBilinearLawAgain) {
  std::string data = "# made of E 1100, yield stress 16, K 160 MPa\nstrain_1 [%], stress_1 [MPa]\n";
  for (int i = 0; i <= 80; ++i) data += fmt::format("{}, {}\n", 0.25 * i, bilinear(0.0025 * i));
  file("u.csv", data);
  const Outcome run = pneuma("material m.yaml foil --data u.csv --fit 1 --strain '20 %' --svg p.svg");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_NEAR(number_after(run.text, "E: ") / 1100, 1, 1e-6);
  EXPECT_NEAR(number_after(run.text, "{stress: ") / 16, 1, 1e-6);
  EXPECT_NEAR(number_after(run.text, "modulus: ") / 160, 1, 1e-6);
  EXPECT_EQ(number_after(run.text, "nu: "), 0.45);
  const std::string fitted = run.text.substr(run.text.find("nearest to u"));
  EXPECT_LT(number_after(fitted, "points): rms"), 1e-6) << fitted;
  EXPECT_THAT(text_of("p.svg"), HasSubstr("test u"));
}

TEST_F(MaterialBench, WhatAFitPrintsIsAMaterial) {
  std::string data = "strain_1 [%], stress_1 [MPa]\n";
  for (int i = 0; i <= 80; ++i) data += fmt::format("{}, {}\n", 0.25 * i, bilinear(0.0025 * i));
  file("u.csv", data);
  const Outcome fit = pneuma("material m.yaml foil --data u.csv --fit 1");
  file("fitted.yaml", fit.text.substr(fit.text.find("foil_1:\n")));
  const Outcome run = pneuma("material fitted.yaml foil_1 --data u.csv --strain '20 %'");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_LT(number_after(run.text, "points): rms"), 1e-6) << run.text; // nine digits are printed
  // of the elastic strain what the plastic one leaves
  const double left = std::expm1(std::log1p(0.2) - bilinear(0.2) * 1.2 / 1100);
  EXPECT_NEAR(number_after(run.text, "left, %") / (100 * left), 1, 5e-3); // three digits are printed
  // and a material's own curve fits without a test
  const Outcome own = pneuma("material fitted.yaml --fit 1 --strain '20 %'");
  EXPECT_NEAR(number_after(own.text, "{stress: ") / 16, 1, 1e-6) << own.text;
}

TEST_F(MaterialBench, FoilsThatFlowAreStifferTheFasterTheyArePulled) {
  // Perzyna, epsilon 1: in steady flow the stress exceeds the yield stress by its product with mu and the plastic rate;
  // no hardening, small strain: S = 20 MPa (1 + 10 s x rate) once the elastic strain has settled
  file("v.yaml", "foil: {law: j2, E: 1000 MPa, nu: 0.45, hardening: [{stress: 20 MPa, modulus: 0 MPa}], strain: small, "
                 "viscosity: {model: perzyna, mu: 10 s, epsilon: 1}}\n");
  const Outcome run = pneuma("material v.yaml --ratios 1:0 --rate 0.001,0.05 --strain '20 %' --csv v.csv --svg v.svg");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("0.001 1/s"));
  std::istringstream row(run.text.substr(run.text.find("\n        20") + 1));
  double strain = 0, slow = 0, fast = 0;
  row >> strain >> slow >> fast;
  // d(Green-Lagrange)/dt = stretch x rate at the end; nominal stress = stretch x S; the law lags by 0.2 s of 4 s
  EXPECT_NEAR(slow / (1.2 * 20 * (1 + 10 * 1.2 * 0.001)), 1, 2e-3);
  EXPECT_NEAR(fast / (1.2 * 20 * (1 + 10 * 1.2 * 0.05)), 1, 2e-2);
  EXPECT_TRUE(well_formed(text_of("v.svg")));
  // its own curve as a test, by the times in the file: the fast one
  std::istringstream lines(text_of("v.csv"));
  std::string line, data = "time [s], strain_1 [-], stress_1 [MPa]\n";
  while (std::getline(lines, line)) {
    const std::regex fast_row("foil, uniaxial, 0.05, loading, ([^,]+), ([^,]+), [^,]+, ([^,]+), .*");
    std::smatch cells;
    if (std::regex_match(line, cells, fast_row))
      data += fmt::format("{}, {}, {}\n", cells[1].str(), cells[2].str(), cells[3].str());
  }
  file("t.csv", data);
  const Outcome against = pneuma("material v.yaml --ratios 1:0 --strain '20 %' --data t.csv");
  EXPECT_LT(number_after(against.text, "101 points): rms"), 1e-5) << against.text; // nine digits are written
}

TEST_F(MaterialBench, ValuesFollowTheTemperatureWithinTheirTable) {
  file("t.yaml", "foil: {law: elastic, E: 1000 MPa, nu: 0.45, temperature: [{at: 43 degC, E: 600 MPa}]}\n");
  const auto stress = [&](const std::string& words) {
    const Outcome run = pneuma("material t.yaml --ratios 1:0 " + words);
    EXPECT_EQ(run.code, 0) << run.text;
    return number_after(run.text, "\n        10");
  };
  EXPECT_NEAR(stress("") / (elastic(0.1) / 0.9), 1, 5e-4);
  EXPECT_NEAR(stress("--temperature '33 degC'") / (elastic(0.1) / 0.9 * 0.8), 1, 5e-4);
  const Outcome run = pneuma("material t.yaml --temperature '50 degC'");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.text, HasSubstr("23 to 43 degC"));
  EXPECT_THAT(pneuma("material m.yaml foil --temperature '50 degC'").text,
              HasSubstr("does not depend on the temperature"));
}

TEST_F(MaterialBench, WhatIsWrongIsSaidWithItsPlace) {
  const auto fails = [&](const std::string& words, const std::string& message) {
    const Outcome run = pneuma("material " + words);
    EXPECT_EQ(run.code, 2) << words << '\n' << run.text;
    EXPECT_THAT(run.text, HasSubstr(message)) << words;
  };
  fails("", "MATERIALS.yaml is missing");
  fails("absent.yaml", "absent.yaml` cannot be read");
  fails("m.yaml fiol", "m.yaml: there is no material `fiol`; did you mean `foil`?; materials: foil, rubber");
  fails("m.yaml --stran 1", "did you mean `--strain`?");
  fails("m.yaml --strain '-1 %'", "--strain");
  fails("m.yaml --strain '5 mm'", "--strain");
  fails("m.yaml --steps 3", "from 10 to 100000");
  fails("m.yaml --ratios 2", "no ratio of stresses");
  fails("m.yaml --ratios shear --true", "has no meaning in shear");
  fails("m.yaml --rate 0", "--rate: `0` is not positive");
  fails("m.yaml --ratios 1:0,1:1,2:1,1:2,3:1,1:3,4:1,1:4,5:1,1:5,6:1 --svg p.svg",
        "22 curves do not fit into one picture");
  fails("m.yaml --svg p.png", "does not end in .svg");
  fails("m.yaml --csv", "--csv needs a value");
  fails("m.yaml --data absent.csv", "--data: the file `absent.csv` cannot be read");
  file("hole.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n2,\n3, 27\n");
  fails("m.yaml --data hole.csv", "hole.csv:3:3: a hole");
  file("word.csv", "strain_1 [%], stress_1 [MPa]\n1, nine\n");
  fails("m.yaml --data word.csv", "word.csv:2:4: `stress_1` must be a plain number");
  file("many.csv", "strain_1 [%], stress_1 [MPa], stress_2 [MPa]\n1, 9, 0\n2, 9, 9\n");
  fails("m.yaml --data many.csv", "no common ratio");
  file("few.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n2, 18\n");
  fails("m.yaml --data few.csv --fit 1", "name one of the 2");
  fails("m.yaml foil --data few.csv --fit 1",
        "has 2 points in tension up to its largest strain, fewer than the 3 that so many branches take");
  file("line.csv", "strain_1 [%], stress_1 [MPa]\n1, 9\n2, 18\n3, 27\n4, 36\n");
  fails("m.yaml foil --data line.csv --fit 1", "`line` does not yield");
  file("zero.csv", "strain_1 [%], stress_1 [MPa]\n1, 0\n2, 0\n");
  fails("m.yaml --data zero.csv", "zero.csv: no row with a weight has a stress");
  fails("m.yaml -s 1", "unknown option `-s`");
  fails("m.yaml foil --data few.csv --true", "leave --data out");
  file("bad.yaml", "foil:\n  law: elastic\n  E: 900 MPa\n  nu: 0.7\n");
  fails("bad.yaml", "bad.yaml:4:7");
}

TEST_F(MaterialBench, RatesOfFoilsThatKnowNoTimeAreOnlyNoted) {
  const Outcome run = pneuma("material m.yaml foil --rate 0.1,'1 %/min'");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.text, HasSubstr("does not depend on the rate"));
}

TEST_F(MaterialBench, CurvesEndWhereTheLawDoes) {
  // St. Venant-Kirchhoff has no width left where E22 = -nu E11 = -1/2: at 79.5 %
  const Outcome run = pneuma("material m.yaml foil --strain 2 --ratios 1:0");
  EXPECT_EQ(run.code, 0);
  EXPECT_NEAR(number_after(run.text, "uniaxial ends at a strain of"), 79.5, 2); // a step
  EXPECT_EQ(pneuma("material --help").code, 0);
}

} // namespace
} // namespace pneuma::tests
