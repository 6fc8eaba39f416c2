// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/gap.h"
#include "geometry/meshing/plan_mesh.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;

class GapOfEveryElement : public testing::TestWithParam<ElementType> {
protected:
  static constexpr std::size_t upper = 0, lower = 1;

  Mesh cushion(double size, const Plan& plan = Rectangle{4, 3}, Pattern pattern = Pattern::structured) const {
    return stack(mesh_plan(plan, {GetParam(), size, std::nullopt, pattern}), {{"upper"}, {"lower"}});
  }

  // gives every block a height over the plan; nodes on edges are met by both and must agree
  static std::vector<Vec3> shaped(const Mesh& mesh, auto&& upper_height, auto&& lower_height) {
    std::vector<Vec3> x = mesh.nodes;
    for (const Index i : mesh.blocks[lower].connectivity) {
      Vec3& node = x[static_cast<std::size_t>(i)];
      node.z() = lower_height(node.x(), node.y());
    }
    for (const Index i : mesh.blocks[upper].connectivity) {
      Vec3& node = x[static_cast<std::size_t>(i)];
      node.z() = upper_height(node.x(), node.y());
    }
    return x;
  }
};
INSTANTIATE_TEST_SUITE_P(Types, GapOfEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

double bubble(double x, double y) {
  return (1 - x * x / 4) * (1 - y * y / 2.25);
}

TEST_P(GapOfEveryElement, IsZeroForAFlatStart) {
  const Mesh mesh = cushion(0.5);
  const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(mesh.nodes);
  EXPECT_NEAR(gap.value, 0, 1e-15);
  EXPECT_EQ(gap.skipped, 0u);
  EXPECT_GT(gap.located, 50u);
}

TEST_P(GapOfEveryElement, IsPositiveForAnInflatedCushion) {
  for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
    const Mesh mesh = cushion(0.4, Rectangle{4, 3}, pattern);
    const auto x = shaped(
        mesh, [](double u, double v) { return 0.5 * bubble(u, v); }, [](double u, double v) { return -bubble(u, v); });
    const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(x);
    EXPECT_GT(gap.value, 0);
    EXPECT_EQ(gap.skipped, 0u);
  }
}

TEST_P(GapOfEveryElement, FindsThePlaceAndDepthOfADent) {
  const Mesh mesh = cushion(0.2);
  const Vec3 dent(0.7, -0.5, 0);
  const auto x = shaped(
      mesh,
      [&](double u, double v) {
        const double d = (u - dent.x()) * (u - dent.x()) + (v - dent.y()) * (v - dent.y());
        return bubble(u, v) * (0.2 - 0.5 * std::exp(-2 * d));
      },
      [](double, double) { return 0.0; });
  const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(x);
  EXPECT_NEAR(gap.value, -0.3 * bubble(dent.x(), dent.y()), 0.02);
  EXPECT_LT((gap.at - dent).head<2>().norm(), 0.25);
  EXPECT_NEAR(gap.at.z(), gap.value, 1e-14);
}

TEST_P(GapOfEveryElement, IsExactBetweenPlanesThatSlidSideways) {
  // two free plates, the upper one moved by several elements: its points lie over other elements than their own
  Mesh mesh = mesh_plan(Rectangle{4, 3}, {GetParam(), 0.25, std::nullopt, Pattern::unstructured});
  mesh.edges.clear();
  Mesh two = mesh;
  two.blocks.push_back({"lower", BlockKind::foil, mesh.blocks[upper].connectivity});
  for (Index& i : two.blocks[lower].connectivity) i += static_cast<Index>(mesh.nodes.size());
  two.nodes.insert(two.nodes.end(), mesh.nodes.begin(), mesh.nodes.end());
  std::vector<Vec3> moved = shaped(
      two, [](double u, double v) { return 1 + 0.1 * u + 0.2 * v; },
      [](double u, double v) { return 0.1 * u + 0.2 * v; });
  const Vec3 shift(1.1, 0.7, 0);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) moved[i] += shift;
  GapSearch search(two, two.blocks[upper], two.blocks[lower]);
  for (int call = 0; call < 2; ++call) {
    const Gap gap = search.smallest(moved);
    EXPECT_NEAR(gap.value, 1 - 0.11 - 0.14, 1e-12);
    const double over = (4 - 1.1) * (3 - 0.7) / 12; // part of the plate that lies over the other
    EXPECT_NEAR(static_cast<double>(gap.located) / static_cast<double>(gap.located + gap.skipped), over, 0.06);
  }
}

