// SPDX-License-Identifier: GPL-3.0-or-later
// pneuma-formfind: from the flat mesh to the form that a film of the wanted prestress takes under the wanted pressure.
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/base/parallel.h"
#include "geometry/surface.h"
#include "geometry/volume.h"
#include "pipeline/state/state_file.h"
#include "solver/element/reference.h"
#include "solver/formfinding/formfinding.h"
#include "solver/linear/blas.h"
#include "stages/common/foil_results.h"
#include "stages/formfind/self_check.h"

namespace pneuma::stages::formfind {

namespace {

namespace workflow = pipeline::workflow;
namespace formfinding = solver::formfinding;
using common::State;
using common::Vec3;

std::vector<double> net_pressures(const common::Start& start, const workflow::FormfindSettings& settings) {
  std::vector<double> net(start.state.mesh.blocks.size(), 0.0);
  for (const pipeline::state::Chamber& chamber : start.state.chambers) {
    const double p = settings.gauge_pressure.at(chamber.name);
    net[static_cast<std::size_t>(chamber.outer)] += p;
    net[static_cast<std::size_t>(chamber.inner)] -= p;
  }
  return net;
}

// Why there is no form, and what would have one: the message for the user.
std::string diagnose(const common::Start& start, const formfinding::Target& target, const std::string& foil,
                     const formfinding::Form& form, const formfinding::Options& options) {
  std::string text = fmt::format("no equilibrium exists for foil `{}` with a prestress of {} N/m under {} Pa: {}", foil,
                                 common::number(target.tension), common::number(target.pressure), form.reason);
  if (target.pressure == 0) return text;
  const auto limit =
      formfinding::find_limit(start.state.mesh, start.state.fixed, start.state.mesh.nodes, target, options);
  if (!limit) return text;
  return text + fmt::format(". The largest pressure that has a film here is {} Pa; {} Pa need a prestress of {} N/m",
                            common::number(limit->largest_pressure), common::number(std::abs(target.pressure)),
                            common::number(limit->needed_tension));
}

void run(const common::Start& start) {
  const common::Clock clock;
  if (start.arguments.check) return;
  solver::linear::prepare_blas(start.arguments.threads);
  const auto& settings = std::get<workflow::FormfindSettings>(start.stage().settings);
  formfinding::Options options;
  options.rule = start.state.stress_rule;
  if (settings.options.tolerance) options.tolerance = *settings.options.tolerance;
  if (settings.options.max_iterations) options.max_updates = *settings.options.max_iterations;

  State state = start.state;
  const std::vector<Vec3> flat = state.mesh.nodes;
  const std::vector<double> net = net_pressures(start, settings);
  const std::size_t count = start.workflow.cushion.foils.size();
  std::vector<formfinding::Form> forms(count);
  std::vector<formfinding::Target> targets(count);
  for (std::size_t b = 0; b < count; ++b) {
    targets[b] = {static_cast<Index>(b), settings.prestress.at(start.workflow.cushion.foils[b].name), net[b]};
  }
  base::parallel_chunks(start.arguments.threads, count, [&](std::size_t b) {
    forms[b] = formfinding::find_form(state.mesh, state.fixed, flat, targets[b], options);
  });

  common::Summary summary(common::origin_of(start), start.arguments.notes);
  common::History history(*start.outputs);
  int updates = 0;
  int factorizations = 0;
  bool converged = true;
  std::string verdict = "converged";
  for (std::size_t b = 0; b < count; ++b) {
    const formfinding::Form& form = forms[b];
    const std::string& name = state.mesh.blocks[b].name;
    updates = std::max(updates, form.updates);
    factorizations += form.factorizations;
    base::say(fmt::format("{}: {} after {} updates, residual {:.1e} across and {:.1e} along the surface", name,
                          form.verdict == formfinding::Verdict::converged  ? "converged"
                          : form.verdict == formfinding::Verdict::swimming ? "still swimming"
                                                                           : "no equilibrium",
                          form.updates, form.residual, form.residual_along));
    if (form.verdict != formfinding::Verdict::converged && converged) {
      converged = false;
      verdict = form.verdict == formfinding::Verdict::swimming
                    ? fmt::format("foil `{}` is still swimming: {}", name, form.reason)
                    : diagnose(start, targets[b], name, form, options);
    }
    if (form.verdict != formfinding::Verdict::no_equilibrium) {
      for (const Index node : state.mesh.blocks[b].connectivity) {
        const auto k = static_cast<std::size_t>(node);
        if (state.fixed[3 * k] == 0) state.mesh.nodes[k] = form.positions[k];
      }
    }
  }

  const std::size_t points = geometry::stress_rule(state.mesh.element, state.stress_rule).size();
  for (std::size_t b = 0; b < count; ++b) {
    const geometry::Block& block = state.mesh.blocks[b];
    pipeline::state::Foil& foil = state.foils[b];
    foil.reference = solver::element::corner_coordinates(block.connectivity, state.mesh.nodes);
    const auto all = static_cast<std::size_t>(state.mesh.element_count(block)) * points;
    for (std::size_t i = 0; i < all; ++i) {
      foil.prestress.insert(foil.prestress.end(), {targets[b].tension, targets[b].tension, 0});
    }
  }
  for (pipeline::state::Chamber& chamber : state.chambers) {
    chamber.gauge_pressure = settings.gauge_pressure.at(chamber.name);
    chamber.volume =
        chamber.dead_volume +
        geometry::enclosed_volume(state.mesh, state.mesh.blocks[static_cast<std::size_t>(chamber.outer)],
                                  state.mesh.blocks[static_cast<std::size_t>(chamber.inner)], state.mesh.nodes);
    const std::string key = "chambers." + chamber.name + ".";
    summary.set(key + "gauge_pressure", chamber.gauge_pressure);
    summary.set(key + "absolute_pressure", chamber.gauge_pressure + chamber.ambient_pressure);
    summary.set(key + "volume", chamber.volume);
    if (converged) {
      base::say(fmt::format("chamber {}: {} Pa, {:.6g} m3", chamber.name, common::number(chamber.gauge_pressure),
                            chamber.volume));
    }
  }

  pipeline::state::Field displacement{"displacement", "m", pipeline::state::Location::point, 3, -1, {}};
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const Vec3 u = state.mesh.nodes[i] - flat[i];
    displacement.values.insert(displacement.values.end(), {u.x(), u.y(), u.z()});
  }
  state.fields = {displacement};
  state.provenance = common::provenance(start);
  state.provenance.converged = converged;
  state.provenance.verdict = verdict;
  state.provenance.load_factor = converged ? 1 : 0;

