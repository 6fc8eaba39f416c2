// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces of a foil that is cut: their sides, their triangles, and the plane they start from.
#include <cmath>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/flattening/parameterization.h"
#include "geometry/flattening/rotation.h"
#include "geometry/meshing/plan_mesh.h"
#include "geometry/polygon.h"
#include "geometry/strips/sides.h"
#include "geometry/strips/strip_surface.h"
#include "tests/unit/message_of.h"

namespace {

using namespace pneuma::geometry;
using pneuma::base::GeometryError;
using pneuma::tests::message_of;
using testing::HasSubstr;

constexpr std::array all_elements = {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9};

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

Vec3 centre_of(const Mesh& mesh, Index element) {
  Vec3 sum = Vec3::Zero();
  const auto nodes = mesh.element_nodes(mesh.blocks[0], element);
  for (const Index node : nodes) sum += mesh.nodes[at(node)];
  return sum / static_cast<double>(nodes.size());
}

// A rectangle of 4 x 3 m in one piece or cut along y = 0.5 and y = -0.5, strips numbered from above.
struct Sheet {
  Mesh mesh;
  std::vector<Index> strip_of_element;
  std::vector<std::vector<Index>> seams; // along x, the upper one first

  explicit Sheet(ElementType element, std::array<int, 2> divisions = {8, 6})
      : mesh(meshing::mesh_plan(Rectangle{4, 3}, {element, {}, divisions, meshing::Pattern::structured})) {
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      const double y = centre_of(mesh, e).y();
      strip_of_element.push_back(y > 0.5 ? 0 : y > -0.5 ? 1 : 2);
    }
    for (const double y : {0.5, -0.5}) {
      std::vector<Index>& seam = seams.emplace_back();
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        if (std::abs(mesh.nodes[i].y() - y) < 1e-9) seam.push_back(static_cast<Index>(i));
      }
      std::sort(seam.begin(), seam.end(),
                [&](Index a, Index b) { return mesh.nodes[at(a)].x() < mesh.nodes[at(b)].x(); });
    }
  }
  const Block& block() const { return mesh.blocks[0]; }
  std::string name(const strips::StripSide& side) const {
    if (side.seam >= 0) return (side.reversed ? "-S" : "S") + std::to_string(side.seam + 1);
    return side.edge >= 0 ? mesh.edges[at(side.edge)].name : "?";
  }
};

TEST(StripSides, RunAroundEachStripThroughAllItsNodes) {
  const std::vector<std::set<std::string>> names = {
      {"S1", "east", "north", "west"}, {"S2", "east", "-S1", "west"}, {"south", "east", "-S2", "west"}};
  for (const ElementType element : all_elements) {
    const Sheet sheet(element);
    for (Index strip = 0; strip < 3; ++strip) {
      const auto sides = strips::sides_of(sheet.mesh, sheet.block(), sheet.strip_of_element, strip, sheet.seams);
      ASSERT_EQ(sides.size(), 4u) << name_of(element);
      std::set<std::string> found;
      std::vector<Vec2> ring;
      for (std::size_t k = 0; k < 4; ++k) {
        found.insert(sheet.name(sides[k]));
        EXPECT_EQ(sides[k].nodes.back(), sides[(k + 1) % 4].nodes.front());
        for (std::size_t i = 0; i + 1 < sides[k].nodes.size(); ++i) {
          const Vec3& x = sheet.mesh.nodes[at(sides[k].nodes[i])];
          const Vec3& next = sheet.mesh.nodes[at(sides[k].nodes[i + 1])];
          EXPECT_NEAR((next - x).norm(), is_quadratic(element) ? 0.25 : 0.5, 1e-12) << name_of(element);
          ring.push_back(x.head<2>());
        }
        if (sides[k].seam < 0) continue;
        // the seam's own nodes, in its direction or against it
        std::vector<Index> nodes = sides[k].nodes;
        if (sides[k].reversed) std::reverse(nodes.begin(), nodes.end());
        EXPECT_EQ(nodes, sheet.seams[at(sides[k].seam)]);
      }
      EXPECT_EQ(found, names[at(strip)]) << name_of(element);
      EXPECT_NEAR(signed_area(ring), 4, 1e-12) << name_of(element); // counterclockwise
    }
  }
}

