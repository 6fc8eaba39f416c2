// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domes.h"
#include "geometry/base/errors.h"
#include "geometry/mesh_check.h"
#include "geometry/rim.h"
#include "geometry/strips/cut.h"
#include "geometry/surface.h"
#include "tests/unit/message_of.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using namespace pneuma::geometry::strips;
using pneuma::base::GeometryError;
using pneuma::tests::message_of;
using testing::HasSubstr;

const Plan rectangle = Rectangle{6, 4};
const Plan circle = Circle{2.5};
const Plan triangle = Triangle{{{-2, -1.5}, {3, -1}, {0, 3}}};
const Plan clockwise = Triangle{{{-2, -1.5}, {0, 3}, {3, -1}}};

// A cushion with a surface for each foil.
struct Cushion {
  Plan plan;
  Mesh mesh;
  std::vector<strips::Surface> surfaces;

  Cushion(const Plan& p, ElementType element, double size, double sag = 0.5)
      : plan(p), mesh(domes::cushion(p, {element, size, std::nullopt, Pattern::unstructured}, sag)) {
    for (const Block& block : mesh.blocks) surfaces.push_back(prepare(plan, mesh, block, mesh.nodes));
  }

  // the line, geodesic or straight, between the crossings of the rim with a line in plan
  CuttingLine line(std::size_t foil, const Vec2& through, const Vec2& along, bool geodesic) const {
    const std::vector<double> ends = rim_crossings(plan, through, along);
    return geodesic ? geodesic_line(surfaces[foil], ends.at(0), ends.at(1))
                    : straight_line(surfaces[foil], ends.at(0), ends.at(1));
  }
  CutMesh cut_along(std::vector<CuttingLine> upper, std::vector<CuttingLine> lower, double size) const {
    const std::vector<Cut> cuts = {{&surfaces[0], std::move(upper)}, {&surfaces[1], std::move(lower)}};
    return cut(plan, mesh, cuts, size);
  }
};

Vec2 in_plan(const Mesh& mesh, Index i) {
  return mesh.nodes[static_cast<std::size_t>(i)].head<2>();
}

double distance_to(const std::vector<Vec2>& line, const Vec2& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec2 along = line[k + 1] - line[k];
    const double part = std::clamp((point - line[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (line[k] + part * along - point).norm());
  }
  return nearest;
}

// degrees, of the elements' corners in plan; but for those in the corners of strips, which may be sharp themselves
double smallest_angle(const CutMesh& cut) {
  const Mesh& mesh = cut.mesh;
  std::set<Index> ends;
  for (const CutFoil& foil : cut.foils) {
    for (const Seam& seam : foil.seams) ends.insert({seam.nodes.front(), seam.nodes.back()});
  }
  for (const Edge& edge : mesh.edges) ends.insert({edge.nodes.front(), edge.nodes.back()});
  double smallest = 180;
  const auto n = static_cast<std::size_t>(corners_per_element(mesh.element));
  for (const Block& block : mesh.blocks) {
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const auto nodes = mesh.element_nodes(block, e);
      const auto wedge = [&](Index i) { return ends.count(i) == 1; };
      if (std::any_of(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(n), wedge)) continue;
      for (std::size_t k = 0; k < n; ++k) {
        const Vec2 a = in_plan(mesh, nodes[(k + 1) % n]) - in_plan(mesh, nodes[k]);
        const Vec2 b = in_plan(mesh, nodes[(k + n - 1) % n]) - in_plan(mesh, nodes[k]);
        smallest = std::min(smallest, std::atan2(cross(a, b), a.dot(b)) * 180 / std::numbers::pi);
      }
    }
  }
  return smallest;
}

std::set<Index> rim_nodes(const Mesh& mesh) {
  std::set<Index> nodes;
  for (const Edge& edge : mesh.edges) nodes.insert(edge.nodes.begin(), edge.nodes.end());
  return nodes;
}

std::set<Index> nodes_of(const CutMesh& cut, std::size_t foil, Index strip) {
  std::set<Index> nodes;
  const Block& block = cut.mesh.blocks[foil];
  for (Index e = 0; e < cut.mesh.element_count(block); ++e) {
    if (cut.foils[foil].strip_of_element[static_cast<std::size_t>(e)] != strip) continue;
    const auto of_element = cut.mesh.element_nodes(block, e);
    nodes.insert(of_element.begin(), of_element.end());
  }
  return nodes;
}

