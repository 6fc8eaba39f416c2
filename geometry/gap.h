// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

struct Gap {
  double value =
      std::numeric_limits<double>::infinity(); // m along the normal, negative where the blocks pass through each other
  Vec3 at = Vec3::Zero();                      // on the upper block
  std::size_t located = 0;                     // points that lie over or under the other block
  std::size_t skipped = 0;                     // points beside it, and where it stands upright or folds over
};

// Smallest gap between two neighbouring blocks, the upper one on the weather side, measured along the normal of their
// plan between the interpolated surfaces: from nodes and inner points of either block that lie on no edge, to the other
// where it has the same place in plan. Which way is up does not matter. Beside shared edges the gap goes to zero: it is
// for the caller to say from which negative value on it is a penetration. Made once for a mesh and asked after every
// step: places found are remembered, so that a call costs O(points). One search serves one thread at a time.
class GapSearch {
public:
  // `normal`: of the plan, towards the weather side.
  GapSearch(const Mesh& mesh, const Block& upper, const Block& lower, const Vec3& normal = Vec3::UnitZ());

  // Positions of all nodes of the mesh, m.
  Gap smallest(std::span<const Vec3> positions);

private:
  struct Sample { // a point of one block, and the element of the other over or under which it was last found
    Index element;
    double xi, eta;
    Index node; // or -1
    Index hint;
  };
  struct Side {
    std::vector<Index> connectivity;
    std::vector<Sample> samples;
  };
  static std::vector<Sample> samples_of(const Mesh& mesh, const Block& block, Index others);

  template <ElementType E>
  Gap search(std::span<const Vec3> positions);
  template <ElementType E>
  void search_from(Side& from, const Side& other, double sign, Gap& gap);

  ElementType element_;
  Side upper_, lower_;
  base::Mat3 frame_; // rows: two axes of the plan, its normal
  base::MatX local_; // places in the frame, 3 x nodes
};

} // namespace pneuma::geometry
