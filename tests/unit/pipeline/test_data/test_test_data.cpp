// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <ostream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/test_data/test_data.h"

namespace pneuma::pipeline::test_data {
namespace {

std::vector<Row> read_good(const std::string& text) {
  std::vector<yaml::Problem> problems;
  std::vector<Row> rows = parse(text, "t.csv", Measure::engineering, {}, problems);
  for (const yaml::Problem& problem : problems) ADD_FAILURE() << to_string(problem);
  return rows;
}

TEST(TestData, AreInSiWhateverTheUnitsAndTheOrderOfColumns) {
  const std::vector<Row> rows = read_good("stress_1 [MPa], strain_1 [%],temperature [degC] ,weight, time [min]\n"
                                          "4.5, 0.5, 23, 2, 0\n"
                                          "9, 1, 24.5, 1, 1.5\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].stress_1, 9e6);
  EXPECT_EQ(rows[1].strain_1, 0.01);
  EXPECT_EQ(rows[1].temperature, 297.65);
  EXPECT_EQ(rows[1].time, 90);
  EXPECT_EQ(rows[0].weight, 2);
  EXPECT_EQ(rows[1].line, 3);
}

TEST(TestData, WithoutAColumnWereNotMeasured) {
  const Row row = read_good("strain_1 [-], stress_1 [Pa]\n0.01, 1e6\n").at(0);
  for (const double value : {row.strain_2, row.stress_2, row.shear_strain, row.shear_stress, row.time, row.temperature})
    EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(row.weight, 1);
}

TEST(TestData, CommentsBlankLinesAndLineEndsOfOtherSystemsAreNothingSpecial) {
  const std::vector<Row> rows =
      read_good("\xEF\xBB\xBF# foil A\r\n\r\nstrain_1 [-],stress_1 [Pa]\r\n  # first\r\n0.01,\t1e6\r\n0.02,2e6");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].line, 5);
  EXPECT_EQ(rows[1].stress_1, 2e6);
}

TEST(TestData, ColumnsMayBeSeparatedBySemicolonsOrTabs) {
  for (const char* text :
       {"strain_1 [%];stress_1 [MPa];weight\n0.5;4.5;2\n",
        "\"strain_1 [%]\";\"stress_1 [MPa]\";\"weight\"\n0.5;4.5;2\n",
        "strain_1 [%] ; stress_1 [MPa];weight\n0,5 ; 4,5;2\n", "strain_1 [%]\tstress_1 [MPa]\tweight\n0.5\t 4.5\t2\n",
        "strain_1 [%]\tstress_1 [MPa]\tweight\n5,0e-1\t4,5\t2\n"}) {
    const std::vector<Row> rows = read_good(text);
    ASSERT_EQ(rows.size(), 1u) << text;
    EXPECT_EQ(rows[0].strain_1, 0.005) << text;
    EXPECT_EQ(rows[0].stress_1, 4.5e6) << text;
    EXPECT_EQ(rows[0].weight, 2) << text;
  }
}

TEST(TestData, ConvertThereAndBackToRounding) {
  Row row;
  row.strain_1 = 0.21;
  row.stress_1 = 24.2e6;
  row.strain_2 = -0.07;
  row.stress_2 = 3e6;
  const Row other = converted(row, Measure::engineering, Measure::green_lagrange);
  EXPECT_NEAR(other.strain_1, 0.5 * (1.21 * 1.21 - 1), 1e-16); // (l^2 - 1) / 2, to rounding
  EXPECT_NEAR(other.stress_1, 20e6, 1e-8);                     // nominal stress over stretch, to rounding
  const Row back = converted(other, Measure::green_lagrange, Measure::engineering);
  EXPECT_NEAR(back.strain_1, row.strain_1, 1e-15);
  EXPECT_NEAR(back.strain_2, row.strain_2, 1e-15);
  EXPECT_NEAR(back.stress_1, row.stress_1, 1e-7);
  EXPECT_NEAR(back.stress_2, row.stress_2, 1e-8);
}

TEST(TestData, SmallStrainsConvertToTheLastDigits) {
  Row row;
  row.strain_1 = 1e-12;
  row.stress_1 = 1;
  // e = E - E^2 / 2 ...
  EXPECT_NEAR(converted(row, Measure::green_lagrange, Measure::engineering).strain_1, 1e-12, 1e-24);
  EXPECT_NEAR(converted(row, Measure::engineering, Measure::green_lagrange).strain_1, 1e-12, 1e-24);
}

struct Bad {
  const char* claim;
  const char* text;
  const char* message; // all of the first problem
};

std::ostream& operator<<(std::ostream& out, const Bad& bad) {
  return out << bad.claim;
}

class BadTestData : public testing::TestWithParam<Bad> {};

TEST_P(BadTestData, AreToldWhatAndWhere) {
  std::vector<yaml::Problem> problems;
  parse(GetParam().text, "t.csv", Measure::engineering, {"strain_1", "stress_1"}, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(to_string(problems.front()), testing::HasSubstr(GetParam().message));
  EXPECT_TRUE(problems.front().error);
}

const Bad cases[] = {
    {"Hole", "strain_1 [-], stress_1 [MPa], strain_2 [-]\n0.01, 9, 0.01\n0.02, , 0.02\n",
     "t.csv:3:7: a hole: `stress_1` has no value here; leave the row out, or keep rows without `stress_1` in a file of "
     "their own"},
    {"NoNumber", "strain_1 [-], stress_1 [MPa]\n0.01, n/a\n",
     "t.csv:2:7: `stress_1` must be a plain number, not `n/a`"},
    {"NotANumber", "strain_1 [-], stress_1 [MPa]\nnan, 5\n", "t.csv:2:1: `strain_1` must be a plain number, not `nan`"},
    {"ShortRow", "strain_1 [-], stress_1 [MPa]\n0.01\n",
     "t.csv:2:1: 1 cell stands under 2 columns: commas must separate them, as in the header"},
    {"DecimalCommas", "strain_1 [-], stress_1 [MPa]\n0,01, 9,5\n",
     "t.csv:2:1: 4 cells stand under 2 columns: where numbers have decimal commas, semicolons or tabs must separate "
     "the "
     "columns, in the header too"},
    {"SemicolonsUnderCommas", "strain_1 [-], stress_1 [MPa]\n0,01; 9,5\n",
     "t.csv:2:1: 3 cells stand under 2 columns: the header separates by commas, this line by semicolons"},
    {"CommasUnderSemicolons", "strain_1 [-]; stress_1 [MPa]\n0.01, 9.5\n",
     "t.csv:2:1: 1 cell stands under 2 columns: the header separates by semicolons, this line by commas"},
    {"ShortRowOfDecimalCommas", "strain_1 [%]; stress_1 [MPa]\n0,5; 4,5\n1,0\n",
     "t.csv:3:1: 1 cell stands under 2 columns: semicolons must separate them, as in the header"},
    {"DecimalPointAmongCommas", "strain_1 [%]; stress_1 [MPa]\n0,5; 4.5\n",
     "t.csv:2:6: `4.5`: decimal commas and points in one file; write one of them, and nothing between thousands"},
    {"PointBetweenThousands", "strain_1 [%]; stress_1 [kPa]\n1; 9.000,5\n",
     "t.csv:2:4: `9.000,5`: decimal commas and points in one file"},
    {"TwoDecimalCommas", "strain_1 [%]; stress_1 [Pa]\n1; 9,000,000\n",
     "t.csv:2:4: `stress_1` must be a plain number, not `9,000,000`"},
    {"BlanksBetweenColumns", "strain_1 [%] stress_1 [MPa]\n1 9\n",
     "t.csv:1:13: only blanks stand between the columns; write commas, semicolons or tabs"},
    {"BarsBetweenColumns", "strain_1 [%] | stress_1 [MPa]\n1 | 9\n",
     "t.csv:1:13: `|` stands between the columns; write commas, semicolons or tabs"},
    {"UnknownColumn", "strain_1 [-], stress_1 [MPa], stres_2 [MPa]\n0.01, 9, 9\n",
     "t.csv:1:31: unknown column `stres_2`; did you mean `stress_2`?; known: strain_1,"},
    {"NoHeader", "1, 9\n2, 15\n",
     "t.csv:1:1: the first line must name the columns with their units, as in `strain_1 [%], stress_1 [MPa]`"},
    {"RoundBrackets", "strain_1 (%), stress_1 [MPa]\n1, 9\n",
     "t.csv:1:1: `strain_1 (%)`: units stand in square brackets, as in `strain_1 [%]`"},
    {"ColumnWithoutName", "strain_1 [%]; stress_1 [MPa];\n1; 9;\n",
     "t.csv:1:30: a column without a name; take its separator out of all lines"},
    {"NoWeight", "strain_1 [%], stress_1 [MPa], weight\n1, 9, 0\n", "no row has a `weight` above 0"},
    {"ColumnTwice", "strain_1 [-], stress_1 [MPa], stress_1 [Pa]\n0.01, 9, 9\n",
     "t.csv:1:31: a second column `stress_1`"},
    {"MissingColumn", "# test\nstrain_1 [-]\n0.01\n", "t.csv:2:1: the column `stress_1` is missing"},
    {"NoUnit", "strain_1, stress_1 [MPa]\n0.01, 9\n",
     "t.csv:1:1: the column `strain_1` says no unit; write `strain_1 [-]`"},
    {"UnitOfAnotherKind", "strain_1 [-], stress_1 [mm]\n0.01, 9\n",
     "t.csv:1:15: unit of `stress_1`: `1 mm` has a unit of another kind; expected a pressure or stress"},
    {"OpenBracket", "strain_1 [-], stress_1 [MPa\n0.01, 9\n",
     "t.csv:1:15: `stress_1 [MPa` lacks the closing bracket of its unit"},
    {"NothingLeftOfTheLength", "strain_1 [-], stress_1 [MPa]\n-1, 9\n",
     "t.csv:2:1: `strain_1` must be above -1, where nothing is left of the length, not -1"},
    {"NegativeWeight", "strain_1 [-], stress_1 [MPa], weight\n0.01, 9, -1\n",
     "t.csv:2:10: `weight` must be at least 0, not -1"},
    {"TimeRunsBackwards", "strain_1 [-], stress_1 [MPa], time [s]\n0.01, 9, 5\n0.02, 18, 4\n",
     "t.csv:3:11: the time runs backwards: 4 s after 5 s"},
    {"Empty", "# nothing\n", "the file is empty; test data begin with a header such as"},
    {"NoRows", "strain_1 [-], stress_1 [MPa]\n", "the file has a header and no rows"}};

INSTANTIATE_TEST_SUITE_P(Cases, BadTestData, testing::ValuesIn(cases),
                         [](const auto& tested) { return std::string(tested.param.claim); });

TEST(BadTestDataFile, OfASpreadsheetIsNotReadAsText) {
  std::vector<yaml::Problem> problems;
  using namespace std::string_literals;
  parse("\xFF\xFEs\0t\0r\0"s, "t.csv", Measure::engineering, {}, problems); // UTF-16
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(to_string(problems.front()), testing::HasSubstr("t.csv:1:1: the file is no text in UTF-8"));
}

std::string warnings_about(const std::string& text) {
  std::vector<yaml::Problem> problems;
  EXPECT_FALSE(parse(text, "t.csv", Measure::engineering, {}, problems).empty());
  std::string all;
  for (const yaml::Problem& problem : problems) {
    EXPECT_FALSE(problem.error) << to_string(problem);
    all += to_string(problem) + "\n";
  }
  return all;
}

class OddTestData : public testing::TestWithParam<Bad> {};

TEST_P(OddTestData, AreReadAndQuestioned) {
  EXPECT_THAT(warnings_about(GetParam().text), testing::HasSubstr(GetParam().message));
}

const Bad odd[] = {
    {"PercentAsFraction", "strain_1 [-], stress_1 [MPa]\n0, 0\n2, 18\n 8, 22\n9, 23\n",
     "t.csv:4:2: warning: `strain_1` of 8 [-] is 800 %; is the unit `strain_1 [%]` meant?\n"},
    {"MegapascalsAsPascals", "strain_1 [%], stress_1 [Pa]\n0.1, 0.9\n1, 9\n2, 18\n",
     "t.csv:3:1: warning: 9e-06 MPa at a strain of 1 % mean a modulus of 0.0009 MPa, where foils have 1 MPa to 100 "
     "GPa; "
     "are the units of `stress_1` and `strain_1` right?\n"},
    {"PascalsAsMegapascals", "shear_strain [-], shear_stress [MPa]\n0.01, 3e6\n",
     "t.csv:2:1: warning: 3e+06 MPa at a strain of 1 % mean a modulus of 3e+08 MPa"},
    {"CelsiusAsKelvin", "strain_1 [%], stress_1 [MPa], temperature [K]\n1, 9, 23\n2, 16, 23\n",
     "t.csv:2:7: warning: `temperature` of 23 [K] is 23 K; is the unit right?\n"},
    {"GripsThatSlip", "strain_1 [%], stress_1 [MPa]\n1, 9\n2, 16\n3, 18\n4, 12\n5, 11\n",
     "t.csv:5:1: warning: `stress_1` falls from 18 MPa (line 4) to 12 MPa while `strain_1` rises from 3 % to 4 %: do "
     "the "
     "grips slip, or is the foil torn?\n"},
    {"StrainsAgain", "strain_1 [%], stress_1 [MPa]\n1, 9\n2, 16\n2, 17\n3, 18\n",
     "t.csv:4:1: warning: the strains of line 3 again, with other stresses; without a column `time` one of them is too "
     "many\n"}};

INSTANTIATE_TEST_SUITE_P(Cases, OddTestData, testing::ValuesIn(odd),
                         [](const auto& tested) { return std::string(tested.param.claim); });

TEST(TestData, AreNotQuestionedForNoiseUnloadingRelaxationOrAGridOfStrains) {
  EXPECT_EQ(warnings_about("strain_1 [%], stress_1 [MPa]\n1, 9\n2, 15.8\n2.1, 15.6\n2, 15.7\n3, 16\n"), "");
  EXPECT_EQ(warnings_about("strain_1 [%], stress_1 [MPa]\n1, 9\n5, 18\n4, 9\n3, 0\n3.5, 4.5\n5, 18\n"), "");
  EXPECT_EQ(warnings_about("strain_1 [%], stress_1 [MPa], time [s]\n1, 9, 0\n1, 7, 60\n1, 6, 600\n"), "");
  // two tests in one file, and elastic foil over a grid: stress_1 falls where strain_2 does
  EXPECT_EQ(warnings_about("strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n1, -0.45, 9, 0\n3, -1.4, 18, "
                           "0\n0.5, 0.5, 9, 9\n1, 1, 16, 16\n"),
            "");
  std::string grid = "strain_1 [%], strain_2 [%], stress_1 [MPa], stress_2 [MPa]\n";
  for (int i = -2; i <= 4; ++i) {
    for (int j = -2; j <= 4; ++j) {
      grid +=
          fmt::format("{}, {}, {}, {}\n", 0.1 * i, 0.1 * j, 11.3 * 0.1 * (i + 0.45 * j), 11.3 * 0.1 * (j + 0.45 * i));
    }
  }
  EXPECT_EQ(warnings_about(grid), "");
}

} // namespace
} // namespace pneuma::pipeline::test_data
