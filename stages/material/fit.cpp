// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/fit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"

namespace pneuma::stages::material {

namespace law = solver::material;

std::vector<TestPoint> rising_part(const TestCurve& test) {
  const int axis = driven_axis(test.ratio);
  const auto last =
      std::max_element(test.points.begin(), test.points.end(),
                       [axis](const TestPoint& a, const TestPoint& b) { return a.strain[axis] < b.strain[axis]; });
  return {test.points.begin(), last == test.points.end() ? last : last + 1};
}

FittedLaw fit(const TestCurve& test, const Options& options, double poissons_ratio, bool logarithmic) {
  const int axis = driven_axis(test.ratio);
  std::vector<law::CurvePoint> points;
  for (const TestPoint& point : rising_part(test)) {
    const double stretch = 1 + point.strain[axis];
    const double nominal = point.stress[axis];
    // weights that make the differences those of nominal stress
    if (logarithmic) {
      points.push_back({std::log(stretch), stretch * nominal, point.weight / (stretch * stretch)});
    } else {
      points.push_back({0.5 * (stretch * stretch - 1), nominal / stretch, point.weight * stretch * stretch});
    }
  }
  const auto found = law::fit_hardening(points, options.branches, options.softening);
  if (!found) {
    const auto is_pulled = [](const law::CurvePoint& point) { return point.strain > 0 && point.weight > 0; };
    const auto pulled = std::count_if(points.begin(), points.end(), is_pulled);
    const int enough = 2 * options.branches + 1;
    const std::string why =
        pulled < enough
            ? fmt::format("has {} points in tension up to its largest strain, fewer than the {} that so many "
                          "branches take; ask for fewer",
                          pulled, enough)
            : fmt::format("does not yield: its curve does not bend as that of a hardening foil{}",
                          options.softening ? "" : "; --softening is for one that falls");
    throw base::InputError(fmt::format("--fit {}: `{}` {}", options.branches, test.name, why));
  }
  return {*found, poissons_ratio, logarithmic};
}

law::Law law_of(const FittedLaw& fitted) {
  const law::Elasticity elasticity{fitted.hardening.youngs_modulus, fitted.poissons_ratio};
  const auto hardening = law::piecewise_linear(fitted.hardening.branches);
  if (!hardening) throw base::InputError("--fit: the yield stress falls below zero; ask for fewer branches");
  const law::Flow flow{*hardening, {}};
  return fitted.logarithmic ? law::Law(law::Logarithmic{elasticity, flow}) : law::Law(law::J2{elasticity, flow});
}

std::string yaml_of(const FittedLaw& fitted, const std::string& name, const std::string& source) {
  const auto megapascal = [](double value) { return fmt::format("{:.9g} MPa", value / 1e6); };
  std::string branches;
  bool softens = false;
  for (const law::HardeningBranch& branch : fitted.hardening.branches) {
    branches += fmt::format("{}{{stress: {}, modulus: {}}}", branches.empty() ? "" : ", ", megapascal(branch.stress),
                            megapascal(branch.modulus));
    softens = softens || branch.modulus < 0;
  }
  return fmt::format("{}:\n  law: j2\n  E: {}\n  nu: {:.9g}\n  hardening: [{}]\n  modulus: plastic\n  strain: {}\n{}"
                     "  source: \"{}\"",
                     name, megapascal(fitted.hardening.youngs_modulus), fitted.poissons_ratio, branches,
                     fitted.logarithmic ? "logarithmic" : "small", softens ? "  softening: true\n" : "", source);
}

} // namespace pneuma::stages::material
