// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/controlled_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuma::solver::path {

namespace {

constexpr double cut = 4;                // a failed step is made so much shorter
constexpr double wanted_iterations = 4;  // of a step
constexpr int most_critical_points = 20; // beyond, bifurcations are not located
constexpr double most_of_span = 0.01;    // of the first arc
constexpr double sliver = 1e-3;          // of a step: behind a limit point no step of its own

Configuration between(const Configuration& a, const Configuration& b, double part) {
  Configuration c = a;
  for (std::size_t i = 0; i < c.positions.size(); ++i) c.positions[i] += part * (b.positions[i] - a.positions[i]);
  c.pressures += part * (b.pressures - a.pressures);
  c.load_factor += part * (b.load_factor - a.load_factor);
  return c;
}

// What a step holds.
struct Goal {
  Held held;
  double from = 0, to = 0;
  bool end_of_part = false;
};

class Walk {
public:
  Walk(System& system, Newton& newton, Configuration& at, const PathControl& control,
       const ControlledPathOptions& options, const Accept& accepted, const Report& report)
      : system_(system), newton_(newton), at_(at), control_(control), options_(options), accepted_(accepted),
        report_(report) {}

  PathResult run() {
    system_.set_time_step(0);
    // e.g. strips that are welded, but not yet in balance with what the load factor of the start says
    const Newton::Outcome balance = newton_.solve(at_);
    if (!balance.converged) {
      result_.reason = fmt::format("no equilibrium at the start: {}", balance.reason);
      return std::move(result_);
    }
    if (balance.iterations > 0) system_.accept_history(); // what flowed on the way there has flowed
    system_.evaluate_accepted(at_, true);                 // a foil that yields goes on to do so
    if (nothing_drives()) {
      result_.reason = "nothing drives the path: what is stated is what the start already has";
      return std::move(result_);
    }
    begin_ = at_;
    first_span_ = span_of(at_);
    start_ = way_value();
    length_ = options_.first_step * std::abs(until() - start_);
    look();
    count_ = count_ahead_;
    if (!is_arc() && std::abs(until() - start_) <= newton_.options().tolerance * std::abs(start_)) {
      result_.held = held_quantity();
      result_.end = PathEnd::reached; // it stands there
    }
    if (is_arc()) look_at_goals();
    while (result_.end == PathEnd::stuck && result_.reason.empty()) {
      if (result_.steps >= options_.max_steps) {
        result_.reason = fmt::format("all {} steps that are allowed ended at load factor {:.6g}", options_.max_steps,
                                     at_.load_factor);
      } else if (way_) {
        walk();
      } else {
        step_by_load();
      }
    }
    system_.evaluate_accepted(at_, true);
    result_.load_factor = at_.load_factor;
    return std::move(result_);
  }

private:
  bool nothing_drives() const {
    for (const assembly::FoilEquations& foil : system_.foils()) {
      if (foil.load_gradient.size() > 0 && foil.load_gradient.cwiseAbs().maxCoeff() > 0) return false;
    }
    for (std::size_t c = 0; c < system_.model().chambers.size(); ++c) {
      if (system_.gas_line(static_cast<Index>(c), at_).drive != 0) return false;
    }
    return true;
  }

  // What ends an arc, beside the fall behind a peak, in the order in which the first one makes the parts.
  struct ArcGoal {
    double value = 0;
    Held held;
    double start = 0;
  };
  std::vector<ArcGoal> arc_goals() const {
    const auto& arc = std::get<ArcLengthPath>(control_);
    std::vector<ArcGoal> goals;
    const auto add = [&](const std::optional<double>& value, const Held& held) {
      if (value) goals.push_back({*value, held, 0});
    };
    add(arc.displacement, displacement_of(farthest(system_, arc.block, at_)));
    add(arc.volume, HeldVolume{arc.chamber});
    add(arc.pressure, HeldPressure{arc.chamber});
    add(arc.load_factor, HeldLoadFactor{});
    for (std::size_t i = 0; i < goals.size(); ++i) {
      goals[i].start = i < goal_starts_.size() ? goal_starts_[i] : value_of(goals[i].held, system_, at_);
    }
    return goals;
  }

