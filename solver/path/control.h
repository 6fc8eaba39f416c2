// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "solver/path/tangent.h"

namespace pneuma::solver::path {

// What a control can hold while the load factor is free to follow.
struct HeldLoadFactor {};
struct HeldPressure {
  Index chamber = 0;
};
struct HeldVolume {
  Index chamber = 0; // of this chamber alone
};
// A weighted sum of displacements against the start of the path, m: a point's component along a direction.
struct HeldDisplacement {
  std::vector<std::pair<Index, double>> weights; // coordinate 3 node + component, weight
};
// The length of the change of all free positions since `from`, root mean square over the nodes, m: cylindrical arc
// length (Crisfield 1981), without the load.
struct HeldArc {
  std::vector<Vec3> from;
};
using Held = std::variant<HeldLoadFactor, HeldPressure, HeldVolume, HeldDisplacement, HeldArc>;

// Its value at the last evaluation, and the line form . change = wanted - value, linearised there.
double value_of(const Held& held, const System& system, const Configuration& configuration);
Row row_of(const Held& held, double wanted, const System& system, const Configuration& configuration);

// The displacement of one node along a direction.
HeldDisplacement displacement_of(Index node, const Vec3& direction);

// The node of a block (all blocks: -1) that moved farthest since the start, or would move farthest with `change`.
struct Farthest {
  Index node = -1;
  Vec3 move = Vec3::Zero(); // m
};
Farthest farthest(const System& system, Index block, const Configuration& configuration,
                  const Change* change = nullptr);

// Its displacement along the way it went; upwards where it did not move.
HeldDisplacement displacement_of(const Farthest& farthest);

// Largest distance of a node from the first one, m: a size to measure moves against.
double span_of(const Configuration& configuration);

// One number for all nodes: sqrt(sum of squares / free nodes), m.
double root_mean_square(const System& system, const Change& change);

} // namespace pneuma::solver::path
