// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

struct Gap {
  double value =
      std::numeric_limits<double>::infinity(); // m along `up`, negative where the blocks pass through each other
  Vec3 at = Vec3::Zero();                      // on the upper block
  std::size_t located = 0;                     // points that lie over or under the lower block
  std::size_t skipped = 0;                     // points beside it, and where it stands upright or folds over
};

// Smallest gap between two neighbouring blocks, the upper one on the weather side, measured along `up` between the
// interpolated surfaces: from nodes and inner points of the upper block that lie on no edge, to the lower block where
// it has the same place in plan. Beside shared edges the gap goes to zero: it is for the caller to say from which
// negative value on it is a penetration. Made once for a mesh and asked after every step: places found are remembered,
// so that a call costs O(points). One search serves one thread at a time.
class GapSearch {
public:
  GapSearch(const Mesh& mesh, const Block& upper, const Block& lower, const Vec3& up = Vec3::UnitZ());

  // Positions of all nodes of the mesh, m.
  Gap smallest(std::span<const Vec3> positions);

private:
  struct Sample { // a point of the upper block, and the element of the lower one under which it was last found
    Index element;
    double xi, eta;
    Index node; // or -1
    Index hint;
  };

  template <ElementType E>
  Gap search(std::span<const Vec3> positions);

  ElementType element_;
  std::vector<Index> upper_, lower_; // connectivities
  base::Mat3 frame_;                 // rows: two axes of the plan, up
  std::vector<Sample> samples_;
  base::MatX local_; // places in the frame, 3 x nodes
};

} // namespace pneuma::geometry