  void look_at_goals() {
    for (const ArcGoal& goal : arc_goals()) {
      goal_starts_.push_back(goal.start);
      if (std::abs(goal.value - goal.start) <= newton_.options().tolerance * std::abs(goal.start)) {
        result_.end = PathEnd::reached; // it stands there
      }
    }
  }

  bool is_arc() const { return std::holds_alternative<ArcLengthPath>(control_); }

  // Where the way of displacement or volume control ends.
  double until() const {
    if (const auto* p = std::get_if<DisplacementPath>(&control_)) return p->until;
    if (const auto* p = std::get_if<LargestDisplacementPath>(&control_)) return p->until;
    if (const auto* p = std::get_if<VolumePath>(&control_)) return p->until;
    return 0;
  }

  Held held_quantity() const {
    if (const auto* p = std::get_if<DisplacementPath>(&control_)) return p->point;
    if (const auto* p = std::get_if<LargestDisplacementPath>(&control_)) {
      const Change* ahead = way_ ? &*way_ : nullptr;
      const Farthest now = farthest(system_, p->block, at_);
      return displacement_of(now.move.norm() > 0 ? now : farthest(system_, p->block, at_, ahead));
    }
    if (const auto* p = std::get_if<VolumePath>(&control_)) return HeldVolume{p->chamber};
    return HeldArc{at_.positions};
  }

  double way_value() const { return is_arc() ? 0.0 : value_of(held_quantity(), system_, at_); }

  // The tangent at the accepted state: where the path goes on, and how many negative eigenvalues there are.
  void look() {
    way_.reset();
    count_ahead_.reset();
    Tangent& tangent = newton_.tangent();
    if (!tangent.factorize(at_, Tangent::Repair::indefinite) || tangent.artificial_tension() > 0) return;
    std::optional<Change> way = tangent.along(at_);
    if (!way) return;
    count_ahead_ = tangent.count(at_, nullptr).load_held;
    way_ = oriented(*way);
  }

  // Along the last step; at first towards the goal, arc length towards more load if its goal is not less.
  Change oriented(const Change& way) {
    double sign = way.load_factor;
    const auto* arc = std::get_if<ArcLengthPath>(&control_);
    if (arc != nullptr && arc->load_factor && *arc->load_factor < at_.load_factor) sign = -sign;
    if (last_) {
      sign = dot_u(way, *last_);
    } else if (!is_arc()) {
      way_ = way; // tells the largest displacement's node
      sign = dot(row_of(held_quantity(), 0, system_, at_).form, way) * (until() - start_);
    }
    return sign < 0 ? -1.0 * way : way;
  }

