// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/geodesics/geodesics.h"
#include "geometry/meshing/plan_mesh.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::geodesics;
using namespace pneuma::geometry::meshing;
using pneuma::base::Vec2;

Triangulation surface_over(const Plan& plan, const MeshOptions& options,
                           const std::function<double(double, double)>& height) {
  Mesh mesh = mesh_plan(plan, options);
  for (Vec3& x : mesh.nodes) x.z() = height(x.x(), x.y());
  return triangulated(mesh, mesh.blocks[0], mesh.nodes, 1);
}

MeshOptions triangles(double size, Pattern pattern = Pattern::structured) {
  return {ElementType::T3, size, std::nullopt, pattern};
}

Index vertex_near(const Triangulation& surface, const Vec2& place) {
  const auto near =
      std::ranges::min_element(surface.points, {}, [&](const Vec3& p) { return (p.head<2>() - place).squaredNorm(); });
  return static_cast<Index>(near - surface.points.begin());
}

Vec2 plan_of(const Triangulation& surface, Index vertex) {
  return surface.points[static_cast<std::size_t>(vertex)].head<2>();
}

// the straight line in plan, bent aside
std::vector<Vec2> bent(const Vec2& from, const Vec2& to, double aside) {
  const Vec2 along = to - from;
  std::vector<Vec2> line;
  for (int i = 0; i <= 20; ++i) {
    const double part = i / 20.0;
    line.push_back(from + part * along + aside * 4 * part * (1 - part) * Vec2(-along.y(), along.x()).normalized());
  }
  return line;
}

double length_of(const Path& path) {
  double length = 0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) length += (path.points[k + 1] - path.points[k]).norm();
  return length;
}

TEST(ShortestPath, OnAPrismIsTheStraightLineOfTheUnrolledPrism) {
  // rows of the grid run along the cylinder's axis, so that its faces are flat strips
  const double radius = 2;
  const auto height = [&](double, double y) { return std::sqrt(radius * radius - y * y); };
  const Triangulation surface = surface_over(Rectangle{4, 3}, triangles(0.3), height);
  const Index from = vertex_near(surface, {-2, -1.5});
  const Index to = vertex_near(surface, {1.5, 1.5});
  double around = 0; // along the cross section, by chords
  const int rows = 10;
  for (int k = 0; k < rows; ++k) {
    const double a = -1.5 + 3.0 * k / rows;
    const double b = -1.5 + 3.0 * (k + 1) / rows;
    around += std::hypot(b - a, height(0, b) - height(0, a));
  }
  const double exact = std::hypot(plan_of(surface, to).x() - plan_of(surface, from).x(), around);
  EXPECT_NEAR(shortest_path(surface, from, to).length, exact, 1e-12 * exact);
  for (const double aside : {-0.8, 0.0, 0.8}) {
    const Path path = relaxed(surface, from, to, bent(plan_of(surface, from), plan_of(surface, to), aside));
    EXPECT_NEAR(path.length, exact, 1e-12 * exact);
    EXPECT_DOUBLE_EQ(length_of(path), path.length);
    EXPECT_EQ(path.points.front(), surface.points[static_cast<std::size_t>(from)]);
    EXPECT_EQ(path.points.back(), surface.points[static_cast<std::size_t>(to)]);
  }
}

TEST(ShortestPath, OnASphereConvergesToTheGreatCircle) {
  const double radius = 2;
  const auto height = [&](double x, double y) { return std::sqrt(radius * radius - x * x - y * y); };
  const auto error = [&](double size) {
    const Triangulation surface = surface_over(Circle{1.2}, triangles(size, Pattern::unstructured), height);
    const Index from = vertex_near(surface, {1.2, 0});
    const Index to = vertex_near(surface, {-0.4, 1.1});
    const auto at = [&](Index i) { return surface.points[static_cast<std::size_t>(i)]; };
    const double exact = radius * std::acos(at(from).dot(at(to)) / (radius * radius));
    const double found = shortest_path(surface, from, to).length;
    EXPECT_NEAR(relaxed(surface, from, to, bent(plan_of(surface, from), plan_of(surface, to), 0.1)).length, found,
                1e-9 * found);
    return 1 - found / exact;
  };
  const double coarse = error(0.2);
  const double fine = error(0.05);
  EXPECT_GT(fine, 0); // a polyhedron inside the sphere
  EXPECT_LT(coarse, 0.2 * 0.2 / 24);
  EXPECT_LT(fine, coarse / 9);
}

TEST(ShortestPath, OnASaddleIsTheStraightRuling) {
  const double twist = 0.4;
  const auto height = [&](double x, double y) { return twist * x * y; };
  const Triangulation surface = surface_over(Rectangle{2, 2}, triangles(0.1), height);
  const Index from = vertex_near(surface, {0.6, -1});
  const Index to = vertex_near(surface, {0.6, 1});
  const double exact = std::hypot(2.0, 2 * twist * plan_of(surface, from).x());
  EXPECT_NEAR(shortest_path(surface, from, to).length, exact, 1e-12);
  for (const double aside : {-0.3, 0.0, 0.3})
    EXPECT_NEAR(relaxed(surface, from, to, bent(plan_of(surface, from), plan_of(surface, to), aside)).length, exact,
                1e-12);
}

class RelaxedLine : public testing::Test {
protected:
  static double dome(double x, double y) { return 0.6 * (1 - x * x / 4) * (1 - y * y / 2.25); }
  static const Triangulation& surface(Pattern pattern) {
    static const Triangulation regular = surface_over(Rectangle{4, 3}, triangles(0.12), dome);
    static const Triangulation free = surface_over(Rectangle{4, 3}, triangles(0.12, Pattern::unstructured), dome);
    return pattern == Pattern::structured ? regular : free;
  }
};

