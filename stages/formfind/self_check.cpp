// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/formfind/self_check.h"

#include <algorithm>
#include <cmath>

#include "geometry/curvature.h"
#include "geometry/surface.h"
#include "geometry/volume.h"
#include "solver/element/film.h"
#include "solver/material/prestress.h"
#include "solver/path/newton.h"
#include "stages/common/equilibrium.h"

namespace pneuma::stages::formfind {

namespace {

using common::State;
using common::Vec3;
using common::VecX;

void check_laplace(const State& state, std::size_t b, double tension, FoilCheck& check) {
  const geometry::Block& block = state.mesh.blocks[b];
  const double scale = check.pressure != 0
                           ? std::abs(check.pressure)
                           : tension / std::sqrt(geometry::surface_area(state.mesh, block, state.mesh.nodes));
  double sum = 0;
  int& count = check.laplace_points;
  for (const geometry::FittedCurvature& c : geometry::fitted_curvatures(state.mesh, block, state.mesh.nodes)) {
    if (!c.reliable) continue;
    // curvatures are positive where the surface bends away from its normal, as a dome does
    const double error = std::abs(tension * c.sum() - check.pressure) / scale;
    check.laplace_max = std::max(check.laplace_max, error);
    sum += error * error;
    ++count;
  }
  check.laplace_rms = count > 0 ? std::sqrt(sum / count) : 0;
}

// What the frame gives, summed over the rim's nodes, against the pressure on the exact area of the plan.
void check_reactions(const State& state, std::size_t b, double tension, double plan_area, FoilCheck& check) {
  const geometry::Block& block = state.mesh.blocks[b];
  Vec3 reaction = Vec3::Zero();
  geometry::dispatch(state.mesh.element, [&]<geometry::ElementType E>() {
    double area = 0;
    geometry::PressureElement<E> p;
    const solver::element::Film film{E, state.stress_rule, block.connectivity, tension};
    solver::element::film_forces(film, state.mesh.nodes, 0, area, [&](const solver::element::ElementBatch& batch) {
      const std::span<const Index> nodes = state.mesh.element_nodes(block, batch.first);
      geometry::pressure_element<E>(geometry::gather<E>(nodes, state.mesh.nodes), geometry::pressure_rule(E), false, p);
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        if (state.fixed[3 * static_cast<std::size_t>(nodes[a])] == 0) continue;
        const auto k = static_cast<Eigen::Index>(3 * a);
        reaction += Eigen::Map<const Vec3>(batch.force + k) - check.pressure * p.force.template segment<3>(k);
      }
    });
  });
  const Vec3 expected(0, 0, -check.pressure * plan_area);
  const double scale = check.pressure != 0 ? expected.norm() : tension * std::sqrt(plan_area);
  check.reaction_error = (reaction - expected).norm() / scale;
}

} // namespace

std::vector<FoilCheck> self_check(const common::Start& start, const State& found,
                                  const std::vector<double>& net_pressure) {
  State state = found;
  std::vector<FoilCheck> checks;
  for (std::size_t b = 0; b < start.workflow.cushion.foils.size(); ++b) {
    pipeline::state::Foil& foil = state.foils[b];
    FoilCheck check;
    check.foil = state.mesh.blocks[b].name;
    check.pressure = net_pressure[b];
    const Vec3 force(foil.prestress[0], foil.prestress[1], foil.prestress[2]);
    check_laplace(state, b, force[0], check);
    check_reactions(state, b, force[0], geometry::area(start.workflow.cushion.plan), check);
    checks.push_back(check);

    const solver::material::Law& law = start.laws.at(start.workflow.cushion.foils[b].material).law;
    const auto g = solver::material::predeformation(law, foil.thickness, force);
    if (!g) return checks; // the inflate stage will say so, with the place
    foil.predeformation.clear();
    for (std::size_t i = 0; i < foil.prestress.size(); i += 3) {
      foil.predeformation.insert(foil.predeformation.end(), {(*g)[0], (*g)[1], (*g)[2]});
    }
  }
  solver::assembly::System system(common::make_model(start, state, 0, 0), start.arguments.threads);
  solver::path::Newton newton(system, {});
  solver::assembly::Configuration c{state.mesh.nodes, VecX::Zero(static_cast<Eigen::Index>(state.chambers.size())), 1};
  const bool solved = newton.solve(c).converged;
  const double span = geometry::span_of(state.mesh.nodes);
  for (std::size_t b = 0; b < checks.size(); ++b) {
    for (const Index node : state.mesh.blocks[b].connectivity) {
      const auto k = static_cast<std::size_t>(node);
      checks[b].elastic_move = std::max(checks[b].elastic_move, (c.positions[k] - state.mesh.nodes[k]).norm() / span);
    }
    if (!solved) checks[b].elastic_move = std::nan("");
    checks[b].passed = checks[b].laplace_rms < 0.05 && checks[b].reaction_error < 0.02 && checks[b].elastic_move < 2e-3;
  }
  return checks;
}

} // namespace pneuma::stages::formfind
