// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/fabrication/fabrication.h"
#include "geometry/strips/cut.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::stages::pattern {

using base::Index;
using base::Vec2;

// Where one foil is cut.
struct Layout {
  double direction = 0; // rad, of the strips' length from the plan's x axis
  std::vector<geometry::strips::CuttingLine> lines;
  std::string reason; // how it was chosen, for the log
};

// Finds the cutting lines of a foil: given curves, or parallel lines (straight in plan or geodesics with the same ends)
// in the given or the best direction, so many as asked for or as the roll demands, placed so that the strips come out
// equally wide when laid flat. Widths are those of flat strips with their allowances, measured on a coarse copy; where
// the roll decides their number, there are `least` at least.
// Throws GeometryError with the place and what would work.
Layout lay_out(const geometry::strips::Surface& surface, const pipeline::workflow::PatternSettings& settings,
               const std::string& foil, int least = 2);

geometry::fabrication::Allowances allowances_of(const pipeline::workflow::PatternSettings& settings);

// Size of elements for all foils' cutting lines, m in plan: that of the mesh, or as much smaller, down to its half, as
// the narrowest strip needs for two elements across.
double element_size(const std::vector<geometry::strips::Cut>& cuts);

} // namespace pneuma::stages::pattern
