// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/curvature.h"
#include "geometry/meshing/plan_mesh.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;

class CurvatureOnEveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(Types, CurvatureOnEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

// largest errors at reliable nodes, of the curvatures and of their sum, 1/m
struct Errors {
  double each = 0, sum = 0, normal = 0;
  int reliable = 0;
};

Errors on_sphere(ElementType element, double size, Pattern pattern) {
  const double radius = 2;
  Mesh mesh = stack(mesh_plan(Circle{1.2}, {element, size, std::nullopt, pattern}), {{"a"}, {"b"}});
  for (Vec3& x : mesh.nodes) x.z() = std::sqrt(radius * radius - x.squaredNorm());
  Errors errors;
  for (const FittedCurvature& c : fitted_curvatures(mesh, mesh.blocks[1], mesh.nodes)) {
    if (!c.reliable) continue;
    ++errors.reliable;
    errors.each = std::max({errors.each, std::abs(c.first - 1 / radius), std::abs(c.second - 1 / radius)});
    errors.sum = std::max(errors.sum, std::abs(c.sum() - 2 / radius));
    EXPECT_NEAR(c.normal.norm(), 1, 1e-14);
    EXPECT_NEAR(c.first_direction.dot(c.second_direction), 0, 1e-12);
    EXPECT_NEAR(c.first_direction.norm(), 1, 1e-12);
  }
  return errors;
}

TEST_P(CurvatureOnEveryElement, OfASphereConverges) {
  for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
    const Errors coarse = on_sphere(GetParam(), 0.2, pattern);
    const Errors fine = on_sphere(GetParam(), 0.1, pattern);
    EXPECT_GT(coarse.reliable, 20);
    EXPECT_LT(fine.sum, 1e-4) << "of 1/m";
    EXPECT_LT(fine.sum, coarse.sum / 5); // order 2.9 to 4.1
    EXPECT_LT(fine.each, coarse.each / 3);
  }
}

TEST_P(CurvatureOnEveryElement, OfACatenoidIsOppositeAlongMeridianAndRing) {
  const double waist = 1;
  const auto errors = [&](double size) {
    Mesh mesh = mesh_plan(Rectangle{2, 1.6}, {GetParam(), size, std::nullopt});
    std::vector<Vec3> x;
    for (const Vec3& plan : mesh.nodes) {
      const double r = waist * std::cosh(plan.y() / waist);
      x.emplace_back(r * std::cos(plan.x()), r * std::sin(plan.x()), plan.y());
    }
    const auto fitted = fitted_curvatures(mesh, mesh.blocks[0], x);
    Errors error;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const FittedCurvature& c = fitted[i];
      if (!c.reliable) continue;
      const double exact = 1 / (waist * std::pow(std::cosh(mesh.nodes[i].y() / waist), 2));
      error.each = std::max({error.each, std::abs(c.first - exact), std::abs(c.second + exact)});
      error.sum = std::max(error.sum, std::abs(c.sum()));
      const Vec3 ring(-std::sin(mesh.nodes[i].x()), std::cos(mesh.nodes[i].x()), 0);
      EXPECT_GT(std::abs(c.first_direction.dot(ring)), 0.99);
      EXPECT_GT(c.normal.dot(Vec3(x[i].x(), x[i].y(), 0)), 0);
    }
    return error;
  };
  const Errors coarse = errors(0.16);
  const Errors fine = errors(0.08);
  EXPECT_LT(coarse.sum, 2e-2) << "beside curvatures of 1/m";
  EXPECT_LT(fine.sum, coarse.sum / 3);
  EXPECT_LT(fine.each, coarse.each / 3);
}

TEST_P(CurvatureOnEveryElement, OfAPlaneIsZeroAndTheRimIsNotReliable) {
  Mesh mesh = mesh_plan(Rectangle{4, 3}, {GetParam(), 0.4, std::nullopt, Pattern::unstructured});
  for (Vec3& x : mesh.nodes) x.z() = 0.3 * x.x() - 0.2 * x.y();
  const auto fitted = fitted_curvatures(mesh, mesh.blocks[0], mesh.nodes);
  for (const FittedCurvature& c : fitted) {
    EXPECT_NEAR(c.first, 0, 1e-12);
    EXPECT_NEAR(c.second, 0, 1e-12);
  }
  for (const Edge& edge : mesh.edges) {
    for (const Index i : edge.nodes) EXPECT_FALSE(fitted[static_cast<std::size_t>(i)].reliable);
  }
}

TEST(Curvature, OfCollapsedPositionsIsUnreliableNotACrash) {
  const Mesh mesh = mesh_plan(Rectangle{4, 3}, {ElementType::T6, 0.5, std::nullopt});
  const std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  for (const FittedCurvature& c : fitted_curvatures(mesh, mesh.blocks[0], x)) EXPECT_FALSE(c.reliable);
}

} // namespace
