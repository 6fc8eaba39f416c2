// SPDX-License-Identifier: GPL-3.0-or-later
// pneuma-mesh: from the outline of a cushion to the flat mesh of its foils.
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/mesh_check.h"
#include "geometry/meshing/plan_mesh.h"
#include "pipeline/state/state_file.h"
#include "stages/common/foil_results.h"

namespace pneuma::stages::mesh {

namespace {

using common::Index;
namespace meshing = geometry::meshing;
namespace workflow = pipeline::workflow;

geometry::Mesh make_mesh(const workflow::Cushion& cushion, const workflow::MeshSettings& settings) {
  meshing::MeshOptions options;
  options.element = settings.element;
  options.size = settings.size;
  options.divisions = settings.divisions;
  const bool has_regular_pattern = !std::holds_alternative<geometry::Polygon>(cushion.plan);
  const bool structured =
      settings.pattern == workflow::MeshPattern::structured || (!settings.pattern && has_regular_pattern);
  options.pattern = structured ? meshing::Pattern::structured : meshing::Pattern::unstructured;
  const geometry::Mesh plan = meshing::mesh_plan(cushion.plan, options);
  std::vector<meshing::Layer> layers;
  layers.reserve(cushion.foils.size() + 1);
  for (const workflow::FoilSettings& foil : cushion.foils) layers.push_back({foil.name, geometry::BlockKind::foil});
  if (cushion.rigid_base) layers.push_back({"base", geometry::BlockKind::base});
  return meshing::stack(plan, layers);
}

common::State make_state(const common::Start& start) {
  const workflow::Workflow& w = start.workflow;
  const auto& settings = std::get<workflow::MeshSettings>(start.stage().settings);
  common::State state;
  try {
    state.mesh = make_mesh(w.cushion, settings);
  } catch (const base::InputError& error) {
    throw base::InputError(common::place(w, settings.size ? "mesh.size" : "mesh.divisions") + error.what());
  }
  state.origin = common::origin_of(start);
  state.stress_rule = settings.stress_rule;
  for (const workflow::FoilSettings& foil : w.cushion.foils) {
    pipeline::state::Foil data;
    data.material = foil.material;
    data.thickness = foil.thickness;
    data.warp_angle = foil.warp;
    state.foils.push_back(data);
  }
  if (w.cushion.rigid_base) state.foils.emplace_back();

  state.fixed.assign(3 * state.mesh.nodes.size(), 0);
  const auto hold = [&](Index node) {
    for (std::size_t c = 0; c < 3; ++c) state.fixed[3 * static_cast<std::size_t>(node) + c] = 1;
  };
  for (const geometry::Edge& edge : state.mesh.edges) {
    for (const Index node : edge.nodes) hold(node);
  }
  for (const geometry::Block& block : state.mesh.blocks) {
    if (block.kind != geometry::BlockKind::base) continue;
    for (const Index node : block.connectivity) hold(node);
  }

  const auto block_of = [&](const std::string& name) {
    Index b = 0;
    while (state.mesh.blocks[static_cast<std::size_t>(b)].name != name) ++b;
    return b;
  };
  for (const workflow::ChamberSettings& chamber : w.cushion.chambers) {
    pipeline::state::Chamber data;
    data.name = chamber.name;
    data.outer = block_of(chamber.between[0]);
    data.inner = block_of(chamber.between[1]);
    data.dead_volume = chamber.dead_volume;
    data.volume = chamber.dead_volume; // the foils lie on each other
    data.ambient_pressure = w.site.ambient_pressure.pascal;
    data.temperature = w.site.temperature;
    for (std::size_t other = 0; other < w.cushion.chambers.size(); ++other) {
      if (w.cushion.chambers[other].name == chamber.connected_to) data.connected_to = static_cast<Index>(other);
    }
    state.chambers.push_back(data);
  }
  state.provenance = common::provenance(start);
  state.provenance.converged = true;
  state.provenance.verdict = "meshed";
  state.provenance.load_factor = 1;
  return state;
}

void run(const common::Start& start) {
  const common::Clock clock;
  const common::State state = make_state(start);
  common::Summary summary(common::origin_of(start), start.arguments.notes);
  Index elements = 0;
  for (const geometry::Block& block : state.mesh.blocks) elements += state.mesh.element_count(block);
  std::string errors;
  for (const geometry::MeshFault& fault : geometry::check_mesh(state.mesh)) {
    if (fault.severity == geometry::Severity::error) {
      errors += fault.message + '\n';
    } else {
      base::warn(fault.message);
      summary.append("warnings", fault.message);
    }
  }
  if (!errors.empty()) throw base::GeometryError("the mesh is not fit for computing:\n" + errors);
  if (start.arguments.check) return;
  base::say(fmt::format("{} nodes, {} elements {} in {} blocks", state.mesh.nodes.size(), elements,
                        geometry::name_of(state.mesh.element), state.mesh.blocks.size()));
  pipeline::state::write_state(state, *start.outputs, start.outputs->state_name());
  summary.set("stage", "mesh");
  summary.set("id", start.stage().id);
  summary.set("converged", true);
  summary.set("verdict", state.provenance.verdict);
  common::summarize_mesh(state, summary);
  summary.set("timing.total", clock.seconds());
  summary.set("memory_peak", common::peak_memory());
  summary.write(*start.outputs);
}

} // namespace

} // namespace pneuma::stages::mesh

int main(int argc, char** argv) {
  return pneuma::stages::common::stage_main("mesh", "meshes the outline: the flat mesh of all foils",
                                            pneuma::stages::mesh::run, argc, argv);
}
