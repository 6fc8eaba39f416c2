// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/verification/examples/strip.h"

#include <limits>

#include "solver/linear/blas.h"

namespace pneuma::tests {

using namespace solver;

assembly::Model pulled_strip(const PerforatedSheet& sheet, const material::Law& law, double displacement) {
  assembly::Model model = plane_model(mesh_of(sheet), law, strip_thickness);
  move_edge(model, nodes_at(model.mesh, 1, sheet.height), 1, displacement);
  return model;
}

PulledStrip::PulledStrip(const PerforatedSheet& sheet, const material::Law& law, double displacement, int parts,
                         double duration, double flow_tolerance)
    : system(pulled_strip(sheet, law, displacement), 1), newton(system, {}), at(start_of(system.model())) {
  linear::prepare_blas(1); // as the programs do
  const std::vector<Index> end = nodes_at(system.model().mesh, 1, sheet.height);
  path::LoadPathOptions options;
  options.parts = parts;
  options.flow = {std::numeric_limits<double>::infinity(), flow_tolerance}; // the parts are the steps
  options.schedule = {{0, 0}, {duration, 1}};
  path = path::follow_load(
      system, newton, at, options,
      [&](const path::Step& step, const assembly::Configuration&) {
        if (step.end_of_part) points.push_back({step.load_factor * displacement, reaction(system, end, 1)});
      },
      tell);
  steps = path.steps;
}

} // namespace pneuma::tests
