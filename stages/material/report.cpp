// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/drawing/chart.h"
#include "pipeline/files/file.h"

namespace pneuma::stages::material {

namespace {

namespace drawing = pipeline::drawing;

constexpr int rows = 10;

// Stress along the driven axis at a strain, linear between the points of loading; none beyond their end.
std::optional<double> stress_at(const Curve& curve, double strain, bool true_measures) {
  const int axis = driven_axis(curve.ratio);
  for (std::size_t i = 1; i < curve.loading.size(); ++i) {
    const Shown a = shown(curve.loading[i - 1], true_measures);
    const Shown b = shown(curve.loading[i], true_measures);
    const double part = (strain - a.strain[axis]) / (b.strain[axis] - a.strain[axis]);
    constexpr double rounding = 1e-9;
    if (part <= 1 + rounding) return a.stress[axis] + part * (b.stress[axis] - a.stress[axis]);
  }
  return std::nullopt;
}

std::string rate_of(const Curve& curve) {
  return curve.rate ? fmt::format("{:g} 1/s", *curve.rate) : "";
}

std::vector<base::Vec2> points_of(const Curve& curve, bool true_measures) {
  const int axis = driven_axis(curve.ratio);
  std::vector<base::Vec2> points;
  for (const auto* part : {&curve.loading, &curve.unloading}) {
    for (const PieceState& state : *part) {
      const Shown at = shown(state, true_measures);
      points.emplace_back(100 * at.strain[axis], at.stress[axis] / 1e6);
    }
  }
  return points;
}

} // namespace

std::string table(std::span<const Curve> curves, const Options& options) {
  constexpr int first = 10, width = 12;
  std::string text = fmt::format("{:>{}}", "strain, %", first);
  for (const Curve& curve : curves) text += fmt::format("{:>{}}", name_of(curve.ratio), width);
  text += fmt::format("   {} stress, MPa\n", options.true_measures ? "Cauchy" : "nominal");
  if (curves.front().rate) {
    text += std::string(first, ' ');
    for (const Curve& curve : curves) text += fmt::format("{:>{}}", rate_of(curve), width);
    text += '\n';
  }
  for (int i = 1; i <= rows; ++i) {
    const double strain = options.strain * i / rows;
    text += fmt::format("{:{}.4g}", 100 * strain, first);
    for (const Curve& curve : curves) {
      const auto stress = stress_at(curve, strain, options.true_measures);
      text += fmt::format("{:>{}}", stress ? fmt::format("{:.4g}", *stress / 1e6) : "-", width);
    }
    text += '\n';
  }
  text += fmt::format("{:>{}}", "left, %", first);
  for (const Curve& curve : curves) {
    std::string left = "-";
    if (!curve.unloading.empty()) {
      const double strain = shown(curve.unloading.back(), options.true_measures).strain[driven_axis(curve.ratio)];
      constexpr double nothing = 1e-9; // of the largest strain
      left = fmt::format("{:.3g}", std::abs(strain) < nothing * options.strain ? 0.0 : 100 * strain);
    }
    text += fmt::format("{:>{}}", left, width);
  }
  return text + "   strain after unloading";
}

void write_csv(std::span<const Curve> curves, const Options& options) {
  const char* strain = options.true_measures ? "logarithmic_strain" : "strain";
  const char* stress = options.true_measures ? "cauchy_stress" : "stress";
  std::string text =
      fmt::format("material, ratio, rate [1/s], part, time [s], {0}_1 [-], {0}_2 [-], {1}_1 [MPa], "
                  "{1}_2 [MPa], thickness_stretch [-], stored_energy [MJ/m3], shear_strain [-], shear_stress "
                  "[MPa]\n",
                  strain, stress);
  for (const Curve& curve : curves) {
    for (const auto* part : {&curve.loading, &curve.unloading}) {
      for (const PieceState& state : *part) {
        const Shown at = shown(state, options.true_measures);
        fmt::format_to(std::back_inserter(text),
                       "{}, {}, {}, {}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}\n",
                       curve.material, name_of(curve.ratio), curve.rate ? fmt::format("{:g}", *curve.rate) : "",
                       part == &curve.loading ? "loading" : "unloading", state.time, at.strain[0], at.strain[1],
                       at.stress[0] / 1e6, at.stress[1] / 1e6, state.thickness_stretch, state.energy / 1e6,
                       at.strain[2], at.stress[2] / 1e6);
      }
    }
  }
  pipeline::files::write_file(options.csv, text);
}

void write_svg(std::span<const Curve> curves, std::span<const TestCurve> tests, const Options& options) {
  constexpr std::size_t most_names = 21; // that the legend has room for
  if (curves.size() + tests.size() > most_names) {
    throw base::InputError(
        fmt::format("--svg: {} curves do not fit into one picture, up to {} do; name fewer materials, "
                    "--ratios or rates",
                    curves.size() + tests.size(), most_names));
  }
  std::set<std::string> materials;
  std::vector<std::string> families; // curves of one material at one rate
  const auto family_of = [](const Curve& curve) { return curve.material + rate_of(curve); };
  for (const Curve& curve : curves) {
    materials.insert(curve.material);
    if (std::find(families.begin(), families.end(), family_of(curve)) == families.end()) {
      families.push_back(family_of(curve));
    }
  }
  // one family: a colour for each ratio; several: a colour for each, a stroke for each ratio
  const auto ratio_index = [&](const Ratio& ratio) {
    const auto same = [&](const Ratio& other) { return name_of(other) == name_of(ratio); };
    return static_cast<int>(std::find_if(options.ratios.begin(), options.ratios.end(), same) - options.ratios.begin());
  };
  constexpr drawing::Stroke strokes[] = {drawing::Stroke::solid, drawing::Stroke::dashed, drawing::Stroke::dotted};
  constexpr drawing::Mark marks[] = {drawing::Mark::circle, drawing::Mark::square, drawing::Mark::triangle,
                                     drawing::Mark::diamond};
  drawing::Chart chart;
  chart.title = materials.size() == 1 ? *materials.begin() : options.materials.filename().string();
  chart.x.label = options.true_measures ? "logarithmic strain, %" : "engineering strain, %";
  chart.y.label = options.true_measures ? "Cauchy stress, MPa" : "nominal stress, MPa";
  for (const Curve& curve : curves) {
    std::string name = name_of(curve.ratio);
    if (materials.size() > 1) name = curve.material + ", " + name;
    if (curve.rate) name += ", " + rate_of(curve);
    const auto family = std::find(families.begin(), families.end(), family_of(curve)) - families.begin();
    const int ratio = ratio_index(curve.ratio);
    chart.curves.push_back({name, points_of(curve, options.true_measures),
                            families.size() > 1 ? strokes[ratio % 3] : drawing::Stroke::solid, drawing::Mark::none,
                            1 + (families.size() > 1 ? static_cast<int>(family) : ratio)});
  }
  for (std::size_t i = 0; i < tests.size() && !options.true_measures; ++i) { // they are in the other measures
    const TestCurve& test = tests[i];
    const int axis = driven_axis(test.ratio);
    drawing::Curve curve{"test " + test.name, {}, drawing::Stroke::none, marks[i % 4], 0};
    constexpr std::size_t most = 40; // marks that can be told apart
    const std::size_t every = 1 + (test.points.size() - 1) / most;
    for (std::size_t k = 0; k < test.points.size(); k += every) {
      const TestPoint& point = test.points[k];
      curve.points.emplace_back(100 * point.strain[axis], point.stress[axis] / 1e6);
    }
    chart.curves.push_back(std::move(curve));
  }
  drawing::write_chart(chart, options.svg);
}

} // namespace pneuma::stages::material
