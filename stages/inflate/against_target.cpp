// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/inflate/against_target.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "geometry/base/log.h"
#include "geometry/deviation.h"

namespace pneuma::stages::inflate {

namespace {

using common::Index;
using common::State;
using common::Vec3;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

struct StressDeviation {
  double rms = 0, max = 0;
};

StressDeviation stress_deviation(const common::FoilResults& results, const std::vector<double>& target,
                                 const std::vector<double>& area) {
  StressDeviation deviation;
  double total = 0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const Vec3 wanted(target[3 * i], target[3 * i + 1], target[3 * i + 2]);
    const Vec3 n =
        results.thickness[i] * Vec3(results.cauchy[3 * i], results.cauchy[3 * i + 1], results.cauchy[3 * i + 2]);
    const auto norm = [](const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + 2 * v[2] * v[2]); };
    const double relative = norm(n - wanted) / norm(wanted);
    deviation.max = std::max(deviation.max, relative);
    deviation.rms += area[i] * relative * relative;
    total += area[i];
  }
  deviation.rms = std::sqrt(deviation.rms / total);
  return deviation;
}

// Flat coordinates of the nodes of each strip.
using FlatPoints = std::map<std::pair<Index, Index>, Vec3>; // (strip, node)

FlatPoints flat_points(const State& state, std::size_t b) {
  const pipeline::state::Foil& foil = state.foils[b];
  const geometry::Block& block = state.mesh.blocks[b];
  const std::size_t n = block.connectivity.size() / foil.strip_of_element.size();
  FlatPoints points;
  for (std::size_t k = 0; k < block.connectivity.size(); ++k) {
    points[{foil.strip_of_element[k / n], block.connectivity[k]}] =
        Vec3(foil.reference[3 * k], foil.reference[3 * k + 1], foil.reference[3 * k + 2]);
  }
  return points;
}

} // namespace

void report_against_target(const State& target, const State& end, const std::vector<common::FoilResults>& foils,
                           const std::vector<std::vector<double>>& area, common::Summary& summary) {
  for (const common::FoilResults& results : foils) {
    const std::size_t b = at(results.block);
    const pipeline::state::Foil& foil = target.foils[b];
    if (foil.strips.empty()) continue;
    const geometry::Deviation shape =
        geometry::normal_deviation(target.mesh, target.mesh.blocks[b], target.mesh.nodes, end.mesh.nodes);
    summary.set("shape_deviation." + results.name + ".max", shape.max);
    summary.set("shape_deviation." + results.name + ".mean", shape.mean);
    summary.set_place("shape_deviation." + results.name + ".at", shape.at);
    std::string line = fmt::format("{}: {:.2f} mm from the target form at most, {:.2f} mm in the mean", results.name,
                                   1e3 * shape.max, 1e3 * shape.mean);
    if (!foil.prestress.empty()) {
      const StressDeviation stress = stress_deviation(results, foil.prestress, area[b]);
      summary.set("stress_deviation." + results.name + ".rms", stress.rms);
      summary.set("stress_deviation." + results.name + ".max", stress.max);
      line += fmt::format("; stress {:.1f} % from the wanted one (rms), {:.1f} % at most", 100 * stress.rms,
                          100 * stress.max);
    }
    const FlatPoints flat = flat_points(target, b);
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const pipeline::state::Seam& seam : foil.seams) {
      for (const Index strip : {seam.left, seam.right}) {
        double flat_length = 0;
        double length = 0;
        for (std::size_t k = 0; k + 1 < seam.nodes.size(); ++k) {
          flat_length += (flat.at({strip, seam.nodes[k + 1]}) - flat.at({strip, seam.nodes[k]})).norm();
          length += (end.mesh.nodes[at(seam.nodes[k + 1])] - end.mesh.nodes[at(seam.nodes[k])]).norm();
        }
        least = std::min(least, length / flat_length - 1);
        most = std::max(most, length / flat_length - 1);
      }
    }
    if (!foil.seams.empty()) {
      summary.set("seam_strain." + results.name + ".max", most);
      summary.set("seam_strain." + results.name + ".min", least);
      line += fmt::format("; seams stretched by {:.3f} to {:.3f} %", 100 * least, 100 * most);
    }
    base::say(line);
  }
}

} // namespace pneuma::stages::inflate
