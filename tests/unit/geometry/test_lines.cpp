// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domes.h"
#include "geometry/base/errors.h"
#include "geometry/rim.h"
#include "geometry/strips/lines.h"
#include "tests/unit/message_of.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using namespace pneuma::geometry::strips;
using pneuma::base::GeometryError;
using pneuma::tests::message_of;
using testing::HasSubstr;

strips::Surface dome(const Plan& plan, double sag, double size, ElementType element = ElementType::T3) {
  const Mesh mesh = domes::cushion(plan, {element, size, std::nullopt, Pattern::unstructured}, sag);
  return prepare(plan, mesh, mesh.blocks[0], mesh.nodes);
}

double position(const Plan& plan, double x, double y) {
  return rim_position(plan, {x, y});
}

const Plan square = Rectangle{4, 4};

TEST(GeodesicLine, OverTheMiddleOfADomeIsStraightInPlan) {
  const strips::Surface surface = dome(square, 0.48, 0.2);
  const CuttingLine line = geodesic_line(surface, position(square, 0, -2), position(square, 0, 2));
  EXPECT_EQ(line.plan.front(), Vec2(0, -2));
  EXPECT_EQ(line.plan.back(), Vec2(0, 2));
  for (const Vec2& p : line.plan) EXPECT_NEAR(p.x(), 0, 0.1);
}

TEST(GeodesicLine, OverARidgeStaysOnItWithEveryElement) {
  // shortest lines on its triangles lie 60 mm beside it; the diagonals of flat triangles are not mirrored
  const Plan plan = Rectangle{4, 3};
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Mesh mesh = domes::cushion(plan, {element, 0.4, std::nullopt, Pattern::structured}, 0.4);
    const strips::Surface surface = prepare(plan, mesh, mesh.blocks[0], mesh.nodes);
    const CuttingLine line = geodesic_line(surface, position(plan, -2, 0), position(plan, 2, 0));
    for (const Vec2& p : line.plan) EXPECT_NEAR(p.y(), 0, is_quadratic(element) ? 2e-3 : 3e-2) << name_of(element);
  }
}

TEST(GeodesicLine, AtAThirdBowsOutAndIsShorterThanTheStraightLine) {
  // 4 x 4 m, sag 12 %: measured with CGAL on 12 800 triangles 4.11614 m, against 4.11825 m of the straight line
  const strips::Surface surface = dome(square, 0.48, 0.1, ElementType::T6);
  const double x = 2.0 / 3;
  const CuttingLine geodesic = geodesic_line(surface, position(square, x, -2), position(square, x, 2));
  const CuttingLine straight = straight_line(surface, position(square, x, -2), position(square, x, 2));
  EXPECT_NEAR(geodesic.length, 4.1162, 2e-4);
  EXPECT_NEAR(straight.length, 4.1183, 2e-4);
  double farthest = 0;
  for (const Vec2& p : geodesic.plan) farthest = std::max(farthest, p.x());
  EXPECT_NEAR(farthest, 0.727, 0.02);
}

TEST(GeodesicLine, IsTheSameFromBothEnds) {
  const strips::Surface surface = dome(square, 0.8, 0.25);
  const CuttingLine there = geodesic_line(surface, 0.7, 9.1);
  const CuttingLine back = geodesic_line(surface, 9.1, 0.7);
  EXPECT_NEAR(there.length, back.length, 1e-12);
  EXPECT_EQ(there.plan.front(), back.plan.back());
}

TEST(GeodesicLine, EndsExactlyOnACurvedRim) {
  const Circle circle{2};
  const strips::Surface surface = dome(circle, 0.4, 0.25);
  for (const double from : {0.0, 0.1, 1.234, 5.0}) {
    const CuttingLine line = geodesic_line(surface, from, from + 5);
    EXPECT_EQ(line.plan.front(), rim_point(circle, from));
    EXPECT_EQ(line.plan.back(), rim_point(circle, from + 5));
    EXPECT_GT(line.length, (line.plan.back() - line.plan.front()).norm());
    EXPECT_LT(line.length, 1.2 * (line.plan.back() - line.plan.front()).norm());
  }
}

TEST(GeodesicLine, MayEndAtOrVeryNearAVertex) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  const double vertex = position(square, -1, -2);
  const double length = geodesic_line(surface, vertex, position(square, 0, 2)).length;
  for (const double beside : {1e-12, 1e-9, 1e-7, 1e-5})
    EXPECT_NEAR(geodesic_line(surface, vertex + beside, position(square, 0, 2)).length, length, beside + 1e-12);
}

