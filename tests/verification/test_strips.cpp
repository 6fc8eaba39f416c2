// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <ctime>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/geodesics/geodesics.h"
#include "geometry/mesh_check.h"
#include "geometry/meshing/plan_mesh.h"
#include "geometry/rim.h"
#include "geometry/strips/cut.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using namespace pneuma::geometry::strips;

// A square of 4 m with a sag of 12 %.
Mesh dome(ElementType element, double size) {
  Mesh mesh = mesh_plan(Rectangle{4, 4}, {element, size, std::nullopt, Pattern::unstructured});
  for (Vec3& x : mesh.nodes) x.z() = 0.48 * (1 - x.x() * x.x() / 4) * (1 - x.y() * x.y() / 4);
  return mesh;
}

const Plan square = Rectangle{4, 4};

// Of the processor, s: what else the machine does hardly counts.
double seconds_of(auto&& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

TEST(GeodesicOnAFineMesh, OverACoarseCopyHasTheExactLengthOfTheFineTriangles) {
  const Mesh mesh = dome(ElementType::T3, 0.048);
  const strips::Surface surface = prepare(square, mesh, mesh.blocks[0], mesh.nodes);
  ASSERT_GT(surface.fine.triangles.size(), 15000u);
  ASSERT_LT(surface.coarse.triangles.size(), 4001u);
  const auto nearest = [&](const Vec2& place) {
    const auto found = std::ranges::min_element(surface.fine.points, {},
                                                [&](const Vec3& p) { return (p.head<2>() - place).squaredNorm(); });
    return static_cast<Index>(found - surface.fine.points.begin());
  };
  const auto position = [&](Index vertex) {
    return rim_position(square, surface.fine.points[static_cast<std::size_t>(vertex)].head<2>());
  };
  const Index from = nearest({0.67, -2});
  const Index to = nearest({0.9, 2});
  const double exact = geodesics::shortest_path(surface.fine, from, to).length;
  EXPECT_NEAR(geodesic_line(surface, position(from), position(to)).length, exact, 1e-5 * exact);
}

TEST(GeodesicOnASphere, MissesTheGreatCircleByNoMoreThanTheChordsOfTheMesh) {
  const double radius = 2;
  const Circle plan{1.6};
  const double drop = std::sqrt(radius * radius - plan.radius * plan.radius);
  const double chord = 2 * plan.radius * std::sin(1.2); // of the rim's points
  const double exact = 2 * radius * std::asin(chord / 2 / radius);
  const auto error = [&](double size) {
    Mesh mesh = mesh_plan(plan, {ElementType::T3, size, std::nullopt, Pattern::unstructured});
    std::vector<bool> rim(mesh.nodes.size(), false);
    for (const Index i : mesh.edges[0].nodes) rim[static_cast<std::size_t>(i)] = true;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      Vec3& x = mesh.nodes[i];
      if (!rim[i]) x.z() = std::sqrt(radius * radius - x.squaredNorm()) - drop;
    }
    const strips::Surface surface = prepare(plan, mesh, mesh.blocks[0], mesh.nodes);
    return std::abs(geodesic_line(surface, 0.3, 0.3 + 2.4 * plan.radius).length / exact - 1);
  };
  // chords of the sphere are shorter by size^2 / 24 radius^2, and the rim's chords cut off size^2 / 8 of its radius at
  // both ends, 1/12 in all; the finest goes through a coarse copy
  for (const double size : {0.2, 0.1, 0.05, 0.025}) EXPECT_LT(error(size), std::pow(size / radius, 2) / 8) << size;
}

TEST(CutOfALargeMesh, CostsLittleMoreThanItsSize) {
  // 10^4 and 4 10^4 triangles: the time may grow by more than four, but far from sixteen
  const auto time = [](double size) {
    const Mesh mesh = dome(ElementType::T3, size);
    return seconds_of([&] {
      const strips::Surface surface = prepare(square, mesh, mesh.blocks[0], mesh.nodes);
      std::vector<CuttingLine> lines;
      for (const double x : {-1.0, 0.0, 1.0})
        lines.push_back(straight_line(surface, rim_position(square, {x, -2}), rim_position(square, {x, 2})));
      const std::vector<Cut> cuts = {{&surface, lines}};
      const CutMesh result = cut(square, mesh, cuts, size);
      EXPECT_TRUE(check_mesh(result.mesh).empty());
    });
  };
  time(0.2); // warm
  const double coarse = time(0.06);
  EXPECT_LT(time(0.03), 10 * coarse);
}

TEST(SeamOfAQuadraticMesh, HasTheLengthOfItsLineWithAtLeastOrderTwo) {
  const auto error = [](double size) {
    const Mesh mesh = dome(ElementType::T6, 0.1);
    const strips::Surface surface = prepare(square, mesh, mesh.blocks[0], mesh.nodes);
    const CuttingLine line =
        geodesic_line(surface, rim_position(square, {-0.67, -2}), rim_position(square, {-0.67, 2}));
    const std::vector<Cut> cuts = {{&surface, {line}}};
    const CutMesh result = cut(square, mesh, cuts, size);
    const std::vector<Index>& seam = result.foils[0].seams[0].nodes;
    double length = 0;
    for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
      length += (result.mesh.nodes[static_cast<std::size_t>(seam[k + 1])] -
                 result.mesh.nodes[static_cast<std::size_t>(seam[k])])
                    .norm();
    }
    return 1 - length / line.length;
  };
  const double coarse = error(0.8);
  const double fine = error(0.4);
  EXPECT_LT(coarse, 3e-3);
  EXPECT_GT(coarse, 0);
  EXPECT_LT(fine, coarse / 3);
}

} // namespace