Block strip_of(const CutMesh& cut, std::size_t foil, Index strip) {
  Block part{"strip", BlockKind::foil, {}};
  const Block& block = cut.mesh.blocks[foil];
  for (Index e = 0; e < cut.mesh.element_count(block); ++e) {
    if (cut.foils[foil].strip_of_element[static_cast<std::size_t>(e)] != strip) continue;
    const auto nodes = cut.mesh.element_nodes(block, e);
    part.connectivity.insert(part.connectivity.end(), nodes.begin(), nodes.end());
  }
  return part;
}

double length_of(const Mesh& mesh, const std::vector<Index>& nodes) {
  double length = 0;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    length +=
        (mesh.nodes[static_cast<std::size_t>(nodes[k + 1])] - mesh.nodes[static_cast<std::size_t>(nodes[k])]).norm();
  }
  return length;
}

// What holds for every mesh of strips.
void expect_sound(const Cushion& cushion, const CutMesh& cut, const std::vector<std::vector<CuttingLine>>& lines,
                  double size) {
  const Mesh& mesh = cut.mesh;
  for (const MeshFault& fault : check_mesh(mesh)) ADD_FAILURE() << fault.message;

  ASSERT_EQ(mesh.edges.size(), cushion.mesh.edges.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    EXPECT_EQ(mesh.edges[e].name, cushion.mesh.edges[e].name);
    EXPECT_EQ(mesh.edges[e].closed, cushion.mesh.edges[e].closed);
    if (mesh.edges[e].closed) continue;
    EXPECT_LT((in_plan(mesh, mesh.edges[e].nodes.front()) - in_plan(cushion.mesh, cushion.mesh.edges[e].nodes.front()))
                  .norm(),
              1e-14);
  }
  const std::set<Index> rim = rim_nodes(mesh);
  EXPECT_EQ(static_cast<std::size_t>(*rim.rbegin() + 1), rim.size()) << "rim nodes come first";
  for (const Index i : rim) {
    const Vec2 at = in_plan(mesh, i);
    EXPECT_LT((rim_point(cushion.plan, rim_position(cushion.plan, at)) - at).norm(), 1e-14);
    EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(i)].z(), 0);
  }

  for (std::size_t f = 0; f < lines.size(); ++f) {
    const CutFoil& foil = cut.foils[f];
    const Block& block = mesh.blocks[f];
    EXPECT_EQ(block.name, cushion.mesh.blocks[f].name);
    const std::set<Index> of_block(block.connectivity.begin(), block.connectivity.end());
    EXPECT_TRUE(std::ranges::includes(of_block, rim));
    EXPECT_EQ(foil.strips, static_cast<Index>(lines[f].size()) + 1);
    ASSERT_EQ(foil.seams.size(), lines[f].size());
    ASSERT_EQ(foil.strip_of_element.size(), static_cast<std::size_t>(mesh.element_count(block)));

    double sum = 0;
    for (Index s = 0; s < foil.strips; ++s) sum += surface_area(mesh, strip_of(cut, f, s), mesh.nodes);
    const double whole = surface_area(mesh, block, mesh.nodes);
    EXPECT_NEAR(sum, whole, 1e-12 * whole);
    EXPECT_NEAR(whole, surface_area(cushion.mesh, cushion.mesh.blocks[f], cushion.mesh.nodes),
                0.7 * std::pow(std::max(size, cushion.surfaces[f].size), 2));

    for (std::size_t l = 0; l < lines[f].size(); ++l) {
      const Seam& seam = foil.seams[l];
      const std::set<Index> left = nodes_of(cut, f, seam.left);
      const std::set<Index> right = nodes_of(cut, f, seam.right);
      EXPECT_TRUE(rim.count(seam.nodes.front()) == 1 && rim.count(seam.nodes.back()) == 1);
      const Vec2 along = in_plan(mesh, seam.nodes.back()) - in_plan(mesh, seam.nodes.front());
      EXPECT_GT(along.dot(lines[f][l].plan.back() - lines[f][l].plan.front()), 0);
      for (const Index i : seam.nodes) {
        EXPECT_TRUE(left.count(i) == 1 && right.count(i) == 1);
        EXPECT_LT(distance_to(lines[f][l].plan, in_plan(mesh, i)), 1e-12);
      }
      const double length = length_of(mesh, seam.nodes);
      EXPECT_LT(length, lines[f][l].length * (1 + 1e-3));
      EXPECT_GT(length, lines[f][l].length - 0.1 * size * size);
      // the nodes stand at equal distances
      const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
      const double side = length / static_cast<double>((seam.nodes.size() - 1) / step);
      for (std::size_t k = 0; k + step < seam.nodes.size(); k += step)
        EXPECT_NEAR(length_of(mesh, {seam.nodes[k], seam.nodes[k + step]}), side, 0.05 * side);
      // the strip to the left lies there
      const auto centre = [&](Index strip) {
        Vec2 mean = Vec2::Zero();
        const std::set<Index> nodes = nodes_of(cut, f, strip);
        for (const Index i : nodes) mean += in_plan(mesh, i) / static_cast<double>(nodes.size());
        return mean;
      };
      EXPECT_GT(cross(along, centre(seam.left) - centre(seam.right)), 0);
      EXPECT_EQ(seam.left + 1, seam.right) << "strips are numbered from left to right";
    }
  }
}

