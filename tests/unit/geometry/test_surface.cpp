// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/plan_mesh.h"
#include "geometry/surface.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;

class SurfaceOfEveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(Types, SurfaceOfEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

Mesh meshed(ElementType element, const Plan& plan, double size, Pattern pattern = Pattern::structured) {
  return mesh_plan(plan, {element, size, std::nullopt, pattern});
}

TEST_P(SurfaceOfEveryElement, AreaOfATiltedPlaneIsExact) {
  Mesh mesh = meshed(GetParam(), Rectangle{4, 3}, 0.5, Pattern::unstructured);
  for (Vec3& x : mesh.nodes) x.z() = 0.75 * x.x() + 2;
  EXPECT_NEAR(surface_area(mesh, mesh.blocks[0], mesh.nodes), 12 * 1.25, 1e-13 * 12);
}

TEST_P(SurfaceOfEveryElement, AreaOfASphericalCapConverges) {
  const double radius = 2;
  const auto error = [&](int n) {
    Mesh mesh = mesh_plan(Circle{1}, {GetParam(), std::nullopt, std::array{n, n / 2}});
    for (Vec3& x : mesh.nodes) x.z() = std::sqrt(radius * radius - x.squaredNorm());
    const double exact = 2 * std::numbers::pi * radius * (radius - std::sqrt(radius * radius - 1));
    return std::abs(surface_area(mesh, mesh.blocks[0], mesh.nodes) - exact);
  };
  EXPECT_GT(std::log2(error(8) / error(16)), is_quadratic(GetParam()) ? 3.5 : 1.9);
}

TEST_P(SurfaceOfEveryElement, DeepestPointOfAParaboloidIsFoundBetweenNodesByQuadraticElements) {
  // straight quadratic triangles and parallelograms hold a paraboloid exactly
  Mesh mesh = meshed(GetParam(), Rectangle{4, 3}, 0.5);
  const Vec3 apex(0.337, -0.211, -0.8);
  for (Vec3& x : mesh.nodes) x.z() = -0.8 + 0.1 * (x - apex).head<2>().squaredNorm();
  const Plane plane{Vec3::Zero(), Vec3::UnitZ()};
  const DeepestPoint deepest = deepest_point(mesh, mesh.blocks[0], mesh.nodes, plane);
  if (is_quadratic(GetParam())) {
    EXPECT_NEAR(deepest.distance, 0.8, 1e-14);
    EXPECT_LT((deepest.at - apex).norm(), 1e-7);
  } else {
    EXPECT_NEAR(deepest.distance, 0.8, 0.1 * 2 * 0.25 * 0.25);
    EXPECT_LT(deepest.distance, 0.8);
  }
  EXPECT_EQ(deepest.at, point_on(mesh, mesh.blocks[0], mesh.nodes, deepest.element, deepest.xi, deepest.eta));
}

TEST_P(SurfaceOfEveryElement, DeepestPointIsNeverBelowAnySampledPoint) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mesh mesh = meshed(GetParam(), Circle{1}, 0.6);
  const Plane plane{Vec3(0.1, 0, 0), Vec3(0.1, 0.2, 1).normalized()};
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec3> x = mesh.nodes;
    for (Vec3& node : x) node += 0.2 * Vec3(uniform(random), uniform(random), uniform(random));
    const DeepestPoint deepest = deepest_point(mesh, mesh.blocks[0], x, plane);
    double sampled = 0;
    const int n = 12;
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          const bool triangle = corners_per_element(GetParam()) == 3;
          if (triangle && i + j > n) continue;
          const double xi = triangle ? i / 12.0 : i / 6.0 - 1;
          const double eta = triangle ? j / 12.0 : j / 6.0 - 1;
          sampled = std::max(sampled, std::abs(plane.distance(point_on(mesh, mesh.blocks[0], x, e, xi, eta))));
        }
      }
    }
    EXPECT_GE(deepest.distance, sampled * (1 - 1e-14));
    EXPECT_LT(deepest.distance, sampled * 1.05);
    EXPECT_NEAR(std::abs(plane.distance(deepest.at)), deepest.distance, 1e-14);
  }
}

TEST_P(SurfaceOfEveryElement, SagIsFoundOnTheRoomSideToo) {
  Mesh mesh = meshed(GetParam(), Circle{1}, 0.25);
  for (Vec3& x : mesh.nodes) x.z() = 0.2 * (x.head<2>().squaredNorm() - 1);
  const DeepestPoint deepest = deepest_point(mesh, mesh.blocks[0], mesh.nodes, edge_plane(mesh, mesh.nodes));
  EXPECT_NEAR(deepest.distance, 0.2, 1e-12); // a regular pattern of a given size has a node in the middle
  EXPECT_LT(deepest.at.z(), 0);
}

TEST(EdgePlane, FollowsARimTurnedInSpaceAndFacesTheWeatherSide) {
  const Mesh mesh = stack(meshed(ElementType::T6, Rectangle{4, 3}, 0.5), {{"a"}, {"b"}});
  const Eigen::Quaterniond turn(0.5, 0.1, -0.7, 0.3);
  const Eigen::Matrix3d rotation = turn.normalized().toRotationMatrix();
  std::vector<Vec3> x = mesh.nodes;
  for (Vec3& node : x) node = rotation * node + Vec3(1, 2, 3);
  const Plane plane = edge_plane(mesh, x);
  EXPECT_LT((plane.normal - rotation.col(2)).norm(), 1e-14);
  EXPECT_NEAR(plane.distance(Vec3(1, 2, 3)), 0, 1e-14);
  EXPECT_LT((normal_at(mesh, mesh.blocks[1], x, 5, 0.2, 0.3) - rotation.col(2)).norm(), 1e-13);
}

TEST(EdgePlane, RefusesEdgesOnALine) {
  Mesh mesh = meshed(ElementType::Q4, Rectangle{4, 3}, 1);
  for (Vec3& x : mesh.nodes) x.y() = 0;
  EXPECT_THROW(edge_plane(mesh, mesh.nodes), pneuma::base::GeometryError);
  mesh.edges.clear();
  EXPECT_THROW(edge_plane(mesh, mesh.nodes), pneuma::base::GeometryError);
}

TEST(DeepestPoint, OfAFlatFoilIsZero) {
  const Mesh mesh = meshed(ElementType::Q9, Rectangle{4, 3}, 1);
  EXPECT_EQ(deepest_point(mesh, mesh.blocks[0], mesh.nodes, edge_plane(mesh, mesh.nodes)).distance, 0);
}

TEST(Span, IsTheLongestSideOfTheBox) {
  const std::vector<Vec3> x = {{0, 0, 1}, {3, -1, 2}, {1, 1, 1}};
  EXPECT_EQ(span_of(x), 3);
  EXPECT_EQ(bounding_box(x).low, Vec3(0, -1, 1));
  EXPECT_EQ(bounding_box(x).high, Vec3(3, 1, 2));
  EXPECT_EQ(span_of({}), 0);
}

} // namespace