TEST_P(GapOfEveryElement, IsMeasuredAlongTheNormalOfThePlan) {
  const Mesh mesh = cushion(0.5);
  const auto x = shaped(
      mesh, [](double u, double v) { return -0.3 * bubble(u, v); }, [](double, double) { return 0.0; });
  const Gap straight = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(x);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.3).normalized().toRotationMatrix();
  std::vector<Vec3> turned = x;
  for (Vec3& node : turned) node = turn * node;
  const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower], 3 * turn.col(2)).smallest(turned);
  EXPECT_NEAR(gap.value, straight.value, 1e-13);
  EXPECT_NEAR(gap.value, -0.3, 0.02);
  EXPECT_LT((gap.at - turn * straight.at).norm(), 1e-12);
}

// A node of the lower block that sticks out between the upper block's points.
TEST_P(GapOfEveryElement, IsSeenFromBothBlocks) {
  Mesh two = mesh_plan(Rectangle{4, 3}, {GetParam(), 0.5, std::nullopt});
  two.edges.clear();
  const auto count = two.nodes.size();
  two.blocks.push_back({"lower", BlockKind::foil, two.blocks[upper].connectivity});
  for (Index& i : two.blocks[lower].connectivity) i += static_cast<Index>(count);
  for (std::size_t i = 0; i < count; ++i) two.nodes.push_back(two.nodes[i]);
  std::size_t spike = count;
  for (std::size_t i = count; i < two.nodes.size(); ++i) {
    two.nodes[i] += Vec3(0.17, 0.11, -1);
    if (two.nodes[i].head<2>().norm() < two.nodes[spike].head<2>().norm()) spike = i;
  }
  two.nodes[spike].z() = 0.2;
  const Gap gap = GapSearch(two, two.blocks[upper], two.blocks[lower]).smallest(two.nodes);
  EXPECT_NEAR(gap.value, -0.2, 1e-14);
  EXPECT_LT((gap.at - Vec3(two.nodes[spike].x(), two.nodes[spike].y(), 0)).norm(), 1e-14);
}

TEST_P(GapOfEveryElement, SkipsPointsThatBulgeBeyondTheRim) {
  const Mesh mesh = cushion(0.1, Circle{1});
  std::vector<Vec3> x = shaped(
      mesh, [](double, double) { return 0.0; }, [](double, double) { return 0.0; });
  for (const Index i : mesh.blocks[upper].connectivity) { // more than half a sphere through the rim
    Vec3& node = x[static_cast<std::size_t>(i)];
    const Vec3 flat = mesh.nodes[static_cast<std::size_t>(i)];
    const double r = flat.norm();
    const double angle = r * 2.2;
    const double radius = 1 / std::sin(2.2);
    if (r > 0) node = radius * std::sin(angle) / r * flat;
    node.z() = radius * (std::cos(angle) - std::cos(2.2));
  }
  const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(x);
  EXPECT_GT(gap.skipped, 0u);
  EXPECT_GT(gap.located, 0u);
  EXPECT_GE(gap.value, -1e-12);
}

TEST_P(GapOfEveryElement, FindsNothingInPositionsThatAreNoNumbers) {
  const Mesh mesh = cushion(0.5);
  const std::vector<Vec3> x(mesh.nodes.size(), Vec3::Constant(std::nan("")));
  const Gap gap = GapSearch(mesh, mesh.blocks[upper], mesh.blocks[lower]).smallest(x);
  EXPECT_EQ(gap.located, 0u);
  EXPECT_TRUE(std::isinf(gap.value));
}

} // namespace
