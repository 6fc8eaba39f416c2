// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/plan_mesh.h"
#include "geometry/plan_region.h"
#include "geometry/shape_functions.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using pneuma::base::GeometryError;

class RegionOnEveryElement : public testing::TestWithParam<ElementType> {
protected:
  Mesh plate = mesh_plan(Rectangle{4, 3}, {GetParam(), 0.4, std::nullopt}); // affine elements
  Mesh free_plate = mesh_plan(Rectangle{4, 3}, {GetParam(), 0.4, std::nullopt, Pattern::unstructured});
  Mesh disc = mesh_plan(Circle{1.5}, {GetParam(), 0.4, std::nullopt});

  static double area(const Mesh& mesh, const PlanRegion& region) {
    return plan_area(mesh, mesh.blocks[0], mesh.nodes, region_quadrature(mesh, mesh.blocks[0], mesh.nodes, region));
  }
};
INSTANTIATE_TEST_SUITE_P(Types, RegionOnEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

// a five-pointed star, not convex
PlanPolygon star(double outer, double inner) {
  PlanPolygon polygon;
  for (int k = 0; k < 10; ++k) {
    const double angle = 0.2 + std::numbers::pi * k / 5;
    polygon.points.push_back((k % 2 == 0 ? outer : inner) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

// the plate without the region: a ring with a slit of no width would touch itself, so the slit is left out by halves
std::vector<PlanRegion> plate_without_box(const Vec2& low, const Vec2& high) {
  const double far = 9;
  return {PlanPolygon{{{-far, -far},
                       {far, -far},
                       {far, high.y()},
                       {high.x(), high.y()},
                       {high.x(), low.y()},
                       {low.x(), low.y()},
                       {-far, low.y()}}},
          PlanPolygon{
              {{-far, low.y()}, {low.x(), low.y()}, {low.x(), high.y()}, {far, high.y()}, {far, far}, {-far, far}}}};
}

TEST_P(RegionOnEveryElement, WholePlanIsTheWholeArea) {
  EXPECT_NEAR(area(plate, WholePlan{}), 12, 1e-12);
  const RegionQuadrature whole = region_quadrature(disc, disc.blocks[0], disc.nodes, WholePlan{});
  EXPECT_EQ(static_cast<Index>(whole.parts.size()), disc.element_count(disc.blocks[0]));
  EXPECT_EQ(whole.points.size(), pressure_rule(GetParam()).size());
}

TEST_P(RegionOnEveryElement, RectangleHasItsAreaWhereverItLies) {
  EXPECT_NEAR(area(plate, PlanRectangle{{-0.37, -0.81}, {1.23, 0.44}}), 1.6 * 1.25, 1e-12);
  EXPECT_NEAR(area(plate, PlanRectangle{{1.9, 1.4}, {9, 9}}), 0.01, 1e-12);         // a corner
  EXPECT_NEAR(area(plate, PlanRectangle{{0.11, 0.12}, {0.13, 0.15}}), 6e-4, 1e-14); // inside one element
  EXPECT_NEAR(area(plate, PlanRectangle{{-9, -9}, {9, 9}}), 12, 1e-12);
  EXPECT_NEAR(area(plate, PlanRectangle{{5, 5}, {9, 9}}), 0, 0);
}

TEST_P(RegionOnEveryElement, RectangleOnElementSidesTakesWholeElements) {
  const RegionQuadrature half = region_quadrature(plate, plate.blocks[0], plate.nodes, PlanRectangle{{0, -9}, {9, 9}});
  EXPECT_EQ(static_cast<Index>(2 * half.parts.size()), plate.element_count(plate.blocks[0]));
  for (const RegionQuadrature::Part& part : half.parts) EXPECT_TRUE(part.whole);
  EXPECT_NEAR(plan_area(plate, plate.blocks[0], plate.nodes, half), 6, 1e-12);
}

TEST_P(RegionOnEveryElement, PolygonNeedNotBeConvexNorCounterclockwise) {
  PlanPolygon polygon = star(1.4, 0.5);
  const double exact = signed_area(polygon.points);
  EXPECT_NEAR(area(plate, polygon), exact, 1e-12);
  std::reverse(polygon.points.begin(), polygon.points.end());
  EXPECT_NEAR(area(plate, polygon), exact, 1e-12);
}

TEST_P(RegionOnEveryElement, RegionAndRestMakeTheWhole) {
  const Vec2 low(-0.33, -0.71);
  const Vec2 high(0.9, 0.57);
  for (const Mesh* mesh : {&plate, &free_plate, &disc}) {
    Mesh bent = *mesh;
    for (Vec3& x : bent.nodes) x += Vec3(0.03 * x.y() * x.y(), 0.02 * std::sin(x.x()), 0.3 * x.x() * x.y());
    double sum = area(bent, PlanRectangle{low, high});
    EXPECT_GT(sum, 0);
    for (const PlanRegion& rest : plate_without_box(low, high)) sum += area(bent, rest);
    // chords of curved elements: exact for their reference areas, to the rule's order for Jacobians
    EXPECT_NEAR(sum, area(bent, WholePlan{}), 1e-10);
  }
}

TEST_P(RegionOnEveryElement, StraightElementsOfAnyShapeComeClose) {
  const PlanPolygon polygon = star(1.3, 0.6);
  const double exact = signed_area(polygon.points);
  // general quadrilaterals are bilinear: chords over an eighth of an element, 3e-5 of its area or less
  const bool affine = corners_per_element(GetParam()) == 3;
  EXPECT_NEAR(area(free_plate, polygon), exact, affine ? 1e-12 : 2e-4 * exact);
}

TEST_P(RegionOnEveryElement, PartlyCoveredElementsGiveTheExactVolumeBelowASurfaceTheyHold) {
  // z = f(x) g(y), of the highest degree the element holds, over a rectangle that cuts elements
  const bool quadratic = is_quadratic(GetParam());
  const bool product = corners_per_element(GetParam()) == 4;
  Mesh mesh = plate;
  for (Vec3& x : mesh.nodes) x.z() = x.x() * (quadratic ? 1 - x.x() : 1) * (product ? x.y() : 1);
  const RegionQuadrature region =
      region_quadrature(mesh, mesh.blocks[0], mesh.nodes, PlanRectangle{{-0.5, 0.1}, {1.13, 1.21}});
  const double volume = dispatch(GetParam(), [&]<ElementType E>() {
    double sum = 0;
    for (const RegionQuadrature::Part& part : region.parts) {
      const auto nodes = mesh.element_nodes(mesh.blocks[0], part.element);
      Eigen::Matrix<double, 3, nodes_per_element(E)> x;
      for (int k = 0; k < nodes_per_element(E); ++k)
        x.col(k) = mesh.nodes[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)])];
      for (const QuadraturePoint& q : region.points_of(part)) {
        const auto shape = shape_functions<E>(q.xi, q.eta);
        const Vec3 at = x * shape.value;
        const Eigen::Matrix<double, 3, 2> tangents = x * shape.derivative;
        sum += q.weight * at.z() * tangents.template topRows<2>().determinant();
      }
    }
    return sum;
  });
  const auto in_x = [&](double x) { return x * x / 2 - (quadratic ? x * x * x / 3 : 0); };
  const auto in_y = [&](double y) { return product ? y * y / 2 : y; };
  EXPECT_NEAR(volume, (in_x(1.13) - in_x(-0.5)) * (in_y(1.21) - in_y(0.1)), 1e-13);
}

TEST_P(RegionOnEveryElement, UprightElementsDoNoHarm) {
  Mesh mesh = plate;
  for (Vec3& x : mesh.nodes) {
    x.z() = std::min(0.0, 1.5 - std::abs(x.x()) * 1.5);
    x.x() = std::clamp(x.x(), -1.0, 1.0);
  }
  EXPECT_NEAR(area(mesh, PlanRectangle{{-9, -9}, {9, 0.3}}), 2 * 1.8, 1e-2);
}

TEST(Region, WithoutAreaOrCrossingItselfIsRefused) {
  const Mesh mesh = mesh_plan(Rectangle{4, 3}, {ElementType::Q4, 1.0, std::nullopt});
  const auto quadrature = [&](const PlanRegion& region) {
    return region_quadrature(mesh, mesh.blocks[0], mesh.nodes, region);
  };
  EXPECT_THROW(quadrature(PlanRectangle{{1, 0}, {0, 1}}), GeometryError);
  EXPECT_THROW(quadrature(PlanPolygon{{{0, 0}, {1, 1}}}), GeometryError);
  EXPECT_THROW(quadrature(PlanPolygon{{{0, 0}, {1, 1}, {2, 2}}}), GeometryError);
  EXPECT_THROW(quadrature(PlanPolygon{{{0, 0}, {1, 1}, {1, 0}, {0, 2}}}), GeometryError);
}

TEST(Polygon, IsMadeUpOfItsTriangles) {
  // a comb with points on a line: ears are few
  std::vector<Vec2> comb = {{0, 0}, {8, 0}};
  for (int k = 7; k >= 0; --k) {
    comb.emplace_back(k + 1, 2);
    comb.emplace_back(k + 0.5, 0.5);
  }
  comb.emplace_back(0, 1);
  double sum = 0;
  for (const auto& t : triangulate(comb)) {
    const std::array<Vec2, 3> corners = {comb[static_cast<std::size_t>(t[0])], comb[static_cast<std::size_t>(t[1])],
                                         comb[static_cast<std::size_t>(t[2])]};
    EXPECT_GT(signed_area(corners), 0);
    sum += signed_area(corners);
  }
  EXPECT_NEAR(sum, signed_area(comb), 1e-13);
  EXPECT_TRUE(contains(comb, {2.6, 0.55}));
  EXPECT_FALSE(contains(comb, {2.4, 1.9}));
}

// The same area as over a mesh of the plan, whatever the region; what is cut in two sums to the whole.
TEST(AreaInside, IsThatOfTheMesh) {
  const Polygon plan{{{0, 0}, {4, 0}, {4, 1}, {2.5, 1}, {2.5, 2}, {0, 2}}};
  const Mesh mesh = mesh_plan(plan, {ElementType::T3, 0.5, std::nullopt, Pattern::unstructured});
  PlanPolygon moved = star(1.5, 0.4);
  for (Vec2& point : moved.points) point += Vec2(2, 1.2);
  const PlanRegion regions[] = {PlanRectangle{{-1, -1}, {3, 1.5}}, PlanRectangle{{3, 0.5}, {9, 9}}, moved,
                                PlanRectangle{{3, 1.2}, {4, 2}}};
  for (const PlanRegion& region : regions) {
    const double meshed =
        plan_area(mesh, mesh.blocks[0], mesh.nodes, region_quadrature(mesh, mesh.blocks[0], mesh.nodes, region));
    EXPECT_NEAR(area_inside(plan, region), meshed, 1e-12);
  }
  EXPECT_NEAR(area_inside(plan, PlanRectangle{{-1, -1}, {1.3, 9}}) +
                  area_inside(plan, PlanRectangle{{1.3, -1}, {9, 9}}),
              area(Plan(plan)), 1e-12);
  EXPECT_NEAR(area_inside(Circle{2}, PlanRectangle{{0, 0}, {2, 2}}), std::numbers::pi, 1.01e-5 * std::numbers::pi);
  EXPECT_GE(area_inside(Circle{2}, PlanRectangle{{0, 0}, {2, 2}}), std::numbers::pi); // never too little
}

} // namespace
