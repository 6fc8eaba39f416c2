// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"
#include "stages/common/summary.h"
#include "stages/pattern/welded.h"

namespace pneuma::stages::pattern {

// What is said of one strip.
struct StripFigures {
  std::string name;
  double width = 0, length = 0; // m, net, across and along the roll
  double area = 0;              // m2, net
  double distortion = 0;        // largest stretch against the wanted one, -
  double seam_mismatch = 0;     // m, largest of its seams
  double compensation[2] = {};  // achieved along warp and weft: 1 - flat length / length on the form, mean
  struct Edge {
    std::string name;
    double requested = 0, achieved = 0; // along the side
  };
  std::vector<Edge> edges; // its sides in order
};

std::vector<StripFigures> figures_of(const Welded& welded, std::size_t block);

// Writes patterns.<foil>.strips and the table of requested and achieved compensation to the summary and the log.
void report_strips(const std::vector<StripFigures>& strips, const Wanted& wanted, const std::string& foil,
                   common::Summary& summary);

} // namespace pneuma::stages::pattern
