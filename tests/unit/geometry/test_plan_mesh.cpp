// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/fill.h"
#include "geometry/meshing/plan_mesh.h"
#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"
#include "tests/unit/message_of.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;
using pneuma::base::GeometryError;
using pneuma::base::InputError;
using pneuma::base::Mat32;

const Rectangle rectangle{6, 3};
const Circle circle{2.5};
const Triangle triangle{{{-1, 0}, {3, 0.5}, {0.5, 2.5}}};
const Polygon pentagon{{{-2, -1}, {1.5, -1.5}, {2.5, 0.5}, {0, 2}, {-2.2, 1}}};
const Polygon l_shape{{{-1, -1}, {3, -1}, {3, 1}, {1, 1}, {1, 3}, {-1, 3}}};

struct Case {
  std::string name;
  Plan plan;
  MeshOptions options;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  const std::vector<std::pair<std::string, Plan>> plans = {
      {"Rectangle", rectangle}, {"Circle", circle}, {"Triangle", triangle}, {"Pentagon", pentagon}, {"L", l_shape}};
  for (const auto& [name, plan] : plans) {
    for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
      for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
        if (pattern == Pattern::structured && std::holds_alternative<Polygon>(plan)) continue;
        for (const double size : {0.9, 0.25}) {
          const std::string text = name + name_of(element) + (pattern == Pattern::structured ? "Structured" : "Free") +
                                   (size > 0.5 ? "Coarse" : "Fine");
          cases.push_back({text, plan, {element, size, std::nullopt, pattern}});
        }
      }
    }
  }
  return cases;
}

// One test for all meshes, not one for each: every start of a program costs more than all the meshes.
void for_each_case(auto&& claim) {
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(c.name);
    claim(c, mesh_plan(c.plan, c.options));
  }
}

const Vec3& node(const Mesh& mesh, Index i) {
  return mesh.nodes[static_cast<std::size_t>(i)];
}

double area_of(const Mesh& mesh) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    double area = 0;
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      const auto nodes = mesh.element_nodes(mesh.blocks[0], e);
      for (const QuadraturePoint& q : pressure_rule(E)) {
        const auto shape = shape_functions<E>(q.xi, q.eta);
        Mat32 tangents = Mat32::Zero();
        for (int k = 0; k < nodes_per_element(E); ++k)
          tangents += node(mesh, nodes[static_cast<std::size_t>(k)]) * shape.derivative.row(k);
        const double jacobian = tangents.col(0).cross(tangents.col(1)).z();
        EXPECT_GT(jacobian, 0) << "element " << e;
        area += q.weight * jacobian;
      }
    }
    return area;
  });
}

std::set<Index> rim_of(const Mesh& mesh) {
  std::set<Index> rim;
  for (const Edge& edge : mesh.edges) rim.insert(edge.nodes.begin(), edge.nodes.end());
  return rim;
}

// corners at the ends of all sides, with the number of elements on them
std::map<std::pair<Index, Index>, int> sides_of(const Mesh& mesh) {
  std::map<std::pair<Index, Index>, int> sides;
  const auto n = static_cast<std::size_t>(corners_per_element(mesh.element));
  for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
    const auto nodes = mesh.element_nodes(mesh.blocks[0], e);
    for (std::size_t k = 0; k < n; ++k) ++sides[std::minmax(nodes[k], nodes[(k + 1) % n])];
  }
  return sides;
}

TEST(EveryPlanMesh, HasTheAreaOfThePlan) {
  for_each_case([](const Case& test_case, const Mesh& mesh) {
    if (const auto* c = std::get_if<Circle>(&test_case.plan)) {
      const double relative = area_of(mesh) / area(*c) - 1;
      const double h = 2 * std::numbers::pi / static_cast<double>(mesh.edges[0].nodes.size());
      EXPECT_LT(relative, 0);
      // the chords leave h^2/6; the parabolas through the mid-nodes, at twice the h, leave less than h^4
      EXPECT_GT(relative, is_quadratic(mesh.element) ? -std::pow(h, 4) : -0.17 * h * h);
    } else {
      EXPECT_NEAR(area_of(mesh), area(test_case.plan), 1e-14 * area(test_case.plan) * 10);
    }
  });
}

