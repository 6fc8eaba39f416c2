// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/plan_mesh.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/mesh_check.h"
#include "geometry/meshing/corner_mesh.h"
#include "geometry/meshing/structured.h"
#include "geometry/meshing/unstructured.h"

namespace pneuma::geometry::meshing {

namespace {

void check_length(const char* name, double value) {
  if (!std::isfinite(value) || value <= 0)
    throw base::GeometryError(fmt::format("plan: the {} must be positive, not {} m", name, value));
}

void check_plan(const Plan& plan) {
  if (const auto* rectangle = std::get_if<Rectangle>(&plan)) {
    check_length("length", rectangle->length);
    check_length("width", rectangle->width);
  } else if (const auto* circle = std::get_if<Circle>(&plan)) {
    check_length("radius", circle->radius);
  } else {
    const double around = perimeter(plan);
    // an equilateral triangle has area / perimeter^2 = 0.048
    if (!std::isfinite(around) || !(area(plan) > 1e-4 * around * around)) {
      throw base::GeometryError(fmt::format("plan: the three points of the triangle lie on a line, or nearly so (area "
                                            "{:.3g} m2 with a perimeter of {:.3g} m)",
                                            area(plan), around));
    }
  }
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
  check_plan(plan);
  // a clockwise triangle is meshed from its first point the other way round: its last edge comes first
  Plan counterclockwise = plan;
  bool turned = false;
  if (auto* triangle = std::get_if<Triangle>(&counterclockwise)) {
    auto& p = triangle->points;
    turned = cross(p[1] - p[0], p[2] - p[0]) < 0;
    if (turned) std::swap(p[1], p[2]);
  }
  CornerMesh corner_mesh = options.pattern == Pattern::structured ? structured_mesh(counterclockwise, options)
                                                                  : unstructured_mesh(counterclockwise, options);
  if (turned) std::swap(corner_mesh.edges[0], corner_mesh.edges[2]);
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
