// SPDX-License-Identifier: GPL-3.0-or-later
// pneuma-inflate: from a form-found or flat cushion to its inflated state under regulated air and its own weight.
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "solver/material/prestress.h"
#include "stages/common/equilibrium.h"
#include "stages/inflate/against_target.h"

namespace pneuma::stages::inflate {

namespace {

namespace workflow = pipeline::workflow;
using common::Vec3;

// The predeformation with which a foil carries `force` [point][3], N/m, where it lies now (numerics 11).
std::vector<double> predeformation(const common::Start& start, std::size_t foil, std::span<const double> force) {
  const workflow::FoilSettings& settings = start.workflow.cushion.foils[foil];
  const solver::material::Law& law = start.laws.at(settings.material).law;
  std::vector<double> result;
  Vec3 last_force = Vec3::Constant(-1);
  Vec3 last = Vec3::Zero();
  for (std::size_t i = 0; i + 3 <= force.size(); i += 3) {
    const Vec3 n(force[i], force[i + 1], force[i + 2]);
    if (n != last_force) { // the same everywhere in an isotropic film
      const auto found = solver::material::predeformation(law, settings.thickness, n);
      if (!found) {
        throw base::InputError(fmt::format("{}foil `{}` cannot carry a prestress of {} N/m (without yielding): lower "
                                           "it, or take a thicker, stiffer or stronger foil",
                                           common::place_of_foil(start.workflow, foil), settings.name,
                                           common::number(n.maxCoeff())));
      }
      last_force = n;
      last = *found;
    }
    result.insert(result.end(), {last[0], last[1], last[2]});
  }
  return result;
}

void run(const common::Start& start) {
  if (start.arguments.in.empty()) return; // --check: all there is to check without a state
  const auto& settings = std::get<workflow::InflateSettings>(start.stage().settings);
  common::Drive drive;
  drive.state = start.state;
  drive.path = settings;

  const bool from_form = start.stage().from_run == "formfind";
  const bool from_strips = start.stage().from_run == "pattern";
  const bool prestressed = from_form && settings.reference == workflow::Reference::prestressed;
  for (std::size_t b = 0; b < start.workflow.cushion.foils.size(); ++b) {
    pipeline::state::Foil& foil = drive.state.foils[b];
    if (prestressed || (from_strips && foil.strips.empty() && !foil.prestress.empty())) {
      foil.predeformation = predeformation(start, b, foil.prestress); // a foil in one piece keeps its form's prestress
    } else if (!from_form && !from_strips) {
      foil.reference =
          solver::element::corner_coordinates(drive.state.mesh.blocks[b].connectivity, drive.state.mesh.nodes);
      if (settings.prestress) {
        const double n = settings.prestress->at(start.workflow.cushion.foils[b].name);
        const std::size_t points =
            foil.reference.size() /
            (3 * static_cast<std::size_t>(geometry::nodes_per_element(drive.state.mesh.element))) *
            geometry::stress_rule(drive.state.mesh.element, drive.state.stress_rule).size();
        std::vector<double> force;
        for (std::size_t i = 0; i < points; ++i) force.insert(force.end(), {n, n, 0});
        foil.predeformation = predeformation(start, b, force);
      }
    }
    foil.prestress.clear(); // from here on the material carries it
  }
  drive.model = common::make_model(start, drive.state, 0, 1);
  for (std::size_t c = 0; c < drive.state.chambers.size(); ++c) {
    pipeline::state::Chamber& chamber = drive.state.chambers[c];
    if (!prestressed && !from_strips) chamber.gauge_pressure = 0; // without stress nothing holds a pressure yet
    drive.model.chambers[c].gas =
        solver::chamber::Regulated{chamber.gauge_pressure, settings.gauge_pressure.at(chamber.name)};
  }
  if (!settings.gauge_pressure.empty()) { // the first chamber's pressure stands for the load
    const double reached = settings.gauge_pressure.at(drive.state.chambers.front().name);
    const auto& ramp = std::get<solver::chamber::Regulated>(drive.model.chambers.front().gas);
    if (ramp.gauge_from == 0 && reached != 0) {
      drive.load_name = "gauge_pressure";
      drive.load_at_one = reached;
    }
  }
  if (!std::holds_alternative<workflow::LoadControl>(settings.control)) {
    bool drives = false;
    for (const auto& chamber : drive.model.chambers) {
      const auto& ramp = std::get<solver::chamber::Regulated>(chamber.gas);
      drives = drives || ramp.gauge_from != ramp.gauge_to;
    }
    if (!drives) {
      throw base::InputError(
          fmt::format("{}the pressures are those that the start already has: they are direction and scale of the path, "
                      "so say others",
                      common::place(start.workflow, fmt::format("stages.{}.gauge_pressure.{}", start.stage().id,
                                                                drive.state.chambers.front().name))));
    }
  }
  drive.modelled.emplace_back("regulated air");
  if (from_strips) {
    drive.modelled.emplace_back("foils welded from flat strips: their shapes are the reference");
    std::vector<std::vector<double>> area;
    for (const auto& foil : drive.model.foils) area.push_back(foil ? foil->reference.area : std::vector<double>());
    drive.report = [&start, area](const common::State& end, const std::vector<common::FoilResults>& foils,
                                  common::Summary& summary) {
      report_against_target(start.state, end, foils, area, summary);
    };
  }
  common::run_equilibrium(start, std::move(drive));
}

} // namespace

} // namespace pneuma::stages::inflate

int main(int argc, char** argv) {
  return pneuma::stages::common::stage_main("inflate", "inflates a cushion under regulated air and its weight",
                                            pneuma::stages::inflate::run, argc, argv);
}
