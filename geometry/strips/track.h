// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/chart.h"

namespace pneuma::geometry::strips {

// A line in plan with its lengths on the surface.
class Track {
public:
  // Lifts the line at steps of at most `step`, m in plan.
  Track(const Chart& chart, std::span<const Vec2> plan, double step);

  double length() const { return lengths_.back(); } // m, on the surface
  // The place in plan at a length from the start, 0 to length().
  Vec2 at(double length) const;

private:
  std::vector<Vec2> places_;
  std::vector<double> lengths_; // m, on the surface, from the start to each place
};

} // namespace pneuma::geometry::strips
