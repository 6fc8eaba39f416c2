// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <csignal>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/base/place.h"
#include "geometry/gap.h"
#include "geometry/surface.h"
#include "pipeline/state/state_file.h"
#include "solver/linear/blas.h"
#include "solver/recovery/reactions.h"
#include "stages/common/path_control.h"
#include "stages/common/summary.h"

namespace pneuma::stages::common {

namespace {

namespace assembly = solver::assembly;
namespace path = solver::path;

constexpr double standard_gravity = 9.80665; // m/s2

volatile std::sig_atomic_t interrupted = 0;
extern "C" void note_interrupt(int number) {
  interrupted = 1;
  std::signal(number, SIG_DFL); // a second one ends at once
}

void stop_if_interrupted() {
  if (interrupted != 0) {
    throw base::Error(base::ExitCode::interrupted, "interrupted: the steps written so far are complete");
  }
}

// Neighbouring blocks that could touch, and how near they are.
class ContactCheck {
public:
  explicit ContactCheck(const geometry::Mesh& mesh) {
    smallest_allowed_ = -1e-6 * geometry::span_of(mesh.nodes);
    for (std::size_t b = 0; b + 1 < mesh.blocks.size(); ++b) {
      names_.emplace_back(mesh.blocks[b].name, mesh.blocks[b + 1].name);
      searches_.emplace_back(mesh, mesh.blocks[b], mesh.blocks[b + 1]);
    }
  }
  struct Found {
    std::string upper, lower;
    geometry::Gap gap;
  };
  std::optional<Found> find(std::span<const Vec3> positions) {
    for (std::size_t i = 0; i < searches_.size(); ++i) {
      const geometry::Gap gap = searches_[i].smallest(positions);
      if (gap.value < smallest_allowed_) return Found{names_[i].first, names_[i].second, gap};
    }
    return std::nullopt;
  }

private:
  double smallest_allowed_ = 0;
  std::vector<std::pair<std::string, std::string>> names_;
  std::vector<geometry::GapSearch> searches_;
};

pipeline::state::GasLaw law_kind(const solver::chamber::Gas& gas) {
  return static_cast<pipeline::state::GasLaw>(gas.index());
}

const char* law_name(pipeline::state::GasLaw law) {
  constexpr const char* names[] = {"regulated", "closed", "volume"};
  return names[static_cast<std::size_t>(law)];
}

// The stage's whole work: system, path and what is written of it.
class Run {
public:
  Run(const Start& start, Drive drive)
      : start_(start), drive_(std::move(drive)), begin_(drive_.model.mesh.nodes),
        system_(drive_.model, start.arguments.threads), newton_(system_, newton_options(drive_.path)),
        history_(*start.outputs), series_(*start.outputs), contact_check_(drive_.model.mesh) {}