TEST(StripSides, OfAWholeCircleAreOneClosedSide) {
  for (const ElementType element : all_elements) {
    const Mesh mesh = meshing::mesh_plan(Circle{2}, {element, {}, std::array{4, 4}, meshing::Pattern::structured});
    const std::vector<Index> one(at(mesh.element_count(mesh.blocks[0])), 0);
    const auto sides = strips::sides_of(mesh, mesh.blocks[0], one, 0, {});
    ASSERT_EQ(sides.size(), 1u);
    EXPECT_EQ(sides[0].edge, 0);
    EXPECT_EQ(sides[0].nodes.front(), sides[0].nodes.back());
    EXPECT_EQ(sides[0].nodes.size(), mesh.edges[0].nodes.size() + 1);
  }
}

TEST(StripSides, OfAStripThatIsNoneAreRefused) {
  Sheet sheet(ElementType::Q4);
  const auto sides = [&](Index strip) {
    strips::sides_of(sheet.mesh, sheet.block(), sheet.strip_of_element, strip, sheet.seams);
  };
  EXPECT_THAT(message_of<GeometryError>([&] { sides(3); }), HasSubstr("strip 4 of"));
  for (Index e = 0; e < sheet.mesh.element_count(sheet.block()); ++e) {
    const Vec3 centre = centre_of(sheet.mesh, e);
    sheet.strip_of_element[at(e)] = centre.head<2>().cwiseAbs().maxCoeff() < 0.6 ? 1 : 0; // a hole in strip 1
  }
  EXPECT_THAT(message_of<GeometryError>([&] { sides(0); }), HasSubstr("strip 1 of"));
  EXPECT_THAT(message_of<GeometryError>([&] { sides(0); }), HasSubstr("has a hole or falls into parts"));
  for (Index e = 0; e < sheet.mesh.element_count(sheet.block()); ++e) {
    const Vec3 centre = centre_of(sheet.mesh, e);
    sheet.strip_of_element[at(e)] = centre.x() * centre.y() > 0 ? 0 : 1; // meets itself in the middle
  }
  EXPECT_THAT(message_of<GeometryError>([&] { sides(0); }), HasSubstr("touches itself at (0, 0, 0) m"));
}

TEST(StripSurface, HasTheStripsAreaAndEachNodeOnce) {
  for (const ElementType element : all_elements) {
    const Sheet sheet(element);
    for (Index strip = 0; strip < 3; ++strip) {
      const strips::StripSurface piece =
          strips::strip_surface(element, sheet.block().connectivity, sheet.strip_of_element, strip, sheet.mesh.nodes);
      double area = 0;
      for (const auto& [a, b, c] : piece.surface.triangles) {
        const auto x = [&](Index i) { return Vec2(piece.surface.points[at(i)].head<2>()); };
        const double part = cross(x(b) - x(a), x(c) - x(a)) / 2;
        EXPECT_GT(part, 0);
        area += part;
      }
      EXPECT_NEAR(area, 4, 1e-12) << name_of(element);
      EXPECT_EQ(std::set<Index>(piece.nodes.begin(), piece.nodes.end()).size(), piece.nodes.size());
      const std::size_t along = is_quadratic(element) ? 17 : 9;
      EXPECT_EQ(piece.nodes.size(), along * (is_quadratic(element) ? 5 : 3)) << name_of(element);
      for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
        EXPECT_EQ(piece.surface.points[i], sheet.mesh.nodes[at(piece.nodes[i])]);
      }
    }
  }
}

// Largest difference of side lengths between a surface and its flat shape, relative.
double stretch(const Triangulation& surface, const std::vector<Vec2>& flat) {
  double most = 0;
  for (const auto& triangle : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = at(triangle[k]);
      const std::size_t b = at(triangle[(k + 1) % 3]);
      const double length = (surface.points[b] - surface.points[a]).norm();
      most = std::max(most, std::abs((flat[b] - flat[a]).norm() / length - 1));
    }
  }
  return most;
}

