// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/report.h"

#include <algorithm>
#include <cmath>

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

// Wanted compensation along a side: of the stretch along its mean direction in the plane, nothing where it fades out.
double requested_along(const Wanted& wanted, const std::vector<Vec2>& side, bool clamped) {
  if (clamped && wanted.decompensation > 0) return 0;
  double sum = 0;
  double length = 0;
  for (std::size_t k = 0; k + 1 < side.size(); ++k) {
    const Vec2 d = side[k + 1] - side[k];
    const Vec2 u = d.normalized();
    const Vec3& g = wanted.stretch;
    // a length dX becomes |G dX|
    const double stretch = Vec2(g[0] * u.x() + g[2] * u.y(), g[2] * u.x() + g[1] * u.y()).norm();
    sum += (1 - 1 / stretch) * d.norm();
    length += d.norm();
  }
  return sum / length;
}

} // namespace

std::vector<StripFigures> figures_of(const Welded& welded, std::size_t block) {
  const FlatFoil& foil = *welded.flat[block];
  const Wanted& wanted = *welded.wanted[block];
  const geometry::Mesh& mesh = welded.state.mesh;
  const geometry::strips::CutFoil& cut = welded.cuts[block];
  const std::size_t points = foil.stretches.size() / cut.strip_of_element.size();
  std::vector<StripFigures> all(at(cut.strips));
  std::vector<double> form_area(all.size(), 0.0);
  for (std::size_t k = 0; k < foil.stretches.size(); ++k) {
    const std::size_t s = at(cut.strip_of_element[k / points]);
    const solver::flattening::PointStretch& stretch = foil.stretches[k];
    StripFigures& f = all[s];
    f.distortion = std::max({f.distortion, stretch.larger - 1, 1 - stretch.smaller});
    f.area += stretch.area * std::sqrt(stretch.inverse_metric.determinant());
    form_area[s] += stretch.area;
    // a length along x of the plane is 1 / sqrt(C11) of the one on the form
    const base::Mat2 metric = stretch.inverse_metric.inverse();
    for (int i = 0; i < 2; ++i) f.compensation[i] += stretch.area * (1 - 1 / std::sqrt(metric(i, i)));
  }
  for (std::size_t s = 0; s < all.size(); ++s) {
    StripFigures& f = all[s];
    f.name = strip_name(mesh.blocks[block].name, static_cast<Index>(s));
    for (double& c : f.compensation) c /= form_area[s];
    Vec2 low = foil.flat.points[at(foil.flat_sides[s][0][0])];
    Vec2 high = low;
    for (std::size_t k = 0; k < foil.sides[s].size(); ++k) {
      const geometry::strips::StripSide& side = foil.sides[s][k];
      std::vector<Vec2> flat;
      double form_length = 0;
      double flat_length = 0;
      for (std::size_t i = 0; i < side.nodes.size(); ++i) {
        flat.push_back(foil.flat.points[at(foil.flat_sides[s][k][i])]);
        low = low.cwiseMin(flat.back());
        high = high.cwiseMax(flat.back());
        if (i == 0) continue;
        form_length += (mesh.nodes[at(side.nodes[i])] - mesh.nodes[at(side.nodes[i - 1])]).norm();
        flat_length += (flat[i] - flat[i - 1]).norm();
      }
      if (side.seam >= 0) {
        const auto& [left, right] = foil.seam_lengths[at(side.seam)];
        f.seam_mismatch = std::max(f.seam_mismatch, std::abs(left - right));
      }
      f.edges.push_back({side.seam >= 0   ? seam_name(side.seam)
                         : side.edge >= 0 ? mesh.edges[at(side.edge)].name
                                          : "",
                         requested_along(wanted, flat, side.edge >= 0), 1 - flat_length / form_length});
    }
    f.length = high.x() - low.x();
    f.width = high.y() - low.y();
  }
  return all;
}

void report_strips(const std::vector<StripFigures>& strips, const Wanted& wanted, const std::string& foil,
                   common::Summary& summary) {
  const double requested[2] = {1 - 1 / wanted.stretch[0], 1 - 1 / wanted.stretch[1]};
  const char* directions[2] = {"warp", "weft"};
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const StripFigures& f = strips[s];
    const std::string key = fmt::format("patterns.{}.strips.#{}.", foil, s);
    summary.set(key + "name", f.name);
    summary.set(key + "width", f.width);
    summary.set(key + "length", f.length);
    summary.set(key + "area", f.area);
    summary.set(key + "distortion_max", f.distortion);
    summary.set(key + "seam_mismatch_max", f.seam_mismatch);
    std::string line =
        fmt::format("{}: {:.0f} x {:.0f} mm, {:.3f} m2, distortion {:.3f} %, compensation wanted/got:", f.name,
                    1e3 * f.length, 1e3 * f.width, f.area, percent(f.distortion));
    for (int i = 0; i < 2; ++i) {
      const std::string direction = key + "compensation." + directions[i] + ".";
      summary.set(direction + "requested", requested[i]);
      summary.set(direction + "achieved", f.compensation[i]);
      line += fmt::format(" {} {:.3f}/{:.3f} %,", directions[i], percent(requested[i]), percent(f.compensation[i]));
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
}

} // namespace pneuma::stages::pattern
