// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/load_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

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

namespace {

// Load control from one accepted state to the next.
class LoadWalk {
public:
  LoadWalk(System& system, Newton& newton, Configuration& at, const LoadPathOptions& options, const Accept& accepted,
           const Report& report)
      : system_(system), newton_(newton), at_(at), options_(options), accepted_(accepted), report_(report),
        length_(1.0 / options.parts) {}

  PathResult run() {
    const std::vector<Moment>& schedule = options_.schedule;
    if (schedule.size() < 2) throw std::invalid_argument("a schedule has a beginning and an end");
    at_.load_factor = result_.load_factor = schedule.front().load_factor;
    const assembly::Balance balance = system_.evaluate_accepted(at_, true);
    const bool in_balance = newton_.stands_at(balance);
    if (in_balance || (balance.possible && moves_edges())) look_ = look_at(newton_, at_);
    is_looked_at_ = in_balance; // else it is no tangent of the path, but serves a first step
    while (stretch_ + 1 < schedule.size() && result_.reason.empty()) step();
    if (result_.reason.empty()) result_.end = PathEnd::reached;
    return std::move(result_);
  }

private:
  struct Plan {
    double next = 0; // of the stretch
    bool to_goal = false;
    double load_factor = 0;
  };
  // A step that was found.
  struct Tried {
    Configuration at;
    Look look;
    Plan plan;
    int iterations = 0;
    double excess = 0;
  };
  // Why a step that was tried must be shorter.
  struct Fault {
    std::string reason;
    bool is_objection = false;
    bool is_hidden = false; // something between its ends
  };

  bool moves_edges() const { return system_.model().move.size() > 0; }

  Plan planned() const {
    const double goal = part_ == options_.parts ? 1.0 : 1.0 / options_.parts * part_;
    const double left = goal - walked_;
    Plan plan;
    plan.to_goal = length_ > 0.999 * left; // no sliver of a step at the end of a part
    plan.next = plan.to_goal ? goal : walked_ + (length_ > 0.6 * left ? 0.5 * left : length_);
    plan.load_factor =
        std::lerp(options_.schedule[stretch_].load_factor, options_.schedule[stretch_ + 1].load_factor, plan.next);
    return plan;
  }

  void step() {
    if (result_.steps == options_.max_steps) {
      return end_at(PathEnd::stuck, fmt::format("all {} steps that are allowed ended at load factor {:.6g}",
                                                options_.max_steps, result_.load_factor));
    }
    const Plan plan = planned();
    const double change = plan.load_factor - result_.load_factor, part = plan.next - walked_;
    Configuration trial = at_;
    if (moves_edges() && look_.way) trial = moved(system_, at_, change * *look_.way);
    trial.load_factor = plan.load_factor;
    system_.set_time_step(part * (options_.schedule[stretch_ + 1].time - options_.schedule[stretch_].time));
    const Newton::Outcome outcome = newton_.solve(trial, [&](const Iteration& i) {
      if (report_) report_(result_.steps + 1, i);
    });
    Fault fault{outcome.converged ? "" : outcome.reason};
    if (outcome.converged && turned_over(system_, at_, trial)) fault.reason = "an element would be turned over";
    const double excess = fault.reason.empty() ? options_.flow.excess(system_.flow()) : 0;
    if (excess > 1 && part > options_.smallest_step) {
      length_ = part * FlowLimits::factor(excess);
      return;
    }
    if (fault.reason.empty() && options_.objection) {
      fault.reason = options_.objection(trial);
      fault.is_objection = !fault.reason.empty();
    }
    Look end;
    if (fault.reason.empty()) fault = hidden(trial, end);
    if (fault.is_hidden) beyond_ = Tried{trial, end, plan, outcome.iterations, excess};
    if (!fault.reason.empty()) return shorten(fault, part, change);
    accept({std::move(trial), std::move(end), plan, outcome.iterations, excess});
  }

  // What the way to a state that was found hides; `end`: the tangent there.
  Fault hidden(const Configuration& trial, Look& end) {
    const bool flows = system_.flows_with_time();               // then the load alone does not tell the way
    if (!flows || moves_edges()) end = look_at(newton_, trial); // before the history is accepted: what flows goes on
    if (!is_looked_at_ || flows) return {};
    bool objected = false;
    const Objection objection = [&](const Configuration& at) {
      const std::string reason = options_.objection ? options_.objection(at) : "";
      objected = objected || !reason.empty();
      return reason;
    };
    const std::string reason = hidden_between(system_, newton_, {at_, trial, look_, end}, objection);
    return {reason, objected, !reason.empty() && !objected};
  }

