// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/verification/examples/sheets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solver/linear/blas.h"

namespace pneuma::tests {

using namespace solver;

namespace {

// Rows x columns of nodes, both ends included; normals towards +z if columns turn left of rows.
void add_elements(geometry::Mesh& mesh, const std::vector<std::vector<Index>>& rows) {
  std::vector<Index>& c = mesh.blocks[0].connectivity;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    for (std::size_t j = 0; j + 1 < rows[i].size(); ++j) {
      c.insert(c.end(), {rows[i][j], rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]});
    }
  }
}

Index add_node(geometry::Mesh& mesh, double x, double y) {
  mesh.nodes.emplace_back(x, y, 0);
  return static_cast<Index>(mesh.nodes.size()) - 1;
}

} // namespace

geometry::Mesh mesh_of(const PerforatedSheet& sheet) {
  geometry::Mesh mesh;
  mesh.element = ElementType::Q4;
  mesh.blocks.push_back({"sheet", geometry::BlockKind::foil, {}});
  std::vector<std::vector<Index>> rings;
  std::vector<Index> top; // of the square, from x = 0
  for (int i = 0; i <= sheet.radial; ++i) {
    const double outwards = static_cast<double>(i) / sheet.radial;
    std::vector<Index> ring;
    for (int j = 0; j <= 2 * sheet.side; ++j) {
      const double part = static_cast<double>(j) / sheet.side;
      const double angle = part * std::numbers::pi / 4;
      const Vec3 hole = sheet.radius * Vec3(std::cos(angle), std::sin(angle), 0);
      const Vec3 outer = sheet.width * Vec3(std::min(1.0, 2 - part), std::min(1.0, part), 0);
      Vec3 x = hole + outwards * (outer - hole);
      if (j == 2 * sheet.side) x.x() = 0; // not the cosine's rounding
      ring.push_back(add_node(mesh, x.x(), x.y()));
    }
    rings.push_back(ring);
  }
  add_elements(mesh, rings);
  if (sheet.above > 0) {
    // columns from x = 0, each from the square upwards
    std::vector<std::vector<Index>> columns;
    for (int j = 0; j <= sheet.side; ++j) {
      std::vector<Index> column = {rings.back()[static_cast<std::size_t>(2 * sheet.side - j)]};
      const double x = mesh.nodes[static_cast<std::size_t>(column[0])].x();
      for (int i = 1; i <= sheet.above; ++i) {
        column.push_back(add_node(mesh, x, sheet.width + (sheet.height - sheet.width) * i / sheet.above));
      }
      columns.push_back(column);
    }
    add_elements(mesh, columns);
  }
  return mesh;
}

geometry::Mesh rectangle(double width, double height, int across, int along) {
  geometry::Mesh mesh;
  mesh.element = ElementType::Q4;
  mesh.blocks.push_back({"sheet", geometry::BlockKind::foil, {}});
  std::vector<std::vector<Index>> columns;
  for (int i = 0; i <= across; ++i) {
    std::vector<Index> column;
    for (int j = 0; j <= along; ++j) column.push_back(add_node(mesh, width * i / across, height * j / along));
    columns.push_back(column);
  }
  add_elements(mesh, columns);
  return mesh;
}

assembly::Model plane_model(const geometry::Mesh& mesh, const material::Law& law, double thickness) {
  assembly::Model model;
  model.mesh = mesh;
  const auto coordinates = static_cast<Eigen::Index>(3 * mesh.nodes.size());
  model.dead_to = VecX::Zero(coordinates);
  model.move = VecX::Zero(coordinates);
  for (const Vec3& x : mesh.nodes) {
    for (int c = 0; c < 3; ++c) model.fixed.push_back(c == 2 || x[c] == 0 ? 1 : 0);
  }
  model.foils.push_back(assembly::Foil{
      element::make_reference(mesh.element, geometry::StressRule::full,
                              element::corner_coordinates(mesh.blocks[0].connectivity, mesh.nodes), Vec3(1, 0, 0)),
      law, thickness});
  return model;
}

std::vector<Index> nodes_at(const geometry::Mesh& mesh, int component, double value) {
  std::vector<Index> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (std::abs(mesh.nodes[i][component] - value) < 1e-12) nodes.push_back(static_cast<Index>(i));
  }
  const int along = component == 0 ? 1 : 0;
  std::sort(nodes.begin(), nodes.end(), [&](Index a, Index b) {
    return mesh.nodes[static_cast<std::size_t>(a)][along] < mesh.nodes[static_cast<std::size_t>(b)][along];
  });
  return nodes;
}

void pull_edge(assembly::Model& model, const std::vector<Index>& edge, int component, double force) {
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const Vec3& a = model.mesh.nodes[static_cast<std::size_t>(edge[i])];
    const Vec3& b = model.mesh.nodes[static_cast<std::size_t>(edge[i + 1])];
    for (const Index node : {edge[i], edge[i + 1]}) model.dead_to[3 * node + component] += force * (b - a).norm() / 2;
  }
}

void move_edge(assembly::Model& model, const std::vector<Index>& edge, int component, double displacement) {
  for (const Index node : edge) {
    model.fixed[static_cast<std::size_t>(3 * node + component)] = 1;
    model.move[3 * node + component] = displacement;
  }
}

double reaction(const assembly::System& system, const std::vector<Index>& nodes, int component) {
  const VecX forces = system.support_forces();
  double sum = 0;
  for (const Index node : nodes) sum += forces[3 * node + component];
  return sum;
}

PlainNewton plain_newton(assembly::System& system, assembly::Configuration& at, double enough, int most) {
  linear::prepare_blas(1); // as the programs do
  path::Work work;
  path::Tangent tangent(system, work);
  PlainNewton result;
  for (int i = 0; i < most; ++i) {
    if (!system.evaluate(at, true).possible) return result;
    if (!tangent.factorize(at, path::Tangent::Repair::indefinite)) return result;
    const path::Change step = tangent.step(at);
    result.norms.push_back(std::sqrt(path::dot_u(step, step)));
    if (!std::isfinite(result.norms.back())) return result;
    at = path::moved(system, at, step);
    if (result.norms.back() < enough) {
      result.converged = system.evaluate(at, true).possible;
      return result;
    }
  }
  return result;
}

void predict(assembly::System& system, assembly::Configuration& at, double load_factor) {
  path::Work work;
  path::Tangent tangent(system, work);
  system.evaluate_accepted(at, true);
  ASSERT_TRUE(tangent.factorize(at, path::Tangent::Repair::indefinite));
  const std::optional<path::Change> way = tangent.along(at);
  ASSERT_TRUE(way);
  at = path::moved(system, at, ((load_factor - at.load_factor) / way->load_factor) * *way);
  at.load_factor = load_factor;
}

} // namespace pneuma::tests
