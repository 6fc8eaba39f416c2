// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/strips/lines.h"

namespace pneuma::geometry::strips {

// One foil of the cushion (or its base) and the lines along which it is cut; no lines: one piece.
struct Cut {
  const Surface* surface = nullptr; // what the new nodes lie on
  std::vector<CuttingLine> lines;   // that do not cross each other
};

struct Seam {
  Index left = 0, right = 0; // numbers of the strips to the left and right of the line
  std::vector<Index> nodes;  // of the mesh, from rim to rim, mid-side nodes included; shared by both strips
};

struct CutFoil {
  Index strips = 1;                    // number of them
  std::vector<Index> strip_of_element; // [element of the block]
  std::vector<Seam> seams;             // one a line, in their order
};

struct CutMesh {
  Mesh mesh;                  // blocks and edges in the order and with the names of the old mesh
  std::vector<CutFoil> foils; // one a block
};

// Meshes every foil anew so that its cutting lines are sides of elements: stations along the lines and the rim at equal
// distances of about `size`, each strip filled in plan (gmsh), nodes lifted to the surface; rim nodes (mid-side nodes
// too) exactly on the rim and shared by all blocks, seam nodes shared by both strips, interior mid-side nodes over the
// middle of their side in plan. Ends of different foils' lines that are closer than a third of an element become one.
// Strips are numbered from left to right seen along the lines: by the positions of their centres across the lines' mean
// direction (lines that run against the first one are turned for it).
// The result passes check_mesh without errors. The same input gives the same mesh.
// Throws GeometryError with the place and what would work where a strip is too narrow for the mesh size (fewer than two
// sides of an element along a line or across a strip), a line comes too near to the rim, or lines cross.
CutMesh cut(const Plan& plan, const Mesh& old, std::span<const Cut> foils, double size);

} // namespace pneuma::geometry::strips
