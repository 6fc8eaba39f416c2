// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/comparison.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuma::stages::material {

namespace law = solver::material;

Ratio ratio_of(const std::vector<TestPoint>& points) {
  base::Mat2 products = base::Mat2::Zero();
  for (const TestPoint& point : points) products += point.weight * point.stress * point.stress.transpose();
  // from the axis of the larger stress: the smaller one over it
  const int larger = products(1, 1) > products(0, 0) ? 1 : 0;
  constexpr double none = 0.01;
  double smaller = products(0, 1) / products(larger, larger);
  if (!(std::abs(smaller) > none)) smaller = 0;
  return larger == 0 ? Ratio{1, smaller} : Ratio{smaller, 1};
}

Misfit misfit(const law::Law& material, const TestCurve& test, const Options& options, std::optional<double> rate) {
  Misfit result;
  law::TestPiece piece(material, options.angle);
  const law::Control control = law::biaxial(test.ratio.a, test.ratio.b);
  const int axis = driven_axis(test.ratio);
  const bool both = test.ratio.a != 0 && test.ratio.b != 0;
  double squares = 0;
  double weights = 0;
  for (const TestPoint& point : test.points) {
    result.measured = std::max(result.measured, point.stress.cwiseAbs().maxCoeff());
  }
  for (const TestPoint& point : test.points) {
    // steps as short as those of the curves
    const double from = piece.driven(control);
    const double way = point.strain[axis] - from;
    double duration = 0;
    if (point.time) {
      duration = std::max(*point.time - piece.state().time, 0.0);
    } else if (rate) {
      duration = std::abs(way) / *rate;
    }
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(way) * options.steps / options.strain)));
    for (int i = 1; i <= steps && result.end.empty(); ++i) {
      if (piece.advance(control, from + way * i / steps, duration / steps)) continue;
      const char* why = piece.status() == law::Status::outside_data ? "its data end before" : "it knows no such state";
      result.end = fmt::format("not compared from a strain of {:.3g} % on: {}", 100 * point.strain[axis], why);
    }
    if (!result.end.empty()) break;
    const Vec2 difference = piece.state().nominal_stress().head<2>() - point.stress;
    for (int i = 0; i < 2; ++i) {
      if (!both && i != axis) continue;
      squares += point.weight * difference[i] * difference[i];
      weights += point.weight;
      if (!(std::abs(difference[i]) > result.max)) continue;
      result.max = std::abs(difference[i]);
      result.at = point.strain[axis];
    }
    ++result.points;
  }
  if (weights > 0) result.rms = std::sqrt(squares / weights);
  return result;
}

} // namespace pneuma::stages::material
