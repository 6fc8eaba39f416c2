// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/plan_mesh.h"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/mesh_check.h"
#include "geometry/meshing/corner_mesh.h"
#include "geometry/meshing/structured.h"
#include "geometry/meshing/unstructured.h"

namespace pneuma::geometry::meshing {

namespace {

// The same region, its points from the first one the other way round.
Plan turned_round(Plan plan) {
  if (auto* triangle = std::get_if<Triangle>(&plan)) std::swap(triangle->points[1], triangle->points[2]);
  if (auto* polygon = std::get_if<Polygon>(&plan)) std::reverse(polygon->points.begin() + 1, polygon->points.end());
  return plan;
}

// the middle of a side of the rim, on the curve of the plan
Vec2 rim_middle(const Plan& plan, const Vec2& a, const Vec2& b) {
  Vec2 chord = (a + b) / 2;
  if (const auto* circle = std::get_if<Circle>(&plan)) return chord * (circle->radius / chord.norm());
  return chord;
}

// Adds mid-side and centre nodes where the element has them and numbers all nodes: those of the rim first, in order
// around it, the others as the elements meet them.
Mesh complete(const Plan& plan, const CornerMesh& corner_mesh, ElementType element) {
  Mesh mesh;
  mesh.element = element;
  const bool quadratic = is_quadratic(element);
  constexpr Index none = -1;
  std::vector<Index> number(corner_mesh.points.size(), none); // of the points
  std::unordered_map<std::uint64_t, Index> middle_of;         // of the sides, by the points at their ends

  const auto place = [&](Index i) -> const Vec2& { return corner_mesh.points[static_cast<std::size_t>(i)]; };
  const auto add = [&](const Vec2& at) {
    mesh.nodes.emplace_back(at.x(), at.y(), 0.0);
    return static_cast<Index>(mesh.nodes.size() - 1);
  };
  const auto corner = [&](Index i) {
    Index& n = number[static_cast<std::size_t>(i)];
    if (n == none) n = add(place(i));
    return n;
  };

  const std::vector<std::string> names = edge_names(plan);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<Index>& points = corner_mesh.edges[i];
    Edge edge{names[i], names.size() == 1, {}};
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Index a = points[k];
      edge.nodes.push_back(corner(a));
      if (!quadratic || (k + 1 == points.size() && !edge.closed)) continue;
      const Index b = points[(k + 1) % points.size()];
      edge.nodes.push_back(middle_of[side_key(a, b)] = add(rim_middle(plan, place(a), place(b))));
    }
    mesh.edges.push_back(edge);
  }

  Block block{"plan", BlockKind::foil, {}};
  const auto corners = static_cast<std::size_t>(corner_mesh.corners);
  block.connectivity.reserve(corner_mesh.cell_count() * static_cast<std::size_t>(nodes_per_element(element)));
  for (std::size_t cell = 0; cell < corner_mesh.cell_count(); ++cell) {
    const Index* points = corner_mesh.cells.data() + cell * corners;
    for (std::size_t k = 0; k < corners; ++k) block.connectivity.push_back(corner(points[k]));
    if (!quadratic) continue;
    Vec3 centre = Vec3::Zero(); // Coons' patch of the sides; the mean of the corners where all sides are straight
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = points[k];
      const Index b = points[(k + 1) % corners];
      const auto [found, fresh] = middle_of.try_emplace(side_key(a, b), none);
      if (fresh) found->second = add((place(a) + place(b)) / 2);
      block.connectivity.push_back(found->second);
      centre += mesh.nodes[static_cast<std::size_t>(found->second)] / 2;
      centre.head<2>() -= place(a) / 4;
    }
    if (element == ElementType::Q9) block.connectivity.push_back(add(centre.head<2>()));
  }
  mesh.blocks.push_back(std::move(block));
  return mesh;
}

} // namespace

Mesh mesh_plan(const Plan& plan, const MeshOptions& options) {
  if (const std::string fault = plan_fault(plan); !fault.empty()) throw base::GeometryError("plan: " + fault);
  if (std::holds_alternative<Polygon>(plan) && options.pattern == Pattern::structured) {
    throw base::InputError("mesh: a polygon has no structured pattern; allowed: unstructured");
  }
  // a clockwise outline is meshed counterclockwise from its first point: its last edge comes first
  const bool turned = signed_area(corner_points(plan)) < 0;
  const Plan counterclockwise = turned ? turned_round(plan) : plan;
  CornerMesh corner_mesh = options.pattern == Pattern::structured ? structured_mesh(counterclockwise, options)
                                                                  : unstructured_mesh(counterclockwise, options);
  if (turned) std::reverse(corner_mesh.edges.begin(), corner_mesh.edges.end());
  Mesh mesh = complete(plan, corner_mesh, options.element);
  for (const MeshFault& fault : check_mesh(mesh)) {
    if (fault.severity == Severity::error)
      throw base::GeometryError("no valid mesh of the plan: " + fault.message + "; try another size or pattern");
  }
  return mesh;
}

Mesh stack(const Mesh& plan_mesh, const std::vector<Layer>& layers) {
  if (plan_mesh.blocks.size() != 1)
    throw base::GeometryError(fmt::format("stack: the plan mesh must have one block, not {}", plan_mesh.blocks.size()));
  if (layers.empty()) throw base::GeometryError("stack: at least one layer is needed");
  const std::vector<Index>& plan = plan_mesh.blocks.front().connectivity;
  const std::size_t count = plan_mesh.nodes.size();
  std::vector<bool> rim(count, false);
  for (const Edge& edge : plan_mesh.edges) {
    for (const Index node : edge.nodes) rim[static_cast<std::size_t>(node)] = true;
  }

  Mesh mesh;
  mesh.element = plan_mesh.element;
  mesh.edges = plan_mesh.edges;
  mesh.nodes = plan_mesh.nodes;
  std::vector<Index> number(count); // of the plan's nodes in the layer
  for (std::size_t i = 0; i < count; ++i) number[i] = static_cast<Index>(i);
  for (const Layer& layer : layers) {
    const bool repeated = std::any_of(mesh.blocks.begin(), mesh.blocks.end(),
                                      [&](const Block& block) { return block.name == layer.name; });
    if (repeated) throw base::GeometryError(fmt::format("stack: two layers are named {}", layer.name));
    if (!mesh.blocks.empty()) {
      for (std::size_t i = 0; i < count; ++i) {
        if (rim[i]) continue;
        number[i] = static_cast<Index>(mesh.nodes.size());
        mesh.nodes.push_back(plan_mesh.nodes[i]);
      }
    }
    Block block{layer.name, layer.kind, {}};
    block.connectivity.reserve(plan.size());
    for (const Index node : plan) block.connectivity.push_back(number[static_cast<std::size_t>(node)]);
    mesh.blocks.push_back(std::move(block));
  }
  return mesh;
}

} // namespace pneuma::geometry::meshing
