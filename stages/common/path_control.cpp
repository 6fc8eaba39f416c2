// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/path_control.h"

#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/plan_point.h"

namespace pneuma::stages::common {

namespace {

namespace workflow = pipeline::workflow;
namespace path = solver::path;

// Number of a foil's block; -1: no name, all foils.
Index block_of(const Start& start, const std::string& foil) {
  const std::vector<workflow::FoilSettings>& foils = start.workflow.cushion.foils;
  for (std::size_t b = 0; b < foils.size(); ++b) {
    if (foils[b].name == foil) return static_cast<Index>(b);
  }
  return -1;
}

Index chamber_of(const Start& start, const std::string& chamber) {
  for (std::size_t c = 0; c < start.state.chambers.size(); ++c) {
    if (start.state.chambers[c].name == chamber) return static_cast<Index>(c);
  }
  return 0; // the only one
}

path::HeldDisplacement point_of(const Start& start, const workflow::DisplacementControl& control) {
  const State& state = start.state;
  const geometry::Block& block = state.mesh.blocks[static_cast<std::size_t>(block_of(start, control.foil))];
  const std::string where = place(start.workflow, fmt::format("stages.{}.control.at.0", start.stage().id));
  const base::Vec2 at = start.frame.to_user(*control.at);
  const std::optional<geometry::PlanPoint> point =
      geometry::point_over(state.mesh, block, state.mesh.nodes, *control.at);
  if (!point) {
    throw base::InputError(fmt::format("{}the point ({}, {}) m of the control does not lie on foil `{}`: move it",
                                       where, number(at.x()), number(at.y()), control.foil));
  }
  const Vec3 direction = control.direction.value_or(start.workflow.site.up.normalized());
  path::HeldDisplacement held;
  double moves = 0;
  for (std::size_t a = 0; a < point->nodes.size(); ++a) {
    for (Index c = 0; c < 3; ++c) {
      const Index k = 3 * point->nodes[a] + c;
      const double weight = point->weights[a] * direction[c];
      if (state.fixed[static_cast<std::size_t>(k)] != 0 || weight == 0) continue;
      held.weights.emplace_back(k, weight);
      moves += std::abs(weight);
    }
  }
  if (moves < 1e-6) {
    throw base::InputError(
        fmt::format("{}the point ({}, {}) m of the control lies on the clamped edge of foil `{}` and "
                    "cannot move that way: take one inside",
                    where, number(at.x()), number(at.y()), control.foil));
  }
  return held;
}

} // namespace

std::optional<path::PathControl> path_control(const Start& start, const workflow::Control& control) {
  if (const auto* c = std::get_if<workflow::DisplacementControl>(&control)) {
    if (c->at) return path::DisplacementPath{point_of(start, *c), c->until};
    return path::LargestDisplacementPath{block_of(start, c->foil), std::abs(c->until)};
  }
  if (const auto* c = std::get_if<workflow::VolumeControl>(&control)) {
    return path::VolumePath{chamber_of(start, c->chamber), c->until};
  }
  if (const auto* c = std::get_if<workflow::ArcLengthControl>(&control)) {
    const workflow::ArcTargets& until = c->until;
    return path::ArcLengthPath{until.load_factor,
                               until.pressure,
                               until.volume,
                               until.displacement,
                               until.after_peak,
                               chamber_of(start, c->chamber.value_or("")),
                               block_of(start, c->foil.value_or(""))};
  }
  return std::nullopt;
}

} // namespace pneuma::stages::common
