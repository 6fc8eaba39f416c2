// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/drawing/chart.h"
#include "tests/unit/pipeline/drawing/well_formed.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::tests {
namespace {

using namespace pipeline::drawing;
using testing::HasSubstr;
using testing::Not;

std::string svg_of(const Chart& chart) {
  const TemporaryFolder folder;
  write_chart(chart, folder / "chart.svg");
  return bytes_of(folder / "chart.svg");
}

struct Frame {
  double left = 0, top = 0, width = 0, height = 0;
};

Frame frame_of(const std::string& svg) {
  const std::regex rect(R"re(class="frame" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)")re");
  std::smatch m;
  if (!std::regex_search(svg, m, rect)) return {};
  return {std::stod(m[1]), std::stod(m[2]), std::stod(m[3]), std::stod(m[4])};
}

// Where the circles stand, as parts of the frame from its lower left corner; without those of the legend.
std::vector<Vec2> circles_in(const std::string& svg) {
  const Frame frame = frame_of(svg);
  const std::string curves = svg.substr(0, svg.find("class=\"legend\""));
  const std::regex circle(R"re(<circle cx="([\d.]+)" cy="([\d.]+)")re");
  std::vector<Vec2> found;
  for (auto i = std::sregex_iterator(curves.begin(), curves.end(), circle); i != std::sregex_iterator(); ++i) {
    found.emplace_back((std::stod((*i)[1]) - frame.left) / frame.width,
                       1 - (std::stod((*i)[2]) - frame.top) / frame.height);
  }
  return found;
}

Chart example() {
  return {"Deflection <B8> & \"more\"",
          {"pressure, kPa"},
          {"deflection, mm"},
          {{"exact", {{0, 0}, {100, 33}, {400, 53}}, Stroke::dashed, Mark::none, 0},
           {"T6 & Q9", {{0, 0}, {100, 33}, {250, 45}, {400, 53}}, Stroke::solid, Mark::circle, 1}}};
}

TEST(Chart, IsWellFormedWhateverTheTexts) {
  const std::string svg = svg_of(example());
  EXPECT_TRUE(well_formed(svg)) << svg;
  EXPECT_THAT(svg, HasSubstr("<title>Deflection &lt;B8&gt; &amp; &quot;more&quot;</title>"));
  EXPECT_THAT(svg, HasSubstr(">T6 &amp; Q9</text>"));
  EXPECT_THAT(svg, HasSubstr(">pressure, kPa</text>"));
}

TEST(Chart, IsTheSameTextEveryTime) {
  EXPECT_EQ(svg_of(example()), svg_of(example()));
}

TEST(Chart, PutsPointsOnLinearAxesWhereTheyBelong) {
  // axes reach from tick to tick: 0 to 400 and 0 to 60
  const std::vector<Vec2> at = circles_in(svg_of(example()));
  ASSERT_EQ(at.size(), 4u);
  constexpr double rounding = 5e-5; // 0.01 px of 300
  EXPECT_LT((at[0] - Vec2(0, 0)).norm(), rounding);
  EXPECT_LT((at[1] - Vec2(0.25, 33 / 60.0)).norm(), rounding);
  EXPECT_LT((at[3] - Vec2(1, 53 / 60.0)).norm(), rounding);
}

TEST(Chart, PutsPointsOnLogarithmicAxesWhereTheyBelong) {
  Chart chart = example();
  chart.x = {"unknowns", Scale::logarithmic, std::array{10.0, 1e5}};
  chart.y = {"error", Scale::logarithmic, std::array{1e-6, 1.0}};
  chart.curves = {{"", {{10, 1}, {100, 1e-3}, {1000, 1e-6}, {3e6, 1e-3}}, Stroke::solid, Mark::circle, 1}};
  const std::string svg = svg_of(chart);
  const std::vector<Vec2> at = circles_in(svg);
  ASSERT_EQ(at.size(), 3u); // none outside the range
  EXPECT_LT((at[0] - Vec2(0, 1)).norm(), 5e-5);
  EXPECT_LT((at[1] - Vec2(0.25, 0.5)).norm(), 5e-5);
  EXPECT_LT((at[2] - Vec2(0.5, 0)).norm(), 5e-5);
  EXPECT_THAT(svg, HasSubstr(">10⁻⁶</text>"));
  EXPECT_THAT(svg, HasSubstr(">10⁵</text>"));
}

TEST(Chart, LabelsOneTwoAndFiveWhereALogarithmicAxisIsShort) {
  Chart chart = example();
  chart.y.scale = Scale::logarithmic;
  chart.curves = {{"", {{0, 30}, {1, 800}}, Stroke::solid, Mark::none, 1}};
  const std::string svg = svg_of(chart);
  for (const char* label : {">50</text>", ">100</text>", ">200</text>", ">500</text>"}) {
    EXPECT_THAT(svg, HasSubstr(label));
  }
}

TEST(Chart, LabelsAnAxisOfLessThanADecadeAsIfItWereLinear) {
  Chart chart = example();
  chart.y.scale = Scale::logarithmic;
  chart.curves = {{"", {{0, 3.1}, {1, 3.9}}, Stroke::solid, Mark::none, 1}};
  const std::string svg = svg_of(chart);
  for (const char* label : {">3.2</text>", ">3.4</text>", ">3.8</text>"}) EXPECT_THAT(svg, HasSubstr(label));
}

TEST(Chart, LabelsOneTwoOrFiveTimesAPowerOfTen) {
  Chart chart = example();
  chart.curves = {{"", {{-0.3, 0}, {0.13, 7}}, Stroke::solid, Mark::none, 1}};
  const std::string svg = svg_of(chart);
  for (const char* label : {">-0.3</text>", ">0.0</text>", ">0.2</text>", ">7</text>"}) {
    EXPECT_THAT(svg, HasSubstr(label));
  }
  EXPECT_THAT(svg, Not(HasSubstr("-0.0<")));
}

TEST(Chart, OfOnePointHasRoomAroundIt) {
  for (const Scale scale : {Scale::linear, Scale::logarithmic}) {
    const Chart chart{"", {"x", scale, {}}, {"y", scale, {}}, {{"", {{3, 5}}, Stroke::solid, Mark::circle, 1}}};
    const std::vector<Vec2> at = circles_in(svg_of(chart));
    ASSERT_EQ(at.size(), 1u);
    EXPECT_GT(at[0].minCoeff(), 0.1);
    EXPECT_LT(at[0].maxCoeff(), 0.9);
  }
}

std::string refusal(const Chart& chart) {
  try {
    svg_of(chart);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Chart, RefusesWhatItCannotShow) {
  Chart chart = example();
  chart.title = "T";
  chart.curves = {};
  EXPECT_EQ(refusal(chart), "chart \"T\": no point to show");
  chart.curves = {{"a", {}, Stroke::solid, Mark::none, 1}};
  EXPECT_EQ(refusal(chart), "chart \"T\": no point to show");
  chart.curves[0].points = {{1, std::nan("")}};
  EXPECT_EQ(refusal(chart), "chart \"T\": a point of \"a\" is not finite");
  chart.curves[0].points = {{1, 0}};
  chart.y.scale = Scale::logarithmic;
  EXPECT_EQ(refusal(chart), "chart \"T\": a point of \"a\" has no logarithm");
  chart.curves[0].points = {{1, 1}};
  chart.y.range = {1.0, 1.0};
  EXPECT_EQ(refusal(chart), "chart \"T\": the range of \"deflection, mm\" is empty");
  chart.y.range = {};
  chart.curves[0].name = std::string(200, 'a');
  EXPECT_EQ(refusal(chart), "chart \"T\": its names leave no room for the curves");
}

} // namespace
} // namespace pneuma::tests
