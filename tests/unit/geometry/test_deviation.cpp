// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/deviation.h"
#include "geometry/meshing/plan_mesh.h"

namespace {

using namespace pneuma::geometry;

constexpr std::array all_elements = {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9};

Mesh sheet(ElementType element) {
  return meshing::mesh_plan(Rectangle{4, 2}, {element, {}, std::array{8, 4}, meshing::Pattern::structured});
}

// On a cylinder of 3 m radius about the y axis, turned about it by `turn` and grown by `rise`.
std::vector<Vec3> rolled(const Mesh& mesh, double turn, double rise) {
  std::vector<Vec3> nodes;
  for (const Vec3& x : mesh.nodes) {
    const double angle = x.x() / 3 + turn;
    nodes.emplace_back((3 + rise) * std::sin(angle), x.y(), (3 + rise) * std::cos(angle));
  }
  return nodes;
}

TEST(NormalDeviation, OfNoMoveIsNone) {
  for (const ElementType element : all_elements) {
    const Mesh mesh = sheet(element);
    const std::vector<Vec3> nodes = rolled(mesh, 0, 0);
    EXPECT_LT(normal_deviation(mesh, mesh.blocks[0], nodes, nodes).max, 1e-14) << name_of(element);
  }
}

TEST(NormalDeviation, OfAMoveAlongTheNormalIsItsDistanceToEitherSide) {
  for (const ElementType element : all_elements) {
    const Mesh mesh = sheet(element);
    for (const double distance : {0.07, -0.07}) {
      std::vector<Vec3> moved = mesh.nodes;
      for (Vec3& x : moved) x += Vec3(0.1, -0.05, distance); // sliding in the plane does not count
      const Deviation flat = normal_deviation(mesh, mesh.blocks[0], mesh.nodes, moved);
      EXPECT_NEAR(flat.max, 0.07, 1e-12) << name_of(element);
      EXPECT_NEAR(flat.mean, 0.07, 1e-12) << name_of(element);
      const Deviation curved = normal_deviation(mesh, mesh.blocks[0], rolled(mesh, 0, 0), rolled(mesh, 0, distance));
      // flat elements of 0.5 m have no common normal at their nodes: (1 - cos 4.8 degrees) of the distance
      EXPECT_NEAR(curved.max, 0.07, is_quadratic(element) ? 1e-5 : 5e-4) << name_of(element);
      EXPECT_NEAR(curved.mean, 0.07, is_quadratic(element) ? 1e-5 : 5e-4) << name_of(element);
    }
  }
}

TEST(NormalDeviation, OfOneNodeIsLargestThereAndSmallInTheMean) {
  const Mesh mesh = sheet(ElementType::T6);
  std::vector<Vec3> moved = mesh.nodes;
  const auto middle = static_cast<std::size_t>(mesh.element_nodes(mesh.blocks[0], 20)[0]);
  moved[middle].z() += 0.01;
  const Deviation deviation = normal_deviation(mesh, mesh.blocks[0], mesh.nodes, moved);
  EXPECT_NEAR(deviation.max, 0.01, 1e-12);
  EXPECT_EQ(deviation.at, moved[middle]);
  EXPECT_GT(deviation.mean, 0);
  EXPECT_LT(deviation.mean, 5e-4);
}

TEST(NormalDeviation, OfASurfaceThatSlidesAlongItselfIsNearlyNone) {
  for (const ElementType element : {ElementType::T6, ElementType::Q9}) {
    const Mesh mesh = sheet(element);
    // by 50 mm along the cylinder, a tenth of an element; the parabolas through its nodes are off by h^3
    const Deviation deviation = normal_deviation(mesh, mesh.blocks[0], rolled(mesh, 0, 0), rolled(mesh, 0.05 / 3, 0));
    EXPECT_LT(deviation.max, 2e-5) << name_of(element);
    EXPECT_LT(deviation.mean, 5e-6) << name_of(element);
  }
}

} // namespace
