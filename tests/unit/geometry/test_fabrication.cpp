// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/fabrication/fabrication.h"
#include "geometry/polygon.h"
#include "tests/unit/message_of.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::fabrication;
using pneuma::base::GeometryError;
using pneuma::tests::message_of;
using std::numbers::pi;
using testing::AllOf;
using testing::HasSubstr;

Side seam(const std::string& name, std::vector<Vec2> points) {
  Side side;
  side.name = name;
  side.seam = true;
  side.points = std::move(points);
  return side;
}
Side clamp(const std::string& name, std::vector<Vec2> points) {
  Side side = seam(name, std::move(points));
  side.seam = false;
  return side;
}

// seams below and above, clamps at both ends
FlatStrip rectangle(double length, double width) {
  const std::vector<Vec2> p = {{0, 0}, {length, 0}, {length, width}, {0, width}};
  return {
      "U1",
      {seam("S1", {p[0], p[1]}), clamp("east", {p[1], p[2]}), seam("S2", {p[2], p[3]}), clamp("west", {p[3], p[0]})}};
}

FlatStrip triangle(const Vec2& a, const Vec2& b, const Vec2& c) {
  return {"U1", {seam("S1", {a, b}), seam("S2", {b, c}), clamp("west", {c, a})}};
}

// between two angles of a circle about the origin, in chords
std::vector<Vec2> arc(double radius, double from, double to, int chords) {
  std::vector<Vec2> points;
  for (int i = 0; i <= chords; ++i) {
    const double angle = from + (to - from) * i / chords;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

double distance_to(const std::vector<Vec2>& ring, const Vec2& point) {
  double distance = 1e300;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 side = ring[(i + 1) % ring.size()] - ring[i];
    const double along = std::clamp((point - ring[i]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    distance = std::min(distance, (ring[i] + along * side - point).norm());
  }
  return distance;
}

TEST(CutStrip, OfARectangleIsARectangleWithTheAllowanceOfEachSide) {
  const CutStrip cut = cut_strip(rectangle(4, 1), {0.006, 0.03, 0});
  ASSERT_EQ(cut.outline.size(), 4u);
  EXPECT_TRUE(cut.low.isApprox(Vec2(-0.03, -0.006), 1e-12));
  EXPECT_TRUE(cut.high.isApprox(Vec2(4.03, 1.006), 1e-12));
  EXPECT_NEAR(cut.area, 4.06 * 1.012, 1e-12);
  EXPECT_NEAR(cut.net_area, 4, 1e-12);
  EXPECT_TRUE(cut.notches.empty());
}

TEST(CutStrip, WithoutAllowancesIsTheNetOutline) {
  const CutStrip cut = cut_strip(rectangle(4, 1), {0, 0, 0.5});
  EXPECT_EQ(cut.outline, cut.net);
  EXPECT_EQ(cut.notches.size(), 14u);
}

// Steiner: area + perimeter d + d^2 sum of tan(turn/2) with sharp corners
TEST(CutStrip, OfAnEquilateralTriangleHasSharpCorners) {
  const double d = 0.05;
  const double height = std::sqrt(3) / 2;
  const CutStrip cut = cut_strip(triangle({0, 0}, {1, 0}, {0.5, height}), {d, d, 0});
  EXPECT_EQ(cut.outline.size(), 3u); // a mitre of exactly twice the allowance
  EXPECT_NEAR(cut.area, height / 2 + 3 * d + 3 * d * d * std::tan(pi / 3), 1e-12);
}

TEST(CutStrip, ASharpWedgeIsCutOffSquareAtTwiceTheAllowance) {
  const double d = 0.01;
  const CutStrip cut = cut_strip(triangle({-4, -0.2}, {0, 0}, {-4, 0.2}), {d, d, 0});
  ASSERT_EQ(cut.outline.size(), 4u);
  EXPECT_NEAR(cut.high.x(), mitre_limit * d, 1e-12);
  EXPECT_EQ(std::count_if(cut.outline.begin(), cut.outline.end(),
                          [&](const Vec2& p) { return std::abs(p.x() - cut.high.x()) < 1e-12; }),
            2);
  // both offset lines keep their distance up to the cut
  for (const Vec2& p : cut.outline) EXPECT_GE(distance_to(cut.net, p), d - 1e-12);
}

TEST(CutStrip, OfACircleInChordsIsTheParallelPolygon) {
  const int chords = 200;
  const double d = 0.02;
  std::vector<Vec2> lower = arc(1, pi, 2 * pi, chords / 2);
  std::vector<Vec2> upper = arc(1, 0, pi, chords / 2);
  lower.back() = upper.front();
  upper.back() = lower.front();
  const CutStrip cut = cut_strip({"U1", {clamp("south", lower), clamp("north", upper)}}, {0, d, 0});
  EXPECT_EQ(cut.outline.size(), 200u);
  const double apothem = std::cos(pi / chords) + d;
  EXPECT_NEAR(cut.area, chords * apothem * apothem * std::tan(pi / chords), 1e-12);
  EXPECT_NEAR(cut.area, pi * (1 + d) * (1 + d), 2e-3);
}

// hollow above: an annulus sector, its parallels are circles of the radii -+ d
TEST(CutStrip, OfAHollowSideKeepsItsDistanceEverywhere) {
  const double d = 0.03;
  const std::vector<Vec2> outer = arc(3, 0, pi / 2, 90);
  const std::vector<Vec2> inner = arc(2, pi / 2, 0, 90);
  const CutStrip cut = cut_strip({"U1",
                                  {seam("S1", outer), clamp("west", {outer.back(), inner.front()}), seam("S2", inner),
                                   clamp("south", {inner.back(), outer.front()})}},
                                 {d, d, 0.5});
  EXPECT_FALSE(crossing_sides(cut.outline));
  for (const Vec2& p : cut.outline) {
    EXPECT_GE(distance_to(cut.net, p), d - 1e-9);
    EXPECT_LE(distance_to(cut.net, p), std::sqrt(2) * d + 1e-3); // the corners, of nearly 90 degrees
  }
  const double closed_form = pi / 4 * (std::pow(3 + d, 2) - std::pow(2 - d, 2)) + 2 * d * (1 + 2 * d);
  EXPECT_NEAR(cut.area, closed_form, 1e-3);
}

TEST(CutStrip, ALensGetsBluntTips) {
  const double half_angle = 0.3;
  const double radius = 5;
  std::vector<Vec2> lower = arc(radius, 1.5 * pi - half_angle, 1.5 * pi + half_angle, 60);
  for (Vec2& p : lower) p.y() += radius * std::cos(half_angle);
  std::vector<Vec2> upper(lower.rbegin(), lower.rend());
  for (Vec2& p : upper) p.y() = -p.y();
  upper.front() = lower.back();
  upper.back() = lower.front();
  const double d = 0.006;
  const CutStrip cut = cut_strip({"U1", {seam("S1", lower), seam("S2", upper)}}, {d, d, 0.5});
  EXPECT_NEAR(cut.high.x(), lower.back().x() + mitre_limit * d, 1e-9);
  EXPECT_NEAR(cut.high.x() + cut.low.x(), 0, 1e-12);
  EXPECT_NEAR(cut.high.y() + cut.low.y(), 0, 1e-12);
  EXPECT_FALSE(crossing_sides(cut.outline));
}

// A clamped edge at 60 degrees to a seam along x, in pieces shorter than what the blunt corner loses: there both cuts
// lie on the same line parallel to it, the weld's width apart along the seam's normal.
TEST(CutStrip, MatingStripsOverlapByTheWeldUpToTheCutOfTheClampedEdge) {
  const Vec2 down = -Vec2(std::cos(pi / 3), std::sin(pi / 3));
  const auto edge = [&](double from) { // of length 1, towards `down`
    std::vector<Vec2> points;
    for (int i = 0; i <= 200; ++i) points.emplace_back((from + i / 200.0) * down);
    return points;
  };
  const std::vector<Vec2> upper_edge = edge(-1);
  const std::vector<Vec2> lower_edge = edge(0);
  const double top = upper_edge.front().y();
  const double bottom = lower_edge.back().y();
  const FlatStrip upper = {
      "U2",
      {clamp("west", upper_edge), seam("S1", {{0, 0}, {3, 0}}), clamp("rest", {{3, 0}, {3, top}, upper_edge.front()})}};
  const FlatStrip lower = {"U1",
                           {clamp("west", lower_edge), clamp("rest", {lower_edge.back(), {3, bottom}, {3, 0}}),
                            seam("S1", {{3, 0}, {0, 0}})}};
  const Allowances allowances = {0.006, 0.03, 0};
  for (const auto& [strip, y] : {std::pair(upper, -0.006), std::pair(lower, 0.006)}) {
    // a line parallel to the edge at 30 mm: x sin 60 - y cos 60 = -0.03
    const Vec2 corner((y * std::cos(pi / 3) - 0.03) / std::sin(pi / 3), y);
    const CutStrip cut = cut_strip(strip, allowances);
    EXPECT_TRUE(std::any_of(cut.outline.begin(), cut.outline.end(), [&](const Vec2& p) {
      return (p - corner).norm() < 1e-9;
    })) << strip.name;
    EXPECT_FALSE(crossing_sides(cut.outline));
  }
}

TEST(CutStrip, AStraightLineOfTwoAllowancesSteps) {
  const FlatStrip strip = {"U1",
                           {clamp("south", {{0, 0}, {2, 0}}), seam("S1", {{2, 0}, {4, 0}}),
                            clamp("east", {{4, 0}, {4, 1}}), clamp("rest", {{4, 1}, {0, 1}, {0, 0}})}};
  const CutStrip cut = cut_strip(strip, {0.006, 0.03, 0});
  EXPECT_THAT(cut.outline, testing::IsSupersetOf({Vec2(2, -0.03), Vec2(2, -0.006)}));
}

TEST(CutStrip, ANarrowHollowIsBridged) {
  // a dent 10 mm wide and 5 mm deep in the upper side; the allowance is 20 mm
  const FlatStrip strip = {
      "U1",
      {clamp("south", {{0, 0}, {1, 0}}), clamp("east", {{1, 0}, {1, 1}}),
       clamp("north", {{1, 1}, {0.505, 1}, {0.503, 0.996}, {0.5, 0.995}, {0.497, 0.996}, {0.495, 1}, {0, 1}}),
       clamp("west", {{0, 1}, {0, 0}})}};
  const double d = 0.02;
  const CutStrip cut = cut_strip(strip, {d, d, 0});
  EXPECT_FALSE(crossing_sides(cut.outline));
  for (const Vec2& p : cut.outline) EXPECT_GE(distance_to(cut.net, p), d - 1e-9);
  EXPECT_NEAR(cut.area, 1.04 * 1.04, 1e-3);
}

TEST(CutStrip, RefusesAllowancesThatOverlapWithThePlace) {
  // a hook whose arms are 40 mm apart
  const FlatStrip hook = {
      "U7", {clamp("rim", {{0, 0}, {1, 0}, {1, 1}, {0.52, 1}, {0.52, 0.2}, {0.48, 0.2}, {0.48, 1}, {0, 1}, {0, 0}})}};
  EXPECT_NO_THROW(cut_strip(hook, {0, 0.019, 0}));
  EXPECT_THAT(message_of<GeometryError>([&] {
                cut_strip(hook, {0, 0.03, 0});
              }),
              AllOf(HasSubstr("strip U7: the cut outline crosses itself"), HasSubstr("(0.5")));
}

TEST(CutStrip, RefusesAnOpenOrCrossedNetOutline) {
  FlatStrip strip = rectangle(4, 1);
  strip.sides[1].points.back() = Vec2(4, 0.9);
  EXPECT_EQ(message_of<GeometryError>([&] { cut_strip(strip, {}); }),
            "strip U1: the outline is open at (4.0000 m, 0.9000 m) of the flat strip");
  strip = rectangle(4, 1);
  strip.sides[1].points = {{4, 0}, {4, -0.5}, {2, 0.5}, {4, 1}};
  EXPECT_THAT(message_of<GeometryError>([&] { cut_strip(strip, {}); }), HasSubstr("the net outline crosses itself"));
}

// a wavy seam as the strips on both sides of it see it, one of them a little shorter
struct MatingStrips {
  FlatStrip left, right;
};
MatingStrips mating_strips() {
  std::vector<Vec2> line;
  for (int i = 0; i <= 40; ++i) line.emplace_back(0.1 * i, 0.02 * std::sin(0.1 * i));
  std::vector<Vec2> shrunk(line.rbegin(), line.rend());
  for (Vec2& p : shrunk) p *= 0.9995;
  const auto end = [&](const std::vector<Vec2>& points, double y) {
    return std::vector<Vec2>{points.back(), {points.back().x(), y}, {points.front().x(), y}, points.front()};
  };
  MatingStrips strips = {{"U2", {seam("S1", line), clamp("rim", end(line, 1))}},
                         {"U1", {seam("S1", shrunk), clamp("rim", end(shrunk, -1))}}};
  Side& of_left = strips.left.sides[0];
  Side& of_right = strips.right.sides[0];
  of_right.reversed = true;
  of_left.mate_length = length(of_right);
  of_right.mate_length = length(of_left);
  return strips;
}

TEST(Notches, StandAtTheSameFractionsOfASeamInBothStrips) {
  const auto [left, right] = mating_strips();
  // just between the two lengths: alone, the strips would count differently
  const double spacing = (length(left.sides[0]) + length(right.sides[0])) / 2 / 8;
  const CutStrip a = cut_strip(left, {0.006, 0.03, spacing});
  const CutStrip b = cut_strip(right, {0.006, 0.03, spacing});
  ASSERT_EQ(a.notches.size(), 8u);
  ASSERT_EQ(b.notches.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    const Notch& of_left = a.notches[k];
    const Notch& of_right = b.notches[7 - k];
    EXPECT_EQ(of_left.name, "S1-" + std::to_string(k + 1));
    EXPECT_EQ(of_right.name, of_left.name);
    const Vec2 net_left = of_left.at + 0.006 * of_left.inwards;
    const Vec2 net_right = of_right.at + 0.006 * of_right.inwards;
    EXPECT_LT((0.9995 * net_left - net_right).norm(), 1e-12);
    EXPECT_LT((of_left.inwards + of_right.inwards).norm(), 1e-12);
    EXPECT_NEAR(distance_to(a.outline, of_left.at), 0, 1e-12);
    EXPECT_NEAR(distance_to(b.outline, of_right.at), 0, 1e-12);
  }
}

TEST(Notches, AreNoFartherApartThanAskedAndNeverOnTheEnds) {
  const CutStrip cut = cut_strip(rectangle(4, 1), {0.006, 0.03, 0.5}); // 8 parts of exactly 0.5 m
  ASSERT_EQ(cut.notches.size(), 14u);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_NEAR(cut.notches[k].at.x(), 0.5 * static_cast<double>(k + 1), 1e-12);
    EXPECT_NEAR(cut.notches[k].at.y(), -0.006, 1e-12);
    EXPECT_TRUE(cut.notches[k].inwards.isApprox(Vec2(0, 1)));
  }
  EXPECT_TRUE(cut_strip(rectangle(0.5, 1), {0.006, 0.03, 0.5}).notches.empty());
  EXPECT_EQ(cut_strip(rectangle(0.6, 1), {0.006, 0.03, 0.5}).notches.size(), 2u);
}

std::vector<CutStrip> rectangles(const std::vector<Vec2>& sizes) {
  std::vector<CutStrip> strips;
  for (const Vec2& size : sizes) strips.push_back(cut_strip(rectangle(size.x(), size.y()), {0.01, 0.01, 0}));
  return strips;
}
const std::vector<std::string> names = {"U1", "U2", "U3", "U4", "U5"};

TEST(Nest, KeepsStripsApartAndInsideTheRoll) {
  const std::vector<CutStrip> strips = rectangles({{3, 0.6}, {5, 0.8}, {4, 0.7}, {5, 0.3}, {2, 1.4}});
  const double gap = 0.01;
  const Nesting nesting = nest(strips, names, 1.55, 0.02, gap);
  ASSERT_EQ(nesting.placements.size(), strips.size());
  std::vector<std::pair<Vec2, Vec2>> boxes;
  double area = 0;
  for (const Placement& placement : nesting.placements) {
    const CutStrip& strip = strips[static_cast<std::size_t>(placement.strip)];
    const Vec2 one = placement(strip.low);
    const Vec2 other = placement(strip.high);
    boxes.emplace_back(one.cwiseMin(other), one.cwiseMax(other));
    area += strip.area;
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_GE(boxes[i].first.y(), 0.02 - 1e-12);
    EXPECT_LE(boxes[i].second.y(), 1.53 + 1e-12);
    EXPECT_GE(boxes[i].first.x(), -1e-12);
    EXPECT_LE(boxes[i].second.x(), nesting.length + 1e-12);
    for (std::size_t j = 0; j < i; ++j) {
      const auto apart = (boxes[i].first - boxes[j].second).cwiseMax(boxes[j].first - boxes[i].second);
      EXPECT_GE(apart.maxCoeff(), gap - 1e-12) << i << " and " << j;
    }
  }
  EXPECT_NEAR(nesting.waste_fraction, 1 - area / (nesting.length * 1.55), 1e-12);
  // 5 x 0.8 beside 5 x 0.3, 4 x 0.7 beside 3 x 0.6, 2 x 1.4 alone; allowances and gaps between
  EXPECT_NEAR(nesting.length, 5.02 + 4.02 + 2.02 + 2 * gap, 1e-12);
}

TEST(Nest, TakesAStripThatFitsExactly) {
  const std::vector<CutStrip> strips = rectangles({{3, 1.2}, {3, 1.3}});
  const double width = roll_width_for(strips, 0.02);
  EXPECT_NEAR(width, 1.36, 1e-12);
  EXPECT_NO_THROW(nest(strips, names, width, 0.02, 0.01));
}

TEST(Nest, RefusesWideStripsWithTheirWidthsAndTheRollThatWouldDo) {
  const std::vector<CutStrip> strips = rectangles({{3, 1.6}, {5, 0.8}, {4, 1.7}});
  EXPECT_EQ(message_of<GeometryError>([&] { nest(strips, names, 1.55, 0.02, 0.01); }),
            "too wide for a roll of 1.550 m with 1.510 m inside its selvedges: U1 (1.620 m), U3 (1.720 m); a roll of "
            "1.760 m would do, or more strips");
}

} // namespace