TEST(EveryPlanMesh, HasItsRimNodesOnTheRim) {
  for_each_case([](const Case& test_case, const Mesh& mesh) {
    const double far = 1e-15;
    const std::vector<pneuma::base::Vec2> corners = corner_points(test_case.plan);
    for (const Edge& edge : mesh.edges) {
      for (const Index i : edge.nodes) {
        const Vec3& x = node(mesh, i);
        EXPECT_EQ(x.z(), 0);
        if (edge.name == "rim") {
          EXPECT_NEAR(x.norm(), circle.radius, far * circle.radius);
        }
        if (edge.name == "south") {
          EXPECT_EQ(x.y(), -1.5);
        }
        if (edge.name == "north") {
          EXPECT_EQ(x.y(), 1.5);
        }
        if (edge.name == "east") {
          EXPECT_EQ(x.x(), 3);
        }
        if (edge.name == "west") {
          EXPECT_EQ(x.x(), -3);
        }
        if (edge.name[0] == 'e' && edge.name.size() == 2) {
          const auto k = static_cast<std::size_t>(edge.name[1] - '1');
          const auto a = corners[k];
          const auto b = corners[(k + 1) % corners.size()];
          const double off = (b - a).x() * (x.head<2>() - a).y() - (b - a).y() * (x.head<2>() - a).x();
          EXPECT_NEAR(off, 0, 1e-14);
        }
      }
    }
  });
}

TEST(EveryPlanMesh, NamesItsEdgesCounterclockwiseInTheOrderOfTheOutline) {
  for_each_case([](const Case& test_case, const Mesh& mesh) {
    const std::vector<std::string> names = edge_names(test_case.plan);
    ASSERT_EQ(mesh.edges.size(), names.size());
    double doubled_area = 0;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Edge& edge = mesh.edges[k];
      EXPECT_EQ(edge.name, names[k]);
      EXPECT_EQ(edge.closed, names.size() == 1);
      if (!edge.closed) {
        EXPECT_EQ(edge.nodes.back(), mesh.edges[(k + 1) % names.size()].nodes.front());
      }
      const std::size_t last = edge.closed ? edge.nodes.size() : edge.nodes.size() - 1;
      for (std::size_t i = 0; i < last; ++i)
        doubled_area += node(mesh, edge.nodes[i]).cross(node(mesh, edge.nodes[(i + 1) % edge.nodes.size()])).z();
    }
    EXPECT_GT(doubled_area, 0);
  });
}

TEST(EveryPlanMesh, HasExactlyTheEdgesOfThePlanAsItsOpenSides) {
  for_each_case([](const Case&, const Mesh& mesh) {
    std::set<std::pair<Index, Index>> open;
    for (const auto& [side, elements] : sides_of(mesh)) {
      EXPECT_LE(elements, 2);
      if (elements == 1) open.insert(side);
    }
    std::set<std::pair<Index, Index>> edges;
    const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
    for (const Edge& edge : mesh.edges) {
      const std::size_t n = edge.nodes.size();
      for (std::size_t k = 0; k + step < n + (edge.closed ? step : 0); k += step)
        edges.insert(std::minmax(edge.nodes[k], edge.nodes[(k + step) % n]));
    }
    EXPECT_EQ(open, edges);
  });
}

TEST(EveryPlanMesh, HasAFreeNodeInEveryElementAndNoInteriorSideBetweenRimNodes) {
  for_each_case([](const Case&, const Mesh& mesh) {
    const std::set<Index> rim = rim_of(mesh);
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      const auto nodes =
          mesh.element_nodes(mesh.blocks[0], e).first(static_cast<std::size_t>(corners_per_element(mesh.element)));
      EXPECT_FALSE(std::all_of(nodes.begin(), nodes.end(), [&](Index i) { return rim.contains(i); }))
          << "element " << e;
    }
    for (const auto& [side, elements] : sides_of(mesh)) {
      if (elements == 2) {
        EXPECT_FALSE(rim.contains(side.first) && rim.contains(side.second));
      }
    }
  });
}

