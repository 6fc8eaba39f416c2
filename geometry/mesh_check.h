// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

enum class FaultKind : std::uint8_t {
  bad_number,         // a node number outside the mesh, a list of the wrong length
  repeated_node,      // twice in one element
  unused_node,        // in no element
  coincident_nodes,   // two nodes of one block at one place
  inverted_element,   // the Jacobian is not positive everywhere
  degenerate_element, // no area, or a corner without an angle
  needle_element,     // smallest angle or aspect ratio far from good
  flipped_neighbour,  // two neighbours look to opposite sides
  non_manifold_side,  // more than two elements of a block at one side
  torn_side,          // neighbours with different mid-side nodes
  side_without_edge,  // an open side that belongs to no named edge
  edge_inside,        // an edge that is no open side of each block
  shared_inside,      // two blocks share a node that lies on no edge
  held_element,       // all nodes on the edges: it could not move
};

enum class Severity : std::uint8_t { warning, error };

struct MeshFault {
  FaultKind kind;
  Severity severity;
  std::string message; // what, which element or node, where
  Vec3 at;             // m
};

// Looks for everything that makes a mesh unfit for computing, in O(n log n). A flat mesh in a plane of constant z must
// face +z; on others each element is held against its own mean normal. Angles below 5 degrees and aspect ratios above
// 50 are warnings. Of each kind at most twenty faults are listed. Numbers outside the mesh end the search.
std::vector<MeshFault> check_mesh(const Mesh& mesh);

} // namespace pneuma::geometry
