// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_grid.h"

#include <algorithm>
#include <cmath>

namespace pneuma::geometry {

BoxGrid::BoxGrid(std::span<const PlanBox> boxes) {
  first_.assign(2, 0);
  if (boxes.empty()) return;
  low_ = boxes.front().low;
  Vec2 high = boxes.front().high;
  for (const PlanBox& box : boxes) {
    if (!box.low.allFinite() || !box.high.allFinite()) return;
    low_ = low_.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  const Vec2 extent = high - low_;
  const auto count = static_cast<double>(boxes.size());
  // boxes that have collapsed to a line still get cells
  cell_ = std::max(std::sqrt(extent.x() * extent.y() / count), extent.maxCoeff() / count);
  if (!(cell_ > 0)) cell_ = 1;
  columns_ = static_cast<Index>(extent.x() / cell_) + 1;
  rows_ = static_cast<Index>(extent.y() / cell_) + 1;

  const auto each_cell = [&](auto&& visit) {
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      for (Index r = row(boxes[k].low.y()); r <= row(boxes[k].high.y()); ++r) {
        for (Index c = column(boxes[k].low.x()); c <= column(boxes[k].high.x()); ++c)
          visit(static_cast<std::size_t>(r * columns_ + c), static_cast<Index>(k));
      }
    }
  };
  first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  each_cell([&](std::size_t cell, Index) { ++first_[cell + 1]; });
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  boxes_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<Index> next = first_;
  each_cell([&](std::size_t cell, Index k) { boxes_[static_cast<std::size_t>(next[cell]++)] = k; });
}

Index BoxGrid::column(double x) const {
  return static_cast<Index>(std::clamp((x - low_.x()) / cell_, 0.0, static_cast<double>(columns_ - 1)));
}

Index BoxGrid::row(double y) const {
  return static_cast<Index>(std::clamp((y - low_.y()) / cell_, 0.0, static_cast<double>(rows_ - 1)));
}

std::span<const Index> BoxGrid::in_cell(Index row, Index column) const {
  const auto cell = static_cast<std::size_t>(row * columns_ + column);
  return std::span(boxes_).subspan(static_cast<std::size_t>(first_[cell]),
                                   static_cast<std::size_t>(first_[cell + 1] - first_[cell]));
}

std::span<const Index> BoxGrid::at(const Vec2& place) const {
  const Vec2 high = low_ + cell_ * Vec2(columns_, rows_);
  if (!(place.array() >= low_.array()).all() || !(place.array() <= high.array()).all()) return {};
  return in_cell(row(place.y()), column(place.x()));
}

std::vector<Index> BoxGrid::around(const Vec2& place, Index rings) const {
  std::vector<Index> found;
  for (Index r = std::max(row(place.y()) - rings, 0); r <= std::min(row(place.y()) + rings, rows_ - 1); ++r) {
    for (Index c = std::max(column(place.x()) - rings, 0); c <= std::min(column(place.x()) + rings, columns_ - 1);
         ++c) {
      const std::span<const Index> here = in_cell(r, c);
      found.insert(found.end(), here.begin(), here.end());
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

} // namespace pneuma::geometry