TEST(EveryPlanMesh, HasStraightInteriorSidesAndNoUnusedNode) {
  for_each_case([](const Case&, const Mesh& mesh) {
    const std::set<Index> rim = rim_of(mesh);
    std::set<Index> used;
    const auto n = static_cast<std::size_t>(corners_per_element(mesh.element));
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      const auto nodes = mesh.element_nodes(mesh.blocks[0], e);
      used.insert(nodes.begin(), nodes.end());
      if (!is_quadratic(mesh.element)) continue;
      Vec3 coons = Vec3::Zero();
      for (std::size_t k = 0; k < n; ++k) {
        const Vec3 middle = (node(mesh, nodes[k]) + node(mesh, nodes[(k + 1) % n])) / 2;
        if (!rim.contains(nodes[n + k])) {
          EXPECT_LT((node(mesh, nodes[n + k]) - middle).norm(), 1e-15);
        }
        coons += node(mesh, nodes[n + k]) / 2 - node(mesh, nodes[k]) / 4;
      }
      if (n == 4) {
        EXPECT_LT((node(mesh, nodes[8]) - coons).norm(), 2e-15);
      }
    }
    EXPECT_EQ(used.size(), mesh.nodes.size());
    EXPECT_EQ(*used.rbegin() + 1, static_cast<Index>(mesh.nodes.size()));
  });
}

TEST(EveryPlanMesh, KeepsToTheSizeAskedForOnTheRim) {
  for_each_case([](const Case& test_case, const Mesh& mesh) {
    const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
    const double size = *test_case.options.size;
    for (const Edge& edge : mesh.edges) {
      for (std::size_t k = 0; k + step < edge.nodes.size(); k += step)
        EXPECT_LE((node(mesh, edge.nodes[k + step]) - node(mesh, edge.nodes[k])).norm(), size * (1 + 1e-12));
    }
    const double mean = std::sqrt(area(test_case.plan) / static_cast<double>(mesh.element_count(mesh.blocks[0])) *
                                  (5 - corners_per_element(mesh.element)));
    EXPECT_GT(mean, 0.3 * size);
    EXPECT_LT(mean, 1.1 * size);
  });
}

TEST(EveryPlanMesh, IsTheSameTwice) {
  for_each_case([](const Case& test_case, const Mesh& mesh) {
    const Mesh again = mesh_plan(test_case.plan, test_case.options);
    EXPECT_EQ(again.nodes, mesh.nodes);
    EXPECT_EQ(again.blocks[0].connectivity, mesh.blocks[0].connectivity);
  });
}

TEST(EveryPlanMesh, StacksLayersThatShareTheEdgeNodesOnly) {
  for_each_case([](const Case&, const Mesh& mesh) {
    const Mesh cushion = stack(mesh, {{"upper"}, {"middle"}, {"lower"}, {"floor", BlockKind::base}});
    ASSERT_EQ(cushion.blocks.size(), 4u);
    EXPECT_EQ(cushion.blocks[3].name, "floor");
    EXPECT_EQ(cushion.blocks[3].kind, BlockKind::base);
    EXPECT_EQ(cushion.blocks[0].connectivity, mesh.blocks[0].connectivity);
    const std::set<Index> rim = rim_of(mesh);
    EXPECT_EQ(cushion.nodes.size(), 4 * mesh.nodes.size() - 3 * rim.size());
    for (std::size_t a = 0; a < 4; ++a) {
      const auto& first = cushion.blocks[a].connectivity;
      for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_EQ(node(cushion, first[i]), node(mesh, mesh.blocks[0].connectivity[i]));
      for (std::size_t b = 0; b < a; ++b) {
        const auto& second = cushion.blocks[b].connectivity;
        const std::set<Index> one(first.begin(), first.end());
        const std::set<Index> other(second.begin(), second.end());
        std::set<Index> both;
        std::set_intersection(one.begin(), one.end(), other.begin(), other.end(), std::inserter(both, both.begin()));
        EXPECT_EQ(both, rim);
      }
    }
  });
}

