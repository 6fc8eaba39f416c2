// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/divisions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "geometry/base/errors.h"

namespace pneuma::geometry::meshing {

namespace {

constexpr double most_cells = 5e6;

// Lengths (m) along which the two numbers of divisions count, and the smallest numbers that leave a free node in each
// element. On a circle the rings stand where the lines from the core to the rim are longest.
struct Measure {
  std::array<double, 2> length;
  std::array<int, 2> least;
  std::array<const char*, 2> name;
};

Measure measure(const Plan& plan, const MeshOptions& options) {
  const bool triangles = corners_per_element(options.element) == 3;
  if (const auto* r = std::get_if<Rectangle>(&plan))
    return {{r->length, r->width}, {2, 2}, {"along the length", "along the width"}};
  if (const auto* c = std::get_if<Circle>(&plan))
    return {{c->radius * std::numbers::pi / 2, 0.53 * c->radius}, {1, 1}, {"per quarter of the rim", "in rings"}};
  const double side = longest_side(corner_points(plan));
  if (std::holds_alternative<Polygon>(plan)) return {{side, 0}, {2, 0}, {"along the longest side", ""}};
  return {{side, 0}, {triangles ? 3 : 2, 0}, {"per side", ""}};
}

} // namespace

double longest_side(std::span<const base::Vec2> ring) {
  double longest = 0;
  for (std::size_t k = 0; k < ring.size(); ++k)
    longest = std::max(longest, (ring[(k + 1) % ring.size()] - ring[k]).norm());
  return longest;
}

std::array<int, 2> divisions_of(const Plan& plan, const MeshOptions& options) {
  const Measure of = measure(plan, options);
  if (options.size.has_value() == options.divisions.has_value())
    throw base::InputError("mesh: give either `size` or `divisions`, exactly one of the two");
  std::array<int, 2> n{};
  if (options.divisions) {
    n = *options.divisions;
    for (std::size_t k = 0; k < 2; ++k) {
      if (n[k] < of.least[k]) {
        throw base::InputError(
            fmt::format("mesh divisions {} {}: at least {} are needed, or elements have no free node", n[k], of.name[k],
                        of.least[k]));
      }
    }
  } else {
    const double size = *options.size;
    if (!std::isfinite(size) || size <= 0)
      throw base::InputError(fmt::format("mesh size {} m: it must be positive", size));
    const bool triangles = corners_per_element(options.element) == 3;
    const bool circle = std::holds_alternative<Circle>(plan);
    const bool grid = options.pattern == Pattern::structured && !std::holds_alternative<Triangle>(plan);
    const bool even = grid || !triangles;
    for (std::size_t k = 0; k < 2; ++k) {
      const double wanted = std::ceil(of.length[k] / size * (1 - 1e-12));
      if (wanted > most_cells)
        throw base::InputError(fmt::format("mesh size {} m: too small for a plan of {:.6g} m", size, of.length[k]));
      n[k] = std::max(static_cast<int>(wanted), of.least[k]);
      if (even && !(circle && k == 1)) n[k] += n[k] % 2;
    }
  }
  const double a = n[0];
  const double b = n[1];
  const double cells = std::holds_alternative<Circle>(plan)      ? a * a + 4 * a * b
                       : std::holds_alternative<Rectangle>(plan) ? a * b
                       : std::holds_alternative<Polygon>(plan)   ? area(plan) * (a / of.length[0]) * (a / of.length[0])
                                                                 : a * a;
  if (cells > most_cells)
    throw base::InputError(fmt::format(
        "about {:.0f} elements a foil asked for, {:.0f} are the most: choose a larger size or fewer divisions", cells,
        most_cells));
  return n;
}

} // namespace pneuma::geometry::meshing
