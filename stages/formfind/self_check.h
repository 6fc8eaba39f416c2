// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "stages/common/stage.h"

namespace pneuma::stages::formfind {

using common::Index;

// How well a found form stands up to checks that know nothing of the search (numerics 15).
struct FoilCheck {
  std::string foil;
  double pressure = 0;       // Pa, net
  double laplace_rms = 0;    // rms and largest |n (k1 + k2) - p| / p, from curvatures fitted to the nodes' positions
  double laplace_max = 0;    //   away from the rim; with p = 0: |n (k1 + k2)| sqrt(area) / n
  int laplace_points = 0;    // nodes with a reliable curvature; 0: the mesh is too coarse for this check
  double reaction_error = 0; // |sum of reactions - pressure x plan area| / that; p = 0: / (tension x sqrt(area))
  double elastic_move = 0;   // largest displacement of an elastic foil with this prestress, released, against the span
  bool passed = false;
};

// `state` is the finished one: positions, references, prestress, pressures.
std::vector<FoilCheck> self_check(const common::Start& start, const common::State& state,
                                  const std::vector<double>& net_pressure);

} // namespace pneuma::stages::formfind
