// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/outline.h"

namespace pneuma::geometry::meshing {

enum class Pattern : std::uint8_t { structured, unstructured };

struct MeshOptions {
  ElementType element = ElementType::T6;
  // exactly one of the two: wanted element size (m), or divisions along (length, width) of a rectangle, (per side, -)
  // of a triangle, (along the longest side, -) of a polygon, whose other sides have as many in proportion, (per quarter
  // rim, radial rings outside the core square) of a circle; an unstructured mesh takes the divisions of the rim only
  std::optional<double> size;
  std::optional<std::array<int, 2>> divisions;
  Pattern pattern = Pattern::structured; // a polygon has the unstructured one only
};

// Meshes the plan once: one block named `plan`, counterclockwise seen from +z, nodes at z = 0, one edge per name of
// edge_names(plan) with its nodes counterclockwise. Interior edges are straight; every node of a curved rim, mid-side
// nodes too, lies on it exactly. No interior edge joins two nodes of the rim, and every element has a corner inside.
// Sides of elements are at most `size` long, diagonals of a structured pattern may exceed it. The nodes of the edges
// have the lowest numbers. The same call gives the same mesh. Throws InputError for options that contradict each other,
// GeometryError with the place where no valid mesh exists.
Mesh mesh_plan(const Plan& plan, const MeshOptions& options);

struct Layer {
  std::string name;
  BlockKind kind = BlockKind::foil;
};

// Copies the one block of `plan_mesh` once per layer (weather side first): the first layer keeps the node numbers, the
// others get interior nodes of their own and share the nodes on the edges.
Mesh stack(const Mesh& plan_mesh, const std::vector<Layer>& layers);

} // namespace pneuma::geometry::meshing
