// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/fabrication.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/polygon.h"
#include "pipeline/drawing/drawing.h"
#include "tests/unit/pipeline/drawing/dxf_reader.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::tests {
namespace {

using namespace stages::pattern;
using base::Vec2;
using geometry::fabrication::Allowances;
using geometry::fabrication::FlatStrip;
using geometry::fabrication::Side;
using testing::HasSubstr;

Fabrication fabricate_into(const std::filesystem::path& folder, std::span<const StripSheet> strips,
                           const Allowances& given, const RollSheet& roll) {
  Fabrication made = fabricate("upper", strips, given, roll);
  pipeline::files::Outputs outputs(folder / "state.hdf", "");
  write_sheets("upper", made, outputs);
  return made;
}

constexpr double radius = 2.4; // of the foil's plan, m
const Allowances allowances = {0.006, 0.03, 0.5};

// A disc cut along y = -1.2, 0, 1.2 into two caps of two sides and two strips of four; the seams a little longer in the
// strips above them.
double seam_length(double y, bool above) {
  return 2 * std::sqrt(radius * radius - y * y) * (above ? 1.0005 : 1);
}

Side seam(const std::string& name, double y, bool above) {
  const double half = seam_length(y, above) / 2;
  Side side = {name, true, "", !above, 0, {}};
  for (int i = 0; i <= 40; ++i) side.points.emplace_back((above ? 1 : -1) * half * (i / 20.0 - 1), y);
  return side;
}

Side rim(const std::string& name, const Vec2& from, const Vec2& to) {
  Side side = {name, false, "", false, 0, {from}};
  const double start = std::atan2(from.y(), from.x());
  double turn = std::atan2(to.y(), to.x()) - start;
  if (turn < 0) turn += 2 * std::numbers::pi;
  for (int i = 1; i < 40; ++i) {
    const double angle = start + turn * i / 40;
    side.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  side.points.push_back(to);
  return side;
}

StripSheet strip(const std::string& name, const std::vector<Side>& seams) {
  FlatStrip flat = {name, {}};
  for (std::size_t i = 0; i < seams.size(); ++i) {
    flat.sides.push_back(seams[i]);
    flat.sides.push_back(rim("rim", seams[i].points.back(), seams[(i + 1) % seams.size()].points.front()));
  }
  return {flat, 0.002};
}

std::vector<StripSheet> disc() {
  return {strip("U1", {seam("S1", -1.2, false)}), strip("U2", {seam("S1", -1.2, true), seam("S2", 0, false)}),
          strip("U3", {seam("S2", 0, true), seam("S3", 1.2, false)}), strip("U4", {seam("S3", 1.2, true)})};
}

class PatternOfADisc : public testing::Test {
protected:
  TemporaryFolder folder;
  const Fabrication result = fabricate_into(folder.path(), disc(), allowances, {});

  std::vector<std::vector<std::string>> table(const std::string& name) const {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(bytes_of(folder / name));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      rows.emplace_back();
      for (std::string text; std::getline(fields, text, ',');) rows.back().push_back(text);
    }
    return rows;
  }
};

TEST_F(PatternOfADisc, HasFiguresOfStripsAndSeams) {
  ASSERT_EQ(result.strips.size(), 4u);
  EXPECT_NEAR(result.strips[1].width, 1.2, 1e-9);
  EXPECT_NEAR(result.strips[1].length, seam_length(0, false), 1e-9);
  EXPECT_NEAR(result.strips[0].width, radius - 1.2, 1e-9);
  EXPECT_NEAR(result.strips[0].cut_width, radius - 1.2 + 0.03 + 0.006, 1e-4);
  EXPECT_NEAR(result.net_area, std::numbers::pi * radius * radius, 0.03);
  EXPECT_GT(result.cut_area, result.net_area);
  ASSERT_EQ(result.seams.size(), 3u);
  EXPECT_EQ(result.seams[0].left, "U2");
  EXPECT_EQ(result.seams[0].right, "U1");
  EXPECT_NEAR(result.seams[1].mismatch(), 0.0005 * 2 * radius, 1e-12);
  EXPECT_NEAR(result.strips[2].seam_mismatch_max, 0.0005 * 2 * radius, 1e-12);
  EXPECT_NEAR(result.mismatch_per_length_max, 0.0005, 1e-6);
  EXPECT_NEAR(result.weld_length, (2 * seam_length(1.2, false) + seam_length(0, false)) * 1.00025, 1e-9);
}

TEST_F(PatternOfADisc, IsDrawnWhereTheStripsLieOnTheRoll) {
  const DxfContents dxf(folder / "upper.dxf");
  std::map<std::string, int> closed;
  std::map<std::string, double> area;
  for (const DxfContents::Line& line : dxf.lines) {
    if (!line.closed) continue;
    ++closed[line.layer];
    area[line.layer] += 1e-6 * geometry::signed_area(line.points);
  }
  EXPECT_EQ(closed["CUT"], 4);
  EXPECT_EQ(closed["NET"], 4);
  EXPECT_EQ(closed["DIM"], 1); // the roll
  EXPECT_NEAR(area["CUT"], result.cut_area, 1e-8);
  EXPECT_NEAR(area["NET"], result.net_area, 1e-8);
  EXPECT_NEAR(area["DIM"], result.nesting.length * 1.55, 1e-8);
  EXPECT_EQ(dxf.layers.size(), 7u); // and layer 0
  EXPECT_NEAR(dxf.vectors.at("$EXTMAX").x(), 1e3 * result.nesting.length, 1e-6);
}

TEST_F(PatternOfADisc, NamesNotchesAlikeOnBothStrips) {
  const DxfContents dxf(folder / "upper.dxf");
  std::map<std::string, int> texts;
  for (const DxfContents::Text& text : dxf.texts) ++texts[text.text];
  for (const char* notch : {"S1-1", "S1-8", "S2-1", "S2-9", "S3-8"}) EXPECT_EQ(texts[notch], 2) << notch;
  EXPECT_EQ(texts["S2-10"], 0);
  EXPECT_EQ(texts["U3"], 1);
  EXPECT_EQ(texts["S2 TO U3"], 2); // near both ends of the seam
  EXPECT_EQ(texts["S2 TO U2"], 2);
  EXPECT_EQ(texts["ROLL DIRECTION"], 4);
}

// corners of a text as drawn, mm
std::vector<Vec2> corners(const DxfContents::Text& text) {
  const Vec2 along(std::cos(text.angle), std::sin(text.angle));
  const Vec2 up = text.height * Vec2(-along.y(), along.x());
  const Vec2 end = text.at + pipeline::drawing::text_width(text.text, text.height) * along;
  return {text.at, end, end + up, text.at + up};
}

TEST_F(PatternOfADisc, HasTextsInsideTheStripsAndClearOfEachOther) {
  const DxfContents dxf(folder / "upper.dxf");
  std::vector<std::vector<Vec2>> drawn;
  for (const DxfContents::Text& text : dxf.texts) {
    if (text.text.find("ROLL 1550") != std::string::npos) continue; // beside the roll
    const std::vector<Vec2> box = corners(text);
    EXPECT_GT(text.height, 3) << text.text;
    const bool in_a_strip = std::any_of(dxf.lines.begin(), dxf.lines.end(), [&](const DxfContents::Line& line) {
      return line.layer == "NET" && std::all_of(box.begin(), box.end(), [&](const Vec2& corner) {
               return geometry::contains(line.points, corner);
             });
    });
    EXPECT_TRUE(in_a_strip) << text.text;
    for (const std::vector<Vec2>& other : drawn) {
      const auto in = [](const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
        return std::any_of(a.begin(), a.end(), [&](const Vec2& p) { return geometry::contains(b, p); });
      };
      EXPECT_FALSE(in(box, other) || in(other, box)) << text.text;
    }
    drawn.push_back(box);
  }
}

TEST_F(PatternOfADisc, HasDimensionsOfTheCut) {
  const DxfContents dxf(folder / "upper.dxf");
  std::vector<std::string> numbers;
  for (const DxfContents::Text& text : dxf.texts) {
    if (text.layer == "DIM") numbers.push_back(text.text);
  }
  for (const StripFigures& strip : result.strips) {
    EXPECT_THAT(numbers, testing::Contains(fmt::format("{:.1f}", 1e3 * strip.cut_width)));
    EXPECT_THAT(numbers, testing::Contains(fmt::format("{:.1f}", 1e3 * strip.cut_length)));
  }
}

TEST_F(PatternOfADisc, HasATableOfStrips) {
  const auto rows = table("upper_strips.csv");
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0][0], "name");
  EXPECT_EQ(rows[2][0], "U2");
  EXPECT_EQ(rows[2][1], "1200.00");
  EXPECT_EQ(rows[2][2], "4800.00");
  EXPECT_EQ(rows[2][8], "S1;S2");
  EXPECT_EQ(rows[2][10], "2.078;-2.400");
  for (const auto& row : rows) EXPECT_EQ(row.size(), 11u);
}

