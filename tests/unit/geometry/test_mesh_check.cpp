// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/mesh_check.h"
#include "geometry/meshing/plan_mesh.h"

namespace {

using namespace pneuma::geometry;
using namespace pneuma::geometry::meshing;

// 4 x 3 quadrilaterals or 24 triangles in two layers
Mesh good(ElementType element) {
  return stack(mesh_plan(Rectangle{4, 3}, {element, std::nullopt, std::array{4, 4}}), {{"upper"}, {"lower"}});
}

bool has(const std::vector<MeshFault>& faults, FaultKind kind) {
  return std::any_of(faults.begin(), faults.end(), [&](const MeshFault& fault) { return fault.kind == kind; });
}

class CheckOfEveryElement : public testing::TestWithParam<ElementType> {
protected:
  Mesh mesh = good(GetParam());
  std::vector<Index>& upper = mesh.blocks[0].connectivity;
  std::size_t per_element = static_cast<std::size_t>(nodes_per_element(GetParam()));

  Index inner() const { // a corner node on no edge
    for (const Index i : upper) {
      const auto on = [&](const Edge& edge) { return std::ranges::count(edge.nodes, i) > 0; };
      if (std::none_of(mesh.edges.begin(), mesh.edges.end(), on)) return i;
    }
    return -1;
  }
  Vec3& node(Index i) { return mesh.nodes[static_cast<std::size_t>(i)]; }
};
INSTANTIATE_TEST_SUITE_P(Types, CheckOfEveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(CheckOfEveryElement, FindsNothingInMeshesOfOurOwn) {
  for (const Plan& plan : {Plan(Rectangle{6, 2}), Plan(Circle{1.5}), Plan(Triangle{{{0, 0}, {4, 1}, {1, 3}}}),
                           Plan(Polygon{{{0, 0}, {3, 0}, {4, 2}, {2, 3}, {-0.5, 2}}}),
                           Plan(Polygon{{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}}})}) {
    for (const Pattern pattern : {Pattern::structured, Pattern::unstructured}) {
      if (pattern == Pattern::structured && std::holds_alternative<Polygon>(plan)) continue;
      for (const double size : {1.0, 0.3}) {
        const Mesh plan_mesh = mesh_plan(plan, {GetParam(), size, std::nullopt, pattern});
        EXPECT_THAT(check_mesh(plan_mesh), testing::IsEmpty());
        EXPECT_THAT(check_mesh(stack(plan_mesh, {{"a"}, {"b"}, {"c"}})), testing::IsEmpty());
      }
    }
  }
}

TEST_P(CheckOfEveryElement, FindsNumbersOutsideTheMesh) {
  upper[3] = static_cast<Index>(mesh.nodes.size());
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::bad_number));
  mesh = good(GetParam());
  mesh.edges[2].nodes[1] = -1;
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::bad_number));
  mesh = good(GetParam());
  mesh.blocks[0].connectivity.pop_back();
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::bad_number));
  mesh = good(GetParam());
  mesh.nodes[4].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::bad_number));
  EXPECT_TRUE(has(check_mesh(Mesh{}), FaultKind::bad_number));
}

TEST_P(CheckOfEveryElement, FindsARepeatedNode) {
  upper[1] = upper[0];
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::repeated_node));
}

TEST_P(CheckOfEveryElement, FindsAnUnusedNodeAndSaysWhere) {
  mesh.nodes.emplace_back(0.125, 0.25, 0);
  const std::vector<MeshFault> faults = check_mesh(mesh);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, FaultKind::unused_node);
  EXPECT_EQ(faults[0].severity, Severity::error);
  EXPECT_EQ(faults[0].at, mesh.nodes.back());
  EXPECT_THAT(faults[0].message, testing::HasSubstr("(0.125, 0.25, 0)"));
}

TEST_P(CheckOfEveryElement, FindsCoincidentNodesOfOneFoilButNotOfTwo) {
  node(inner()) = node(upper[0]);
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::coincident_nodes));
}