// the pattern, as the set of the elements' centres, is the same after turning or mirroring
bool is_symmetric(const Mesh& mesh, const Eigen::Matrix2d& image) {
  const auto centres = [&](const Eigen::Matrix2d& map) {
    std::set<std::pair<long, long>> set;
    for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
      pneuma::base::Vec2 sum = pneuma::base::Vec2::Zero();
      const auto nodes = mesh.element_nodes(mesh.blocks[0], e);
      for (int k = 0; k < corners_per_element(mesh.element); ++k)
        sum += map * node(mesh, nodes[static_cast<std::size_t>(k)]).head<2>();
      set.emplace(std::lround(sum.x() * 1e9), std::lround(sum.y() * 1e9));
    }
    return set;
  };
  // a grid of 1e-9 may part two equal places: compare with some tolerance
  const auto a = centres(Eigen::Matrix2d::Identity());
  return std::ranges::all_of(centres(image), [&](const auto& p) {
    for (long i = -1; i <= 1; ++i) {
      for (long j = -1; j <= 1; ++j) {
        if (a.contains({p.first + i, p.second + j})) return true;
      }
    }
    return false;
  });
}

TEST(StructuredMesh, IsSymmetricAboutBothAxesForEvenDivisions) {
  const Eigen::Matrix2d in_x = Eigen::Vector2d(-1, 1).asDiagonal();
  const Eigen::Matrix2d in_y = Eigen::Vector2d(1, -1).asDiagonal();
  for (const ElementType element : {ElementType::T6, ElementType::Q4}) {
    for (const Plan& plan : {Plan(rectangle), Plan(circle)}) {
      const Mesh mesh = mesh_plan(plan, {element, std::nullopt, std::array{6, 4}});
      EXPECT_TRUE(is_symmetric(mesh, in_x));
      EXPECT_TRUE(is_symmetric(mesh, in_y));
    }
    const double c = -0.5;
    const double s = std::sqrt(0.75);
    const Eigen::Matrix2d third{{c, -s}, {s, c}};
    const Mesh mesh = mesh_plan(equilateral(3), {element, std::nullopt, std::array{8, 0}});
    EXPECT_TRUE(is_symmetric(mesh, in_x));
    EXPECT_TRUE(is_symmetric(mesh, third));
  }
}

TEST(StructuredMesh, HasTheDivisionsAskedFor) {
  const auto count = [](const Plan& plan, ElementType element, int n, int m) {
    const Mesh mesh = mesh_plan(plan, {element, std::nullopt, std::array{n, m}});
    return mesh.element_count(mesh.blocks[0]);
  };
  EXPECT_EQ(count(rectangle, ElementType::Q9, 5, 3), 15);
  EXPECT_EQ(count(rectangle, ElementType::T6, 5, 3), 30);
  EXPECT_EQ(count(circle, ElementType::Q4, 3, 2), 9 + 24);
  EXPECT_EQ(count(circle, ElementType::T3, 1, 1), 10);
  EXPECT_EQ(count(triangle, ElementType::T6, 5, 0), 25);
  EXPECT_EQ(count(triangle, ElementType::Q9, 4, 0), 12);
}

TEST(StructuredMesh, OfACircleHasAreaOfOrderTwoAndFour) {
  for (const ElementType element : {ElementType::T3, ElementType::Q4, ElementType::T6, ElementType::Q9}) {
    const auto error = [&](int n) {
      const Mesh mesh = mesh_plan(circle, {element, std::nullopt, std::array{n, n / 2}});
      return std::abs(area_of(mesh) - area(circle));
    };
    EXPECT_NEAR(std::log2(error(8) / error(16)), is_quadratic(element) ? 4 : 2, 0.05) << name_of(element);
  }
}

