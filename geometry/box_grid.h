// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry {

using base::Index;
using base::Vec2;

struct PlanBox {
  Vec2 low, high; // m
};

// Boxes in plan sorted into the cells of a grid, about one box a cell, so that those near a place are found at once.
class BoxGrid {
public:
  // Where a box has no finite place, none is found anywhere.
  explicit BoxGrid(std::span<const PlanBox> boxes);

  double cell() const { return cell_; } // m, side of a cell

  // Numbers of the boxes that touch the cell of a place, ascending; none outside the grid.
  std::span<const Index> at(const Vec2& place) const;

  // Those that touch the cells up to `rings` cells away from a place, inside the grid or not; ascending, each once.
  std::vector<Index> around(const Vec2& place, Index rings) const;

private:
  Index column(double x) const;
  Index row(double y) const;
  std::span<const Index> in_cell(Index row, Index column) const;

  Vec2 low_ = Vec2::Zero();
  double cell_ = 1;
  Index columns_ = 1, rows_ = 1;
  std::vector<Index> first_; // of each cell, in `boxes_`
  std::vector<Index> boxes_;
};

} // namespace pneuma::geometry
