// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "geometry/base/log.h"

namespace pneuma::stages::pattern {

namespace {

constexpr double much_distortion = 0.005; // spec engineering: warn above 0.5 %

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

double percent(double value) {
  return 100 * value;
}

// Wanted compensation along a direction of the plane: a length dX becomes |G dX|.
double requested_along(const double* g, const Vec2& direction) {
  const Vec2 u = direction.normalized();
  return 1 - 1 / Vec2(g[0] * u.x() + g[2] * u.y(), g[2] * u.x() + g[1] * u.y()).norm();
}

// The element of each strip that has a side on its boundary, by the side's corners counterclockwise.
using ElementOfSide = std::map<std::pair<Index, Index>, std::size_t>;

ElementOfSide elements_by_side(const geometry::Mesh& mesh, const geometry::Block& block) {
  const auto corners = at(geometry::corners_per_element(mesh.element));
  ElementOfSide elements;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const std::span<const Index> nodes = mesh.element_nodes(block, e);
    for (std::size_t k = 0; k < corners; ++k) elements[{nodes[k], nodes[(k + 1) % corners]}] = at(e);
  }
  return elements;
}

} // namespace

std::vector<StripQuality> quality_of(const Welded& welded, std::size_t block) {
  const FlatFoil& foil = *welded.flat[block];
  const Wanted& wanted = *welded.wanted[block];
  const ElementOfSide element_of = elements_by_side(welded.state.mesh, welded.state.mesh.blocks[block]);
  const std::size_t step = geometry::is_quadratic(welded.state.mesh.element) ? 2 : 1; // nodes from corner to corner
  const geometry::Mesh& mesh = welded.state.mesh;
  const geometry::strips::CutFoil& cut = welded.cuts[block];
  const std::size_t points = foil.stretches.size() / cut.strip_of_element.size();
  std::vector<StripQuality> all(at(cut.strips));
  std::vector<double> form_area(all.size(), 0.0);
  for (std::size_t k = 0; k < foil.stretches.size(); ++k) {
    const std::size_t s = at(cut.strip_of_element[k / points]);
    const solver::flattening::PointStretch& stretch = foil.stretches[k];
    StripQuality& f = all[s];
    f.distortion = std::max({f.distortion, stretch.larger - 1, 1 - stretch.smaller});
    form_area[s] += stretch.area;
    // a length along x of the plane is 1 / sqrt(C11) of the one on the form
    const base::Mat2 metric = stretch.inverse_metric.inverse();
    for (int i = 0; i < 2; ++i) {
      f.compensation[i] += stretch.area * (1 - 1 / std::sqrt(metric(i, i)));
      f.requested[i] += stretch.area * requested_along(foil.wanted.data() + 3 * k, Vec2::Unit(i));
    }
  }
  for (std::size_t s = 0; s < all.size(); ++s) {
    StripQuality& f = all[s];
    f.name = strip_name(mesh.blocks[block].name, static_cast<Index>(s));
    for (int i = 0; i < 2; ++i) {
      f.compensation[i] /= form_area[s];
      f.requested[i] /= form_area[s];
    }
    for (std::size_t k = 0; k < foil.sides[s].size(); ++k) {
      const geometry::strips::StripSide& side = foil.sides[s][k];
      std::vector<Vec2> flat;
      double form_length = 0;
      double flat_length = 0;
      for (std::size_t i = 0; i < side.nodes.size(); ++i) {
        flat.push_back(foil.flat.points[at(foil.flat_sides[s][k][i])]);
        if (i == 0) continue;
        form_length += (mesh.nodes[at(side.nodes[i])] - mesh.nodes[at(side.nodes[i - 1])]).norm();
        flat_length += (flat[i] - flat[i - 1]).norm();
      }
      double requested = 0;
      for (std::size_t i = 0; i + step < side.nodes.size(); i += step) {
        const Vec2 along = flat[i + step] - flat[i];
        const std::size_t e = element_of.at({side.nodes[i], side.nodes[i + step]});
        requested += along.norm() * requested_along(foil.wanted.data() + 3 * points * e, along) / flat_length;
      }
      if (side.edge >= 0 && wanted.decompensation > 0) requested = 0; // the frame does not stretch
      f.edges.push_back({side.seam >= 0   ? seam_name(side.seam)
                         : side.edge >= 0 ? mesh.edges[at(side.edge)].name
                                          : "",
                         requested, 1 - flat_length / form_length});
    }
  }
  return all;
}

void report_strips(const std::vector<StripQuality>& strips, const Fabrication& made, const std::string& foil,
                   common::Summary& summary) {
  const char* directions[2] = {"warp", "weft"};
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const StripQuality& f = strips[s];
    const StripFigures& size = made.strips[s];
    const std::string key = fmt::format("patterns.{}.strips.#{}.", foil, s);
    summary.set(key + "name", f.name);
    summary.set(key + "width", size.width);
    summary.set(key + "length", size.length);
    summary.set(key + "area", size.net_area);
    summary.set(key + "distortion_max", f.distortion);
    summary.set(key + "seam_mismatch_max", size.seam_mismatch_max);
    std::string line =
        fmt::format("{}: {:.0f} x {:.0f} mm, {:.3f} m2, distortion {:.3f} %, compensation wanted/got:", f.name,
                    1e3 * size.length, 1e3 * size.width, size.net_area, percent(f.distortion));
    for (int i = 0; i < 2; ++i) {
      const std::string direction = key + "compensation." + directions[i] + ".";
      summary.set(direction + "requested", f.requested[i]);
      summary.set(direction + "achieved", f.compensation[i]);
      line += fmt::format(" {} {:.3f}/{:.3f} %,", directions[i], percent(f.requested[i]), percent(f.compensation[i]));
    }
    for (std::size_t e = 0; e < f.edges.size(); ++e) {
      const std::string edge = fmt::format("{}edges.#{}.", key, e);
      summary.set(edge + "name", f.edges[e].name);
      summary.set(edge + "requested", f.edges[e].requested);
      summary.set(edge + "achieved", f.edges[e].achieved);
      line += fmt::format(" {} {:.3f}/{:.3f} %{}", f.edges[e].name, percent(f.edges[e].requested),
                          percent(f.edges[e].achieved), e + 1 < f.edges.size() ? "," : "");
    }
    base::say(line);
    if (f.distortion > much_distortion) {
      const std::string warning =
          fmt::format("strip {} is distorted by {:.2f} % when it is laid flat (above {} %): take narrower strips",
                      f.name, percent(f.distortion), percent(much_distortion));
      base::warn(warning);
      summary.append("warnings", warning);
    }
  }
  const std::string pattern = "patterns." + foil + ".";
  summary.set(pattern + "waste_fraction", made.nesting.waste_fraction);
  summary.set(pattern + "weld_length", made.weld_length);
  summary.set(pattern + "roll_width", made.roll_width);
  summary.set(pattern + "roll_length", made.nesting.length);
  base::say(fmt::format("{}: {:.1f} m of a roll of {:.0f} mm, waste {:.1f} %, welds {:.1f} m, mating seams differ by "
                        "{:.2g} mm/m at most",
                        foil, made.nesting.length, 1e3 * made.roll_width, percent(made.nesting.waste_fraction),
                        made.weld_length, 1e3 * made.mismatch_per_length_max));
}

} // namespace pneuma::stages::pattern