struct Case {
  std::string name;
  Plan plan;
  ElementType element;
  bool geodesic;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  const std::vector<std::pair<std::string, Plan>> plans = {
      {"Rectangle", rectangle}, {"Circle", circle}, {"Triangle", triangle}, {"Clockwise", clockwise}};
  for (const auto& [name, plan] : plans) {
    for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
      for (const bool geodesic : {false, true})
        cases.push_back({name + name_of(element) + (geodesic ? "Geodesic" : "Straight"), plan, element, geodesic});
    }
  }
  return cases;
}

class EveryCut : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cases, EveryCut, testing::ValuesIn(all_cases()),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(EveryCut, IsASoundMeshWithSeamsOnItsLines) {
  const auto& [name, plan, element, geodesic] = GetParam();
  const Cushion cushion(plan, element, 0.4);
  for (const double size : {0.5, 0.25}) {
    std::vector<std::vector<CuttingLine>> lines(2);
    for (const double aside : {-0.8, 0.1, 1.0}) {
      // across the triangle's sides, not along them
      const bool upright = !std::holds_alternative<Triangle>(plan);
      lines[0].push_back(upright ? cushion.line(0, {aside, 0}, {0.1, 1}, geodesic)
                                 : cushion.line(0, {0, 0.4 + 0.9 * aside}, {-1, -0.1}, geodesic));
    }
    std::swap(lines[0][0], lines[0][2]); // given in another order than the strips'
    const CutMesh cut = cushion.cut_along(lines[0], {}, size);
    expect_sound(cushion, cut, lines, size);
    EXPECT_GT(smallest_angle(cut), 15) << "size " << size;
  }
}

class CutOfEveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(Types, CutOfEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(CutOfEveryElement, SharesTheRimOfFoilsWithDifferentLines) {
  const Cushion cushion(rectangle, GetParam(), 0.4);
  const std::vector<std::vector<CuttingLine>> lines = {
      {cushion.line(0, {-1, 0}, {0, 1}, true), cushion.line(0, {1, 0}, {0, 1}, true)},
      {cushion.line(1, {-1.5, 0}, {0, 1}, true), cushion.line(1, {0, 0}, {0, 1}, true),
       cushion.line(1, {1.5, 0}, {0, 1}, true)}};
  const CutMesh cut = cushion.cut_along(lines[0], lines[1], 0.4);
  expect_sound(cushion, cut, lines, 0.4);
  EXPECT_GT(smallest_angle(cut), 15);
}

TEST_P(CutOfEveryElement, MergesEndsThatNearlyCoincide) {
  const double size = 0.3;
  const Cushion cushion(rectangle, GetParam(), 0.4);
  const double near = 0.3 * size;
  const std::vector<CuttingLine> upper = {cushion.line(0, {0, 0}, {0, 1}, true)};
  const std::vector<CuttingLine> lower = {cushion.line(1, {near, 0}, {0, 1}, true)};
  const CutMesh cut = cushion.cut_along(upper, lower, size);
  for (const MeshFault& fault : check_mesh(cut.mesh)) ADD_FAILURE() << fault.message;
  const Seam& above = cut.foils[0].seams[0];
  const Seam& below = cut.foils[1].seams[0];
  EXPECT_EQ(above.nodes.front(), below.nodes.front());
  EXPECT_EQ(above.nodes.back(), below.nodes.back());
  for (const Index i : below.nodes) EXPECT_LT(distance_to(lower[0].plan, in_plan(cut.mesh, i)), near + 1e-12);
  EXPECT_GT(smallest_angle(cut), 15);
}

TEST_P(CutOfEveryElement, MovesAnEndNearACornerIntoIt) {
  const Cushion cushion(rectangle, GetParam(), 0.4);
  const double corner = rim_corners(rectangle)[1];
  const CuttingLine line = straight_line(cushion.surfaces[0], corner - 0.1, rim_position(rectangle, {-1, 2}));
  const CutMesh cut = cushion.cut_along({line}, {}, 0.4);
  for (const MeshFault& fault : check_mesh(cut.mesh)) ADD_FAILURE() << fault.message;
  const std::vector<Index>& seam = cut.foils[0].seams[0].nodes;
  EXPECT_EQ(in_plan(cut.mesh, seam.front()), Vec2(3, -2));
  const std::vector<Vec2> straight = {{3, -2}, {-1, 2}};
  for (const Index i : seam) EXPECT_LT(distance_to(straight, in_plan(cut.mesh, i)), 1e-12);
}

TEST_P(CutOfEveryElement, WithoutLinesIsAMeshOfTheWhole) {
  for (const Plan& plan : {rectangle, circle, triangle}) {
    const Cushion cushion(plan, GetParam(), 0.4);
    const CutMesh cut = cushion.cut_along({}, {}, 0.3);
    expect_sound(cushion, cut, {{}, {}}, 0.3);
    EXPECT_EQ(std::ranges::count(cut.foils[0].strip_of_element, 0),
              static_cast<std::ptrdiff_t>(cut.foils[0].strip_of_element.size()));
  }
}

TEST_P(CutOfEveryElement, MayHaveAStripBetweenThreeLines) {
  const Cushion cushion(circle, GetParam(), 0.4);
  std::vector<CuttingLine> lines;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * std::numbers::pi * k / 3;
    const Vec2 out(std::cos(angle), std::sin(angle));
    lines.push_back(cushion.line(0, 1.6 * out, {-out.y(), out.x()}, false));
  }
  const CutMesh cut = cushion.cut_along(lines, {}, 0.3);
  for (const MeshFault& fault : check_mesh(cut.mesh)) ADD_FAILURE() << fault.message;
  std::set<Index> middle;
  for (const Seam& seam : cut.foils[0].seams) middle.insert(seam.left);
  EXPECT_EQ(middle.size(), 1u); // the lines run counterclockwise around it
  EXPECT_EQ(cut.foils[0].strips, 4);
}

TEST_P(CutOfEveryElement, MayBeOfAPolygonWithAnInnerCorner) {
  const Polygon angle{{{-3, -2}, {-3, 2}, {0, 2}, {0, 0}, {3, 0}, {3, -2}}}; // clockwise
  const Cushion cushion(angle, GetParam(), 0.3);
  const std::vector<std::vector<CuttingLine>> lines = {
      {cushion.line(0, {-1.5, 0}, {0, 1}, true), cushion.line(0, {1.5, 0}, {0, 1}, false)}, {}};
  const CutMesh cut = cushion.cut_along(lines[0], lines[1], 0.3);
  expect_sound(cushion, cut, lines, 0.3);
  EXPECT_GT(smallest_angle(cut), 15);
}

TEST_P(CutOfEveryElement, IsTheSameEachTime) {
  const Cushion cushion(triangle, GetParam(), 0.4);
  const std::vector<CuttingLine> lines = {cushion.line(0, {0, 0}, {0.3, 1}, true)};
  const CutMesh first = cushion.cut_along(lines, {}, 0.3);
  const CutMesh second = cushion.cut_along(lines, {}, 0.3);
  EXPECT_EQ(first.mesh.nodes, second.mesh.nodes);
  EXPECT_EQ(first.mesh.blocks[0].connectivity, second.mesh.blocks[0].connectivity);
}

TEST(Cut, OfACircleHasAClosedRimWhateverTheOldMeshSays) {
  Cushion cushion(circle, ElementType::T3, 0.5);
  cushion.mesh.edges[0].closed = false; // a mesh that only brings names
  const CutMesh cut = cushion.cut_along({cushion.line(0, {0, 0.3}, {1, 0}, false)}, {}, 0.5);
  EXPECT_TRUE(cut.mesh.edges[0].closed);
  EXPECT_EQ(cut.foils[0].strips, 2);
}

