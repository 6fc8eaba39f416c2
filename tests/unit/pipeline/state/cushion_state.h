// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>

#include "pipeline/state/state.h"

// States made up for tests: no equilibrium, but everything a state can hold.
namespace pneuma::tests {

using pipeline::state::Index;
using pipeline::state::State;

// The element e = (i, j) of an n x m grid in the numbering (column, row) of a grid of element corners, or of corners
// and mid-sides. Triangles: two a square.
inline std::vector<std::vector<std::pair<int, int>>> grid_elements(geometry::ElementType type, int n, int m) {
  using enum geometry::ElementType;
  std::vector<std::vector<std::pair<int, int>>> elements;
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int x = is_quadratic(type) ? 2 * i : i;
      const int y = is_quadratic(type) ? 2 * j : j;
      switch (type) {
      case T3:
        elements.push_back({{x, y}, {x + 1, y}, {x + 1, y + 1}});
        elements.push_back({{x, y}, {x + 1, y + 1}, {x, y + 1}});
        break;
      case Q4:
        elements.push_back({{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}});
        break;
      case T6:
        elements.push_back({{x, y}, {x + 2, y}, {x + 2, y + 2}, {x + 1, y}, {x + 2, y + 1}, {x + 1, y + 1}});
        elements.push_back({{x, y}, {x + 2, y + 2}, {x, y + 2}, {x + 1, y + 1}, {x + 1, y + 2}, {x, y + 1}});
        break;
      case Q9:
        elements.push_back({{x, y},
                            {x + 2, y},
                            {x + 2, y + 2},
                            {x, y + 2},
                            {x + 1, y},
                            {x + 2, y + 1},
                            {x + 1, y + 2},
                            {x, y + 1},
                            {x + 1, y + 1}});
        break;
      }
    }
  }
  return elements;
}

// Nodes of a block that lie in elements of strip 0 and of strip 1.
inline std::vector<Index> nodes_of_both(const geometry::Block& block, const std::vector<Index>& strip_of_element) {
  const std::size_t each = block.connectivity.size() / strip_of_element.size();
  std::set<Index> strips[2];
  for (std::size_t i = 0; i < block.connectivity.size(); ++i) {
    strips[strip_of_element[i / each]].insert(block.connectivity[i]);
  }
  std::vector<Index> both;
  std::set_intersection(strips[0].begin(), strips[0].end(), strips[1].begin(), strips[1].end(),
                        std::back_inserter(both));
  return both;
}

