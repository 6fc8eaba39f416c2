// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "geometry/rim.h"

namespace {

using namespace pneuma::geometry;
using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;

const Rectangle rectangle{6, 3};
const Circle circle{2.5};
const Triangle triangle{{{-1, 0}, {3, 0.5}, {0.5, 2.5}}};
const Triangle clockwise{{{-1, 0}, {0.5, 2.5}, {3, 0.5}}};
const Polygon angle{{{-3, -2}, {3, -2}, {3, 1}, {1, 1}, {1, 3}, {-3, 3}}};
const Polygon clockwise_angle{{{-3, 3}, {1, 3}, {1, 1}, {3, 1}, {3, -2}, {-3, -2}}};
const std::vector<Plan> plans = {rectangle, circle, triangle, clockwise, angle, clockwise_angle};

TEST(Rim, PositionsAndPointsAreInverse) {
  for (const Plan& plan : plans) {
    for (int i = 0; i < 1000; ++i) {
      const double position = perimeter(plan) * i / 1000;
      EXPECT_NEAR(rim_position(plan, rim_point(plan, position)), position, 1e-12);
    }
    for (const double corner : rim_corners(plan)) EXPECT_EQ(rim_position(plan, rim_point(plan, corner)), corner);
  }
}

TEST(Rim, RunsCounterclockwiseAtUnitSpeed) {
  for (const Plan& plan : plans) {
    const int n = 20000;
    double length = 0;
    double doubled_area = 0;
    for (int i = 0; i < n; ++i) {
      const Vec2 a = rim_point(plan, perimeter(plan) * i / n);
      const Vec2 b = rim_point(plan, perimeter(plan) * (i + 1) / n);
      length += (b - a).norm();
      doubled_area += a.x() * b.y() - a.y() * b.x();
    }
    EXPECT_NEAR(length, perimeter(plan), 4e-3); // chords cut corners off
    EXPECT_NEAR(doubled_area / 2, area(plan), 1e-5);
  }
}

TEST(Rim, HasItsEdgesWhereMeshesHaveThem) {
  for (const Plan& plan : plans) {
    const Mesh mesh = meshing::mesh_plan(plan, {ElementType::T3, 0.5, std::nullopt, meshing::Pattern::unstructured});
    const std::vector<double> corners = rim_corners(plan);
    const std::vector<std::size_t> edges = rim_edges(plan);
    ASSERT_EQ(corners.size(), mesh.edges.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Edge& edge = mesh.edges[edges[k]];
      const Vec2 first = mesh.nodes[static_cast<std::size_t>(edge.nodes.front())].head<2>();
      if (edge.closed) continue; // a rim without corners begins anywhere
      EXPECT_LT((rim_point(plan, corners[k]) - first).norm(), 1e-14) << edge.name;
      for (const Index i : edge.nodes) {
        const double position = rim_position(plan, mesh.nodes[static_cast<std::size_t>(i)].head<2>());
        const bool at_end = i == edge.nodes.back();
        EXPECT_GE(position, at_end ? 0 : corners[k] - 1e-12);
        if (k + 1 < corners.size()) {
          EXPECT_LE(position, corners[k + 1] + 1e-12);
        }
      }
    }
  }
}

TEST(Rim, OfAClockwiseTriangleHasTheFirstEdgeFirst) {
  EXPECT_EQ(rim_point(clockwise, 0), Vec2(0.5, 2.5)); // e1 is run from its second point to its first
  EXPECT_THAT(rim_edges(clockwise), ElementsAre(0u, 2u, 1u));
  EXPECT_THAT(rim_edges(triangle), ElementsAre(0u, 1u, 2u));
}

TEST(Rim, PositionIsThatOfTheNearestPoint) {
  EXPECT_DOUBLE_EQ(rim_position(rectangle, {0, -1.4}), 3);
  EXPECT_DOUBLE_EQ(rim_position(rectangle, {7, 0}), 7.5);
  EXPECT_DOUBLE_EQ(rim_position(rectangle, {-4, -2}), 0);
  EXPECT_DOUBLE_EQ(rim_position(circle, {0, 0.1}), 2.5 * std::numbers::pi / 2);
}

TEST(Rim, IsCrossedInTheOrderOfTheLine) {
  EXPECT_THAT(rim_crossings(rectangle, {1, 0}, {0, 1}), ElementsAre(DoubleEq(4), DoubleEq(11)));
  EXPECT_THAT(rim_crossings(rectangle, {1, 0}, {0, -2}), ElementsAre(DoubleEq(11), DoubleEq(4)));
  const double quarter = 2.5 * std::numbers::pi / 2;
  EXPECT_THAT(rim_crossings(circle, {0, 7}, {0, 1}),
              ElementsAre(DoubleNear(3 * quarter, 1e-12), DoubleNear(quarter, 1e-12)));
  EXPECT_THAT(rim_crossings(circle, {0, 3}, {1, 0}), testing::IsEmpty());
  for (const Plan& plan : plans) {
    const std::vector<double> found = rim_crossings(plan, {0.3, 0.8}, {1, 0.2});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_LT(rim_point(plan, found[0]).x(), rim_point(plan, found[1]).x());
    for (const double position : found) {
      const Vec2 along = rim_point(plan, position) - Vec2(0.3, 0.8);
      EXPECT_NEAR(along.y(), 0.2 * along.x(), 1e-12);
    }
  }
}

TEST(Rim, IsNotCrossedWhereALineTouchesItOrRunsAlongIt) {
  EXPECT_THAT(rim_crossings(rectangle, {0, -1.5}, {1, 0}), testing::IsEmpty());
  EXPECT_THAT(rim_crossings(rectangle, {3, 1.5}, {1, -1}), testing::IsEmpty());
  EXPECT_THAT(rim_crossings(circle, {0, 2.5}, {1, 0}), testing::IsEmpty());
  EXPECT_THAT(rim_crossings(rectangle, {0, 0}, {6, 3}), ElementsAre(0, 9)); // from corner to corner
  // along the edges of the inner corner, and out through it
  EXPECT_THAT(rim_crossings(angle, {0, 1}, {1, 0}), ElementsAre(DoubleEq(19), DoubleEq(11)));
  EXPECT_THAT(rim_crossings(angle, {1, 0}, {0, 1}), ElementsAre(DoubleEq(4), DoubleEq(11)));
}

TEST(Rim, EnclosesThePlan) {
  for (const Plan& plan : plans) {
    for (int i = 0; i < 50; ++i) {
      const Vec2 on = rim_point(plan, perimeter(plan) * i / 50);
      const Vec2 middle(0.5, 0.8);
      EXPECT_TRUE(inside(plan, on, 1e-12));
      EXPECT_TRUE(inside(plan, on + 0.01 * (middle - on), 0));
      EXPECT_FALSE(inside(plan, on - 0.01 * (middle - on), 1e-9));
      EXPECT_TRUE(inside(plan, on - 0.01 * (middle - on), 0.1));
    }
  }
}

} // namespace
