// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/local.h"

namespace pneuma::stages::common {

namespace {

namespace workflow = pipeline::workflow;
using base::Vec2;
using geometry::LocalFrame;

void move(std::vector<Vec2>& points, const LocalFrame& frame) {
  for (Vec2& point : points) point = frame.to_local(point);
}

void move(workflow::Region& region, const LocalFrame& frame) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (region.x) (*region.x)[i] = frame.to_local({(*region.x)[i], 0}).x();
    if (region.y) (*region.y)[i] = frame.to_local({0, (*region.y)[i]}).y();
  }
  if (region.polygon) move(*region.polygon, frame);
}

void move(workflow::PathSettings& path, const LocalFrame& frame) {
  auto* control = std::get_if<workflow::DisplacementControl>(&path.control);
  if (control != nullptr && control->at) control->at = frame.to_local(*control->at);
}

void move(workflow::WindSettings& wind, const LocalFrame& frame) {
  move(static_cast<workflow::PathSettings&>(wind), frame);
  for (workflow::Load& load : wind.loads) {
    if (load.region) move(*load.region, frame);
    if (auto* patch = std::get_if<workflow::PatchLoad>(&load.kind)) patch->center = frame.to_local(patch->center);
  }
}

void move(workflow::PatternSettings& pattern, const LocalFrame& frame) {
  for (auto& [foil, curves] : pattern.curves) {
    for (std::vector<Vec2>& curve : curves) move(curve, frame);
  }
}

} // namespace

workflow::Workflow to_local(workflow::Workflow workflow, const LocalFrame& frame) {
  workflow.cushion.plan = geometry::to_local(workflow.cushion.plan, frame);
  for (workflow::StageSettings& stage : workflow.stages) {
    if (auto* inflate = std::get_if<workflow::InflateSettings>(&stage.settings)) move(*inflate, frame);
    if (auto* wind = std::get_if<workflow::WindSettings>(&stage.settings)) move(*wind, frame);
    if (auto* pattern = std::get_if<workflow::PatternSettings>(&stage.settings)) move(*pattern, frame);
  }
  return workflow;
}

} // namespace pneuma::stages::common