Triangulation bent(const std::function<Vec3(const Vec3&)>& shape) {
  Sheet sheet(ElementType::T6);
  for (Vec3& x : sheet.mesh.nodes) x = shape(x);
  return strips::strip_surface(ElementType::T6, sheet.block().connectivity, sheet.strip_of_element, 1, sheet.mesh.nodes)
      .surface;
}

TEST(Conformal, KeepsAPlaneInSpaceAndADevelopableSurface) {
  const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
  const Triangulation plane = bent([&](const Vec3& x) { return Vec3(turn * x + Vec3(5, 6, 7)); });
  EXPECT_LT(stretch(plane, flattening::conformal(plane)), 1e-9);
  // a cylinder of 2 m radius; chords instead of arcs
  const Triangulation cylinder =
      bent([](const Vec3& x) { return Vec3(2 * std::sin(x.x() / 2), x.y(), 2 * std::cos(x.x() / 2)); });
  EXPECT_LT(stretch(cylinder, flattening::conformal(cylinder)), 1e-3);
}

TEST(Conformal, KeepsTheAreaAndTheOrientationOfADome) {
  const Triangulation dome = bent(
      [](const Vec3& x) { return Vec3(x.x(), x.y(), 0.3 * (1 - x.x() * x.x() / 4) * (1 - x.y() * x.y() / 2.25)); });
  const std::vector<Vec2> flat = flattening::conformal(dome);
  double area = 0;
  double flat_area = 0;
  Vec2 moment = Vec2::Zero();
  for (const auto& [a, b, c] : dome.triangles) {
    area += (dome.points[at(b)] - dome.points[at(a)]).cross(dome.points[at(c)] - dome.points[at(a)]).norm() / 2;
    const double part = cross(flat[at(b)] - flat[at(a)], flat[at(c)] - flat[at(a)]) / 2;
    EXPECT_GT(part, 0);
    flat_area += part;
    moment += part / 3 * (flat[at(a)] + flat[at(b)] + flat[at(c)]);
  }
  EXPECT_NEAR(flat_area, area, 1e-12);
  EXPECT_LT(moment.norm(), 1e-12);
  EXPECT_LT(stretch(dome, flat), 0.05);
}

TEST(Conformal, OfAClosedSurfaceIsRefused) {
  const Triangulation tetrahedron = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  EXPECT_THAT(message_of<GeometryError>([&] { flattening::conformal(tetrahedron); }), HasSubstr("without a boundary"));
}

TEST(LaidOver, FindsTheMoveAndTurnAndDoesNotMirror) {
  const std::vector<Vec2> points = {{0, 0}, {3, 0}, {3, 1}, {0.5, 2}};
  std::vector<Vec2> targets;
  for (const Vec2& p : points) targets.push_back(Eigen::Rotation2Dd(2.7) * p + Vec2(-4, 9));
  const std::vector<Vec2> laid = flattening::laid_over(points, targets);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((laid[i] - targets[i]).norm(), 1e-14);

  std::vector<Vec2> mirrored;
  for (const Vec2& p : points) mirrored.emplace_back(p.x(), -p.y());
  const std::vector<Vec2> over = flattening::laid_over(points, mirrored);
  EXPECT_NEAR(signed_area(over), signed_area(points), 1e-12);
  // no turn and no move brings it nearer
  const auto misfit = [&](double angle, const Vec2& move) {
    double sum = 0;
    for (std::size_t i = 0; i < over.size(); ++i)
      sum += (Eigen::Rotation2Dd(angle) * over[i] + move - mirrored[i]).squaredNorm();
    return sum;
  };
  for (const double angle : {-0.01, 0.01}) EXPECT_GT(misfit(angle, Vec2::Zero()), misfit(0, Vec2::Zero()));
  for (const Vec2& move : {Vec2(0.01, 0), Vec2(-0.01, 0), Vec2(0, 0.01), Vec2(0, -0.01)}) {
    EXPECT_GT(misfit(0, move), misfit(0, Vec2::Zero()));
  }
}

} // namespace