  // One step of the control, cut until it is found.
  void walk() {
    std::optional<double> shortest;
    for (;;) {
      const std::optional<Goal> goal = next_goal();
      if (!goal) return;
      if (!shortest) shortest = options_.smallest_step * first_length();
      const Change foreseen = predicted(*goal);
      Configuration next = moved(system_, at_, foreseen);
      const Newton::Outcome outcome = solve(next, *goal);
      flow_excess_ = outcome.converged ? options_.flow.excess(system_.flow()) : 0;
      const double planned = std::abs(goal->to - goal->from);
      if (flow_excess_ > 1 && planned > *shortest) {
        system_.evaluate_accepted(at_, true);
        length_ = planned * FlowLimits::factor(flow_excess_);
        continue;
      }
      std::string reason = outcome.reason;
      bool objected = false;
      if (outcome.converged) {
        if (dot_u(difference(system_, at_, next), *way_) <= 0) {
          reason = "the path was lost";
        } else if (turned_over(system_, at_, next)) {
          reason = "an element would be turned over";
        } else if (const std::string objection = objection_to(next); !objection.empty()) {
          reason = objection;
          objected = true;
        } else if (take(*goal, next, outcome.iterations, std::sqrt(dot_u(foreseen, foreseen)))) {
          return;
        } else {
          reason = "the path bends too much, or its end is passed but not found";
        }
      }
      system_.evaluate_accepted(at_, true);
      length_ = std::abs(goal->to - goal->from) / cut;
      constexpr double near_enough = 1e-2; // to what is objected to, of the first step
      if (objected && length_ < near_enough * first_length()) {
        result_.end = PathEnd::stopped;
        result_.reason = reason;
        return;
      }
      if (length_ < *shortest) {
        if (!last_ && result_.steps == 0 && !started_by_load_) { // where all is about to change (no stress yet)
          started_by_load_ = true;
          length_ = first_length();
          way_.reset();
          return;
        }
        if (!is_arc() && turns_back_ahead(*goal)) {
          result_.reason = fmt::format("the controlled quantity turns back near {:.6g}, load factor {:.6g}: arc_length "
                                       "goes on",
                                       goal->from, at_.load_factor);
          return;
        }
        result_.reason = fmt::format("no equilibrium found beyond load factor {:.6g}: {}", at_.load_factor, reason);
        return;
      }
    }
  }

  std::string objection_to(const Configuration& at) const { return options_.objection ? options_.objection(at) : ""; }

  // Whether a short arc beyond the last accepted state leads to where the held quantity goes back.
  bool turns_back_ahead(const Goal& goal) {
    if (!last_) return false;
    const Configuration from = at_;
    const std::optional<Change> way_before = way_, last_before = last_;
    bool turns = false;
    double length = root_mean_square(system_, *last_);
    for (int tries = 0; tries < 6 && !turns; ++tries, length *= cut) {
      Configuration next = moved(system_, from, (length / root_mean_square(system_, *way_before)) * *way_before);
      if (!solve(next, {HeldArc{from.positions}, 0, length, false}).converged) break;
      last_ = difference(system_, from, next);
      at_ = next;
      look();
      if (!way_ || dot_u(*way_, *way_before) < 0.5) break;
      turns = dot(row_of(goal.held, goal.to, system_, at_).form, *way_) * (goal.to - goal.from) < 0;
    }
    at_ = from;
    way_ = way_before;
    last_ = last_before;
    system_.evaluate_accepted(at_, true);
    return turns;
  }

  double first_length() {
    if (is_arc()) return first_arc_;
    return options_.first_step * std::abs(until() - start_);
  }

  double part_end() const {
    return part_ >= options_.parts ? until() : start_ + (until() - start_) * part_ / options_.parts;
  }

  std::optional<Goal> next_goal() {
    if (is_arc()) {
      if (first_arc_ == 0) {
        const double rate = std::max(std::abs(way_->load_factor), 1e-300);
        // at a limit point the load says nothing about lengths
        first_arc_ =
            std::min(options_.first_step / rate * root_mean_square(system_, *way_), most_of_span * span_of(at_));
        if (length_ == 0) length_ = first_arc_;
      }
      return Goal{HeldArc{at_.positions}, 0, length_, goal_starts_.empty()};
    }
    Goal goal{held_quantity(), way_value(), 0, false};
    const Row row = row_of(goal.held, goal.from, system_, at_);
    const double forward = until() >= start_ ? 1 : -1;
    const double rate = dot(row.form, *way_) * forward;
    constexpr double rounding = 1e-10;
    if (rate <= rounding * std::sqrt(dot_u(row.form, row.form))) {
      result_.reason = fmt::format("the controlled quantity {} at {:.6g}, load factor {:.6g}: {}",
                                   rate < 0 ? "turns back" : "does not move with the load", goal.from, at_.load_factor,
                                   rate < 0 ? "arc_length goes on" : "control another one");
      return std::nullopt;
    }
    if (!last_ && at_.load_factor == 0 && way_->load_factor < 0) {
      result_.reason = fmt::format(
          "the load leads from {:.6g} away from the goal, {:.6g}: turn the sign of the load, or set another goal",
          start_, until());
      return std::nullopt;
    }
    // to the end of a part at most, without a sliver before it
    const double end = part_end();
    const double left = std::abs(end - goal.from);
    const bool to_end = length_ > 0.999 * left;
    goal.to = to_end ? end : goal.from + forward * (length_ > 0.6 * left ? 0.5 * left : length_);
    goal.end_of_part = to_end;
    return goal;
  }