  const geometry::Plane plane = geometry::edge_plane(state.mesh, state.mesh.nodes);
  common::History::Row row{{"updates", updates}};
  for (std::size_t b = 0; b < count; ++b) {
    const geometry::Block& block = state.mesh.blocks[b];
    const std::string foil = "foils." + block.name + ".";
    const double sag = geometry::deepest_point(state.mesh, block, state.mesh.nodes, plane).distance;
    double deflection = 0;
    for (const Index node : block.connectivity) {
      const auto k = static_cast<std::size_t>(node);
      deflection = std::max(deflection, (state.mesh.nodes[k] - flat[k]).norm());
    }
    summary.set(foil + "area", geometry::surface_area(state.mesh, block, state.mesh.nodes));
    summary.set(foil + "sag", sag);
    summary.set(foil + "max_deflection", deflection);
    summary.set(foil + "residual_across", forms[b].residual);
    summary.set(foil + "residual_along", forms[b].residual_along);
    row.emplace_back(foil + "sag", sag);
    row.emplace_back(foil + "residual_across", forms[b].residual);
  }
  history.add(row);
  for (const pipeline::state::Chamber& chamber : state.chambers) {
    const double span = geometry::span_of(state.mesh.nodes);
    if (converged && chamber.volume - chamber.dead_volume < -1e-9 * span * span * span) {
      throw base::GeometryError(
          fmt::format("the foils of chamber `{}` pass through each other: it has {} m3 at {} Pa; a chamber needs more "
                      "pressure than what lies beyond its foils",
                      chamber.name, common::number(chamber.volume), common::number(chamber.gauge_pressure)));
    }
  }

  if (converged) {
    for (const FoilCheck& check : self_check(start, state, net)) {
      const bool curved = check.laplace_points > 0;
      const std::string laplace = curved
                                      ? fmt::format("{:.2e} rms, {:.2e} at most", check.laplace_rms, check.laplace_max)
                                      : "not checked (mesh too coarse)";
      base::say(fmt::format(
          "self-check {}: Laplace-Young {}; reactions {:.1e}; elastic foil moves {:.1e} of the span: {}", check.foil,
          laplace, check.reaction_error, check.elastic_move, check.passed ? "passed" : "NOT passed"));
      const std::string key = "self_check." + check.foil + ".";
      if (curved) {
        summary.set(key + "laplace_young_rms", check.laplace_rms);
        summary.set(key + "laplace_young_max", check.laplace_max);
      }
      summary.set(key + "reactions", check.reaction_error);
      summary.set(key + "elastic_move", check.elastic_move);
      summary.set(key + "passed", check.passed);
      if (!check.passed) {
        const std::string warning = fmt::format("foil `{}` does not pass its self-check: refine the mesh", check.foil);
        base::warn(warning);
        summary.append("warnings", warning);
      }
    }
  }

  pipeline::state::write_state(state, *start.outputs, start.outputs->state_name());
  summary.set("stage", "formfind");
  summary.set("id", start.stage().id);
  summary.set("converged", converged);
  summary.set("verdict", verdict);
  summary.set("load_factor", state.provenance.load_factor);
  summary.set("steps", 1);
  summary.set("iterations", updates);
  summary.set("factorizations", factorizations);
  common::summarize_mesh(state, summary);
  summary.set("timing.total", clock.seconds());
  summary.set("memory_peak", common::peak_memory());
  summary.append("modelled", "a film of uniform, isotropic prestress under uniform pressure");
  summary.append("not_modelled", "weight of the foils, elasticity, cutting patterns");
  summary.write(*start.outputs);
  if (converged) return;
  const std::string pressure_key =
      state.chambers.empty() ? "" : "stages." + start.stage().id + ".gauge_pressure." + state.chambers[0].name;
  throw base::Error(base::ExitCode::no_equilibrium, common::place(start.workflow, pressure_key) + verdict);
}

} // namespace

} // namespace pneuma::stages::formfind

int main(int argc, char** argv) {
  return pneuma::stages::common::stage_main(
      "formfind", "finds the form of a film of given prestress under given pressure, with a verdict and a self-check",
      pneuma::stages::formfind::run, argc, argv);
}