TEST_F(RelaxedLine, HasTheLengthOfTheShortestPathWhateverItsStart) {
  // A polyhedron has a local minimum on either side of many a vertex: they differ by a hair.
  constexpr double other_minimum = 1e-6;
  for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
    const Triangulation& s = surface(pattern);
    const Index from = vertex_near(s, {-1.2, -1.5});
    for (const Vec2& end : {Vec2(-1.2, 1.5), Vec2(0.3, 1.5), Vec2(2, 0.7)}) {
      const Index to = vertex_near(s, end);
      const Path shortest = shortest_path(s, from, to);
      for (const double aside : {-0.25, -0.01, 0.0, 0.3}) {
        const Path path = relaxed(s, from, to, bent(plan_of(s, from), plan_of(s, to), aside));
        EXPECT_GT(path.length, shortest.length * (1 - 1e-12));
        EXPECT_LT(path.length, shortest.length * (1 + other_minimum)) << "to " << end.transpose() << " aside " << aside;
      }
      std::vector<Vec2> near;
      for (const Vec3& point : shortest.points) near.emplace_back(point.head<2>());
      EXPECT_NEAR(relaxed(s, from, to, near).length, shortest.length, 1e-9 * shortest.length);
    }
  }
}

TEST_F(RelaxedLine, MayStartAlongSidesAndThroughVertices) {
  const Triangulation& s = surface(Pattern::structured);
  const Index from = vertex_near(s, {-1, -1.5});
  const Index to = vertex_near(s, {-1, 1.5});
  const Vec2 a = plan_of(s, from);
  const Vec2 b = plan_of(s, to);
  const double shortest = shortest_path(s, from, to).length;
  const std::vector<Vec2> along_grid = {a, b};
  const std::vector<Vec2> corners = {a, {0, a.y()}, {0, b.y()}, b}; // first along the rim
  const std::vector<Vec2> back_and_forth = {a, {a.x(), 0}, {a.x(), -0.6}, {1, -0.6}, {-0.9, -0.6}, b};
  for (const auto& start : {along_grid, corners, back_and_forth})
    EXPECT_NEAR(relaxed(s, from, to, start).length, shortest, 1e-9 * shortest);
}

TEST_F(RelaxedLine, IsTheSameInBothDirections) {
  for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
    const Triangulation& s = surface(pattern);
    const Index from = vertex_near(s, {-0.7, -1.5});
    const Index to = vertex_near(s, {0.4, 1.5});
    std::vector<Vec2> start = bent(plan_of(s, from), plan_of(s, to), 0.15);
    const Path there = relaxed(s, from, to, start);
    std::reverse(start.begin(), start.end());
    const Path back = relaxed(s, to, from, start);
    EXPECT_NEAR(there.length, back.length, 1e-13 * there.length);
    EXPECT_NEAR(shortest_path(s, from, to).length, shortest_path(s, to, from).length, 1e-12 * there.length);
  }
}

TEST(RelaxedLineOnAPeak, LeadsAroundItOnTheSideOfItsStart) {
  const auto peak = [](double x, double y) { return 3 * std::exp(-4 * (x * x + y * y)); };
  const Triangulation s = surface_over(Rectangle{4, 4}, triangles(0.1), peak);
  const Index from = vertex_near(s, {-2, 0});
  const Index to = vertex_near(s, {2, 0});
  const auto middle = [&](double aside) {
    const Path path = relaxed(s, from, to, bent({-2, 0}, {2, 0}, aside));
    double farthest = 0;
    for (const Vec3& p : path.points) farthest = std::abs(p.y()) > std::abs(farthest) ? p.y() : farthest;
    return std::pair(path.length, farthest);
  };
  const auto [left, above] = middle(1);
  const auto [right, below] = middle(-1);
  EXPECT_GT(above, 0.3);
  EXPECT_LT(below, -0.3);
  EXPECT_NEAR(left, right, 1e-3 * left);
  EXPECT_NEAR(std::min(left, right), shortest_path(s, from, to).length, 1e-9 * left);
}

TEST(Paths, BetweenNeighboursAreTheirCommonSide) {
  const Triangulation s = surface_over(Rectangle{2, 2}, triangles(0.5), [](double x, double y) { return x * y; });
  const auto& [a, b, c] = s.triangles[5];
  const auto at = [&](Index i) { return s.points[static_cast<std::size_t>(i)]; };
  EXPECT_NEAR(shortest_path(s, a, b).length, (at(a) - at(b)).norm(), 1e-15);
  EXPECT_NEAR(relaxed(s, a, b, {plan_of(s, a), plan_of(s, b)}).length, (at(a) - at(b)).norm(), 1e-15);
}

TEST(Paths, AreRefusedWhereNoneLeads) {
  Triangulation two;
  two.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {9, 9, 0}};
  two.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_THROW(shortest_path(two, 0, 4), pneuma::base::GeometryError);
  EXPECT_THROW(relaxed(two, 0, 4, {{0, 0}, {6, 0}}), pneuma::base::GeometryError);
  EXPECT_THROW(shortest_path(two, 0, 6), pneuma::base::GeometryError); // in no triangle
  EXPECT_THROW(relaxed(two, 6, 0, {{9, 9}, {0, 0}}), pneuma::base::GeometryError);
}

} // namespace
