// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/common/summary.h"
#include "stages/pattern/fabrication.h"
#include "stages/pattern/welded.h"

namespace pneuma::stages::pattern {

// What flattening did to one strip.
struct StripQuality {
  std::string name;
  double distortion = 0; // largest stretch against the wanted one, -
  // along warp and weft: 1 - flat length / length on the form, means over the strip
  double requested[2] = {}, compensation[2] = {};
  struct Edge {
    std::string name;
    double requested = 0, achieved = 0; // along the side
  };
  std::vector<Edge> edges; // its sides in order
};

std::vector<StripQuality> quality_of(const Welded& welded, std::size_t block);

// Writes patterns.<foil> to the summary and a line a strip to the log: sizes, distortion, requested and achieved
// compensation.
void report_strips(const std::vector<StripQuality>& strips, const Fabrication& made, const std::string& foil,
                   common::Summary& summary);

} // namespace pneuma::stages::pattern
