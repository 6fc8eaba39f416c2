// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/nurbs/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace pneuma::geometry::nurbs {

using base::Mat2;
using base::Vec2;

template <int D>
void check(const Surface<D>& surface) {
  check(surface.u);
  check(surface.v);
  const std::size_t functions =
      static_cast<std::size_t>(surface.u.functions()) * static_cast<std::size_t>(surface.v.functions());
  if (surface.points.size() != functions) {
    throw std::invalid_argument(fmt::format("the knots ask for {} x {} control points, not {}", surface.u.functions(),
                                            surface.v.functions(), surface.points.size()));
  }
  if (!surface.weights.empty() && surface.weights.size() != functions) {
    throw std::invalid_argument(fmt::format("{} control points have {} weights", functions, surface.weights.size()));
  }
  for (const double weight : surface.weights) {
    if (!(weight > 0)) throw std::invalid_argument(fmt::format("weights must be positive, not {}", weight));
  }
}

namespace {

// sum over the net of basis functions times `coefficient(number of control point)`, with derivatives
template <class T, class F>
void add_up(const Basis& u, const Basis& v, int degree_u, int degree_v, std::size_t columns, const F& coefficient,
            const T& zero, std::array<T, 6>& sums) {
  sums.fill(zero);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(degree_u); ++i) {
    const std::size_t row = (static_cast<std::size_t>(u.first) + i) * columns + static_cast<std::size_t>(v.first);
    T value = zero;
    T first = zero;
    T second = zero;
    for (std::size_t j = 0; j <= static_cast<std::size_t>(degree_v); ++j) {
      const T& c = coefficient(row + j);
      value += v.functions[0][j] * c;
      first += v.functions[1][j] * c;
      second += v.functions[2][j] * c;
    }
    sums[0] += u.functions[0][i] * value;
    sums[1] += u.functions[1][i] * value;
    sums[2] += u.functions[0][i] * first;
    sums[3] += u.functions[2][i] * value;
    sums[4] += u.functions[1][i] * first;
    sums[5] += u.functions[0][i] * second;
  }
}

} // namespace

template <int D>
SurfaceJet<D> evaluate(const Surface<D>& surface, double u, double v) noexcept {
  Basis in_u;
  Basis in_v;
  evaluate_basis(surface.u, u, 2, in_u);
  evaluate_basis(surface.v, v, 2, in_v);
  const auto columns = static_cast<std::size_t>(surface.v.functions());
  SurfaceJet<D> s;
  if (surface.weights.empty()) {
    if constexpr (D == 1) {
      std::array<double, 6> a;
      add_up<double>(
          in_u, in_v, surface.u.degree, surface.v.degree, columns,
          [&](std::size_t i) -> const double& { return surface.points[i][0]; }, 0.0, a);
      s.value[0] = a[0];
      s.u[0] = a[1];
      s.v[0] = a[2];
      s.uu[0] = a[3];
      s.uv[0] = a[4];
      s.vv[0] = a[5];
    } else {
      std::array<Point<D>, 6> a;
      add_up<Point<D>>(
          in_u, in_v, surface.u.degree, surface.v.degree, columns,
          [&](std::size_t i) -> const Point<D>& { return surface.points[i]; }, Point<D>::Zero(), a);
      s = {a[0], a[1], a[2], a[3], a[4], a[5]};
    }
    return s;
  }
  std::array<double, 6> w;
  add_up<double>(
      in_u, in_v, surface.u.degree, surface.v.degree, columns,
      [&](std::size_t i) -> const double& { return surface.weights[i]; }, 0.0, w);
  std::array<Point<D>, 6> a;
  add_up<Point<D>>(
      in_u, in_v, surface.u.degree, surface.v.degree, columns,
      [&](std::size_t i) -> Point<D> { return surface.weights[i] * surface.points[i]; }, Point<D>::Zero(), a);
  s.value = a[0] / w[0];
  s.u = (a[1] - w[1] * s.value) / w[0];
  s.v = (a[2] - w[2] * s.value) / w[0];
  s.uu = (a[3] - 2 * w[1] * s.u - w[3] * s.value) / w[0];
  s.uv = (a[4] - w[1] * s.v - w[2] * s.u - w[4] * s.value) / w[0];
  s.vv = (a[5] - 2 * w[2] * s.v - w[5] * s.value) / w[0];
  return s;
}

namespace {

template <int D>
std::optional<Vec2> descend(const Surface<D>& surface, const Vec2& place, Vec2 at, double size) {
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  SurfaceJet<D> s = evaluate(surface, at[0], at[1]);
  Vec2 miss = s.value.template head<2>() - place;
  constexpr int enough = 60;
  for (int iteration = 0; iteration < enough && miss.norm() > 0; ++iteration) {
    Mat2 slope;
    slope << s.u.template head<2>(), s.v.template head<2>();
    const Vec2 step = slope.inverse() * miss;
    if (!step.allFinite()) return std::nullopt;
    double part = 1;
    Vec2 next;
    Vec2 next_miss;
    for (int halvings = 0; halvings < 30; ++halvings, part /= 2) {
      next[0] = std::clamp(at[0] - part * step[0], surface.u.first(), surface.u.last());
      next[1] = std::clamp(at[1] - part * step[1], surface.v.first(), surface.v.last());
      s = evaluate(surface, next[0], next[1]);
      next_miss = s.value.template head<2>() - place;
      if (next_miss.norm() < miss.norm()) break;
    }
    if (!(next_miss.norm() < miss.norm())) break;
    at = next;
    miss = next_miss;
  }
  return miss.norm() <= rounding * size ? std::optional<Vec2>(at) : std::nullopt;
}

} // namespace

template <int D>
std::optional<Vec2> parameters_at(const Surface<D>& surface, const Vec2& place) {
  const std::vector<double> us = greville(surface.u);
  const std::vector<double> vs = greville(surface.v);
  struct Start {
    double distance;
    Vec2 at;
  };
  std::vector<Start> starts;
  double size = place.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < us.size(); ++i) {
    for (std::size_t j = 0; j < vs.size(); ++j) {
      const Vec2 corner = surface.points[i * vs.size() + j].template head<2>();
      size = std::max(size, corner.cwiseAbs().maxCoeff());
      starts.push_back({(corner - place).norm(), Vec2(us[i], vs[j])});
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.distance < b.distance; });
  for (const Start& start : starts) {
    if (std::optional<Vec2> at = descend(surface, place, start.at, size)) return at;
  }
  return std::nullopt;
}

template void check(const Surface<1>&);
template void check(const Surface<2>&);
template void check(const Surface<3>&);
template SurfaceJet<1> evaluate(const Surface<1>&, double, double) noexcept;
template SurfaceJet<2> evaluate(const Surface<2>&, double, double) noexcept;
template SurfaceJet<3> evaluate(const Surface<3>&, double, double) noexcept;
template std::optional<Vec2> parameters_at(const Surface<2>&, const Vec2&);
template std::optional<Vec2> parameters_at(const Surface<3>&, const Vec2&);

} // namespace pneuma::geometry::nurbs
