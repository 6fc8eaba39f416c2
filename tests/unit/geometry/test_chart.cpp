// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domes.h"
#include "geometry/base/errors.h"
#include "geometry/chart.h"
#include "geometry/surface.h"
#include "geometry/triangulation.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using domes::cushion;
using pneuma::base::GeometryError;

class EveryElement : public testing::TestWithParam<ElementType> {
protected:
  Mesh dome(const Plan& plan, double size = 0.3) const {
    return cushion(plan, {GetParam(), size, std::nullopt, Pattern::unstructured}, 0.5);
  }
};
INSTANTIATE_TEST_SUITE_P(Types, EveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(EveryElement, ChartFindsEveryNode) {
  for (const Plan& plan : {Plan(Rectangle{4, 3}), Plan(Circle{2}), Plan(Triangle{{{0, 0}, {4, 1}, {1, 3}}})}) {
    const Mesh mesh = dome(plan);
    for (const Block& block : mesh.blocks) {
      const Chart chart(mesh, block, mesh.nodes);
      for (const Index i : block.connectivity) {
        const Vec3& x = mesh.nodes[static_cast<std::size_t>(i)];
        const auto place = chart.locate(x.head<2>());
        ASSERT_TRUE(place) << "node " << i << " at " << x.transpose();
        EXPECT_LT((point_on(mesh, block, mesh.nodes, place->element, place->xi, place->eta) - x).norm(), 1e-8);
        EXPECT_LT((chart.lift(x.head<2>()) - x).norm(), 1e-8);
      }
    }
  }
}

TEST_P(EveryElement, ChartLiftsAnyPlaceOntoTheSurface) {
  const Rectangle plan{4, 3};
  const Mesh mesh = dome(plan);
  const Chart chart(mesh, mesh.blocks[1], mesh.nodes);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-2, 2);
  std::uniform_real_distribution<double> y(-1.5, 1.5);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 at(x(random), y(random));
    const auto place = chart.locate(at);
    ASSERT_TRUE(place) << at.transpose();
    const Vec3 point = point_on(mesh, mesh.blocks[1], mesh.nodes, place->element, place->xi, place->eta);
    EXPECT_LT((point.head<2>() - at).norm(), 1e-12);
    EXPECT_LT((chart.lift(at) - point).norm(), 1e-12);
    EXPECT_NEAR(point.z(), -domes::height(plan, at, 0.5), is_quadratic(GetParam()) ? 2e-3 : 2e-2);
    const Vec3 normal = normal_at(mesh, mesh.blocks[1], mesh.nodes, place->element, place->xi, place->eta);
    EXPECT_LT((chart.normal(at) - normal).norm(), 1e-12);
  }
}

TEST_P(EveryElement, ChartGoesOnBesideACurvedRimButNotFar) {
  const Mesh mesh = dome(Circle{2});
  const Chart chart(mesh, mesh.blocks[0], mesh.nodes);
  for (int i = 0; i < 100; ++i) {
    const Vec2 at = 2 * Vec2(std::cos(0.1 * i), std::sin(0.1 * i));
    EXPECT_NEAR(chart.lift(at).z(), 0, 1e-2);
    EXPECT_EQ(chart.lift(at).head<2>(), at);
    EXPECT_THROW(chart.lift(2 * at), GeometryError);
  }
  EXPECT_FALSE(chart.locate({2.5, 0}));
}

TEST_P(EveryElement, ChartRefusesAnOverhangAndSaysWhere) {
  Mesh mesh = dome(Circle{2});
  for (Vec3& x : mesh.nodes) {
    if (x.head<2>().norm() < 1) x.x() += 1.5 * (1 - x.head<2>().squaredNorm()); // the top leans over
  }
  try {
    const Chart chart(mesh, mesh.blocks[0], mesh.nodes);
    FAIL();
  } catch (const GeometryError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("folds over at ("));
  }
}

TEST_P(EveryElement, TriangulatedHasItsAreaAndEveryPointOnce) {
  const Mesh mesh = dome(Rectangle{4, 3});
  for (const int parts : {1, 2, 5}) {
    const Triangulation surface = triangulated(mesh, mesh.blocks[0], mesh.nodes, parts);
    const auto per_element = static_cast<std::size_t>(parts * parts * (corners_per_element(GetParam()) == 3 ? 1 : 2));
    EXPECT_EQ(surface.triangles.size(), per_element * static_cast<std::size_t>(mesh.element_count(mesh.blocks[0])));
    // Euler: one boundary, so that points - sides + triangles = 1
    std::set<std::pair<Index, Index>> sides;
    double area = 0;
    for (const auto& t : surface.triangles) {
      for (std::size_t k = 0; k < 3; ++k) sides.insert(std::minmax(t[k], t[(k + 1) % 3]));
      const auto at = [&](std::size_t k) { return surface.points[static_cast<std::size_t>(t[k])]; };
      const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
      EXPECT_GT(normal.z(), 0);
      area += normal.norm() / 2;
    }
    EXPECT_EQ(surface.points.size() + surface.triangles.size(), sides.size() + 1);
    EXPECT_NEAR(area, surface_area(mesh, mesh.blocks[0], mesh.nodes), 0.004 * area);
  }
}

} // namespace