  Change predicted(const Goal& goal) const {
    if (is_arc()) return (goal.to / root_mean_square(system_, *way_)) * *way_;
    const Row row = row_of(goal.held, goal.to, system_, at_);
    return (-row.residual / dot(row.form, *way_)) * *way_;
  }

  Newton::Outcome solve(Configuration& next, const Goal& goal) {
    return newton_.solve(next, goal.held, goal.to, options_.max_iterations, [&](const Iteration& i) {
      if (report_) report_(result_.steps + 1, i);
    });
  }

  // Without a tangent (flat, slack) a step of load control, short enough not to pass the first goal.
  void step_by_load() {
    double step = options_.first_step * (last_ && last_->load_factor < 0 ? -1 : 1);
    bool away = false;
    bool turned = false;
    const double standing = way_value();
    for (int tries = 0; tries < 16; ++tries, step /= cut) {
      Configuration next = at_;
      next.load_factor += step;
      const Newton::Outcome outcome = newton_.solve(next, [&](const Iteration& i) {
        if (report_) report_(result_.steps + 1, i);
      });
      turned = outcome.converged && turned_over(system_, at_, next);
      if (!outcome.converged || turned || options_.flow.excess(system_.flow()) > 1 || !objection_to(next).empty()) {
        continue;
      }
      if (!is_arc()) {
        const double now = value_of(held_quantity_at(next), system_, next);
        const bool forward = (now - start_) * (until() - start_) > 0;
        away = away || !forward;
        const bool beyond = (now - part_end()) * (until() - start_) > 0;
        if (!forward || beyond || std::abs(now - standing) > std::max(length_, options_.smallest_step * first_length()))
          continue;
      }
      const Configuration from = at_;
      const std::optional<Change> last_before = last_;
      last_ = difference(system_, from, next);
      at_ = std::move(next);
      look();
      const End end = end_between(from);
      if (end == End::missed) {
        at_ = from;
        last_ = last_before;
        way_.reset();
        continue;
      }
      count_ = count_ahead_;
      rate_.reset();
      if (is_arc()) length_ = first_arc_ = root_mean_square(system_, *last_);
      if (end == End::found) {
        finish(outcome.iterations);
      } else {
        accept(outcome.iterations, end == End::part || (is_arc() && goal_starts_.empty()));
      }
      return;
    }
    system_.evaluate_accepted(at_, true);
    result_.reason = fmt::format("no equilibrium found beyond load factor {:.6g}: {}", at_.load_factor,
                                 away     ? "the load moves the controlled quantity away from its goal"
                                 : turned ? "an element would be turned over"
                                          : "the cushion has no stiffness, and no small part of the load gives it one");
  }

  Held held_quantity_at(const Configuration& next) const {
    if (const auto* p = std::get_if<LargestDisplacementPath>(&control_)) {
      return displacement_of(farthest(system_, p->block, next));
    }
    return held_quantity();
  }

  // Whether the cubic through load and rate at both ends of a step turns twice between them: too long a step, which
  // would pass two limit points unseen.
  static bool turns_twice(double change, double length, double rate, double rate_next) {
    if (rate * rate_next <= 0) return false;
    constexpr int samples = 16;
    for (int i = 1; i < samples; ++i) {
      const double t = static_cast<double>(i) / samples;
      const double slope =
          rate * (1 - 4 * t + 3 * t * t) + rate_next * (3 * t * t - 2 * t) + 6 * change / length * t * (1 - t);
      if (slope * rate < 0) return true;
    }
    return false;
  }

