// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/welded.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/log.h"
#include "geometry/base/parallel.h"
#include "geometry/volume.h"
#include "solver/element/reference.h"
#include "solver/formfinding/formfinding.h"

namespace pneuma::stages::pattern {

namespace {

namespace formfinding = solver::formfinding;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Pressure on each block along its normal, Pa.
std::vector<double> net_pressures(const State& state) {
  std::vector<double> net(state.mesh.blocks.size(), 0.0);
  for (const pipeline::state::Chamber& chamber : state.chambers) {
    net[at(chamber.outer)] += chamber.gauge_pressure;
    net[at(chamber.inner)] -= chamber.gauge_pressure;
  }
  return net;
}

void hold(State& state, const std::vector<Index>& nodes) {
  for (const Index node : nodes) std::fill_n(state.fixed.begin() + static_cast<std::ptrdiff_t>(3 * at(node)), 3, 1);
}

// The film's own equilibrium on the new mesh: a few Newton steps from the old surface.
void settle(State& state, const std::vector<double>& tension, int threads) {
  const std::vector<double> net = net_pressures(state);
  std::vector<formfinding::Form> forms(state.mesh.blocks.size());
  base::parallel_chunks(threads, forms.size(), [&](std::size_t b) {
    if (tension[b] <= 0) return;
    formfinding::Options options;
    options.rule = state.stress_rule;
    forms[b] = formfinding::find_form(state.mesh, state.fixed, state.mesh.nodes,
                                      {static_cast<Index>(b), tension[b], net[b]}, options);
  });
  for (std::size_t b = 0; b < forms.size(); ++b) {
    if (tension[b] <= 0) continue;
    if (forms[b].verdict != formfinding::Verdict::converged) {
      base::warn(
          fmt::format("foil `{}` keeps the form of the old mesh: {}", state.mesh.blocks[b].name, forms[b].reason));
      continue;
    }
    for (const Index node : state.mesh.blocks[b].connectivity) {
      if (state.fixed[3 * at(node)] == 0) state.mesh.nodes[at(node)] = forms[b].positions[at(node)];
    }
  }
}

} // namespace

State transferred(const common::Start& start, const geometry::strips::CutMesh& cut) {
  State state = start.state;
  state.mesh = cut.mesh;
  state.fields.clear();
  state.fixed.assign(3 * state.mesh.nodes.size(), 0);
  for (const geometry::Edge& edge : state.mesh.edges) hold(state, edge.nodes);
  for (const geometry::Block& block : state.mesh.blocks) {
    if (block.kind == geometry::BlockKind::base) hold(state, block.connectivity);
  }
  std::vector<double> tension(state.mesh.blocks.size(), 0.0);
  for (std::size_t b = 0; b < tension.size(); ++b) {
    const std::vector<double>& prestress = start.state.foils[b].prestress;
    if (!prestress.empty()) tension[b] = prestress.front(); // the same everywhere: an isotropic film
  }
  settle(state, tension, start.arguments.threads);

  const std::size_t points = geometry::stress_rule(state.mesh.element, state.stress_rule).size();
  for (std::size_t b = 0; b < state.mesh.blocks.size(); ++b) {
    const geometry::Block& block = state.mesh.blocks[b];
    pipeline::state::Foil& foil = state.foils[b];
    if (block.kind == geometry::BlockKind::base) continue;
    foil.reference = solver::element::corner_coordinates(block.connectivity, state.mesh.nodes);
    foil.prestress.clear();
    for (std::size_t i = 0; tension[b] > 0 && i < at(state.mesh.element_count(block)) * points; ++i) {
      foil.prestress.insert(foil.prestress.end(), {tension[b], tension[b], 0});
    }
  }
  for (pipeline::state::Chamber& chamber : state.chambers) {
    chamber.volume =
        chamber.dead_volume + geometry::enclosed_volume(state.mesh, state.mesh.blocks[at(chamber.outer)],
                                                        state.mesh.blocks[at(chamber.inner)], state.mesh.nodes);
  }
  return state;
}

void weld(Welded& welded) {
  using pipeline::state::Field;
  using pipeline::state::Location;
  State& state = welded.state;
  Field strip{"strip", "1", Location::cell, 1, -1, {}};
  Field distortion{"distortion", "1", Location::cell, 1, -1, {}};
  for (std::size_t b = 0; b < state.mesh.blocks.size(); ++b) {
    const std::size_t elements = at(state.mesh.element_count(state.mesh.blocks[b]));
    if (!welded.flat[b]) {
      strip.values.insert(strip.values.end(), elements, 0.0);
      distortion.values.insert(distortion.values.end(), elements, 0.0);
      continue;
    }
    const FlatFoil& flat = *welded.flat[b];
    const geometry::strips::CutFoil& cut = welded.cuts[b];
    pipeline::state::Foil& foil = state.foils[b];
    foil.reference = corner_coordinates(flat);
    foil.warp_angle = 0; // the roll lies along x of the flat strips
    foil.strip_of_element = cut.strip_of_element;
    for (Index s = 0; s < cut.strips; ++s) foil.strips.push_back(strip_name(state.mesh.blocks[b].name, s));
    for (std::size_t s = 0; s < cut.seams.size(); ++s) {
      foil.seams.push_back(
          {seam_name(static_cast<Index>(s)), cut.seams[s].left, cut.seams[s].right, cut.seams[s].nodes});
    }
    const std::size_t points = flat.stretches.size() / elements;
    for (std::size_t e = 0; e < elements; ++e) {
      strip.values.push_back(cut.strip_of_element[e] + 1.0);
      double worst = 0;
      for (std::size_t k = e * points; k < (e + 1) * points; ++k) {
        worst = std::max({worst, flat.stretches[k].larger - 1, 1 - flat.stretches[k].smaller});
      }
      distortion.values.push_back(worst);
    }
  }
  state.fields = {strip, distortion};
}

} // namespace pneuma::stages::pattern
