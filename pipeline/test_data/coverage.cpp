// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "pipeline/test_data/coverage.h"

namespace pneuma::pipeline::test_data {

namespace {

constexpr double near_uniaxial = 0.1, near_equal = 0.9; // of the stress ratio

} // namespace

std::array<double, 2> least_stress_ratios(std::span<const Point> points, bool has_axes) {
  double largest = 0;
  for (const Point& point : points) {
    if (point.weight > 0) largest = std::max({largest, point.stress_1, point.stress_2});
  }
  constexpr double none = std::numeric_limits<double>::infinity();
  std::array ratios = {none, none};
  for (const Point& point : points) {
    const auto [smaller, larger] = std::minmax(point.stress_1, point.stress_2);
    if (!(point.weight > 0 && larger > 0 && larger >= largest / 4)) continue;
    const double ratio = smaller / larger;
    if (point.stress_1 >= point.stress_2) ratios[0] = std::min(ratios[0], ratio);
    if (point.stress_2 >= point.stress_1) ratios[1] = std::min(ratios[1], ratio);
  }
  if (!has_axes) ratios.fill(std::min(ratios[0], ratios[1]));
  return ratios;
}

MissingTests missing_tests(std::span<const Point> points, bool has_axes) {
  if (points.empty()) return {};
  const std::array ratios = least_stress_ratios(points, has_axes);
  const double least = std::min(ratios[0], ratios[1]);
  if (!std::isfinite(least)) return {}; // no tension at all: the fit refuses
  const std::string fill = has_axes ? "" : ", or `fit_to` a law that fills what tests leave open";
  if (least > near_equal) {
    return {fmt::format("all tests are near equal stresses, the smaller at least {:.2g} of the larger: they do not say "
                        "how stresses differ where strains do; add uniaxial tests{}",
                        least, fill),
            true};
  }
  std::string where;
  for (std::size_t i = 0; i < 2; ++i) {
    if (ratios[i] <= near_uniaxial || (!has_axes && i > 0)) continue;
    where += fmt::format("{}{}, {}", where.empty() ? "" : ", nor", has_axes ? fmt::format(" along axis {}", i + 1) : "",
                         std::isfinite(ratios[i])
                             ? fmt::format("the smaller stress is at least {:.2g} of the larger", ratios[i])
                             : "where no stress is the larger");
  }
  if (where.empty()) return {};
  return {fmt::format("no test is near uniaxial stress{}: a table ends at its uniaxial-stress curve, and what lies "
                      "between that and the tests, as strains beside clamped edges do, is outside the data or guessed; "
                      "add a uniaxial test{}",
                      where, fill),
          false};
}

} // namespace pneuma::pipeline::test_data
