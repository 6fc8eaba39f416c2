// SPDX-License-Identifier: GPL-3.0-or-later
// pneuma-pattern: from the form-found cushion to flat strips that weld up to it, and to the drawings to cut them by.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "geometry/base/parallel.h"
#include "geometry/surface.h"
#include "pipeline/state/state_file.h"
#include "solver/linear/blas.h"
#include "stages/common/equilibrium.h"
#include "stages/pattern/layout.h"
#include "stages/pattern/report.h"
#include "stages/pattern/strip_drawing.h"

namespace pneuma::stages::pattern {

namespace {

namespace strips = geometry::strips;
namespace workflow = pipeline::workflow;

// Numbers of the blocks to be cut: those named, those with curves, or all foils that are not flat.
std::vector<std::size_t> foils_to_cut(const common::Start& start, const workflow::PatternSettings& settings) {
  const geometry::Mesh& mesh = start.state.mesh;
  const geometry::Plane plane = geometry::edge_plane(mesh, mesh.nodes);
  const double flat = 1e-6 * geometry::span_of(mesh.nodes);
  std::vector<std::size_t> chosen;
  for (std::size_t b = 0; b < start.workflow.cushion.foils.size(); ++b) {
    const bool is_flat = geometry::deepest_point(mesh, mesh.blocks[b], mesh.nodes, plane).distance < flat;
    const bool named =
        settings.foils && std::ranges::find(*settings.foils, mesh.blocks[b].name) != settings.foils->end();
    const bool wanted = settings.curves.empty() ? !is_flat : settings.curves.contains(mesh.blocks[b].name);
    if (settings.foils ? named : wanted) chosen.push_back(b);
  }
  if (chosen.empty()) {
    throw base::InputError(common::place(start.workflow, "stages." + start.stage().id + ".from") +
                           "all foils are flat: there is nothing to cut");
  }
  return chosen;
}

// Place of the key that decides how a foil is cut, for messages.
std::string cutting_place(const common::Start& start, const std::string& foil) {
  const std::string stage = "stages." + start.stage().id + ".";
  for (const std::string& key :
       {"curves." + foil + ".0.0.0", std::string("strips_per_foil"), std::string("roll.width")}) {
    if (std::string place = common::place(start.workflow, stage + key); !place.empty()) return place;
  }
  return "";
}

// Runs `make` and puts what is said of a shape that cannot be at a place of the user's file.
template <class Make>
auto at_place(const std::string& place, const Make& make) {
  try {
    return make();
  } catch (const base::GeometryError& error) {
    throw base::GeometryError(place + error.what());
  }
}

Layout lay_out_at_place(const common::Start& start, const workflow::PatternSettings& settings,
                        const strips::Surface& surface, const std::string& foil, int least) {
  try {
    return lay_out(surface, settings, foil, least);
  } catch (const base::GeometryError& error) {
    std::string message = error.what();
    const std::string name = fmt::format("foil `{}`: ", foil);
    if (!message.starts_with(name)) message = name + message;
    if (!settings.strips_per_foil && settings.roll && !settings.curves.contains(foil)) {
      message += "; the roll asks for so many strips, and a wider roll for fewer";
    }
    throw base::GeometryError(cutting_place(start, foil) + message);
  }
}

// What the flat strips of a foil shall be.
Wanted wanted_of(const common::Start& start, const workflow::PatternSettings& settings, std::size_t b,
                 double direction) {
  const workflow::FoilSettings& foil = start.workflow.cushion.foils[b];
  const std::vector<double>& prestress = start.state.foils[b].prestress;
  const double tension = prestress.empty() ? 0 : prestress.front();
  const auto elastic = elastic_stretch(start.laws.at(foil.material).law, foil.thickness, tension);
  if (!elastic) {
    throw base::InputError(fmt::format("{}foil `{}` cannot carry the prestress of {} N/m that its form was found for",
                                       common::place_of_foil(start.workflow, b), foil.name, common::number(tension)));
  }
  Wanted wanted;
  wanted.direction = direction;
  wanted.decompensation = settings.decompensation;
  wanted.weight = elastic->weight;
  const workflow::SolverOptions& options = settings.options;
  if (options.tolerance) wanted.options.tolerance = *options.tolerance;
  if (options.max_iterations) wanted.options.max_iterations = *options.max_iterations;
  if (settings.by_strain()) wanted.stretch = elastic->stretch / (1 - settings.creep);
  if (const auto* given = std::get_if<workflow::GivenCompensation>(&settings.compensation)) {
    wanted.stretch = Vec3(1 / (1 - given->warp), 1 / (1 - given->weft), 0);
  }
  return wanted;
}

// Lays out, cuts and flattens once; `least` [block]: strips at least, where the roll decides.
Welded cut_once(const common::Start& start, const workflow::PatternSettings& settings,
                const std::vector<std::size_t>& chosen, const std::vector<strips::Surface>& surfaces,
                const std::vector<int>& least) {
  const geometry::Mesh& mesh = start.state.mesh;
  std::vector<strips::Cut> cuts;
  for (const strips::Surface& surface : surfaces) cuts.push_back({&surface, {}});
  Welded welded;
  welded.wanted.resize(mesh.blocks.size());
  welded.flat.resize(mesh.blocks.size());
  for (const std::size_t b : chosen) {
    const Layout layout = lay_out_at_place(start, settings, surfaces[b], mesh.blocks[b].name, least[b]);
    base::say(fmt::format("{}: {}", mesh.blocks[b].name, layout.reason));
    cuts[b].lines = layout.lines;
    welded.wanted[b] = wanted_of(start, settings, b, layout.direction);
  }
  const double size = element_size(cuts);
  if (size < surfaces.front().size) {
    base::say(
        fmt::format("elements of {:.3g} m instead of {:.3g} m, for the narrowest strip", size, surfaces.front().size));
  }
  strips::CutMesh cut = at_place(cutting_place(start, mesh.blocks[chosen.front()].name),
                                 [&] { return strips::cut(start.workflow.cushion.plan, mesh, cuts, size); });
  welded.state = transferred(start, cut);
  welded.cuts = std::move(cut.foils);
  base::parallel_chunks(start.arguments.threads, chosen.size(), [&](std::size_t i) {
    const std::size_t b = chosen[i];
    welded.flat[b] = flatten_foil(welded.state.mesh, static_cast<base::Index>(b), welded.state.stress_rule,
                                  welded.cuts[b], *welded.wanted[b]);
  });
  for (const std::size_t b : chosen) {
    if (welded.flat[b]->flat.converged) continue;
    throw base::Error(base::ExitCode::no_equilibrium,
                      fmt::format("the strips of foil `{}` did not settle in the plane after {} iterations",
                                  mesh.blocks[b].name, welded.flat[b]->flat.iterations));
  }
  return welded;
}

// Of the cut strips of a foil, m.
double widest_cut(const Welded& welded, std::size_t b, const workflow::PatternSettings& settings) {
  double widest = 0;
  for (const auto& strip : outlines(*welded.flat[b], welded.state.mesh, static_cast<base::Index>(b))) {
    const auto cut = geometry::fabrication::cut_strip(strip, allowances_of(settings));
    widest = std::max(widest, cut.high.y() - cut.low.y());
  }
  return widest;
}

// Where the roll decides on the number of strips, the finished ones are checked against it, and a foil with too wide
// ones gets one more: the layout knows their widths from a coarse copy only.
Welded cut_and_flatten(const common::Start& start, const workflow::PatternSettings& settings,
                       const std::vector<std::size_t>& chosen) {
  const geometry::Mesh& mesh = start.state.mesh;
  std::vector<strips::Surface> surfaces;
  for (const geometry::Block& block : mesh.blocks) {
    surfaces.push_back(at_place(
        fmt::format("{}foil `{}`: ", common::place(start.workflow, "stages." + start.stage().id + ".from"), block.name),
        [&] { return strips::prepare(start.workflow.cushion.plan, mesh, block, mesh.nodes); }));
  }
  const bool roll_decides = settings.roll && !settings.strips_per_foil && settings.curves.empty();
  const workflow::Roll roll = settings.roll_or_usual();
  const double usable = roll.width - 2 * roll.selvedge;
  std::vector<int> least(mesh.blocks.size(), 2);
  for (int attempts = roll_decides ? 4 : 1;; --attempts) {
    Welded welded = cut_once(start, settings, chosen, surfaces, least);
    bool fits = true;
    for (const std::size_t b : chosen) {
      if (attempts == 1) break;
      const double widest = widest_cut(welded, b, settings);
      if (widest <= usable) continue;
      fits = false;
      least[b] = welded.cuts[b].strips + 1;
      base::say(fmt::format("{}: its strips came out up to {:.0f} mm wide, the roll has {:.0f} mm: one more",
                            mesh.blocks[b].name, 1e3 * widest, 1e3 * usable));
    }
    if (!fits) continue;
    weld(welded);
    return welded;
  }
}

// What a manufacturer gets of one foil.
Fabrication draw(const common::Start& start, const workflow::PatternSettings& settings, const Welded& welded,
                 std::size_t b, const std::vector<StripQuality>& quality) {
  std::vector<StripSheet> sheets;
  for (geometry::fabrication::FlatStrip& strip :
       outlines(*welded.flat[b], welded.state.mesh, static_cast<base::Index>(b))) {
    sheets.push_back({std::move(strip), quality[sheets.size()].distortion});
  }
  const workflow::Roll roll = settings.roll_or_usual();
  Fabrication made = at_place(common::place(start.workflow, "stages." + start.stage().id + ".roll.width"), [&] {
    return fabricate(welded.state.mesh.blocks[b].name, sheets, allowances_of(settings),
                     {roll.width, roll.selvedge, RollSheet{}.gap, !settings.roll});
  });
  const base::Vec2 centre = start.frame.origin();
  if (!centre.isZero(0)) draw_plan_centre(centre, made.roll_width, made.drawing);
  return made;
}

void run(const common::Start& start) {
  const common::Clock clock;
  if (start.arguments.in.empty()) return; // --check: all there is to check without a state
  const auto& settings = std::get<workflow::PatternSettings>(start.stage().settings);
  const std::vector<std::size_t> chosen = foils_to_cut(start, settings);
  for (const std::size_t b : chosen) wanted_of(start, settings, b, 0); // that the foils can carry their prestress
  if (start.arguments.check) return;
  solver::linear::prepare_blas(start.arguments.threads);
  Welded welded = cut_and_flatten(start, settings, chosen);

  common::Summary summary(common::origin_of(start), start.arguments.notes);
  summary.set("stage", "pattern");
  summary.set("id", start.stage().id);
  summary.set("converged", true);
  summary.set("verdict", "converged");
  int iterations = 0;
  int factorizations = 0;
  std::map<std::string, Fabrication> sheets; // of each foil
  for (const std::size_t b : chosen) {
    const std::string& name = welded.state.mesh.blocks[b].name;
    iterations = std::max(iterations, welded.flat[b]->flat.iterations);
    factorizations += welded.flat[b]->flat.factorizations;
    const std::vector<StripQuality> quality = quality_of(welded, b);
    const Fabrication& made = sheets[name] = draw(start, settings, welded, b, quality);
    report_strips(quality, made, name, summary);
    summary.set("patterns." + name + ".direction", welded.wanted[b]->direction);
    if (made.roll_width > settings.roll_or_usual().width) {
      const std::string warning = fmt::format("the strips of foil `{}` need a roll of {:.0f} mm, {:.0f} mm are usual: "
                                              "take more strips, or name the roll",
                                              name, 1e3 * made.roll_width, 1e3 * settings.roll_or_usual().width);
      base::warn(warning);
      summary.append("warnings", warning);
    }
    summary.set("foils." + name + ".area",
                geometry::surface_area(welded.state.mesh, welded.state.mesh.blocks[b], welded.state.mesh.nodes));
  }
  summary.set("iterations", iterations);
  summary.set("factorizations", factorizations);
  for (const pipeline::state::Chamber& chamber : welded.state.chambers) {
    summary.set("chambers." + chamber.name + ".gauge_pressure", chamber.gauge_pressure);
    summary.set("chambers." + chamber.name + ".volume", chamber.volume);
  }
  welded.state.provenance = common::provenance(start);
  welded.state.provenance.converged = true;
  welded.state.provenance.verdict = "converged";
  welded.state.provenance.load_factor = 1;
  // after all foils have theirs
  for (const auto& [foil, made] : sheets) write_sheets(foil, made, *start.outputs);
  pipeline::state::write_state(welded.state, *start.outputs, start.outputs->state_name());
  common::summarize_mesh(welded.state, summary);
  summary.set("timing.total", clock.seconds());
  summary.set("memory_peak", common::peak_memory());
  summary.append("modelled", "strips welded edge to edge, mating seams equally long");
  summary.append("not_modelled", "double thickness of the welds");
  summary.append("not_modelled", "curvature of the frame's clamps");
  summary.write(*start.outputs);
}

} // namespace

} // namespace pneuma::stages::pattern

int main(int argc, char** argv) {
  return pneuma::stages::common::stage_main("pattern",
                                            "cuts a form into flat strips, draws them, and welds the cushion from them",
                                            pneuma::stages::pattern::run, argc, argv);
}
