// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/track.h"

#include <algorithm>
#include <cmath>

namespace pneuma::geometry::strips {

Track::Track(const Chart& chart, std::span<const Vec2> plan, double step) : places_{plan[0]}, lengths_{0.0} {
  Vec3 before = chart.lift(plan[0]);
  for (std::size_t k = 0; k + 1 < plan.size(); ++k) {
    const Vec2 along = plan[k + 1] - plan[k];
    const int parts = std::max(static_cast<int>(std::ceil(along.norm() / step)), 1);
    for (int i = 1; i <= parts; ++i) {
      places_.push_back(i < parts ? Vec2(plan[k] + static_cast<double>(i) / parts * along) : plan[k + 1]);
      const Vec3 point = chart.lift(places_.back());
      lengths_.push_back(lengths_.back() + (point - before).norm());
      before = point;
    }
  }
}

Vec2 Track::at(double length) const {
  const auto found = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, length);
  const auto k = static_cast<std::size_t>(found - lengths_.begin()) - 1;
  const double part = (length - lengths_[k]) / (lengths_[k + 1] - lengths_[k]);
  return places_[k] + part * (places_[k + 1] - places_[k]);
}

} // namespace pneuma::geometry::strips
