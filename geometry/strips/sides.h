// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry::strips {

// A side of a strip: along one seam or one edge of the plan.
struct StripSide {
  Index seam = -1;       // number of the seam, or -1
  Index edge = -1;       // number of the mesh's edge, or -1
  bool reversed = false; // runs against the seam's direction
  std::vector<Index>
      nodes; // of the mesh, counterclockwise seen from the weather side, both ends and mid-nodes included
};

// The sides of one strip in counterclockwise order, each ending where the next begins; the first side starts at a
// corner. `seams`: nodes of each seam from end to end. A single closed side (a whole circle) repeats its first node.
// Throws GeometryError where the strip has a hole or falls into parts.
std::vector<StripSide> sides_of(const Mesh& mesh, const Block& block, std::span<const Index> strip_of_element,
                                Index strip, std::span<const std::vector<Index>> seams);

} // namespace pneuma::geometry::strips
