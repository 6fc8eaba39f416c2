// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/analytical/balloon.h"

#include <cmath>
#include <numbers>

#include "solver/analytical/root.h"

namespace pneuma::solver::analytical {

namespace {

// The axial stretch at which caps are in balance, 2 lz W2 = l W1; NaN if there is none.
double capped_axial_stretch(const StretchLaw& law, double l) {
  double lz = std::sqrt(l);
  for (int i = 0; i < 60; ++i) {
    const Energy e = energy(law, l, lz);
    const double change = (2 * lz * e.w2 - l * e.w1) / (2 * e.w2 + 2 * lz * e.w22 - l * e.w12);
    lz -= change;
    if (!(lz > 0)) break;
    if (std::abs(change) < 1e-15 * lz) return lz;
  }
  return std::nan("");
}

} // namespace

std::optional<InflatedBalloon> inflate(const Balloon& balloon, double stretch) {
  if (!(stretch >= 1)) return std::nullopt;
  const double R = balloon.radius, h = balloon.thickness, l = stretch;
  InflatedBalloon result;
  result.stretch = l;
  Energy e;
  switch (balloon.shape) {
  case BalloonShape::sphere:
    result.axial_stretch = l;
    e = energy(balloon.law, l, l);
    result.pressure = 2 * h / R * e.w1 / (l * l);
    result.slope = 2 * h / R * ((e.w11 + e.w12) - 2 * e.w1 / l) / (l * l);
    result.volume = 4.0 / 3 * std::numbers::pi * std::pow(R * l, 3);
    result.energy = 4 * std::numbers::pi * R * R * h * e.w;
    break;
  case BalloonShape::held_tube:
    e = energy(balloon.law, l, 1);
    result.pressure = h / R * e.w1 / l;
    result.slope = h / R * (e.w11 - e.w1 / l) / l;
    result.volume = std::numbers::pi * std::pow(R * l, 2);
    result.energy = 2 * std::numbers::pi * R * h * e.w;
    break;
  case BalloonShape::capped_tube: {
    const double lz = capped_axial_stretch(balloon.law, l);
    if (std::isnan(lz)) return std::nullopt;
    result.axial_stretch = lz;
    e = energy(balloon.law, l, lz);
    const double dlz = (e.w1 + l * e.w11 - 2 * lz * e.w12) / (2 * e.w2 + 2 * lz * e.w22 - l * e.w12);
    result.pressure = h / R * e.w1 / (l * lz);
    result.slope = h / R * (e.w11 + e.w12 * dlz - e.w1 / l - e.w1 * dlz / lz) / (l * lz);
    result.volume = std::numbers::pi * std::pow(R * l, 2) * lz;
    result.energy = 2 * std::numbers::pi * R * h * e.w;
    break;
  }
  }
  result.thickness_stretch = e.thickness_stretch;
  // nominal stress -> Cauchy stress: by the area of the cut
  result.hoop = e.w1 / (result.axial_stretch * e.thickness_stretch);
  result.axial = e.w2 / (l * e.thickness_stretch);
  return result;
}

std::vector<InflatedBalloon> limit_points(const Balloon& balloon) {
  constexpr double step = 0.005, last = 20;
  double sign = -1; // of the slope behind the next limit point
  const auto passed = [&](double stretch) {
    const auto state = inflate(balloon, stretch);
    return state ? sign * state->slope : std::nan("");
  };
  std::vector<InflatedBalloon> points;
  for (int i = 0; 1 + i * step < last; ++i) {
    const double low = 1 + i * step, high = low + step;
    if (!(passed(high) > 0)) continue;
    points.push_back(inflate(balloon, root_between(low, high, passed)).value());
    sign = -sign;
  }
  return points;
}

} // namespace pneuma::solver::analytical
