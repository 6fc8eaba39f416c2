// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/rim_stations.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/rim.h"

namespace pneuma::geometry::strips {

namespace {

// Positions where stations must be.
class Breaks {
public:
  Breaks(const Plan& plan, double near) : around_(perimeter(plan)), near_(near) {
    if (!std::holds_alternative<Circle>(plan)) positions_ = rim_corners(plan); // a circle has none
  }

  // Number of the break for an end: an earlier one nearby, or one of its own.
  std::size_t at(double position) {
    std::size_t best = positions_.size();
    double smallest = near_;
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      const double apart = std::abs(positions_[k] - position);
      const double distance = std::min(apart, around_ - apart);
      if (distance >= smallest) continue;
      smallest = distance;
      best = k;
    }
    if (best == positions_.size()) positions_.push_back(position);
    return best;
  }

  std::vector<double> positions() const { return positions_.empty() ? std::vector{0.0} : positions_; }

private:
  std::vector<double> positions_;
  double around_; // m, of the whole rim
  double near_;   // m
};

// Numbers of the breaks at the lines' ends.
std::vector<std::vector<RimStations::Ends>> merge_ends(const Plan& plan, std::span<const Cut> foils, double size,
                                                       Breaks& breaks) {
  std::vector<std::vector<RimStations::Ends>> ends;
  for (const Cut& foil : foils) {
    std::vector<RimStations::Ends>& of_foil = ends.emplace_back();
    std::vector<std::size_t> taken;
    const auto end = [&](double position) {
      const std::size_t number = breaks.at(position);
      if (std::ranges::count(taken, number) > 0) {
        const Vec2 place = rim_point(plan, position);
        throw base::GeometryError(
            fmt::format("two lines of one foil end at {} m, or within a third of the mesh size {:.3g} m: "
                        "move one of them, take fewer strips, or smaller elements",
                        base::place_text(place), size));
      }
      taken.push_back(number);
      return static_cast<Index>(number);
    };
    for (const CuttingLine& line : foil.lines) {
      const Index from = end(line.from);
      of_foil.push_back({from, end(line.to)});
    }
  }
  return ends;
}

} // namespace

int sides_in(double length, double size, bool even) {
  const int step = even ? 2 : 1;
  return step * std::max(static_cast<int>(std::round(length / (step * size))), 1);
}

RimStations rim_stations(const Plan& plan, std::span<const Cut> foils, double size, bool even) {
  Breaks breaks(plan, size / 3);
  RimStations rim;
  rim.ends = merge_ends(plan, foils, size, breaks);

  const std::vector<double> positions = breaks.positions();
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  std::vector<Index> station_of(positions.size());
  const double around = perimeter(plan);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double start = positions[order[k]];
    const double end = k + 1 < order.size() ? positions[order[k + 1]] : positions[order[0]] + around;
    const int parts = sides_in(end - start, size, even);
    station_of[order[k]] = static_cast<Index>(rim.positions.size());
    for (int i = 0; i < parts; ++i) {
      const double position = start + (end - start) * i / parts;
      const double middle = start + (end - start) * (i + 0.5) / parts;
      rim.positions.push_back(position);
      // only on a circle, which closes smoothly, do parts run beyond the whole length
      rim.points.push_back(rim_point(plan, position));
      rim.middles.push_back(rim_point(plan, middle));
    }
  }
  for (auto& of_foil : rim.ends) {
    for (auto& [from, to] : of_foil) {
      from = station_of[static_cast<std::size_t>(from)];
      to = station_of[static_cast<std::size_t>(to)];
    }
  }

  const auto count = static_cast<Index>(rim.positions.size());
  const std::vector<std::size_t> names = rim_edges(plan);
  rim.edges.resize(names.size());
  if (std::holds_alternative<Circle>(plan)) {
    rim.edges[0].resize(rim.positions.size());
    std::iota(rim.edges[0].begin(), rim.edges[0].end(), 0);
    return rim;
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Index first = station_of[k];
    const Index last = k + 1 < names.size() ? station_of[k + 1] : count;
    for (Index i = first; i <= last; ++i) rim.edges[names[k]].push_back(i % count);
  }
  return rim;
}

} // namespace pneuma::geometry::strips
