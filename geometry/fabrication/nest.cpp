// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/base/errors.h"
#include "geometry/fabrication/fabrication.h"

namespace pneuma::geometry::fabrication {

namespace {

constexpr double rounding = 1e-9; // m

// A stretch of the roll as long as the strip that opened it, filled across the roll.
struct Shelf {
  double start, next; // x of its begin, y of what is free
};

void refuse_wide(const std::vector<CutStrip>& strips, const std::vector<std::string>& names, double width,
                 double selvedge) {
  std::vector<std::string> wide;
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const double across = strips[i].high.y() - strips[i].low.y();
    if (across > width - 2 * selvedge + rounding) wide.push_back(fmt::format("{} ({:.3f} m)", names[i], across));
  }
  if (wide.empty()) return;
  throw base::GeometryError(fmt::format(
      "too wide for a roll of {:.3f} m with {:.3f} m inside its selvedges: {}; a roll of {:.3f} m would do, or more "
      "strips",
      width, width - 2 * selvedge, fmt::join(wide, ", "), std::ceil(1e3 * roll_width_for(strips, selvedge)) / 1e3));
}

} // namespace

double roll_width_for(const std::vector<CutStrip>& strips, double selvedge) {
  double widest = 0;
  for (const CutStrip& strip : strips) widest = std::max(widest, strip.high.y() - strip.low.y());
  return widest + 2 * selvedge;
}

Nesting nest(const std::vector<CutStrip>& strips, const std::vector<std::string>& names, double width, double selvedge,
             double gap) {
  refuse_wide(strips, names, width, selvedge);
  std::vector<std::size_t> longest_first(strips.size());
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  const auto extent = [&](std::size_t i) -> Vec2 { return strips[i].high - strips[i].low; };
  std::stable_sort(longest_first.begin(), longest_first.end(),
                   [&](std::size_t a, std::size_t b) { return extent(a).x() > extent(b).x(); });

  Nesting nesting;
  std::vector<Shelf> shelves;
  double area = 0;
  for (const std::size_t i : longest_first) {
    auto shelf = std::find_if(shelves.begin(), shelves.end(),
                              [&](const Shelf& s) { return s.next + extent(i).y() <= width - selvedge + rounding; });
    if (shelf == shelves.end()) {
      const double start = shelves.empty() ? 0 : nesting.length + gap;
      shelf = shelves.insert(shelf, {start, selvedge});
      nesting.length = start + extent(i).x();
    }
    nesting.placements.push_back({static_cast<Index>(i), false, Vec2(shelf->start, shelf->next) - strips[i].low});
    shelf->next += extent(i).y() + gap;
    area += strips[i].area;
  }
  if (nesting.length > 0) nesting.waste_fraction = 1 - area / (nesting.length * width);
  return nesting;
}

} // namespace pneuma::geometry::fabrication