  // Whether a step is much longer than the tangents at both its ends foresee: another branch has the held quantity too,
  // behind a place where it turns back.
  bool jumped(const Goal& goal, double length, double foreseen) const {
    if (is_arc() || !way_) return false;
    constexpr double much = 1.5;
    const double rate = std::abs(dot(row_of(goal.held, goal.to, system_, at_).form, *way_));
    return length > much * std::max(foreseen, std::abs(goal.to - goal.from) / rate);
  }

  // A step was found: first what lies between, then the step itself. False: it is too long.
  bool take(const Goal& goal, const Configuration& next, int iterations, double foreseen) {
    const Configuration from = at_;
    const double rate = rate_.value_or(way_->load_factor);
    std::optional<int> count = count_;
    const std::optional<Change> way_before = way_, last_before = last_;
    last_ = difference(system_, from, next);
    at_ = next;
    look();
    const double length = std::sqrt(dot_u(*last_, *last_));
    const auto too_long = [&] {
      at_ = from;
      way_ = way_before;
      last_ = last_before;
      return false;
    };
    if (jumped(goal, length, foreseen)) return too_long();
    const bool too_curved = way_ && dot_u(*way_, *way_before) < 0.5;
    if (length_ > options_.smallest_step * first_length() * cut * cut && way_ &&
        (too_curved || turns_twice(last_->load_factor, length, rate, way_->load_factor))) {
      return too_long();
    }
    if (way_ && rate * way_->load_factor < 0) {
      const double beyond = way_->load_factor;
      const std::optional<int> count_beyond = count_ahead_;
      if (locate_limit(goal, from, next, rate, beyond)) {
        if (count && count_beyond) *count += *count_beyond > *count ? 1 : -1;
        const CriticalPoint limit{CriticalPoint::Kind::limit, at_.load_factor, at_.pressures, result_.steps + 1};
        const Change left = difference(system_, at_, next);
        const End end = end_between(from);
        if (end == End::missed) return too_long();
        if (end != End::none) {
          rate_ = last_->load_factor < 0 ? -1.0 : 1.0; // before the limit point
          count_ = count_ahead_;
          if (end == End::found) {
            finish(iterations);
          } else {
            accept(iterations, true);
          }
          return true;
        }
        result_.critical.push_back(limit);
        if (dot_u(left, left) > sliver * sliver * length * length) {
          rate_ = beyond;
          count_ = count;
          accept(0, false);
          return true;
        }
      }
      stand_at(from, next);
    }
    const End reached = end_between(from);
    if (reached == End::missed) return too_long();
    if (way_ && count && count_ahead_ && *count != *count_ahead_ && !options_.only_looking) {
      const Configuration end = at_;
      Goal way = goal;
      if (is_arc()) way.to = value_of(goal.held, system_, at_);
      locate_bifurcations(way, from, end, *count, *count_ahead_);
      stand_at(from, end);
    }
    rate_ = way_ ? std::optional<double>(way_->load_factor) : std::nullopt;
    count_ = count_ahead_;
    if (reached == End::found) {
      finish(iterations);
      return true;
    }
    if (is_arc() && lost(from)) return true;
    grow(goal, iterations);
    accept(iterations, goal.end_of_part || reached == End::part);
    if (!is_arc() && goal.end_of_part && ++part_ > options_.parts) result_.end = PathEnd::reached;
    return true;
  }

  // An arc that leads nowhere: back to where it began, or far beyond any cushion.
  bool lost(const Configuration& from) {
    constexpr double far = 1e3;
    const Change way = difference(system_, begin_, at_);
    const double moved_by = root_mean_square(system_, way);
    farthest_ = std::max(farthest_, moved_by);
    if (moved_by > far * first_span_) {
      result_.reason =
          fmt::format("the path runs away: at load factor {:.6g} the cushion is {:.3g} m large and no goal is "
                      "reached",
                      at_.load_factor, span_of(at_));
    } else if (from.load_factor * at_.load_factor < 0) {
      const double part = from.load_factor / (from.load_factor - at_.load_factor);
      constexpr double near = 0.02;
      if (root_mean_square(system_, difference(system_, begin_, between(from, at_, part))) < near * farthest_) {
        result_.reason = "the path came back to where it began: it turned at a bifurcation, and no goal was reached";
      }
    }
    if (result_.reason.empty()) return false;
    at_ = from;
    return true;
  }

