// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry {

using base::Index;
using base::Vec3;

// One number for a side, from either end.
inline std::uint64_t side_key(Index a, Index b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
}

// Membrane elements. Node order as in VTK and gmsh: corners, mid-sides 01 12 23 (30), centre.
enum class ElementType : std::uint8_t { T3, T6, Q4, Q9 };

constexpr int nodes_per_element(ElementType type) {
  constexpr int count[] = {3, 6, 4, 9};
  return count[static_cast<int>(type)];
}
constexpr int corners_per_element(ElementType type) {
  return type == ElementType::T3 || type == ElementType::T6 ? 3 : 4;
}
constexpr bool is_quadratic(ElementType type) {
  return type == ElementType::T6 || type == ElementType::Q9;
}
const char* name_of(ElementType type);

// What a block of elements is: a foil carries load; a base is a rigid wall that closes a chamber.
enum class BlockKind : std::uint8_t { foil, base };

// The elements of one foil (or of the base).
struct Block {
  std::string name;
  BlockKind kind = BlockKind::foil;
  std::vector<Index> connectivity; // [element][node], node numbers of the mesh
};

// A named edge of the plan, with its nodes in order along the edge (mid-side nodes included, both ends included).
struct Edge {
  std::string name;
  bool closed = false; // a rim: the last node is followed by the first
  std::vector<Index> nodes;
};

// The mesh of a cushion: all blocks are copies of one plan mesh, share only the nodes on its edges, and are oriented
// with their normals towards the weather side (+z for a plan in xy). Blocks stand in the order of the foils from the
// weather side inwards; a rigid base comes last.
struct Mesh {
  ElementType element = ElementType::T6;
  std::vector<Vec3> nodes; // m
  std::vector<Block> blocks;
  std::vector<Edge> edges;

  Index element_count(const Block& block) const {
    return static_cast<Index>(block.connectivity.size()) / nodes_per_element(element);
  }
  std::span<const Index> element_nodes(const Block& block, Index e) const {
    const auto n = static_cast<std::size_t>(nodes_per_element(element));
    return {block.connectivity.data() + static_cast<std::size_t>(e) * n, n};
  }
};

} // namespace pneuma::geometry