TEST_P(CheckOfEveryElement, FindsAFoldedElement) {
  node(inner()) += Vec3(1.5, 1.2, 0);
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::inverted_element));
}

TEST_P(CheckOfEveryElement, FindsElementsWithoutAreaAndNeedles) {
  for (Vec3& x : mesh.nodes) x.y() *= 0.01;
  const std::vector<MeshFault> faults = check_mesh(mesh);
  EXPECT_TRUE(has(faults, FaultKind::needle_element));
  EXPECT_TRUE(std::ranges::all_of(faults, [](const MeshFault& f) { return f.severity == Severity::warning; }));
  for (Vec3& x : mesh.nodes) x.y() = 0.3 * x.x();
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::degenerate_element));
}

TEST_P(CheckOfEveryElement, FindsANeighbourThatLooksTheOtherWay) {
  const int corners = corners_per_element(GetParam());
  std::reverse(upper.begin() + 1, upper.begin() + corners);
  if (is_quadratic(GetParam())) std::reverse(upper.begin() + corners, upper.begin() + 2 * corners);
  for (Vec3& x : mesh.nodes) x.z() = 0.1 * x.x() * x.y(); // else the element is simply turned over
  const std::vector<MeshFault> faults = check_mesh(mesh);
  EXPECT_TRUE(has(faults, FaultKind::flipped_neighbour));
  EXPECT_FALSE(has(faults, FaultKind::torn_side));
}

TEST_P(CheckOfEveryElement, FindsThreeElementsAtOneSide) {
  upper.insert(upper.end(), upper.begin(), upper.begin() + static_cast<std::ptrdiff_t>(per_element));
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::non_manifold_side));
}

TEST_P(CheckOfEveryElement, FindsAHoleWithoutAnEdge) {
  upper.erase(upper.end() - static_cast<std::ptrdiff_t>(per_element), upper.end());
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::side_without_edge));
}

TEST_P(CheckOfEveryElement, FindsAnEdgeThatRunsInside) {
  mesh.edges[0].nodes[2] = inner();
  const std::vector<MeshFault> faults = check_mesh(mesh);
  EXPECT_TRUE(has(faults, FaultKind::edge_inside));
}

TEST_P(CheckOfEveryElement, FindsFoilsThatShareANodeInside) {
  const Index shared = inner();
  const auto place = static_cast<std::size_t>(std::ranges::find(upper, shared) - upper.begin());
  const Index other = mesh.blocks[1].connectivity[place];
  std::ranges::replace(mesh.blocks[1].connectivity, other, shared);
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::shared_inside));
}

TEST_P(CheckOfEveryElement, FindsAnElementHeldAtAllNodes) {
  Edge inside{"inside", false, {}};
  for (std::size_t k = 0; k < per_element; ++k) inside.nodes.push_back(upper[k]);
  if (inside.nodes.size() % 2 == 0) inside.nodes.push_back(upper[0]);
  mesh.edges.push_back(inside);
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::held_element));
}

TEST(Check, FindsATornSideOfQuadraticElements) {
  Mesh mesh = good(ElementType::T6);
  std::vector<Index>& upper = mesh.blocks[0].connectivity;
  for (std::size_t k = 3; k < 6; ++k) {
    mesh.nodes.push_back(mesh.nodes[static_cast<std::size_t>(upper[k])] + Vec3(1e-3, 1e-3, 0));
    upper[k] = static_cast<Index>(mesh.nodes.size() - 1);
  }
  EXPECT_TRUE(has(check_mesh(mesh), FaultKind::torn_side));
}

TEST(Check, ListsTwentyFaultsOfAKindAtMost) {
  Mesh mesh = good(ElementType::T3);
  for (int i = 0; i < 100; ++i) mesh.nodes.emplace_back(i, 0, 0);
  const std::vector<MeshFault> faults = check_mesh(mesh);
  EXPECT_EQ(faults.size(), 20u);
  EXPECT_THAT(faults.back().message, testing::HasSubstr("not listed"));
}

} // namespace