TEST(Cut, KeepsABaseAsItIs) {
  const Mesh plan_mesh = mesh_plan(rectangle, {ElementType::T6, 0.5, std::nullopt});
  Mesh mesh = stack(plan_mesh, {{"foil"}, {"wall", BlockKind::base}});
  std::vector<bool> of_foil(mesh.nodes.size(), false);
  for (const Index i : mesh.blocks[0].connectivity) of_foil[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (of_foil[i]) mesh.nodes[i].z() = domes::height(rectangle, mesh.nodes[i].head<2>(), 0.5);
  }
  const strips::Surface foil = prepare(rectangle, mesh, mesh.blocks[0], mesh.nodes);
  const strips::Surface wall = prepare(rectangle, mesh, mesh.blocks[1], mesh.nodes);
  const double end = rim_position(rectangle, {0.2, -2});
  const std::vector<Cut> cuts = {{&foil, {geodesic_line(foil, end, rim_position(rectangle, {0.2, 2}))}}, {&wall, {}}};
  const CutMesh result = cut(rectangle, mesh, cuts, 0.4);
  EXPECT_THAT(check_mesh(result.mesh), testing::IsEmpty());
  EXPECT_EQ(result.mesh.blocks[1].kind, BlockKind::base);
  for (const Index i : result.mesh.blocks[1].connectivity)
    EXPECT_EQ(result.mesh.nodes[static_cast<std::size_t>(i)].z(), 0);
}

class Refusal : public testing::Test {
protected:
  const Cushion cushion{rectangle, ElementType::T3, 0.5};
  CuttingLine at(double x) const { return cushion.line(0, {x, 0}, {0, 1}, false); }
};

TEST_F(Refusal, OfTooManyStripsSaysWhereAndWhatWouldDo) {
  const std::string message = message_of<GeometryError>([&] { cushion.cut_along({at(0), at(0.5), at(1)}, {}, 0.4); });
  EXPECT_THAT(message, HasSubstr("foil `upper`: a strip is 0.5 m wide at the rim behind (0"));
  EXPECT_THAT(message, HasSubstr("at most 0.333 m"));
}

TEST_F(Refusal, OfLinesThatComeTogetherInTheMiddle) {
  const std::vector<Vec2> bow = {{1, -2}, {0.3, 0}, {1, 2}};
  const std::string message = message_of<GeometryError>([&] {
    cushion.cut_along({at(0), given_line(cushion.surfaces[0], bow)}, {}, 0.3);
  });
  EXPECT_THAT(message, HasSubstr("foil `upper`: lines 1 and 2 come as near as 0.3"));
}

TEST_F(Refusal, OfLinesThatCross) {
  const std::vector<Vec2> across = {{-1, -2}, {1, 2}};
  EXPECT_THAT(message_of<GeometryError>([&] {
                cushion.cut_along({at(0), given_line(cushion.surfaces[0], across)}, {}, 0.3);
              }),
              HasSubstr("lines 1 and 2 cross or touch near (0, 0)"));
}

TEST_F(Refusal, OfLinesThatEndAtOnePlace) {
  const std::vector<Vec2> fan = {{0, -2}, {2, 2}};
  EXPECT_THAT(message_of<GeometryError>([&] {
                cushion.cut_along({at(0), given_line(cushion.surfaces[0], fan)}, {}, 0.3);
              }),
              HasSubstr("end at (0, -2)"));
}

TEST_F(Refusal, OfALineThatFollowsTheRim) {
  const std::vector<Vec2> beside = {{-2, -2}, {-1.8, -1.9}, {1.8, -1.9}, {2, -2}};
  EXPECT_THAT(message_of<GeometryError>([&] { cushion.cut_along({given_line(cushion.surfaces[0], beside)}, {}, 0.3); }),
              HasSubstr("to the rim at (-"));
}

TEST_F(Refusal, OfALineThatIsNotOnTheRim) {
  CuttingLine line = at(0);
  line.plan.front().y() += 0.5;
  EXPECT_THAT(message_of<GeometryError>([&] { cushion.cut_along({line}, {}, 0.3); }),
              HasSubstr("line 1 ends at (0, -1.5)"));
}

TEST_F(Refusal, OfAMeshSizeThatIsNone) {
  EXPECT_THAT(message_of<GeometryError>([&] { cushion.cut_along({}, {}, -1); }),
              HasSubstr("must be positive, not -1 m"));
}

} // namespace