  void stand_at(const Configuration& from, const Configuration& at) {
    at_ = at;
    system_.evaluate(at_, true);
    last_ = difference(system_, from, at_);
    look();
  }

  void finish(int iterations) {
    accept(iterations, true);
    result_.end = PathEnd::reached;
  }

  void grow(const Goal& goal, int iterations) {
    const double factor = std::clamp(std::sqrt(wanted_iterations / std::max(iterations, 1)), 0.5, 2.0);
    const double planned = is_arc() ? goal.to : std::max(std::abs(goal.to - goal.from), length_);
    length_ = std::min(factor, FlowLimits::factor(flow_excess_)) * planned;
  }

  void accept(int iterations, bool end_of_part) {
    system_.accept_history(); // of the last evaluation, which was here
    ++result_.steps;
    // an arc from where it is has no direction: the last one has
    result_.held = is_arc() ? Held(HeldArc{moved(system_, at_, -1.0 * *last_).positions}) : held_quantity();
    const Step step{result_.steps, at_.load_factor, iterations, end_of_part};
    if (accepted_) accepted_(step, at_);
  }

  // The state a part of the way from `from` to `next`.
  std::optional<Configuration> state_between(const Goal& goal, const Configuration& from, const Configuration& next,
                                             double part) {
    Goal inner = goal;
    inner.to = goal.from + part * (goal.to - goal.from);
    Configuration c = between(from, next, part);
    if (!solve(c, inner).converged) return std::nullopt;
    return c;
  }

  // The state where the load has its extreme: a root of its rate along the path (regula falsi, Illinois rule).
  bool locate_limit(const Goal& goal, const Configuration& from, const Configuration& next, double rate_from,
                    double rate_next) {
    double low = 0, f_low = rate_from, high = 1, f_high = rate_next;
    double extreme = from.load_factor;
    for (int i = 0; i < 30; ++i) {
      const double part = low + (high - low) * std::clamp(f_low / (f_low - f_high), 0.02, 0.98);
      std::optional<Configuration> c = state_between(goal, from, next, part);
      if (!c) return false;
      at_ = std::move(*c);
      last_ = difference(system_, from, at_);
      look();
      if (!way_) return false;
      const double rate = way_->load_factor;
      const double change = std::abs(at_.load_factor - extreme);
      extreme = at_.load_factor;
      // the load's error is of second order in the place's
      if (rate == 0 || (i > 1 && change <= 1e-10 * std::abs(extreme))) break;
      if (rate * f_low > 0) {
        low = part;
        f_low = rate;
        f_high /= 2;
      } else {
        high = part;
        f_high = rate;
        f_low /= 2;
      }
    }
    return true;
  }

  // The places where the count of negative eigenvalues changes, each by bisection to 1e-4 of the step.
  void locate_bifurcations(const Goal& goal, const Configuration& from, const Configuration& next, int count,
                           int beyond) {
    if (std::abs(beyond - count) > 3) return; // wrinkles: as many as the mesh has
    double start = 0;
    while (count != beyond && static_cast<int>(result_.critical.size()) < most_critical_points) {
      double low = start, high = 1;
      int count_high = beyond;
      Configuration at = next;
      for (int i = 0; i < 14; ++i) {
        const double part = 0.5 * (low + high);
        std::optional<Configuration> c = state_between(goal, from, next, part);
        if (!c) return;
        at_ = std::move(*c);
        last_ = difference(system_, from, at_);
        look();
        if (count_ahead_ && *count_ahead_ == count) {
          low = part;
          continue;
        }
        high = part; // or singular: this is the place
        at = at_;
        if (count_ahead_) count_high = *count_ahead_;
      }
      result_.critical.push_back({CriticalPoint::Kind::bifurcation, at.load_factor, at.pressures, result_.steps + 1});
      count = count_high;
      start = high;
    }
  }