  // Throws Error with exit code 5, after everything is written, where the path did not reach its end.
  void run() {
    interrupted = 0;
    std::signal(SIGINT, note_interrupt);
    std::signal(SIGTERM, note_interrupt);
    if (std::signal(SIGHUP, note_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN); // nohup
    assembly::Configuration c{begin_, VecX::Zero(static_cast<Eigen::Index>(drive_.state.chambers.size())), 0};
    for (std::size_t i = 0; i < drive_.state.chambers.size(); ++i) {
      c.pressures[static_cast<Eigen::Index>(i)] = drive_.state.chambers[i].gauge_pressure;
    }
    const path::PathResult result = follow(c);
    progress_.done();
    finish(c, result);
  }

private:
  static path::NewtonOptions newton_options(const pipeline::workflow::PathSettings& path) {
    path::NewtonOptions options;
    const pipeline::workflow::PathOptions& given = path.options;
    if (given.tolerance) options.tolerance = *given.tolerance;
    if (given.max_iterations) options.max_iterations = *given.max_iterations;
    return options;
  }

  // What to say of foils that pass through each other; empty: they do not.
  std::string contact_at(const assembly::Configuration& c) {
    const auto found = contact_check_.find(c.positions);
    if (!found) return "";
    return fmt::format("contact at load factor {:.4g} at {} m between `{}` and `{}`", c.load_factor,
                       base::place_text(found->gap.at), found->upper, found->lower);
  }

  path::PathResult follow(assembly::Configuration& c) {
    const path::Objection objection = drive_.path.contact_stops
                                          ? [this](const assembly::Configuration& at) { return contact_at(at); }
                                          : path::Objection();
    const path::Accept accepted = [&](const path::Step& step, const assembly::Configuration& at) {
      return accept(step, at);
    };
    const path::Report report = [&](int step, const path::Iteration& i) {
      progress_.show(fmt::format("step {}, load factor {:.4g}, iteration {}: residual {:.2e}{}", step, i.load_factor,
                                 i.number + 1, i.residual,
                                 i.shift > 0 ? fmt::format(", artificial tension {:.2g} N/m", i.shift) : ""));
      artificial_tension_ = std::max(artificial_tension_, i.shift);
      stop_if_interrupted();
    };
    const int parts = steps_of(drive_.path.control).value_or(1);
    const pipeline::workflow::PathOptions& given = drive_.path.options;
    if (const std::optional<path::PathControl> control = path_control(start_, drive_.path.control)) {
      path::ControlledPathOptions options;
      options.parts = parts;
      options.objection = objection;
      if (given.max_steps) options.max_steps = *given.max_steps;
      options.flow.growth = given.plastic_step;
      if (given.max_iterations) options.max_iterations = *given.max_iterations;
      return path::follow_control(system_, newton_, c, *control, options, accepted, report);
    }
    path::LoadPathOptions options;
    if (!drive_.path.history.empty()) options.schedule = {{0, 0}};
    for (const pipeline::workflow::Moment& moment : drive_.path.history) {
      options.schedule.push_back({moment.time, moment.factor});
    }
    options.parts = parts;
    options.objection = objection;
    if (given.max_steps) options.max_steps = *given.max_steps;
    options.flow.growth = given.plastic_step;
    options.snaps = drive_.path.snaps;
    return path::follow_load(system_, newton_, c, options, accepted, report);
  }

  void accept(const path::Step& step, const assembly::Configuration& c) {
    if (std::abs(step.load_factor) > std::abs(largest_load_)) {
      largest_load_ = step.load_factor;
      largest_load_step_ = step.number;
    }
    progress_.done();
    std::string line =
        fmt::format("step {}: load factor {:.6g}, {} iterations", step.number, step.load_factor, step.iterations);
    for (std::size_t i = 0; i < drive_.state.chambers.size(); ++i) {
      line += fmt::format(", {}: {:.6g} Pa, {:.6g} m3", drive_.state.chambers[i].name,
                          c.pressures[static_cast<Eigen::Index>(i)], system_.chamber_volume(static_cast<Index>(i)));
    }
    base::say(line);
    if (!drive_.path.contact_stops && contact_.empty()) {
      contact_ = contact_at(c);
      if (!contact_.empty()) base::warn(contact_ + " (goes on: contact is ignored)");
    }
    const std::vector<FoilResults> foils = results(c);
    write_history(step, c, foils);
    if (steps_of(drive_.path.control) && step.end_of_part) {
      const Clock clock;
      State state = make_state(c, foils);
      state.provenance.converged = true;
      state.provenance.load_factor = step.load_factor;
      state.provenance.verdict = fmt::format("step {} of the path", step.number);
      series_.write(state, step.load_factor);
      io_ += clock.seconds();
    }
    stop_if_interrupted();
  }

  std::vector<FoilResults> results(const assembly::Configuration& c) const {
    std::vector<FoilResults> all;
    for (std::size_t i = 0; i < system_.foils().size(); ++i) {
      const assembly::FoilEquations& foil = system_.foils()[i];
      all.push_back(foil_results(system_.model().mesh, foil.block, foil.membrane,
                                 drive_.state.foils[static_cast<std::size_t>(foil.block)].strip_of_element, begin_,
                                 c.positions, system_.history(static_cast<Index>(i))));
    }
    return all;
  }

  void write_history(const path::Step& step, const assembly::Configuration& c, const std::vector<FoilResults>& foils) {
    History::Row row{{"step", step.number}, {"load_factor", step.load_factor}, {"iterations", step.iterations}};
    if (!drive_.path.history.empty()) row.emplace_back("time", step.time);
    for (std::size_t i = 0; i < drive_.state.chambers.size(); ++i) {
      const std::string chamber = "chambers." + drive_.state.chambers[i].name + ".";
      row.emplace_back(chamber + "gauge_pressure", c.pressures[static_cast<Eigen::Index>(i)]);
      row.emplace_back(chamber + "volume", system_.chamber_volume(static_cast<Index>(i)));
    }
    for (const FoilResults& r : foils) {
      const std::string foil = "foils." + r.name + ".";
      row.emplace_back(foil + "sag", r.sag);
      row.emplace_back(foil + "max_deflection", r.max_deflection);
      row.emplace_back(foil + "von_mises.max", r.von_mises.max);
      if (r.plastic) row.emplace_back(foil + "plastic_strain.max", r.plastic_strain.max);
    }
    history_.add(row);
  }

  State make_state(const assembly::Configuration& c, const std::vector<FoilResults>& foils) const {
    State state = drive_.state;
    state.mesh.nodes = c.positions;
    state.fields.clear();
    for (std::size_t i = 0; i < state.chambers.size(); ++i) {
      pipeline::state::Chamber& chamber = state.chambers[i];
      const auto air = static_cast<std::size_t>(system_.air_of(static_cast<Index>(i)));
      const assembly::Chamber& model = system_.model().chambers[air];
      chamber.law = law_kind(model.gas);
      if (const auto* closed = std::get_if<solver::chamber::Closed>(&model.gas)) {
        chamber.kappa = closed->kappa;
        chamber.temperature = std::lerp(closed->temperature0, closed->temperature, c.load_factor);
      }
      chamber.ambient_pressure = solver::chamber::ambient_pressure(model.gas, model.ambient, c.load_factor);
      chamber.gauge_pressure = c.pressures[static_cast<Eigen::Index>(i)];
      chamber.volume = system_.chamber_volume(static_cast<Index>(i));
    }
    for (std::size_t i = 0; i < system_.foils().size(); ++i) {
      const assembly::FoilEquations& foil = system_.foils()[i];
      pipeline::state::Foil& written = state.foils[static_cast<std::size_t>(foil.block)];
      const std::span<const double> history = system_.history(static_cast<Index>(i));
      const std::span<const std::string_view> names = solver::material::history_names(foil.membrane.law);
      written.history.assign(history.begin(), history.end());
      written.history_names.assign(names.begin(), names.end());
    }
    state.loads.clear();
    for (const DrivenLoad& driven : drive_.loads) {
      const double part = std::lerp(driven.from, driven.to, c.load_factor);
      if (part == 0) continue;
      pipeline::state::Load load = driven.load;
      load.pressure *= part;
      for (double& force : load.dead) force *= part;
      state.loads.push_back(std::move(load));
    }
    add_fields(foils, begin_, state);
    state.provenance = provenance(start_);
    return state;
  }

  static void warn(const std::string& warning, Summary& summary) {
    base::warn(warning);
    summary.append("warnings", warning);
  }

  void summarize_path(const path::PathResult& result, Summary& summary) const {
    bool has_limit = false;
    for (std::size_t i = 0; i < result.critical.size(); ++i) {
      const path::CriticalPoint& point = result.critical[i];
      const bool is_limit = point.kind == path::CriticalPoint::Kind::limit;
      has_limit = has_limit || is_limit;
      const std::string key = fmt::format("critical_points.#{}.", i);
      summary.set(key + "kind", is_limit ? "limit point" : "bifurcation point");
      summary.set(key + "load_factor", point.load_factor);
      summary.set(key + "step", point.step);
      for (std::size_t k = 0; k < drive_.state.chambers.size(); ++k) {
        summary.set(key + "chambers." + drive_.state.chambers[k].name + ".gauge_pressure",
                    point.pressures[static_cast<Eigen::Index>(k)]);
      }
      base::say(fmt::format("{} point at load factor {:.6g}, step {}", is_limit ? "limit" : "bifurcation",
                            point.load_factor, point.step));
    }
    if (!has_limit) return;
    summary.set("peak.quantity", drive_.load_name);
    summary.set("peak.value", drive_.load_at_one * largest_load_);
    summary.set("peak.step", largest_load_step_);
  }

  static std::string reached_verdict(const path::PathResult& result) {
    if (result.snaps.empty()) return "converged";
    return fmt::format("converged after the cushion lost its shape at load factor {:.4g}", result.snaps.front().from);
  }

  static void summarize_snaps(const path::PathResult& result, Summary& summary) {
    for (std::size_t i = 0; i < result.snaps.size(); ++i) {
      const auto& [from, to] = result.snaps[i];
      const std::string key = fmt::format("snaps.#{}.", i);
      summary.set(key + "from", from);
      summary.set(key + "to", to);
      warn(fmt::format("the cushion loses its shape at load factor {:.4g} and jumps to another (`after_limit: snap`)",
                       from),
           summary);
    }
  }

  // What acts on a foil and what the frame answers, N: pressures, and the dead loads at its free nodes (those at held
  // nodes reach the frame without it).
  void summarize_balance(const FoilResults& r, Summary& summary) const {
    for (const assembly::FoilEquations& foil : system_.foils()) {
      if (foil.block != r.block) continue;
      Vec3 load = Vec3::Zero(), frame = Vec3::Zero();
      for (Eigen::Index k = 0; k < foil.external.size(); ++k) {
        load[k % 3] += foil.external[k];
        if (system_.model().fixed[static_cast<std::size_t>(k)] != 0)
          frame[k % 3] += foil.internal[k] - foil.external[k];
      }
      const std::string key = "foils." + r.name + ".balance.";
      summary.set(key + "load", load);
      summary.set(key + "frame", frame);
      summary.set(key + "error", (load + frame).norm());
    }
  }

  void finish(assembly::Configuration& c, const path::PathResult& path_result) {
    system_.evaluate_accepted(c, true);
    const std::optional<path::Row> held =
        path_result.held ? std::optional(path::row_of(*path_result.held, 0, system_, c)) : std::nullopt;
    const path::Stability stability = newton_.tangent().stability(c, held ? &*held : nullptr);
    const std::vector<FoilResults> foils = results(c);
    const bool reached = path_result.end == path::PathEnd::reached;
    const std::string verdict = reached ? reached_verdict(path_result) : path_result.reason;

    State state = make_state(c, foils);
    state.provenance.converged = reached;
    state.provenance.verdict = verdict;
    state.provenance.load_factor = c.load_factor;
    const Clock writing;
    pipeline::state::write_state(state, *start_.outputs, start_.outputs->state_name());
    io_ += writing.seconds();

    Summary summary(origin_of(start_), start_.arguments.notes);
    summary.set("stage", start_.stage().run);
    summary.set("id", start_.stage().id);
    summary.set("converged", reached);
    summary.set("verdict", verdict);
    summary.set("load_factor", c.load_factor);
    summary.set("steps", path_result.steps);
    summary.set("iterations", newton_.work().iterations);
    summary.set("factorizations", newton_.work().factorizations);
    for (const pipeline::state::Chamber& chamber : state.chambers) {
      const std::string key = "chambers." + chamber.name + ".";
      summary.set(key + "gauge_pressure", chamber.gauge_pressure);
      summary.set(key + "absolute_pressure", chamber.gauge_pressure + chamber.ambient_pressure);
      summary.set(key + "volume", chamber.volume);
      summary.set(key + "law", law_name(chamber.law));
    }
    summarize_path(path_result, summary);
    summarize_snaps(path_result, summary);
    for (const pipeline::state::Chamber& chamber : state.chambers) {
      if (chamber.law != pipeline::state::GasLaw::closed || chamber.gauge_pressure >= 0) continue;
      warn(fmt::format("the air shut in chamber `{}` is at {} Pa below the still air: it has lost its pressure",
                       chamber.name, number(-chamber.gauge_pressure)),
           summary);
    }
    summarize(start_.laws, summary);
    for (const FoilResults& r : foils) {
      summarize(r, summary);
      summarize_balance(r, summary);
      if (r.wrinkled_area + r.slack_area > 1e-3) {
        warn(fmt::format("foil `{}` is wrinkled on {:.1f} % of its area and slack on {:.1f} %", r.name,
                         100 * r.wrinkled_area, 100 * r.slack_area),
             summary);
      }
      if (r.outside_area > 0) {
        warn(fmt::format("the strains of {:.2g} % of foil `{}` are outside the data of its table, which goes on "
                         "linearly there",
                         100 * r.outside_area, r.name),
             summary);
      }
      if (r.compressed_area > 1e-3) {
        warn(fmt::format("{:.1f} % of foil `{}` is in compression, up to {} MPa: a real foil wrinkles there",
                         100 * r.compressed_area, r.name, number(r.compression / 1e6)),
             summary);
      }
    }
    const VecX forces = system_.support_forces();
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index k = 0; k < forces.size(); k += 3) sum += forces.segment<3>(k);
    summary.set("reactions.sum", sum);
    const std::vector<double> all(forces.begin(), forces.end());
    double line = 0;
    for (const Vec3& q : solver::recovery::line_load(state.mesh, state.mesh.nodes, all).load)
      line = std::max(line, q.norm());
    summary.set("reactions.line_load_max", line);
    const auto count = [&](const char* key, const std::optional<int>& value) {
      if (value) {
        summary.set(key, *value);
      } else {
        summary.set(key, "undetermined");
      }
    };
    if (stability.load_held.value_or(0) > 0) {
      warn(
          fmt::format("the end state is in equilibrium but not stable where the load is held: {} negative eigenvalue{}",
                      *stability.load_held, *stability.load_held == 1 ? "" : "s"),
          summary);
    }
    count("stability.load_held", stability.load_held);
    count("stability.control_held", stability.control_held);
    summarize_mesh(state, summary);
    const path::Work& work = newton_.work();
    // acted in tangents on the way only: the accepted state is in equilibrium without it
    summary.set("artificial_tension_on_the_way", artificial_tension_);
    summary.set("timing.total", clock_.seconds());
    summary.set("timing.assembly", work.assembly);
    summary.set("timing.analysis", work.analysis);
    summary.set("timing.factorization", work.factorization);
    summary.set("timing.solve", work.solve);
    summary.set("timing.io", io_);
    summary.set("memory_peak", peak_memory());
    for (const std::string& text : drive_.modelled) summary.append("modelled", text);
    for (const std::string& text : drive_.not_modelled) summary.append("not_modelled", text);
    if (!contact_.empty()) summary.append("warnings", contact_);
    if (drive_.report) drive_.report(state, foils, summary);
    summary.write(*start_.outputs);
    if (!reached) {
      throw base::Error(base::ExitCode::no_equilibrium, verdict + "; the last good state is written and marked");
    }
  }

