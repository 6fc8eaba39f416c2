// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/load_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/volume.h"
#include "solver/path/controlled_path.h"

namespace pneuma::solver::path {

namespace {

// A limit point within `reach` of the load beyond a good state, where load control got stuck.
std::optional<CriticalPoint> limit_ahead(System& system, Newton& newton, const Configuration& from, double reach) {
  ControlledPathOptions options;
  options.first_step = reach;
  options.max_steps = 12;
  options.smallest_step = 1e-2; // a look, not a search
  options.only_looking = true;
  ArcLengthPath arc;
  arc.load_factor = from.load_factor + 2 * reach;
  arc.after_peak = 1 - 1e-9;
  Configuration at = from;
  for (const CriticalPoint& point : follow_control(system, newton, at, arc, options, {}).critical) {
    if (point.kind == CriticalPoint::Kind::limit) return point;
  }
  return std::nullopt;
}

std::string pressures_of(const System& system, const CriticalPoint& point) {
  std::string text;
  for (std::size_t c = 0; c < system.model().chambers.size(); ++c) {
    text += fmt::format("{}{}: {:.6g} Pa", text.empty() ? "" : ", ", system.model().chambers[c].name,
                        point.pressures[static_cast<Eigen::Index>(c)]);
  }
  return text;
}

// With a tension field an element that is taut nowhere folds like cloth: that it lies upside down says nothing.
// `states` of the foil are computed when first asked for.
bool is_folded(const assembly::FoilEquations& foil, Index element, const Configuration& at,
               std::vector<element::PointState>& states) {
  if (!material::has_tension_field(foil.membrane.law)) return false;
  if (states.empty()) states = element::point_states(foil.membrane, at.positions, {});
  const auto points = static_cast<std::ptrdiff_t>(foil.membrane.reference.points);
  const auto first = states.begin() + element * points;
  return std::none_of(first, first + points,
                      [](const element::PointState& p) { return p.surface == material::Surface::taut; });
}

// Where the free nodes go as the load factor grows by one, from the last evaluation, if edges move: with the edges
// alone, the strip of elements beside them would take all their move.
std::optional<Change> way_with_edges(const System& system, Newton& newton, const Configuration& at) {
  if (system.model().move.size() == 0) return std::nullopt;
  Tangent& tangent = newton.tangent();
  if (!tangent.factorize(at, Tangent::Repair::indefinite) || tangent.artificial_tension() > 0) return std::nullopt;
  const std::optional<Change> way = tangent.along(at);
  constexpr double no_load = 1e-12;
  if (!way || std::abs(way->load_factor) <= no_load) return std::nullopt;
  return (1 / way->load_factor) * *way;
}

} // namespace

bool turned_over(const System& system, const Configuration& before, const Configuration& after) {
  const geometry::Mesh& mesh = system.model().mesh;
  bool turned = false;
  geometry::dispatch(mesh.element, [&]<geometry::ElementType E>() {
    const auto middle = geometry::corners_per_element(E) == 3 ? geometry::shape_functions<E>(1.0 / 3, 1.0 / 3)
                                                              : geometry::shape_functions<E>(0, 0);
    const auto normal = [&](std::span<const Index> nodes, const Configuration& at) -> Vec3 {
      const base::Mat32 g = geometry::gather<E>(nodes, at.positions) * middle.derivative;
      return g.col(0).cross(g.col(1));
    };
    for (const assembly::FoilEquations& foil : system.foils()) {
      const geometry::Block& block = mesh.blocks[static_cast<std::size_t>(foil.block)];
      std::vector<element::PointState> states;
      for (Index e = 0; e < mesh.element_count(block) && !turned; ++e) {
        const std::span<const Index> nodes = mesh.element_nodes(block, e);
        turned = normal(nodes, before).dot(normal(nodes, after)) <= 0 && !is_folded(foil, e, after, states);
      }
    }
  });
  return turned;
}

PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const Accept& accepted, const Report& report) {
  PathResult result;
  const double part = 1.0 / options.parts;
  double length = part;
  int part_number = 1; // the part being walked
  constexpr int easy_iterations = 8;
  std::optional<Change> way;
  if (system.model().move.size() > 0 && system.evaluate(configuration, true).possible) {
    way = way_with_edges(system, newton, configuration);
  }
  while (part_number <= options.parts) {
    if (result.steps == options.max_steps) {
      system.evaluate(configuration, true);
      result.reason = fmt::format("all {} steps that are allowed ended at load factor {:.6g}", options.max_steps,
                                  result.load_factor);
      return result;
    }
    const double goal = part_number == options.parts ? 1.0 : part * part_number;
    const double left = goal - result.load_factor;
    // no sliver of a step at the end of a part
    const bool to_goal = length > 0.999 * left;
    const double next = to_goal ? goal : result.load_factor + (length > 0.6 * left ? 0.5 * left : length);
    Configuration trial = way ? moved(system, configuration, (next - result.load_factor) * *way) : configuration;
    trial.load_factor = next;
    Newton::Outcome outcome = newton.solve(trial, [&](const Iteration& i) {
      if (report) report(result.steps + 1, i);
    });
    if (outcome.converged && turned_over(system, configuration, trial)) {
      outcome.converged = false;
      outcome.reason = "an element would be turned over";
    }
    const std::string objection = outcome.converged && options.objection ? options.objection(trial) : "";
    if (!outcome.converged || !objection.empty()) {
      const double reach = trial.load_factor - result.load_factor;
      length = reach / 4;
      constexpr double near_enough = 1e-3; // to what is objected to
      if (length < (objection.empty() ? options.smallest_step : std::max(options.smallest_step, near_enough))) {
        system.evaluate(configuration, true);
        result.end = objection.empty() ? PathEnd::stuck : PathEnd::stopped;
        result.reason = objection.empty() ? fmt::format("no equilibrium found beyond load factor {:.6g}: {}",
                                                        result.load_factor, outcome.reason)
                                          : objection;
        if (const auto limit = limit_ahead(system, newton, configuration, reach)) {
          result.critical.push_back(*limit);
          result.critical.back().step = result.steps;
          result.reason = fmt::format(
              "limit point at load factor {:.8g} ({}): nothing nearby carries more; a control of "
              "volume, displacement or arc_length goes on{}{}",
              limit->load_factor, pressures_of(system, *limit), objection.empty() ? "" : "; behind it ", objection);
        }
        system.evaluate(configuration, true);
        return result;
      }
      continue;
    }
    way = way_with_edges(system, newton, trial); // before the history is accepted: what flows goes on flowing
    system.accept_history();
    configuration = std::move(trial);
    result.load_factor = configuration.load_factor;
    ++result.steps;
    if (to_goal) ++part_number;
    if (outcome.iterations <= easy_iterations) length = std::min(2 * length, part);
    const Step step{result.steps, result.load_factor, outcome.iterations, to_goal};
    if (accepted) accepted(step, configuration);
  }
  result.end = PathEnd::reached;
  return result;
}

} // namespace pneuma::solver::path