// Two foils and a chamber over a rectangle of 6 m x 3 m with n x m squares: sag 0.6 m upwards and 0.4 m downwards, the
// edge nodes shared.
inline State cushion_state(geometry::ElementType type, int n, int m) {
  using namespace pipeline::state;
  State state;
  geometry::Mesh& mesh = state.mesh;
  mesh.element = type;
  const int columns = (is_quadratic(type) ? 2 * n : n) + 1;
  const int rows = (is_quadratic(type) ? 2 * m : m) + 1;
  const auto elements = grid_elements(type, n, m);
  std::vector<Index> number(static_cast<std::size_t>(columns * rows), -1);
  for (const double sag : {0.6, -0.4}) {
    const bool first = sag > 0;
    geometry::Block block{first ? "upper" : "lower", geometry::BlockKind::foil, {}};
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        const bool edge = i == 0 || j == 0 || i == columns - 1 || j == rows - 1;
        if (edge && !first) continue;
        const double x = 6.0 * i / (columns - 1);
        const double y = 3.0 * j / (rows - 1);
        const double z = edge ? 0 : sag * std::sin(std::numbers::pi * x / 6) * std::sin(std::numbers::pi * y / 3);
        number[static_cast<std::size_t>(j * columns + i)] = static_cast<Index>(mesh.nodes.size());
        mesh.nodes.emplace_back(x - 3, y - 1.5, z);
        state.fixed.insert(state.fixed.end(), 3, edge ? 1 : 0);
      }
    }
    for (const auto& element : elements) {
      for (const auto& [i, j] : element) {
        block.connectivity.push_back(number[static_cast<std::size_t>(j * columns + i)]);
      }
    }
    mesh.blocks.push_back(block);
  }
  geometry::Edge south{"south", false, {}};
  for (int i = 0; i < columns; ++i) south.nodes.push_back(number[static_cast<std::size_t>(i)]);
  mesh.edges = {south, {"empty", true, {}}};

  double value = 0.1; // anything irregular
  const auto numbers = [&](std::size_t count) {
    std::vector<double> values(count);
    for (double& v : values) v = value = std::fmod(value * 1.37 + 0.31, 7.0);
    return values;
  };
  const std::size_t points = geometry::stress_rule(type).size();
  for (const geometry::Block& block : mesh.blocks) {
    const std::size_t gauss = points * elements.size();
    Foil foil;
    foil.material = "etfe_elastic";
    foil.thickness = 250e-6;
    foil.warp_angle = 0.1;
    foil.reference = numbers(3 * block.connectivity.size());
    foil.predeformation = numbers(3 * gauss);
    foil.prestress = numbers(3 * gauss);
    for (std::size_t i = 0; i < foil.prestress.size(); ++i) foil.prestress[i] += i % 3 == 2 ? 0 : 100; // a tension
    foil.history_names = {"plastic_strain_11", "plastic_strain_22"};
    foil.history = numbers(2 * gauss);
    // the weather side alone is welded: its elements of the left and the right half, the seam where they meet
    if (state.foils.empty()) {
      foil.strips = {"upper-1", "upper-2"};
      for (const auto& element : elements) {
        foil.strip_of_element.push_back(2 * element[0].first < columns - 1 ? 0 : 1);
      }
      const std::vector<Index> both = nodes_of_both(block, foil.strip_of_element);
      if (!both.empty()) foil.seams = {{"S1", 0, 1, both}, {"S2", 1, 0, {both[1], both[0]}}};
    }
    state.foils.push_back(foil);
  }
  state.chambers = {{"main", 0, 1, 0.05, GasLaw::closed, 1.4, 400.0, 101325.0, 296.15, 9.5, -1}};
  const auto of_block = static_cast<std::size_t>(mesh.element_count(mesh.blocks[1]));
  std::vector<Index> offset(of_block + 1, 2); // two places in the first element
  offset[0] = 0;
  state.loads = {{"Böe", 0, -600, {}, {}, {}},
                 {"part", 1, 250, offset, {{0.25, 0.5, 0.1}, {0.125, 0.3, 0.2}}, {}},
                 {"snow", 0, 0, {}, {}, numbers(3 * mesh.nodes.size())}};
  std::vector<double> displacement;
  for (const Vec3& node : mesh.nodes) displacement.insert(displacement.end(), {0.01 * node.x(), 0, 0.1 * node.z()});
  std::vector<double> stress;
  for (const geometry::Block& block : mesh.blocks) {
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      Vec3 centre(0, 0, 0);
      for (const Index node : mesh.element_nodes(block, e)) centre += mesh.nodes[static_cast<std::size_t>(node)];
      stress.push_back(4e6 + 1e6 * centre.z() / nodes_per_element(type));
    }
  }
  state.fields = {{"displacement", "m", Location::point, 3, -1, displacement},
                  {"von_mises", "Pa", Location::cell, 1, -1, stress},
                  {"von_mises", "Pa", Location::gauss, 1, 0, numbers(points * elements.size())},
                  {"von_mises", "Pa", Location::gauss, 1, 1, numbers(points * elements.size())},
                  {"sag", "m", Location::point, 1, -1, numbers(mesh.nodes.size())}};
  state.provenance = {"pneuma-inflate 0.1.0",
                      "inflate",
                      "inflated",
                      {{"state", "0123abcd"}, {"config", "ffff"}},
                      "run: inflate\nname: Kissen für Köln\n",
                      "converged in 7 steps",
                      true,
                      1.0};
  return state;
}

} // namespace pneuma::tests