  void shorten(const Fault& fault, double part, double change) {
    length_ = part / 4;
    constexpr double near_enough = 1e-3; // to what is objected to, or hidden
    const double least = fault.is_objection ? near_enough : fault.is_hidden ? near_enough / 4 : 0;
    if (length_ >= std::max(options_.smallest_step, least)) return;
    if (options_.snaps && !fault.is_objection && beyond_) return snap();
    const bool looks = change != 0 && !options_.snaps;
    const auto limit = looks ? limit_ahead(system_, newton_, at_, change) : std::nullopt;
    const PathEnd end = fault.is_objection ? PathEnd::stopped : PathEnd::stuck;
    if (limit) {
      result_.critical.push_back(*limit);
      result_.critical.back().step = result_.steps;
      return end_at(end,
                    fmt::format("limit point at load factor {:.8g} ({}): nothing nearby carries more; a control of "
                                "volume, displacement or arc_length goes on{}{}",
                                limit->load_factor, pressures_of(system_, *limit),
                                fault.is_objection ? "; behind it " : "", fault.is_objection ? fault.reason : ""));
    }
    if (fault.is_objection) return end_at(end, fault.reason);
    if (fault.is_hidden) {
      return end_at(end, fmt::format("the cushion loses its shape between load factor {:.6g} and {:.6g}: {}",
                                     result_.load_factor, result_.load_factor + change, fault.reason));
    }
    end_at(end, fmt::format("no equilibrium found beyond load factor {:.6g}: {}", result_.load_factor, fault.reason));
  }

  // Takes the nearest state behind a jump.
  void snap() {
    Tried beyond = *std::exchange(beyond_, std::nullopt);
    system_.evaluate(beyond.at, true);
    result_.snaps.push_back({result_.load_factor, beyond.at.load_factor});
    length_ = beyond.plan.next - walked_;
    accept(std::move(beyond));
  }

  void accept(Tried step_found) {
    constexpr int easy_iterations = 8;
    auto& [found, look, plan, iterations, excess] = step_found;
    system_.accept_history();
    at_ = std::move(found);
    look_ = std::move(look);
    beyond_.reset();
    is_looked_at_ = true;
    result_.load_factor = at_.load_factor;
    const double step_length = plan.next - walked_;
    walked_ = plan.next;
    ++result_.steps;
    if (iterations <= easy_iterations) {
      const double factor = std::min(2.0, FlowLimits::factor(excess));
      length_ = std::min(factor * (factor < 2 ? step_length : length_), 1.0 / options_.parts);
    }
    const Step step{result_.steps, result_.load_factor, iterations, plan.to_goal,
                    std::lerp(options_.schedule[stretch_].time, options_.schedule[stretch_ + 1].time, walked_)};
    if (plan.to_goal && ++part_ > options_.parts) {
      ++stretch_;
      part_ = 1;
      walked_ = 0;
    }
    if (accepted_) accepted_(step, at_);
  }

  void end_at(PathEnd end, std::string reason) {
    system_.evaluate_accepted(at_, true);
    result_.end = end;
    result_.reason = std::move(reason);
  }

  System& system_;
  Newton& newton_;
  Configuration& at_; // the last accepted state
  const LoadPathOptions& options_;
  const Accept& accepted_;
  const Report& report_;
  PathResult result_;
  std::size_t stretch_ = 0;     // of the schedule
  double length_;               // of the next step, of a stretch
  int part_ = 1;                // the one being walked
  double walked_ = 0;           // of the stretch
  Look look_;                   // at the last accepted state
  std::optional<Tried> beyond_; // the nearest that was found behind a jump
  bool is_looked_at_ = false;   // it is in balance, so that its tangent is that of the path
};

} // namespace

PathResult follow_load(System& system, Newton& newton, Configuration& configuration, const LoadPathOptions& options,
                       const Accept& accepted, const Report& report) {
  return LoadWalk(system, newton, configuration, options, accepted, report).run();
}

} // namespace pneuma::solver::path
