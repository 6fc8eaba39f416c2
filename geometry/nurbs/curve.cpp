// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/nurbs/curve.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace pneuma::geometry::nurbs {

template <int D>
void check(const Curve<D>& curve) {
  check(curve.knots);
  const auto functions = static_cast<std::size_t>(curve.knots.functions());
  if (curve.points.size() != functions) {
    throw std::invalid_argument(
        fmt::format("the knots ask for {} control points, not {}", functions, curve.points.size()));
  }
  if (!curve.weights.empty() && curve.weights.size() != functions) {
    throw std::invalid_argument(fmt::format("{} control points have {} weights", functions, curve.weights.size()));
  }
  for (const double weight : curve.weights) {
    if (!(weight > 0)) throw std::invalid_argument(fmt::format("weights must be positive, not {}", weight));
  }
}

template <int D>
CurveJet<D> evaluate(const Curve<D>& curve, double u) noexcept {
  Basis basis;
  evaluate_basis(curve.knots, u, 2, basis);
  CurveJet<D> a{Point<D>::Zero(), Point<D>::Zero(), Point<D>::Zero()};
  double w = 0;
  double w1 = 0;
  double w2 = 0;
  const bool rational = !curve.weights.empty();
  for (std::size_t j = 0; j <= static_cast<std::size_t>(curve.knots.degree); ++j) {
    const std::size_t i = static_cast<std::size_t>(basis.first) + j;
    const double weight = rational ? curve.weights[i] : 1;
    w += basis.functions[0][j] * weight;
    w1 += basis.functions[1][j] * weight;
    w2 += basis.functions[2][j] * weight;
    a.value += basis.functions[0][j] * weight * curve.points[i];
    a.first += basis.functions[1][j] * weight * curve.points[i];
    a.second += basis.functions[2][j] * weight * curve.points[i];
  }
  if (!rational) return a;
  CurveJet<D> c;
  c.value = a.value / w;
  c.first = (a.first - w1 * c.value) / w;
  c.second = (a.second - 2 * w1 * c.first - w2 * c.value) / w;
  return c;
}

template <int D>
std::optional<double> parameter_at(const Curve<D>& curve, int coordinate, double value) {
  double low = curve.knots.first();
  double high = curve.knots.last();
  const double at_low = curve.points.front()[coordinate];
  const double at_high = curve.points.back()[coordinate];
  if (!(value >= std::min(at_low, at_high) && value <= std::max(at_low, at_high))) return std::nullopt;
  const double sign = at_high >= at_low ? 1 : -1;
  double u = at_high == at_low ? low : low + (high - low) * (value - at_low) / (at_high - at_low);
  constexpr int enough = 200; // halving alone needs about 60
  for (int i = 0; i < enough; ++i) {
    const CurveJet<D> at = evaluate(curve, u);
    const double error = at.value[coordinate] - value;
    (sign * error <= 0 ? low : high) = u;
    const double newton = u - error / at.first[coordinate];
    constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    if (std::abs(newton - u) <= rounding * std::max(std::abs(u), high - low)) return u;
    u = newton > low && newton < high ? newton : 0.5 * (low + high); // false for NaN
  }
  return u;
}

template void check(const Curve<1>&);
template void check(const Curve<2>&);
template void check(const Curve<3>&);
template CurveJet<1> evaluate(const Curve<1>&, double) noexcept;
template CurveJet<2> evaluate(const Curve<2>&, double) noexcept;
template CurveJet<3> evaluate(const Curve<3>&, double) noexcept;
template std::optional<double> parameter_at(const Curve<1>&, int, double);
template std::optional<double> parameter_at(const Curve<2>&, int, double);
template std::optional<double> parameter_at(const Curve<3>&, int, double);

} // namespace pneuma::geometry::nurbs
