// SPDX-License-Identifier: GPL-3.0-or-later
// pneuma-wind: from an inflated cushion to its state under wind, snow and patch loads, with the air in its chambers
// taking part as the load case says.
#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/base/errors.h"
#include "solver/load/loads.h"
#include "stages/common/equilibrium.h"

namespace pneuma::stages::wind {

namespace {

namespace workflow = pipeline::workflow;
using common::Index;
using common::Vec3;
using common::VecX;

geometry::PlanRegion region_of(const std::optional<workflow::Region>& region, std::span<const Vec3> nodes) {
  if (!region) return geometry::WholePlan{};
  if (region->polygon) return geometry::PlanPolygon{*region->polygon};
  geometry::PlanRectangle box{nodes.front().head<2>(), nodes.front().head<2>()}; // farther than the foil reaches
  for (const Vec3& node : nodes) {
    box.low = box.low.cwiseMin(node.head<2>());
    box.high = box.high.cwiseMax(node.head<2>());
  }
  const base::Vec2 margin = base::Vec2::Constant((box.high - box.low).norm());
  box = {box.low - margin, box.high + margin};
  if (region->x) std::tie(box.low.x(), box.high.x()) = std::pair((*region->x)[0], (*region->x)[1]);
  if (region->y) std::tie(box.low.y(), box.high.y()) = std::pair((*region->y)[0], (*region->y)[1]);
  return box;
}

// Place of a load in the user's file, for messages.
std::string place_of_load(const common::Start& start, const workflow::WindSettings& settings,
                          const workflow::Load& load) {
  const auto i = &load - settings.loads.data();
  return common::place(start.workflow, fmt::format("stages.{}.loads.{}.name", start.stage().id, i));
}

// The load at factor 1.
pipeline::state::Load load_of(const workflow::Load& load, const std::string& where, const common::Start& start) {
  const geometry::Mesh& mesh = start.state.mesh;
  const std::vector<workflow::FoilSettings>& foils = start.workflow.cushion.foils;
  Index block = 0;
  while (foils[static_cast<std::size_t>(block)].name != load.foil) ++block;
  const geometry::Block& foil = mesh.blocks[static_cast<std::size_t>(block)];
  pipeline::state::Load out{load.name, block, 0, {}, {}, {}};
  const auto quadrature = [&](const geometry::PlanRegion& region) {
    return geometry::region_quadrature(mesh, foil, mesh.nodes, region);
  };
  // the region of a wind or snow load may stick out, but must not miss the foil
  const auto loaded = [&] {
    geometry::RegionQuadrature inside = quadrature(region_of(load.region, mesh.nodes));
    if (!(geometry::plan_area(mesh, foil, mesh.nodes, inside) > 0)) {
      throw base::GeometryError(
          fmt::format("{}load `{}`: nothing of its region lies on foil `{}`: move it", where, load.name, foil.name));
    }
    return inside;
  };
  const auto dead = [&](const geometry::RegionQuadrature& region, const Vec3& per_plan_area) {
    VecX force = VecX::Zero(static_cast<Eigen::Index>(3 * mesh.nodes.size()));
    solver::load::add_plan_load(mesh, block, mesh.nodes, region, per_plan_area, force);
    out.dead.assign(force.begin(), force.end());
  };

  if (const auto* wind = std::get_if<workflow::WindLoad>(&load.kind)) {
    // the first foil shows its weather face (normal outwards), the last of several its room face
    out.pressure = (block == 0 ? -1 : 1) * wind->pressure;
    if (load.region) {
      solver::assembly::PressureZone zone = solver::load::pressure_zone(mesh, block, loaded());
      out.offset = std::move(zone.offset);
      out.points = std::move(zone.points);
    }
  } else if (const auto* snow = std::get_if<workflow::SnowLoad>(&load.kind)) {
    dead(loaded(), -snow->weight * start.workflow.site.up.normalized());
  } else {
    const auto& patch = std::get<workflow::PatchLoad>(load.kind);
    const geometry::RegionQuadrature inside =
        quadrature(geometry::PlanRectangle{patch.center - 0.5 * patch.size, patch.center + 0.5 * patch.size});
    const double area = geometry::plan_area(mesh, foil, mesh.nodes, inside);
    const double wanted = patch.size.x() * patch.size.y();
    if (area < (1 - 1e-6) * wanted) {
      throw base::GeometryError(
          fmt::format("{}load `{}`: only {} of the patch's {} m2 lie on foil `{}`: move it or make "
                      "it smaller",
                      where, load.name, common::number(area), common::number(wanted), foil.name));
    }
    dead(inside, patch.force / area);
  }
  return out;
}

// What acts in the state that the stage starts from: it stays, or goes to the part of it that `factors` says.
std::vector<common::DrivenLoad> carried_loads(const common::Start& start, const workflow::WindSettings& settings,
                                              std::vector<std::string>& modelled) {
  std::vector<common::DrivenLoad> loads;
  std::vector<std::string> names;
  for (const pipeline::state::Load& load : start.state.loads) {
    const auto factor = settings.factors.find(load.name);
    loads.push_back({load, 1, factor == settings.factors.end() ? 1 : factor->second});
    names.push_back(load.name);
    modelled.push_back(fmt::format("load {}: of the state before, {}", load.name,
                                   factor == settings.factors.end()
                                       ? "stays as it is"
                                       : fmt::format("goes to {} of what it was", common::number(factor->second))));
  }
  for (const auto& [name, factor] : settings.factors) {
    const bool is_own = std::any_of(settings.loads.begin(), settings.loads.end(),
                                    [&](const workflow::Load& load) { return load.name == name; });
    if (is_own || std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw base::InputError(
        fmt::format("{}`factors` names load `{}`, which does not act in the state that the stage "
                    "starts from; there {}",
                    common::place(start.workflow, fmt::format("stages.{}.factors.{}", start.stage().id, name)), name,
                    names.empty() ? "no load does" : fmt::format("act: {}", fmt::join(names, ", "))));
  }
  for (const workflow::Load& own : settings.loads) {
    if (std::find(names.begin(), names.end(), own.name) == names.end()) continue;
    throw base::InputError(fmt::format("{}load `{}` acts in the state that the stage starts from: to change it give "
                                       "its factor in `factors`, or choose another name",
                                       place_of_load(start, settings, own), own.name));
  }
  return loads;
}

// `volume`: of the air now, that of connected chambers included, m3.
solver::chamber::Gas gas_of(const workflow::Gas& gas, const pipeline::state::Chamber& chamber, double volume,
                            std::string& text) {
  if (const auto* closed = std::get_if<workflow::ClosedGas>(&gas)) {
    solver::chamber::Closed law;
    law.kappa = closed->kappa;
    law.absolute0 = chamber.gauge_pressure + chamber.ambient_pressure;
    law.volume0 = volume;
    law.temperature0 = chamber.temperature;
    law.temperature = closed->temperature.value_or(chamber.temperature);
    law.ambient_from = chamber.ambient_pressure;
    law.ambient_to = closed->ambient_pressure.value_or(chamber.ambient_pressure);
    text = fmt::format("chamber {}: closed air, kappa {}, absolute pressure {} Pa at the start", chamber.name,
                       law.kappa, common::number(law.absolute0));
    if (!(law.absolute0 > 0) || !(law.volume0 > 0)) {
      throw base::InputError(
          fmt::format("chamber `{}` cannot be closed: it holds {} m3 at an absolute pressure of {} Pa", chamber.name,
                      common::number(law.volume0), common::number(law.absolute0)));
    }
    return law;
  }
  if (const auto* prescribed = std::get_if<workflow::VolumeGas>(&gas)) {
    text = fmt::format("chamber {}: prescribed volume", chamber.name);
    return solver::chamber::PrescribedVolume{volume, prescribed->volume};
  }
  text = fmt::format("chamber {}: regulated air", chamber.name);
  const auto& regulated = std::get<workflow::RegulatedGas>(gas);
  return solver::chamber::Regulated{chamber.gauge_pressure, regulated.gauge_pressure.value_or(chamber.gauge_pressure)};
}

void run(const common::Start& start) {
  if (start.arguments.in.empty()) return; // --check: all there is to check without a state
  const auto& settings = std::get<workflow::WindSettings>(start.stage().settings);
  common::Drive drive;
  drive.state = start.state;
  drive.path = settings;
  drive.model = common::make_model(start, drive.state, 1, 1);
  const std::vector<pipeline::state::Chamber>& chambers = drive.state.chambers;
  for (std::size_t c = 0; c < chambers.size(); ++c) {
    std::string text;
    if (chambers[c].connected_to >= 0) {
      text = fmt::format("chamber {}: one air with {}", chambers[c].name,
                         chambers[static_cast<std::size_t>(chambers[c].connected_to)].name);
    } else {
      double volume = chambers[c].volume;
      for (const pipeline::state::Chamber& other : chambers) {
        if (other.connected_to == static_cast<Index>(c)) volume += other.volume;
      }
      drive.model.chambers[c].gas = gas_of(settings.gas.at(chambers[c].name), chambers[c], volume, text);
    }
    drive.modelled.push_back(text);
  }
  drive.loads = carried_loads(start, settings, drive.modelled);
  for (const workflow::Load& load : settings.loads) {
    drive.loads.push_back(
        {load_of(load, place_of_load(start, settings, load), start), 0, settings.factors.at(load.name)});
    constexpr const char* kinds[] = {"wind as a pressure that follows the foil", "snow as a dead load on the plan",
                                     "patch as a dead load on the plan"};
    drive.modelled.push_back(fmt::format("load {}: {}", load.name, kinds[load.kind.index()]));
  }
  for (const common::DrivenLoad& driven : drive.loads) common::add_load(driven, drive.model);
  if (settings.loads.size() == 1 && settings.factors.size() == 1) { // then the load has a name and a unit of its own
    const workflow::Load& load = settings.loads.front();
    const double factor = settings.factors.at(load.name);
    if (const auto* wind = std::get_if<workflow::WindLoad>(&load.kind)) {
      drive.load_name = "wind";
      drive.load_at_one = factor * wind->pressure;
    } else if (const auto* snow = std::get_if<workflow::SnowLoad>(&load.kind)) {
      drive.load_name = "snow";
      drive.load_at_one = factor * snow->weight;
    } else {
      drive.load_name = "patch";
      drive.load_at_one = factor * std::get<workflow::PatchLoad>(load.kind).force.norm();
    }
  }
  common::run_equilibrium(start, std::move(drive));
}

} // namespace

} // namespace pneuma::stages::wind

int main(int argc, char** argv) {
  return pneuma::stages::common::stage_main("wind", "loads an inflated cushion by wind, snow and patch loads",
                                            pneuma::stages::wind::run, argc, argv);
}