  enum class End : std::uint8_t { none, part, found, missed };

  // Arc length: whether a goal, or the end of a part on the way to the first one, lies between `from` and the new
  // state; then the nearest becomes the new state. Missed: it is passed, but not found from here.
  End end_between(const Configuration& from) {
    const auto* arc = std::get_if<ArcLengthPath>(&control_);
    if (arc == nullptr) return End::none;
    std::vector<ArcGoal> goals = arc_goals();
    const std::size_t ends = goals.size();
    if (ends > 0 && part_ < options_.parts) {
      const ArcGoal& first = goals.front();
      goals.push_back({first.start + (first.value - first.start) * part_ / options_.parts, first.held, first.start});
    }
    if (arc->after_peak) {
      std::optional<double> fallen;
      for (const CriticalPoint& point : result_.critical) {
        if (point.kind == CriticalPoint::Kind::limit && (!fallen || std::abs(point.load_factor) > std::abs(*fallen))) {
          fallen = point.load_factor;
        }
      }
      if (fallen) goals.insert(goals.begin(), {*fallen * *arc->after_peak, HeldLoadFactor{}, 0});
    }
    double nearest = 2; // part of the step
    const ArcGoal* which = nullptr;
    Configuration before = from;
    for (const ArcGoal& goal : goals) {
      const bool needs_volume = std::holds_alternative<HeldVolume>(goal.held);
      if (needs_volume) system_.evaluate(before, false);
      const double a = value_of(goal.held, system_, before);
      if (needs_volume) system_.evaluate(at_, true);
      const double b = value_of(goal.held, system_, at_);
      if (a == b || a == goal.value || (a - goal.value) * (b - goal.value) > 0) continue;
      const double part = (goal.value - a) / (b - a);
      if (part < nearest) {
        nearest = part;
        which = &goal;
      }
    }
    if (which == nullptr) return End::none;
    Configuration end = between(from, at_, nearest);
    const Change step = difference(system_, from, at_);
    const bool found = newton_.solve(end, which->held, which->value, options_.max_iterations, {}).converged;
    const double part = dot_u(difference(system_, from, end), step) / dot_u(step, step);
    if (!found || part < -sliver || part > 1 + sliver) return End::missed; // or another branch has it too
    stand_at(from, end);
    const bool is_part = part_ < options_.parts && ends > 0 && which == &goals.back();
    if (is_part) ++part_;
    return is_part ? End::part : End::found;
  }

  System& system_;
  Newton& newton_;
  Configuration& at_; // the last accepted state, while a step is looked into also one that is not
  const PathControl& control_;
  const ControlledPathOptions& options_;
  const Accept& accepted_;
  const Report& report_;
  PathResult result_;
  double start_ = 0, length_ = 0, first_arc_ = 0;
  int part_ = 1;
  bool started_by_load_ = false;
  double flow_excess_ = 0;                 // of the last step that was found
  Configuration begin_;                    // in equilibrium
  double first_span_ = 0;                  // m, of the cushion there
  double farthest_ = 0;                    // root mean square displacement so far, m
  std::vector<double> goal_starts_;        // of an arc's goals
  std::optional<Change> way_;              // unit tangent of the path, along it
  std::optional<Change> last_;             // the last step
  std::optional<double> rate_;             // of the load along the path behind the last accepted state
  std::optional<int> count_, count_ahead_; // negative eigenvalues, load held
};

} // namespace

PathResult follow_control(System& system, Newton& newton, Configuration& configuration, const PathControl& control,
                          const ControlledPathOptions& options, const Accept& accepted, const Report& report) {
  return Walk(system, newton, configuration, control, options, accepted, report).run();
}

} // namespace pneuma::solver::path
