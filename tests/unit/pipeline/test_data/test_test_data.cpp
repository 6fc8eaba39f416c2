// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <ostream>

#include <gmock/gmock.h>

#include "pipeline/test_data/test_data.h"

namespace pneuma::pipeline::test_data {
namespace {

std::vector<Row> read_good(const std::string& text) {
  std::vector<schema::Problem> problems;
  std::vector<Row> rows = parse(text, "t.csv", Measure::engineering, {}, problems);
  for (const schema::Problem& problem : problems) ADD_FAILURE() << to_string(problem);
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
  std::vector<schema::Problem> problems;
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
    {"ShortRow", "strain_1 [-], stress_1 [MPa]\n0.01\n", "t.csv:2:1: 1 cells stand under 2 columns"},
    {"DecimalCommas", "strain_1 [-], stress_1 [MPa]\n0,01, 9,5\n", "t.csv:2:1: 4 cells stand under 2 columns"},
    {"UnknownColumn", "strain_1 [-], stress_1 [MPa], stres_2 [MPa]\n0.01, 9, 9\n",
     "t.csv:1:31: unknown column `stres_2`; did you mean `stress_2`?; known: strain_1,"},
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

} // namespace
} // namespace pneuma::pipeline::test_data