TEST(StructuredMesh, OfAClockwiseTriangleNamesTheSameEdges) {
  const Triangle clockwise{{triangle.points[0], triangle.points[2], triangle.points[1]}};
  const Mesh mesh = mesh_plan(clockwise, {ElementType::T6, 0.5, std::nullopt});
  EXPECT_NEAR(area_of(mesh), area(triangle), 1e-14);
  // counterclockwise along e1 = points 0-1: from point 1 to point 0
  EXPECT_EQ(mesh.edges[0].name, "e1");
  EXPECT_EQ(node(mesh, mesh.edges[0].nodes.front()).head<2>(), clockwise.points[1]);
  EXPECT_EQ(node(mesh, mesh.edges[0].nodes.back()).head<2>(), clockwise.points[0]);
  EXPECT_EQ(node(mesh, mesh.edges[2].nodes.back()).head<2>(), clockwise.points[2]);
}

TEST(UnstructuredMesh, OfAClockwisePolygonNamesTheSameEdges) {
  Polygon clockwise = l_shape;
  std::reverse(clockwise.points.begin(), clockwise.points.end());
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Mesh mesh = mesh_plan(clockwise, {element, 0.5, std::nullopt, Pattern::unstructured});
    EXPECT_NEAR(area_of(mesh), 12, 1e-13);
    ASSERT_EQ(mesh.edges.size(), 6U);
    for (std::size_t k = 0; k < 6; ++k) {
      // counterclockwise along e1 = points 0-1: from point 1 to point 0
      EXPECT_EQ(mesh.edges[k].name, "e" + std::to_string(k + 1));
      EXPECT_EQ(node(mesh, mesh.edges[k].nodes.front()).head<2>(), clockwise.points[(k + 1) % 6]);
      EXPECT_EQ(node(mesh, mesh.edges[k].nodes.back()).head<2>(), clockwise.points[k]);
    }
  }
}

TEST(UnstructuredMesh, OfAPolygonDividesItsSidesInProportionToTheLongest) {
  const Polygon plan{{{0, 0}, {4, 0}, {4, 1}, {2, 1.5}, {0, 1}}};
  const auto divisions = [&](ElementType element, int n) {
    const Mesh mesh = mesh_plan(plan, {element, std::nullopt, std::array{n, n}, Pattern::unstructured});
    EXPECT_NEAR(area_of(mesh), 5, 1e-13);
    std::vector<std::size_t> counts;
    for (const Edge& edge : mesh.edges) counts.push_back((edge.nodes.size() - 1) / (is_quadratic(element) ? 2 : 1));
    return counts;
  };
  EXPECT_EQ(divisions(ElementType::T6, 12), (std::vector<std::size_t>{12, 3, 6, 6, 3}));
  EXPECT_EQ(divisions(ElementType::T3, 2), (std::vector<std::size_t>{2, 2, 2, 2, 2}));
  EXPECT_EQ(divisions(ElementType::Q9, 12), (std::vector<std::size_t>{12, 4, 6, 6, 4}));
  EXPECT_EQ(divisions(ElementType::Q4, 2), (std::vector<std::size_t>{2, 2, 2, 2, 2}));
}

TEST(UnstructuredMesh, OfAPolygonMayHaveStraightCornersAndNarrowArms) {
  // a corner in the middle of a side, two arms, a slot between them
  const Polygon comb{{{0, 0}, {3, 0}, {6, 0}, {6, 3}, {5.6, 3}, {5.6, 0.5}, {0.4, 0.5}, {0.4, 3}, {0, 3}}};
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Mesh mesh = mesh_plan(comb, {element, 0.3, std::nullopt, Pattern::unstructured});
    EXPECT_NEAR(area_of(mesh), area(comb), 1e-13);
    EXPECT_EQ(mesh.edges[1].name, "e2");
  }
}

