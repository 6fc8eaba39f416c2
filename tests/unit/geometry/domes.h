// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "geometry/meshing/plan_mesh.h"
#include "geometry/polygon.h"
#include "geometry/rim.h"

namespace domes {

using namespace pneuma::geometry;

// Height of a dome over a plan: `sag` at its centre or less, zero on the rim.
inline double height(const Plan& plan, const Vec2& at, double sag) {
  if (const auto* r = std::get_if<Rectangle>(&plan)) {
    return sag * (1 - 4 * at.x() * at.x() / (r->length * r->length)) *
           (1 - 4 * at.y() * at.y() / (r->width * r->width));
  }
  if (const auto* c = std::get_if<Circle>(&plan)) return sag * (1 - at.squaredNorm() / (c->radius * c->radius));
  if (std::holds_alternative<Polygon>(plan)) { // steep at the rim, with ridges
    const double distance = (rim_point(plan, rim_position(plan, at)) - at).norm();
    return sag * distance / (distance + 0.5);
  }
  const auto& p = std::get<Triangle>(plan).points;
  const double whole = cross(p[1] - p[0], p[2] - p[0]);
  const double a = cross(p[1] - at, p[2] - at) / whole;
  const double b = cross(p[2] - at, p[0] - at) / whole;
  return 27 * sag * a * b * (1 - a - b);
}

// A cushion of two foils, the upper one `sag` above the rim and the lower one as deep below it.
inline Mesh cushion(const Plan& plan, const meshing::MeshOptions& options, double sag) {
  Mesh mesh = meshing::stack(meshing::mesh_plan(plan, options), {{"upper"}, {"lower"}});
  std::vector<double> sign(mesh.nodes.size(), 1.0);
  for (const Index i : mesh.blocks[1].connectivity) sign[static_cast<std::size_t>(i)] = -1;
  for (const Edge& edge : mesh.edges) {
    for (const Index i : edge.nodes) sign[static_cast<std::size_t>(i)] = 0;
  }
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    mesh.nodes[i].z() = sign[i] * height(plan, mesh.nodes[i].head<2>(), sag);
  return mesh;
}

} // namespace domes