TEST(GeodesicLine, AlongTheRimIsRefused) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  EXPECT_THAT(message_of<GeometryError>([&] { geodesic_line(surface, 0.5, 3.5); }),
              HasSubstr("runs along the rim at ("));
  EXPECT_THAT(message_of<GeometryError>([&] { geodesic_line(surface, 0.5, 0.6); }),
              HasSubstr("closer than an element"));
}

TEST(StraightLine, AcrossTheOutsideOfAnInnerCornerIsRefused) {
  const Polygon angle{{{-3, -2}, {3, -2}, {3, 0}, {0, 0}, {0, 2}, {-3, 2}}};
  const strips::Surface surface = dome(angle, 0.4, 0.3);
  EXPECT_THAT(
      message_of<GeometryError>([&] { straight_line(surface, position(angle, -1, 2), position(angle, 3, -1)); }),
      HasSubstr("leaves the plan at (0."));
  EXPECT_THAT(
      message_of<GeometryError>([&] { geodesic_line(surface, position(angle, -0.1, 2), position(angle, 3, -0.1)); }),
      HasSubstr("runs along the rim at ("));
}

TEST(StraightLine, AlongTheRimIsRefused) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  EXPECT_THAT(message_of<GeometryError>([&] { straight_line(surface, 0.5, 3.5); }),
              HasSubstr("runs along the rim at ("));
}

TEST(GivenLine, IsPutOnTheRimAndKeptInside) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  const std::vector<Vec2> points = {{-1.01, -1.99}, {-0.8, -1}, {-0.8, 1}, {-1, 2.02}};
  const CuttingLine line = given_line(surface, points);
  EXPECT_EQ(line.plan.size(), points.size());
  EXPECT_LT((line.plan.front() - Vec2(-1.01, -2)).norm(), 1e-15);
  EXPECT_LT((line.plan.back() - Vec2(-1, 2)).norm(), 1e-15);
  EXPECT_NEAR(line.from, 0.99, 1e-12);
  EXPECT_GT(line.length, 4.04);
}

TEST(GivenLine, ThatDoesNotReachTheRimIsRefusedWithThePlaceThatWouldDo) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  const std::string message = message_of<GeometryError>([&] {
    given_line(surface, std::vector<Vec2>{{-1, -1.5}, {-1, 2}});
  });
  EXPECT_THAT(message, HasSubstr("(-1, -1.5)"));
  EXPECT_THAT(message, HasSubstr("end it at (-1, -2)"));
}

TEST(GivenLine, ThatLeavesThePlanOrCrossesItselfIsRefusedWithThePlace) {
  const strips::Surface surface = dome(square, 0.4, 0.25);
  EXPECT_THAT(message_of<GeometryError>([&] {
                given_line(surface, std::vector<Vec2>{{-1, -2}, {-3, 0}, {-1, 2}});
              }),
              HasSubstr("leaves the plan at (-2"));
  EXPECT_THAT(message_of<GeometryError>([&] {
                given_line(surface, std::vector<Vec2>{{-1, -2}, {1, 1}, {1, 0}, {-1.5, 0}, {-1, 2}});
              }),
              HasSubstr("crosses itself near ("));
}

TEST(Crossing, FindsTheLinesAndThePlace) {
  const auto line = [](std::vector<Vec2> plan) { return CuttingLine{0, 0, std::move(plan), 0}; };
  const std::vector<CuttingLine> parallel = {line({{-1, -2}, {-1, 2}}), line({{0, -2}, {0.2, 0}, {0, 2}})};
  EXPECT_EQ(crossing(parallel), "");
  const std::vector<CuttingLine> crossed = {parallel[0], parallel[1], line({{-0.5, -2}, {0.5, 2}})};
  EXPECT_THAT(crossing(crossed), HasSubstr("lines 2 and 3 cross or touch near (0."));
  const std::vector<CuttingLine> touching = {parallel[0], line({{-1, 2}, {1, 0}})};
  EXPECT_THAT(crossing(touching), HasSubstr("lines 1 and 2 cross or touch near (-"));
}

TEST(Prepare, RefusesARimOutOfThePlane) {
  Mesh mesh = domes::cushion(square, {ElementType::T3, 0.5, std::nullopt}, 0.4);
  for (Vec3& x : mesh.nodes) x.z() += 0.1 * x.x();
  EXPECT_THAT(message_of<GeometryError>([&] { prepare(square, mesh, mesh.blocks[0], mesh.nodes); }),
              HasSubstr("leaves the plane z = 0"));
}

} // namespace
