// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <sys/resource.h>
#include <unistd.h>

namespace pneuma::pipeline::workflow {

namespace {

double squares_of(const geometry::Plan& plan, const MeshSettings& mesh) {
  const double area = geometry::area(plan);
  if (mesh.size) return area / (*mesh.size * *mesh.size);
  const double a = (*mesh.divisions)[0], b = (*mesh.divisions)[1];
  if (std::holds_alternative<geometry::Circle>(plan)) return a * a + 4 * a * b; // a core, and rings around it
  if (std::holds_alternative<geometry::Rectangle>(plan)) return a * b;
  double longest = 0; // side, which has `a`
  const std::vector<base::Vec2> corners = geometry::corner_points(plan);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    longest = std::max(longest, (corners[(k + 1) % corners.size()] - corners[k]).norm());
  }
  return area * (a / longest) * (a / longest);
}

} // namespace

MeshEstimate estimate(const geometry::Plan& plan, const MeshSettings& mesh) {
  const double squares = squares_of(plan, mesh);
  const bool triangles = geometry::corners_per_element(mesh.element) == 3;
  return {triangles ? 2 * squares : squares, geometry::is_quadratic(mesh.element) ? 4 * squares : squares};
}

double machine_memory() {
  double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
  }
  return bytes;
}

} // namespace pneuma::pipeline::workflow
