// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "tests/unit/pipeline/drawing/dxf_reader.h"
#include "tests/unit/pipeline/drawing/example.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::tests {
namespace {

using namespace pipeline::drawing;

class DxfReadBack : public testing::Test {
protected:
  TemporaryFolder folder;
  DxfContents read_back(const Drawing& drawing) {
    write_dxf(drawing, folder / "strip.dxf");
    return DxfContents(folder / "strip.dxf");
  }
};

TEST_F(DxfReadBack, HasLayersWithTheirColours) {
  EXPECT_THAT(read_back(example_drawing()).layers,
              testing::UnorderedElementsAre(testing::Pair("0", 7), testing::Pair("CUT", 7), testing::Pair("NET", 5),
                                            testing::Pair("TEXT", 3)));
}

TEST_F(DxfReadBack, HasLinesInMillimetresTrueToScale) {
  const Drawing drawing = example_drawing();
  const DxfContents contents = read_back(drawing);
  ASSERT_EQ(contents.lines.size(), drawing.lines.size());
  for (std::size_t i = 0; i < drawing.lines.size(); ++i) {
    EXPECT_EQ(contents.lines[i].layer, drawing.lines[i].layer);
    EXPECT_EQ(contents.lines[i].closed, drawing.lines[i].closed);
    ASSERT_EQ(contents.lines[i].points.size(), drawing.lines[i].points.size());
    for (std::size_t k = 0; k < drawing.lines[i].points.size(); ++k) {
      EXPECT_LT((contents.lines[i].points[k] - 1e3 * drawing.lines[i].points[k]).norm(), 1e-6);
    }
  }
}

TEST_F(DxfReadBack, HasTextsWithPlaceHeightAndAngle) {
  const DxfContents contents = read_back(example_drawing());
  ASSERT_EQ(contents.texts.size(), 2u);
  EXPECT_EQ(contents.texts[0].text, "U1 <S1 & S2>");
  EXPECT_EQ(contents.texts[0].layer, "TEXT");
  EXPECT_LT((contents.texts[0].at - base::Vec2(500, 250)).norm(), 1e-6);
  EXPECT_NEAR(contents.texts[0].height, 40, 1e-6);
  EXPECT_NEAR(contents.texts[1].angle, 0.5, 1e-9);
}

TEST_F(DxfReadBack, SaysThatItIsR12InMillimetresAndHowLarge) {
  const DxfContents contents = read_back(example_drawing());
  EXPECT_EQ(contents.strings.at("$ACADVER"), "AC1009");
  EXPECT_EQ(contents.integers.at("$INSUNITS"), 4);
  EXPECT_LT((contents.vectors.at("$EXTMIN") - base::Vec2(-30.1234567, -1)).norm(), 1e-6);
  EXPECT_LT((contents.vectors.at("$EXTMAX") - base::Vec2(12345.6789012, 1500)).norm(), 1e-6);
}

TEST_F(DxfReadBack, HoldsNamesThatR12Allows) {
  const DxfContents contents = read_back({"",
                                          {{"my layer.1", 1}},
                                          {{"my layer.1", true, {{0, 0}, {1, 0}, {0, 1}}}},
                                          {{"TEXT", {0, 0}, 1, 0, "S\n\xc3\xbc"}}});
  EXPECT_EQ(contents.layers.count("MY_LAYER_1"), 1u);
  EXPECT_EQ(contents.lines.at(0).layer, "MY_LAYER_1");
  EXPECT_EQ(contents.texts.at(0).text, "S___");
}

TEST_F(DxfReadBack, OfAnEmptyDrawingIsEmpty) {
  const DxfContents contents = read_back({});
  EXPECT_TRUE(contents.lines.empty());
  EXPECT_EQ(contents.vectors.at("$EXTMAX"), base::Vec2(0, 0));
}

TEST_F(DxfReadBack, LeavesNoOtherFileBehind) {
  read_back(example_drawing());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Dxf, ThatCannotBeWrittenSaysWhy) {
  try {
    write_dxf(example_drawing(), "/nowhere/strip.dxf");
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_EQ(error.code(), base::ExitCode::machine_refuses);
    EXPECT_THAT(error.what(), testing::StartsWith("`/nowhere/strip.dxf` cannot be written: No such file or directory"));
  }
}

} // namespace
} // namespace pneuma::tests