  const Start& start_;
  Drive drive_;
  std::vector<Vec3> begin_;
  Clock clock_;
  assembly::System system_;
  path::Newton newton_;
  History history_;
  pipeline::state::StepSeries series_;
  ContactCheck contact_check_;
  base::Progress progress_;
  std::string contact_;           // the first one that was ignored
  double artificial_tension_ = 0; // N/m, largest in any tangent on the way
  double largest_load_ = 0;       // load factor
  int largest_load_step_ = 0;
  double io_ = 0;
};

} // namespace

// A history belongs to the law that wrote it.
void check_history(const pipeline::state::Foil& foil, const solver::material::Law& law, const std::string& name) {
  const std::span<const std::string_view> names = solver::material::history_names(law);
  if (foil.history.empty() || std::ranges::equal(foil.history_names, names)) return;
  throw base::StateError(fmt::format(
      "foil `{}` carries the history of another law ({}); this one has {}: run the stages before with the same "
      "material",
      name, fmt::join(foil.history_names, ", "), names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

assembly::Model make_model(const Start& start, const State& state, double weight_from, double weight_to) {
  const Workflow& workflow = start.workflow;
  assembly::Model model;
  model.mesh = state.mesh;
  model.fixed = state.fixed;
  const auto coordinates = static_cast<Eigen::Index>(3 * state.mesh.nodes.size());
  std::vector<double> weight(static_cast<std::size_t>(coordinates), 0.0);
  for (std::size_t b = 0; b < state.mesh.blocks.size(); ++b) {
    if (state.mesh.blocks[b].kind == geometry::BlockKind::base) {
      model.foils.emplace_back();
      continue;
    }
    const pipeline::state::Foil& foil = state.foils[b];
    const Vec3 warp(std::cos(foil.warp_angle), std::sin(foil.warp_angle), 0);
    const pipeline::workflow::Material& material = workflow.materials.at(workflow.cushion.foils[b].material);
    const solver::material::Law& law = start.laws.at(material.name).law;
    check_history(foil, law, state.mesh.blocks[b].name);
    model.foils.push_back(assembly::Foil{solver::element::make_reference(state.mesh.element, state.stress_rule,
                                                                         foil.reference, warp, foil.predeformation),
                                         law, foil.thickness, foil.history});
    if (workflow.site.gravity && material.density) {
      const solver::element::Membrane membrane{state.mesh.blocks[b].connectivity, model.foils.back()->reference,
                                               model.foils.back()->law, foil.thickness};
      solver::element::add_weight(membrane, *material.density, -standard_gravity * workflow.site.up.normalized(),
                                  weight);
    }
  }
  const Eigen::Map<const VecX> all(weight.data(), coordinates);
  model.dead_from = weight_from * all;
  model.dead_to = weight_to * all;
  for (const pipeline::state::Chamber& chamber : state.chambers) {
    model.chambers.push_back({chamber.name, chamber.outer, chamber.inner, chamber.dead_volume,
                              solver::chamber::Regulated{chamber.gauge_pressure, chamber.gauge_pressure},
                              chamber.ambient_pressure, chamber.connected_to});
  }
  model.face_pressure.assign(state.mesh.blocks.size(), assembly::Ramp{});
  return model;
}

void add_load(const DrivenLoad& driven, assembly::Model& model) {
  const pipeline::state::Load& load = driven.load;
  const assembly::Ramp pressure{driven.from * load.pressure, driven.to * load.pressure};
  if (!load.points.empty()) {
    model.zones.push_back({load.block, load.offset, load.points, pressure});
  } else if (load.pressure != 0) {
    assembly::Ramp& face = model.face_pressure[static_cast<std::size_t>(load.block)];
    for (std::size_t end = 0; end < 2; ++end) face[end] += pressure[end];
  }
  if (load.dead.empty()) return;
  const Eigen::Map<const VecX> dead(load.dead.data(), static_cast<Eigen::Index>(load.dead.size()));
  model.dead_from += driven.from * dead;
  model.dead_to += driven.to * dead;
}

void run_equilibrium(const Start& start, Drive drive) {
  if (start.arguments.check) return;
  const Workflow& workflow = start.workflow;
  drive.modelled.insert(drive.modelled.begin(), {"large deformation of membranes without bending stiffness",
                                                 "pressure that follows the foils, with its load stiffness"});
  drive.modelled.push_back(workflow.site.gravity ? "weight of the foils" : "no weight of the foils (gravity: off)");
  const auto any_foil = [&](const auto& is_such) {
    return std::ranges::any_of(drive.model.foils, [&](const auto& foil) { return foil && is_such(foil->law); });
  };
  if (any_foil([](const auto& law) { return !solver::material::has_tension_field(law); })) {
    drive.not_modelled.emplace_back("wrinkling (no tension field): compressed areas carry compression");
  }
  if (any_foil([](const auto& law) { return solver::material::has_tension_field(law); })) {
    drive.modelled.emplace_back("wrinkling by a tension field: foils carry no compression");
  }
  const bool plastic = any_foil([](const auto& law) { return solver::material::history_components(law) > 0; });
  const bool flows = any_foil([](const auto& law) { return solver::material::is_rate_dependent(law); });
  if (plastic) drive.modelled.emplace_back("yield of the foils whose law has it, with its history");
  if (flows && !drive.path.history.empty()) drive.modelled.emplace_back("flow with time of the foils whose law has it");
  if (flows && drive.path.history.empty()) {
    drive.not_modelled.emplace_back("flow with time: without `duration` or `history` no time passes");
  }
  drive.not_modelled.insert(drive.not_modelled.end(),
                            {plastic ? "tear of the foil" : "yield, creep and tear of the foil: the law is elastic",
                             "contact forces between foils", "dynamics", "flexibility of the frame"});
  solver::linear::prepare_blas(start.arguments.threads);
  Run(start, std::move(drive)).run();
}

} // namespace pneuma::stages::common
