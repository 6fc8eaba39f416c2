// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/equilibrium.h"

#include <cmath>
#include <csignal>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/gap.h"
#include "geometry/surface.h"
#include "pipeline/state/state_file.h"
#include "solver/recovery/reactions.h"
#include "stages/common/summary.h"

namespace pneuma::stages::common {

namespace {

namespace assembly = solver::assembly;
namespace path = solver::path;

constexpr double standard_gravity = 9.80665; // m/s2

volatile std::sig_atomic_t interrupted = 0;
extern "C" void note_interrupt(int) {
  interrupted = 1;
}

void stop_if_interrupted() {
  if (interrupted != 0) {
    throw base::Error(base::ExitCode::interrupted, "interrupted: the steps written so far are complete");
  }
}

// Neighbouring blocks that could touch, and how near they are.
class ContactCheck {
public:
  ContactCheck(const geometry::Mesh& mesh, const Vec3& up) {
    smallest_allowed_ = -1e-6 * geometry::span_of(mesh.nodes);
    for (std::size_t b = 0; b + 1 < mesh.blocks.size(); ++b) {
      names_.emplace_back(mesh.blocks[b].name, mesh.blocks[b + 1].name);
      searches_.emplace_back(mesh, mesh.blocks[b], mesh.blocks[b + 1], up);
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
        folder_(start.arguments.out.parent_path()), system_(drive_.model, start.arguments.threads),
        newton_(system_, newton_options(start)), history_(folder_ / "history.csv"), series_(folder_),
        contact_(drive_.model.mesh, start.workflow.site.up) {}

  // Throws Error with exit code 5, after everything is written, where the path did not reach its end.
  void run() {
    interrupted = 0;
    std::signal(SIGINT, note_interrupt);
    std::signal(SIGTERM, note_interrupt);
    assembly::Configuration c{begin_, VecX::Zero(static_cast<Eigen::Index>(drive_.state.chambers.size())), 0};
    for (std::size_t i = 0; i < drive_.state.chambers.size(); ++i) {
      c.pressures[static_cast<Eigen::Index>(i)] = drive_.state.chambers[i].gauge_pressure;
    }
    path::LoadPathOptions options;
    options.parts = drive_.steps.value_or(1);
    const path::PathResult result = path::follow_load(
        system_, newton_, c, options,
        [&](const path::Step& step, const assembly::Configuration& at) { return accept(step, at); },
        [&](int step, const path::Iteration& i) {
          progress_.show(fmt::format("step {}, load factor {:.4g}, iteration {}: residual {:.2e}{}", step,
                                     i.load_factor, i.number + 1, i.residual,
                                     i.shift > 0 ? fmt::format(", artificial tension {:.2g} N/m", i.shift) : ""));
          artificial_tension_ = std::max(artificial_tension_, i.shift);
          stop_if_interrupted();
        });
    progress_.done();
    finish(c, result);
  }

private:
  static path::NewtonOptions newton_options(const Start& start) {
    path::NewtonOptions options;
    const pipeline::workflow::SolverOptions& given = start.stage().options;
    if (given.tolerance) options.tolerance = *given.tolerance;
    if (given.max_iterations) options.max_iterations = *given.max_iterations;
    return options;
  }

  path::Verdict accept(const path::Step& step, const assembly::Configuration& c) {
    progress_.done();
    std::string line =
        fmt::format("step {}: load factor {:.6g}, {} iterations", step.number, step.load_factor, step.iterations);
    for (std::size_t i = 0; i < drive_.state.chambers.size(); ++i) {
      line += fmt::format(", {}: {:.6g} Pa, {:.6g} m3", drive_.state.chambers[i].name,
                          c.pressures[static_cast<Eigen::Index>(i)], system_.chamber_volume(static_cast<Index>(i)));
    }
    base::say(line);
    if (!contact_found_) {
      if (const auto found = contact_.find(c.positions)) {
        contact_found_ = fmt::format(
            "contact at load factor {:.4g} at ({:.4g}, {:.4g}, {:.4g}) m between `{}` and `{}`", step.load_factor,
            found->gap.at.x(), found->gap.at.y(), found->gap.at.z(), found->upper, found->lower);
        if (!drive_.contact_stops) base::warn(*contact_found_ + " (goes on: contact is ignored)");
      }
    }
    const std::vector<FoilResults> foils = results(c);
    write_history(step, c, foils);
    if (drive_.steps && step.end_of_part) {
      const Clock clock;
      State state = make_state(c, foils);
      state.provenance.converged = true;
      state.provenance.load_factor = step.load_factor;
      state.provenance.verdict = fmt::format("step {} of the path", step.number);
      series_.write(state, step.load_factor);
      io_ += clock.seconds();
    }
    stop_if_interrupted();
    return contact_found_ && drive_.contact_stops ? path::Verdict::stop : path::Verdict::go_on;
  }

  std::vector<FoilResults> results(const assembly::Configuration& c) const {
    std::vector<FoilResults> all;
    for (const assembly::FoilEquations& foil : system_.foils()) {
      all.push_back(foil_results(system_.model().mesh, foil.block, foil.membrane,
                                 drive_.state.foils[static_cast<std::size_t>(foil.block)].strip_of_element, begin_,
                                 c.positions, {}));
    }
    return all;
  }

  void write_history(const path::Step& step, const assembly::Configuration& c, const std::vector<FoilResults>& foils) {
    History::Row row{{"step", step.number}, {"load_factor", step.load_factor}, {"iterations", step.iterations}};
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
    }
    history_.add(row);
  }

  State make_state(const assembly::Configuration& c, const std::vector<FoilResults>& foils) const {
    State state = drive_.state;
    state.mesh.nodes = c.positions;
    state.fields.clear();
    for (std::size_t i = 0; i < state.chambers.size(); ++i) {
      pipeline::state::Chamber& chamber = state.chambers[i];
      const Index air = system_.air_of(static_cast<Index>(i));
      const assembly::Chamber& model = system_.model().chambers[static_cast<std::size_t>(air)];
      chamber.law = law_kind(model.gas);
      if (const auto* closed = std::get_if<solver::chamber::Closed>(&model.gas)) {
        chamber.kappa = closed->kappa;
        chamber.temperature = std::lerp(closed->temperature0, closed->temperature, c.load_factor);
      }
      chamber.ambient_pressure = solver::chamber::ambient_pressure(model.gas, model.ambient, c.load_factor);
      chamber.gauge_pressure = c.pressures[static_cast<Eigen::Index>(i)];
      chamber.volume = system_.chamber_volume(static_cast<Index>(i));
    }
    add_fields(foils, begin_, state);
    state.provenance = provenance(start_);
    return state;
  }

  void finish(assembly::Configuration& c, const path::PathResult& path_result) {
    system_.evaluate(c, true);
    const path::Stability stability = newton_.tangent().stability(c, nullptr);
    const std::vector<FoilResults> foils = results(c);
    const bool reached = path_result.end == path::PathEnd::reached;
    const std::string verdict = reached                                     ? "converged"
                                : path_result.end == path::PathEnd::stopped ? *contact_found_
                                                                            : path_result.reason;

    State state = make_state(c, foils);
    state.provenance.converged = reached;
    state.provenance.verdict = verdict;
    state.provenance.load_factor = c.load_factor;
    const Clock writing;
    pipeline::state::write_state(state, start_.arguments.out);
    io_ += writing.seconds();

    Summary summary;
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
    for (const FoilResults& r : foils) {
      summarize(r, summary);
      if (r.compressed_area > 1e-3) {
        const std::string warning =
            fmt::format("{:.1f} % of foil `{}` is in compression, up to {} MPa: a real foil wrinkles there",
                        100 * r.compressed_area, r.name, number(r.compression / 1e6));
        base::warn(warning);
        summary.append("warnings", warning);
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
    if (contact_found_) summary.append("warnings", *contact_found_);
    if (drive_.report) drive_.report(state, foils, summary);
    summary.write(folder_ / "summary.json");
    if (!reached) {
      throw base::Error(base::ExitCode::no_equilibrium, verdict + "; the last good state is written and marked");
    }
  }

  const Start& start_;
  Drive drive_;
  std::vector<Vec3> begin_;
  std::filesystem::path folder_;
  Clock clock_;
  assembly::System system_;
  path::Newton newton_;
  History history_;
  pipeline::state::StepSeries series_;
  ContactCheck contact_;
  base::Progress progress_;
  std::optional<std::string> contact_found_;
  double artificial_tension_ = 0; // N/m, largest in any tangent on the way
  double io_ = 0;
};

} // namespace

solver::material::Law law_of(const pipeline::workflow::Material& material) {
  const auto* elastic = std::get_if<pipeline::workflow::ElasticLaw>(&material.law);
  if (elastic == nullptr || material.tension_field) {
    throw base::InputError(fmt::format("{}: material `{}`: {} is not wired", to_string(material.mark), material.name,
                                       elastic == nullptr ? "its law" : "`tension_field: on`"));
  }
  return solver::material::StVenantKirchhoff{elastic->E, elastic->nu};
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
    model.foils.push_back(assembly::Foil{solver::element::make_reference(state.mesh.element, state.stress_rule,
                                                                         foil.reference, warp, foil.predeformation),
                                         law_of(material), foil.thickness});
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

int run_equilibrium(const Start& start, Drive drive) {
  const Workflow& workflow = start.workflow;
  drive.modelled.insert(drive.modelled.begin(), {"large deformation of membranes without bending stiffness",
                                                 "pressure that follows the foils, with its load stiffness"});
  drive.modelled.push_back(workflow.site.gravity ? "weight of the foils" : "no weight of the foils (gravity: off)");
  drive.not_modelled.insert(drive.not_modelled.end(),
                            {"wrinkling (no tension field): compressed areas carry compression",
                             "yield, creep and tear of the foil: the law is elastic", "contact forces between foils",
                             "dynamics", "flexibility of the frame"});
  solver::linear::use_one_blas_thread();
  Run(start, std::move(drive)).run();
  return 0;
}

} // namespace pneuma::stages::common