template <class Error>
std::string message_of(const Plan& plan, const MeshOptions& options) {
  return pneuma::tests::message_of<Error>([&] { mesh_plan(plan, options); });
}

TEST(PlanMesh, RefusesBadOptionsAndSaysWhatIsAllowed) {
  using testing::HasSubstr;
  const auto divisions = [](ElementType e, int n, int m) { return MeshOptions{e, std::nullopt, std::array{n, m}}; };
  const auto size = [](double s) { return MeshOptions{ElementType::T6, s, std::nullopt}; };
  EXPECT_THAT(message_of<InputError>(rectangle, {}), HasSubstr("exactly one"));
  EXPECT_THAT(message_of<InputError>(rectangle, {ElementType::T6, 0.1, std::array{4, 4}}), HasSubstr("exactly one"));
  EXPECT_THAT(message_of<InputError>(rectangle, size(-1)), HasSubstr("must be positive"));
  EXPECT_THAT(message_of<InputError>(rectangle, size(std::nan(""))), HasSubstr("must be positive"));
  EXPECT_THAT(message_of<InputError>(rectangle, size(1e-9)), HasSubstr("too small"));
  EXPECT_THAT(message_of<InputError>(rectangle, size(1e-3)), HasSubstr("are the most"));
  EXPECT_THAT(message_of<InputError>(rectangle, divisions(ElementType::T3, 1, 4)), HasSubstr("at least 2"));
  EXPECT_THAT(message_of<InputError>(circle, divisions(ElementType::Q4, 4, 0)), HasSubstr("at least 1"));
  EXPECT_THAT(message_of<InputError>(triangle, divisions(ElementType::T3, 2, 0)), HasSubstr("at least 3"));
  EXPECT_THAT(message_of<InputError>(triangle, divisions(ElementType::Q9, 5, 0)), HasSubstr("even"));
  EXPECT_THAT(
      message_of<InputError>(rectangle, {ElementType::Q4, std::nullopt, std::array{5, 4}, Pattern::unstructured}),
      HasSubstr("even"));
  EXPECT_THAT(message_of<GeometryError>(Rectangle{6, 0}, size(1)), HasSubstr("width must be positive"));
  EXPECT_THAT(message_of<GeometryError>(Circle{-1}, size(1)), HasSubstr("radius must be positive"));
  EXPECT_THAT(message_of<GeometryError>(Triangle{{{0, 0}, {1, 1}, {2, 2}}}, size(1)), HasSubstr("lie on a line"));
}

TEST(PlanMesh, RefusesPolygonsThatAreNoRegionWithThePlace) {
  using testing::HasSubstr;
  const auto fault = [](std::vector<pneuma::base::Vec2> points) {
    return message_of<GeometryError>(Polygon{std::move(points)},
                                     {ElementType::T6, 0.5, std::nullopt, Pattern::unstructured});
  };
  EXPECT_THAT(fault({{0, 0}, {1, 0}}), HasSubstr("three points at least, not 2"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {std::nan(""), 1}}), HasSubstr("not finite"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 0}, {1, 2}}),
              HasSubstr("the edge e2 has no length: the points 2 and 3 are the same, (1, 0)"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 2}, {0, 0}}),
              HasSubstr("the edge e4 has no length: the points 4 and 1 are the same"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {0, 2}, {2, 2}}),
              HasSubstr("crosses or touches itself: its edges e2 from (2, 0) and e4 from (2, 2) meet"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}), HasSubstr("crosses or touches itself"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {4, 0}, {3, 1e-6}}), HasSubstr("lie on a line"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {2, 2}, {2, 3}, {2, 1.5}, {0, 2}}), HasSubstr("crosses or touches itself"));
  EXPECT_THAT(fault({{0, 0}, {4, 0}, {2, 0}, {2, 2}}), HasSubstr("its edges e1 from (0, 0) and e3 from (2, 0) meet"));
}

