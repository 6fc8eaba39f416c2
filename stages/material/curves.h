// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/material/test_piece.h"
#include "stages/material/options.h"

namespace pneuma::stages::material {

using base::Vec3;
using solver::material::PieceState;

// Strain and stress along the two axes, in the measures that are shown: engineering and nominal, or logarithmic and
// Cauchy (-, Pa); third: 2 E12 and S12.
struct Shown {
  Vec3 strain, stress;
};
Shown shown(const PieceState& state, bool true_measures);

solver::material::Control control_of(const Ratio& ratio);

// The engineering strain of a strain that is shown, and back.
double engineering(double strain, bool true_measures);

// Steps in time of a foil that flows, for each one that is shown: the law's implicit steps are of first order.
inline constexpr int steps_in_time = 10;

// A piece pulled with stresses in a ratio, until the strain along the axis of the larger one is reached, and back to
// no force at the same rate.
struct Curve {
  std::string material;
  Ratio ratio;
  std::optional<double> rate;        // 1/s; none: the material does not know time
  std::vector<PieceState> loading;   // from the virgin state on, `steps` more
  std::vector<PieceState> unloading; // after the last of these
  std::string end;                   // why it was not pulled as far as wanted; empty: it was
};
Curve follow(const solver::material::Law& law, const Ratio& ratio, const Options& options, std::optional<double> rate);

// The component whose strain drives: that of the larger stress, or shear.
inline int driven_axis(const Ratio& ratio) {
  if (ratio.shear) return 2;
  return std::abs(ratio.b) > std::abs(ratio.a) ? 1 : 0;
}

} // namespace pneuma::stages::material