TEST_F(PatternOfADisc, HasATableOfSeams) {
  EXPECT_EQ(bytes_of(folder / "upper_seams.csv"),
            "name,left,right,length_left_mm,length_right_mm,mismatch_mm,mismatch_mm_per_m\n"
            "S1,U2,U1,4159.00,4156.92,2.078,0.4999\n"
            "S2,U3,U2,4802.40,4800.00,2.400,0.4999\n"
            "S3,U4,U3,4159.00,4156.92,2.078,0.4999\n");
}

TEST_F(PatternOfADisc, IsTheSameEveryTime) {
  const TemporaryFolder again;
  fabricate_into(again.path(), disc(), allowances, {});
  for (const char* name : {"upper.dxf", "upper.svg", "upper_strips.csv", "upper_seams.csv"}) {
    EXPECT_EQ(bytes_of(again / name), bytes_of(folder / name)) << name;
  }
}

TEST(Fabrication, RefusesANarrowRollUnlessItMayWiden) {
  const TemporaryFolder folder;
  const RollSheet narrow = {1.2, 0.01, 0.01, false};
  try {
    fabricate_into(folder.path(), disc(), allowances, narrow);
    FAIL();
  } catch (const base::GeometryError& error) {
    EXPECT_THAT(error.what(), HasSubstr("too wide for a roll of 1.200 m"));
    EXPECT_THAT(error.what(), HasSubstr("U1 (1.23"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const Fabrication result = fabricate_into(folder.path(), disc(), allowances, {1.2, 0.01, 0.01, true});
  EXPECT_NEAR(result.roll_width, result.strips[0].cut_width + 0.02, 1e-6);
}

TEST(Fabrication, QuotesNamesInTables) {
  const TemporaryFolder folder;
  std::vector<StripSheet> one = {strip("a \"b\", c", {})};
  one[0].flat.sides = {rim("south", {-1, -0.5}, {1, -0.5}), {"north", false, "", false, 0, {{1, -0.5}, {-1, -0.5}}}};
  fabricate_into(folder.path(), one, allowances, {3, 0, 0, true});
  EXPECT_THAT(bytes_of(folder / "upper_strips.csv"), HasSubstr("\n\"a \"\"b\"\", c\","));
}

} // namespace
} // namespace pneuma::tests
