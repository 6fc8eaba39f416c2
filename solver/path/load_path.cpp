// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/load_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "geometry/volume.h"
#include "solver/path/controlled_path.h"

namespace pneuma::solver::path {

namespace {

// A limit point within `reach` of the load beyond a good state, where load control got stuck.
std::optional<CriticalPoint> limit_ahead(System& system, Newton& newton, const Configuration& from, double reach) {
  ControlledPathOptions options;
  options.first_step = std::abs(reach);
  options.max_steps = 12;
  options.smallest_step = 1e-2; // a look, not a search
  options.only_looking = true;
  ArcLengthPath arc;
  arc.load_factor = from.load_factor + 2 * reach;
  arc.after_peak = 1 - 1e-9;
  Configuration at = from;
  const System::Memory memory = system.memory();
  const PathResult seen = follow_control(system, newton, at, arc, options, {});
  system.restore(memory);
  for (const CriticalPoint& point : seen.critical) {
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
bool is_folded(const System& system, Index foil, Index element, const Configuration& at,
               std::vector<element::PointState>& states) {
  const element::Membrane& membrane = system.foils()[static_cast<std::size_t>(foil)].membrane;
  if (!material::has_tension_field(membrane.law)) return false;
  if (states.empty()) states = element::point_states(membrane, at.positions, system.history(foil));
  const auto points = static_cast<std::ptrdiff_t>(membrane.reference.points);
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

double FlowLimits::excess(const System::Flow& flow) const {
  return std::max(flow.growth / growth, std::sqrt(flow.error / error)); // the error goes with the step's square
}

double FlowLimits::factor(double excess) {
  constexpr double safety = 0.8;
  return std::max(0.1, safety / std::max(excess, 1e-300));
}

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
    for (std::size_t f = 0; f < system.foils().size(); ++f) {
      const geometry::Block& block = mesh.blocks[static_cast<std::size_t>(system.foils()[f].block)];
      std::vector<element::PointState> states;
      for (Index e = 0; e < mesh.element_count(block) && !turned; ++e) {
        const std::span<const Index> nodes = mesh.element_nodes(block, e);
        turned = normal(nodes, before).dot(normal(nodes, after)) <= 0 &&
                 !is_folded(system, static_cast<Index>(f), e, after, states);
      }
    }
  });
  return turned;
}

PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const Accept& accepted, const Report& report) {
  PathResult result;
  const std::vector<Moment>& schedule = options.schedule;
  if (schedule.size() < 2) throw std::invalid_argument("a schedule has a beginning and an end");
  configuration.load_factor = result.load_factor = schedule.front().load_factor;
  const double part = 1.0 / options.parts;
  constexpr int easy_iterations = 8;
  std::optional<Change> way;
  if (system.model().move.size() > 0 && system.evaluate_accepted(configuration, true).possible) {
    way = way_with_edges(system, newton, configuration);
  }
  double length = part; // of a stretch
  int part_number = 1;  // the part being walked
  double walked = 0;    // of the stretch
  const auto stuck = [&](std::string reason) {
    system.evaluate_accepted(configuration, true);
    result.reason = std::move(reason);
    return result;
  };
  std::size_t stretch = 0;
  while (stretch + 1 < schedule.size()) {
    const Moment& begin = schedule[stretch];
    const Moment& end = schedule[stretch + 1];
    if (result.steps == options.max_steps) {
      return stuck(fmt::format("all {} steps that are allowed ended at load factor {:.6g}", options.max_steps,
                               result.load_factor));
    }
    const double goal = part_number == options.parts ? 1.0 : part * part_number;
    const double left = goal - walked;
    // no sliver of a step at the end of a part
    const bool to_goal = length > 0.999 * left;
    const double next = to_goal ? goal : walked + (length > 0.6 * left ? 0.5 * left : length);
    const double load_factor = std::lerp(begin.load_factor, end.load_factor, next);
    Configuration trial = way ? moved(system, configuration, (load_factor - result.load_factor) * *way) : configuration;
    trial.load_factor = load_factor;
    system.set_time_step((next - walked) * (end.time - begin.time));
    Newton::Outcome outcome = newton.solve(trial, [&](const Iteration& i) {
      if (report) report(result.steps + 1, i);
    });
    if (outcome.converged && turned_over(system, configuration, trial)) {
      outcome.converged = false;
      outcome.reason = "an element would be turned over";
    }
    const double excess = outcome.converged ? options.flow.excess(system.flow()) : 0;
    if (excess > 1 && next - walked > options.smallest_step) {
      length = (next - walked) * FlowLimits::factor(excess);
      continue;
    }
    const std::string objection = outcome.converged && options.objection ? options.objection(trial) : "";
    if (!outcome.converged || !objection.empty()) {
      const double reach = trial.load_factor - result.load_factor;
      length = (next - walked) / 4;
      constexpr double near_enough = 1e-3; // to what is objected to
      if (length < (objection.empty() ? options.smallest_step : std::max(options.smallest_step, near_enough))) {
        result.end = objection.empty() ? PathEnd::stuck : PathEnd::stopped;
        const auto limit = reach != 0 ? limit_ahead(system, newton, configuration, reach) : std::nullopt;
        if (limit) {
          result.critical.push_back(*limit);
          result.critical.back().step = result.steps;
          return stuck(fmt::format("limit point at load factor {:.8g} ({}): nothing nearby carries more; a control of "
                                   "volume, displacement or arc_length goes on{}{}",
                                   limit->load_factor, pressures_of(system, *limit),
                                   objection.empty() ? "" : "; behind it ", objection));
        }
        return stuck(!objection.empty() ? objection
                                        : fmt::format("no equilibrium found beyond load factor {:.6g}: {}",
                                                      result.load_factor, outcome.reason));
      }
      continue;
    }
    way = way_with_edges(system, newton, trial); // before the history is accepted: what flows goes on flowing
    system.accept_history();
    configuration = std::move(trial);
    result.load_factor = configuration.load_factor;
    const double step_length = next - walked;
    walked = next;
    ++result.steps;
    if (outcome.iterations <= easy_iterations) {
      const double factor = std::min(2.0, FlowLimits::factor(excess));
      length = std::min(factor * (factor < 2 ? step_length : length), part);
    }
    const Step step{result.steps, result.load_factor, outcome.iterations, to_goal,
                    std::lerp(begin.time, end.time, walked)};
    if (to_goal && ++part_number > options.parts) {
      ++stretch;
      part_number = 1;
      walked = 0;
    }
    if (accepted) accepted(step, configuration);
  }
  result.end = PathEnd::reached;
  return result;
}

} // namespace pneuma::solver::path