TEST(PlanMesh, RefusesOptionsThatAPolygonDoesNotHave) {
  using testing::HasSubstr;
  EXPECT_THAT(message_of<InputError>(pentagon, {ElementType::T6, 0.5, std::nullopt, Pattern::structured}),
              HasSubstr("a polygon has no structured pattern; allowed: unstructured"));
  EXPECT_THAT(
      message_of<InputError>(pentagon, {ElementType::T6, std::nullopt, std::array{1, 1}, Pattern::unstructured}),
      HasSubstr("mesh divisions 1 along the longest side: at least 2"));
  EXPECT_THAT(
      message_of<InputError>(pentagon, {ElementType::Q4, std::nullopt, std::array{7, 7}, Pattern::unstructured}),
      HasSubstr("even"));
  EXPECT_THAT(message_of<InputError>(pentagon, {ElementType::T3, 1e-3, std::nullopt, Pattern::unstructured}),
              HasSubstr("are the most"));
}

TEST(UnstructuredMesh, KeepsItsShapeFromAMillimetreToAHundredMetres) {
  const Mesh mesh = mesh_plan(Circle{1}, {ElementType::Q9, 0.2, std::nullopt, Pattern::unstructured});
  for (const double scale : {1.0 / 2048, 64.0}) {
    const Mesh scaled = mesh_plan(Circle{scale}, {ElementType::Q9, 0.2 * scale, std::nullopt, Pattern::unstructured});
    EXPECT_EQ(scaled.blocks[0].connectivity, mesh.blocks[0].connectivity);
    EXPECT_NEAR(area_of(scaled), area_of(mesh) * scale * scale, 1e-13 * scale * scale);
  }
}

TEST(Fill, RefusesRingsThatAreNoPolygon) {
  EXPECT_THROW(fill(std::vector<pneuma::base::Vec2>{{0, 0}, {1, 0}}, false), GeometryError);
  EXPECT_THROW(fill(std::vector<pneuma::base::Vec2>{{1, 1}, {1, 1}, {1, 1}}, false), GeometryError);
  EXPECT_THROW(fill(std::vector<pneuma::base::Vec2>{{0, 0}, {0, 1}, {1, 1}}, false), GeometryError); // clockwise
  EXPECT_THROW(fill(std::vector<pneuma::base::Vec2>{{0, 0}, {2, 0}, {0.5, 1}, {1, -1}}, false), GeometryError);
  EXPECT_THROW(fill(std::vector<pneuma::base::Vec2>{{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}, false), GeometryError);
}

TEST(Stack, RefusesLayersOfOneNameAndNoLayers) {
  const Mesh mesh = mesh_plan(rectangle, {ElementType::Q4, 1.0, std::nullopt});
  EXPECT_THROW(stack(mesh, {}), GeometryError);
  EXPECT_THROW(stack(mesh, {{"a"}, {"a"}}), GeometryError);
  EXPECT_THROW(stack(stack(mesh, {{"a"}, {"b"}}), {{"a"}}), GeometryError);
}

TEST(Outline, KnowsAreaPerimeterAndNames) {
  EXPECT_DOUBLE_EQ(area(rectangle), 18);
  EXPECT_DOUBLE_EQ(perimeter(rectangle), 18);
  EXPECT_DOUBLE_EQ(area(circle), std::numbers::pi * 6.25);
  EXPECT_DOUBLE_EQ(perimeter(circle), std::numbers::pi * 5);
  EXPECT_NEAR(area(equilateral(2)), std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(perimeter(equilateral(2)), 6, 1e-15);
  EXPECT_EQ(edge_names(rectangle), (std::vector<std::string>{"south", "east", "north", "west"}));
  EXPECT_DOUBLE_EQ(area(l_shape), 12);
  EXPECT_DOUBLE_EQ(perimeter(l_shape), 16);
  EXPECT_EQ(edge_names(pentagon), (std::vector<std::string>{"e1", "e2", "e3", "e4", "e5"}));
}

} // namespace
