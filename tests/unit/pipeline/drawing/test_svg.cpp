// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/pipeline/drawing/example.h"
#include "tests/unit/pipeline/drawing/well_formed.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::tests {
namespace {

using namespace pipeline::drawing;
using testing::HasSubstr;

std::string svg_of(const Drawing& drawing) {
  const TemporaryFolder folder;
  write_svg(drawing, folder / "strip.svg");
  return bytes_of(folder / "strip.svg");
}

TEST(Svg, TheCheckForWellFormedXmlSeesFaults) {
  EXPECT_TRUE(well_formed("<?xml version=\"1.0\"?><a><b x=\"1\"/>t &amp; u</a>"));
  EXPECT_FALSE(well_formed("<a><b></a></b>"));
  EXPECT_FALSE(well_formed("<a>t & u</a>"));
  EXPECT_FALSE(well_formed("<a>t < u</a>"));
  EXPECT_FALSE(well_formed("<a>"));
}

TEST(Svg, IsWellFormedWhateverTheTexts) {
  const std::string svg = svg_of(example_drawing());
  EXPECT_TRUE(well_formed(svg)) << svg;
  EXPECT_THAT(svg, HasSubstr(">U1 &lt;S1 &amp; S2&gt;</text>"));
  EXPECT_THAT(svg, HasSubstr("<title>foil &quot;upper&quot; &lt;A&amp;B&gt;</title>"));
  EXPECT_TRUE(well_formed(svg_of({})));
}

TEST(Svg, HasAUserUnitAMillimetreAndLooksUpwards) {
  const std::string svg = svg_of({"", {{"CUT", 7}}, {{"CUT", true, {{0, 0}, {3.9, 0}, {3.9, 1}, {0, 1}}}}, {}});
  // margin: a hundredth of 3900 and 1
  EXPECT_THAT(svg,
              HasSubstr(R"(width="3980.000mm" height="1080.000mm" viewBox="-40.000 -1040.000 3980.000 1080.000")"));
  EXPECT_THAT(svg, HasSubstr(R"(<polygon points="0.000,0.000 3900.000,0.000 3900.000,-1000.000 0.000,-1000.000"/>)"));
}

TEST(Svg, HasAGroupALayer) {
  const std::string svg = svg_of(example_drawing());
  EXPECT_THAT(svg, HasSubstr(R"(<g id="CUT" stroke="#000000">)"));
  EXPECT_THAT(svg, HasSubstr(R"(<g id="NET" stroke="#0040c0">)"));
  EXPECT_THAT(svg, HasSubstr(R"(<g id="TEXT" stroke="#008030">)"));
  EXPECT_LT(svg.find("<polygon"), svg.find("id=\"NET\""));
  EXPECT_GT(svg.find("<polyline"), svg.find("id=\"NET\""));
}

} // namespace
} // namespace pneuma::tests
