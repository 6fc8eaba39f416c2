// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/outline.h"
#include "geometry/strips/cut.h"

namespace pneuma::geometry::strips {

// The nodes of the rim that all foils of a cushion share.
struct RimStations {
  std::vector<double> positions; // m, ascending
  std::vector<Vec2> points;      // on the rim exactly
  std::vector<Vec2> middles;     // on the rim, between each station and the next

  struct Ends {
    Index from, to;
  };
  std::vector<std::vector<Ends>> ends;   // [foil][line]: stations of the lines' ends
  std::vector<std::vector<Index>> edges; // stations on each edge of edge_names(plan), counterclockwise, both ends
};

// Stations at the corners of the plan and at all ends of lines, ends that are closer than a third of `size` to an
// earlier one or to a corner becoming one with it; between them at equal distances of about `size`, in `even` numbers
// if asked for. Throws GeometryError with the place where two ends of one foil's lines come together.
RimStations rim_stations(const Plan& plan, std::span<const Cut> foils, double size, bool even);

// Number of sides of about `size` in a length; even: a multiple of two.
int sides_in(double length, double size, bool even);

} // namespace pneuma::geometry::strips
