// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/nurbs_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "geometry/nurbs/fit.h"
#include "solver/material/pd_nurbs.h"

namespace pneuma::solver::material {

namespace nurbs = geometry::nurbs;
using base::Vec2;

namespace {

constexpr double smoothing_of_law = 1e-10;
constexpr double smoothing_of_points = 1e-7;
// Of what points add to the table of a law that yields. They part from it at a corner of their own, along which a
// surface must not swing, and what they say should go on beside them, not end.
constexpr double smoothing_of_rest = 1e-5;
constexpr double most_smoothing = 1e-3;

// The fit with the wanted smoothing or, where that is left open, with the least from `least` on, in powers of ten, that
// lets the stress rise everywhere: points leave ridges beside the lines of their tests. Where none does, with the
// least.
template <class F>
auto smooth(const std::optional<double>& wanted, double least, const F& fit) {
  auto first = fit(wanted.value_or(least));
  if (wanted || first.report.monotone) return first;
  for (double smoothing = 10 * least; smoothing < 2 * most_smoothing; smoothing *= 10) {
    auto found = fit(smoothing);
    if (found.report.monotone) return found;
  }
  return first;
}

// Weight of a law against points, where a surface is of both, and where it is of the rest.
constexpr double fill_of_law = 1e-3;
constexpr double fill_of_rest = 1e-6;

double logarithmic(double strain) {
  return 0.5 * std::log1p(2 * strain);
}

void check(const NurbsOptions& options) {
  if (options.degree < 2 || options.degree > nurbs::max_degree - 1) {
    throw std::invalid_argument(
        fmt::format("the degree of a table must be 2 to {}, not {}: of degree 1 the tangent jumps",
                    nurbs::max_degree - 1, options.degree));
  }
  for (const int n : options.net) {
    if (n <= options.degree || n > 200) {
      throw std::invalid_argument(fmt::format("a net of degree {} has {} to 200 control points a side, not {}",
                                              options.degree, options.degree + 1, n));
    }
  }
  if (options.knee && !(*options.knee > 0)) {
    throw std::invalid_argument(fmt::format("knee must be a positive strain, not {}", *options.knee));
  }
  if (options.range && !(options.range->min > -0.5 && options.range->min <= 0 && options.range->max > 0)) {
    throw std::invalid_argument(
        fmt::format("the range of strains must begin between -0.5 and 0 and end above 0, not at {} "
                    "and {}",
                    options.range->min, options.range->max));
  }
}

void check(const StressPoint& point, std::size_t number, const std::optional<StrainRange>& range) {
  if (!std::isfinite(point.e1) || !std::isfinite(point.e2) || !(std::min(point.e1, point.e2) > -0.5)) {
    throw std::invalid_argument(
        fmt::format("point {}: strains {} and {} must be above -0.5", number + 1, point.e1, point.e2));
  }
  if (std::isinf(point.s1) || std::isinf(point.s2) || !(point.weight >= 0)) {
    throw std::invalid_argument(
        fmt::format("point {}: stresses {}, {} and weight {}", number + 1, point.s1, point.s2, point.weight));
  }
  if (range && (std::min(point.e1, point.e2) < range->min || std::max(point.e1, point.e2) > range->max)) {
    throw std::invalid_argument(fmt::format("point {}: strains {} and {} lie outside the range {} to {}", number + 1,
                                            point.e1, point.e2, range->min, range->max));
  }
}

StrainRange range_of(std::span<const StressPoint> points, const std::optional<StrainRange>& wanted) {
  if (wanted) return *wanted;
  StrainRange range;
  for (const StressPoint& point : points) {
    range.min = std::min({range.min, point.e1, point.e2});
    range.max = std::max({range.max, point.e1, point.e2});
  }
  if (!(range.max > 0)) throw std::invalid_argument("a table needs points with a positive strain");
  range.min = std::min(range.min, -range.max / 20);
  return range;
}

// Corners of the convex hull, counterclockwise (Andrew 1979, Inf. Process. Lett. 9).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]); });
  const auto turns_left = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0;
  };
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const Vec2& point : points) {
      while (hull.size() >= begin + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

TableDomain domain_of(std::span<const StressPoint> points, StrainRange range, bool symmetric) {
  std::vector<Vec2> places;
  const double near = std::min(-range.min, range.max / 20);
  for (const double x : {-near, near}) {
    for (const double y : {-near, near}) places.emplace_back(x, y);
  }
  for (const StressPoint& point : points) {
    if (point.weight == 0) continue;
    places.emplace_back(point.e1, point.e2);
    if (symmetric) places.emplace_back(point.e2, point.e1);
  }
  const std::vector<Vec2> hull = convex_hull(std::move(places));
  TableDomain domain{range, {}};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2& from = hull[i];
    const Vec2 along = (hull[(i + 1) % hull.size()] - from).normalized();
    const TableBorder border{along[1], -along[0], along[1] * from[0] - along[0] * from[1]};
    // not those along the range's own
    if (std::max(std::abs(border.a), std::abs(border.b)) < 1 - 1e-12 ||
        border.c < (border.a + border.b > 0 ? range.max : -range.min) - 1e-12) {
      domain.borders.push_back(border);
    }
  }
  return domain;
}

// Into how many parts the spans of a row of the net are cut where a law is asked: three, of coarse nets so many that
// there are twice as many as the potential has control points in the row.
int parts_of_span(int net, int degree) {
  const int spans = net - degree;
  return std::max(3, (2 * (net + 1) + spans - 1) / spans);
}

// Strains at which a law is asked: borders of spans and the places between that cut them into equal parts.
std::vector<double> places_in(const std::vector<double>& breaks, int parts = 3) {
  std::vector<double> places;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int part = 0; part < parts; ++part) {
      places.push_back(breaks[i] + static_cast<double>(part) / parts * (breaks[i + 1] - breaks[i]));
    }
  }
  places.push_back(breaks.back());
  return places;
}

std::vector<Vec2> pairs(std::span<const double> first, std::span<const double> second) {
  std::vector<Vec2> result;
  for (const double a : first) {
    for (const double b : second) result.emplace_back(a, b);
  }
  return result;
}

// What a law's material answers, without its tension field, in one step from the unloaded state.
bool ask(const Law& law, const Vec3& strain, double time, Response& response) {
  std::vector<double> history(static_cast<std::size_t>(2 * history_components(law)), 0.0);
  const double* old_history = history.data();
  double* new_history = history.data() + history_components(law);
  const Status status = std::visit(
      [&]<Material M>(const M& m) {
        if constexpr (requires { m.relaxed(strain, old_history); }) {
          return m.law.evaluate(strain, old_history, new_history, time, response);
        } else {
          return m.evaluate(strain, old_history, new_history, time, response);
        }
      },
      law);
  return status == Status::ok && response.stress.allFinite();
}

// Half of the sizes lie below.
double median(std::vector<double> sizes) {
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  return sizes[sizes.size() / 2];
}

// Weight of a stress of this size: errors of stresses beyond the usual count relative to them.
double weight_of(double size, double usual) {
  return usual > 0 ? std::pow(usual / (usual + size), 2) : 1;
}

// An isotropic law answers turned strain with turned stress.
void check_isotropic(const Law& law, StrainRange range, double time) {
  const double e1 = 0.7 * range.max;
  const double e2 = 0.2 * range.max;
  Response straight;
  Response turned;
  if (!ask(law, Vec3(e1, e2, 0), time, straight)) return;
  for (const double angle : {std::acos(0.0), 0.4}) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const Vec3 strain(c * c * e1 + s * s * e2, s * s * e1 + c * c * e2, 2 * c * s * (e1 - e2));
    if (!ask(law, strain, time, turned)) continue;
    const double s1 = straight.stress[0];
    const double s2 = straight.stress[1];
    const Vec3 expected(c * c * s1 + s * s * s2, s * s * s1 + c * c * s2, c * s * (s1 - s2));
    constexpr double local_iterations = 1e-7; // what plastic laws may leave
    if ((turned.stress - expected).cwiseAbs().maxCoeff() > local_iterations * straight.stress.cwiseAbs().maxCoeff()) {
      throw std::invalid_argument("the law to fit depends on the direction, pd_nurbs does not: use le_nurbs");
    }
  }
}

// Knees to choose from: parts of the largest logarithmic strain, and none.
std::vector<std::optional<double>> knees(StrainRange range) {
  const double largest = std::max(-logarithmic(range.min), logarithmic(range.max));
  std::vector<std::optional<double>> result = {std::nullopt};
  for (const double part : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) result.emplace_back(part * largest);
  return result;
}

// The knee with which linear interpolation between the breaks follows a law best, along lines through its range; the
// errors of stresses beyond the median count relative to them.
std::optional<double> best_knee(const Law& law, StrainRange range, int spans, double time) {
  const double largest = std::max(-logarithmic(range.min), logarithmic(range.max));
  const std::vector<double> lines = strain_breaks(range, 8, largest / 10);
  const std::vector<StressPoint> points = sample(law, pairs(lines, lines), time);
  std::vector<double> sizes;
  for (const StressPoint& point : points) sizes.push_back(std::hypot(point.s1, point.s2));
  const double usual = median(std::move(sizes));
  std::optional<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::optional<double>& knee : knees(range)) {
    const std::vector<double> ends = strain_breaks(range, spans, knee);
    double error = 0;
    Response left;
    Response middle;
    Response right;
    for (const double line : lines) {
      bool known = ask(law, Vec3(ends[0], line, 0), time, left);
      for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const bool next = ask(law, Vec3(ends[i + 1], line, 0), time, right);
        if (known && next && ask(law, Vec3(0.5 * (ends[i] + ends[i + 1]), line, 0), time, middle)) {
          const Vec3 miss = middle.stress - 0.5 * (left.stress + right.stress);
          error = std::max(error, weight_of(middle.stress.head<2>().norm(), usual) * miss.head<2>().squaredNorm());
        }
        known = next;
        left = right;
      }
    }
    if (error < 0.98 * least) {
      least = error;
      best = knee;
    }
  }
  return best;
}

// Stresses of a table along (first) and across (second) a direction, with derivatives.
struct TableStress {
  double first, second;
  double d11, d12, d21, d22;
};

// Of strains without shear.
TableStress along_axes(const Response& r) {
  return {r.stress[0], r.stress[1], r.tangent(0, 0), r.tangent(0, 1), r.tangent(1, 0), r.tangent(1, 1)};
}

// The least slope of a stress by its own strain: of the Kirchhoff stress, or of S.
double least_slope(const TableStress& at, const Vec2& e, bool of_kirchhoff) {
  if (!of_kirchhoff) return std::min(at.d11, at.d22);
  return std::min(2 * at.first + (1 + 2 * e[0]) * at.d11, 2 * at.second + (1 + 2 * e[1]) * at.d22);
}

// Monotony of the Kirchhoff stress, or of S, and integrability, looked for at these strains.
template <class F>
void judge(const F& stress, bool of_kirchhoff, const TableDomain& domain, std::span<const Vec2> places,
           FitReport& report) {
  double least = std::numeric_limits<double>::infinity();
  double stiffest = 0;
  double defect = 0;
  for (const Vec2& e : places) {
    if (!domain.holds(e[0], e[1])) continue;
    const TableStress at = stress(e[0], e[1]);
    const double slope = least_slope(at, e, of_kirchhoff);
    if (slope < least) {
      least = slope;
      report.not_monotone = e;
    }
    stiffest = std::max({stiffest, std::abs(at.d11), std::abs(at.d12), std::abs(at.d21), std::abs(at.d22)});
    defect = std::max(defect, std::abs(at.d12 - at.d21));
  }
  report.monotone = least >= 0;
  report.integrability_defect = stiffest > 0 ? defect / stiffest : 0;
}

// Stresses as derivatives of a potential.
std::vector<nurbs::SurfaceObservation> gradients(std::span<const StressPoint> points) {
  std::vector<nurbs::SurfaceObservation> result;
  for (const StressPoint& p : points) {
    if (!std::isnan(p.s1)) result.push_back({p.e1, p.e2, 1, 0, p.s1, p.weight});
    if (!std::isnan(p.s2)) result.push_back({p.e1, p.e2, 0, 1, p.s2, p.weight});
  }
  if (result.empty()) throw std::invalid_argument("a table needs points with stresses");
  return result;
}

double sum_of_weights(const std::vector<nurbs::SurfaceObservation>& observations) {
  double sum = 0;
  for (const nurbs::SurfaceObservation& o : observations) sum += o.weight;
  return sum;
}

// How a table's stress follows the first `reported` of the points and, beyond them, those that fill.
template <class F>
void report_misfit(const F& stress, std::span<const StressPoint> points, std::size_t reported, FitReport& report) {
  double sum = 0;
  double weights = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StressPoint& p = points[i];
    const TableStress at = stress(p.e1, p.e2);
    for (const auto& [ours, theirs] : {std::pair(at.first, p.s1), {at.second, p.s2}}) {
      if (std::isnan(theirs) || p.weight == 0) continue;
      const double miss = std::abs(ours - theirs);
      if (i >= reported) {
        report.max_from_fill = std::max(report.max_from_fill, miss);
        continue;
      }
      sum += p.weight * miss * miss;
      weights += p.weight;
      report.largest_stress = std::max(report.largest_stress, std::abs(theirs));
      if (miss >= report.max) {
        report.max = miss;
        report.where = Vec2(p.e1, p.e2);
      }
    }
  }
  report.rms = std::sqrt(sum / weights);
}

// The potential whose derivatives follow the points best, with W = 0 and no stress at zero strain.
nurbs::SurfaceFit fit_potential(const nurbs::Knots& first, const nurbs::Knots& second,
                                std::vector<nurbs::SurfaceObservation> all, bool symmetric, double smoothing) {
  const double sum = sum_of_weights(all);
  const double size = first.last() - first.first();
  all.push_back({0, 0, 0, 0, 0, sum / (size * size)}); // the constant, seen by nothing else
  all.push_back({0, 0, 1, 0, 0, sum});
  all.push_back({0, 0, 0, 1, 0, sum});
  nurbs::SurfaceFit fit = nurbs::fit(first, second, all, {smoothing, 3, true, symmetric});
  // what is left of them, to rounding: control values at the Greville abscissae are a linear function
  for (int repeat = 0; repeat < 2; ++repeat) {
    const nurbs::SurfaceJet<1> zero = nurbs::evaluate(fit.surface, 0, 0);
    const double slope_v = symmetric ? zero.u[0] : zero.v[0];
    const std::vector<double> us = nurbs::greville(first);
    const std::vector<double> vs = nurbs::greville(second);
    std::size_t k = 0;
    for (const double u : us) {
      for (const double v : vs) fit.surface.points[k++][0] -= zero.value[0] + zero.u[0] * u + slope_v * v;
    }
  }
  return fit;
}

// A stress as a surface of its own, with no stress at zero strain.
nurbs::SurfaceFit fit_stress(const nurbs::Knots& first, const nurbs::Knots& second,
                             std::vector<nurbs::SurfaceObservation> observations, double smoothing) {
  observations.push_back({0, 0, 0, 0, 0, sum_of_weights(observations)});
  nurbs::SurfaceFit fit = nurbs::fit(first, second, observations, {smoothing, 2, false, false});
  const double left = nurbs::evaluate(fit.surface, 0, 0).value[0];
  for (nurbs::Point<1>& point : fit.surface.points) point[0] -= left;
  return fit;
}

double smallest_span(const std::vector<double>& breaks) {
  double smallest = breaks.back() - breaks.front();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) smallest = std::min(smallest, breaks[i + 1] - breaks[i]);
  return smallest;
}

// The knee whose potential follows points best.
std::optional<double> best_knee(std::span<const StressPoint> points, StrainRange range, bool symmetric,
                                const NurbsOptions& options) {
  const double smoothing = options.smoothing.value_or(smoothing_of_points);
  const std::vector<nurbs::SurfaceObservation> observations = gradients(points);
  std::optional<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::optional<double>& knee : knees(range)) {
    const auto knots = [&](int points_of_net) {
      return nurbs::from_breaks(options.degree + 1, strain_breaks(range, points_of_net - options.degree, knee));
    };
    const double rms =
        fit_potential(knots(options.net[0]), knots(options.net[1]), observations, symmetric, smoothing).residuals.rms;
    if (rms < 0.98 * least) {
      least = rms;
      best = knee;
    }
  }
  return best;
}

// What a table's report says of its points and of its stress at these strains.
void report(const std::shared_ptr<const PdTable>& table, std::span<const StressPoint> points, std::size_t reported,
            std::span<const Vec2> places, FitReport& report) {
  const auto stress = [law = PdNurbs{table, true, 0.5}](double e1, double e2) {
    Response response;
    law.evaluate(Vec3(e1, e2, 0), nullptr, nullptr, 0, response);
    return along_axes(response);
  };
  report_misfit(stress, points, reported, report);
  const bool is_of_small_strain = table->yield && !table->yield->logarithmic; // S is what rises in such a law
  judge(stress, !is_of_small_strain, table->domain, places, report);
}

// The points' stresses less those of a table.
std::vector<StressPoint> less(std::span<const StressPoint> points, const YieldTable& table) {
  std::vector<StressPoint> rest(points.begin(), points.end());
  for (StressPoint& p : rest) {
    double unused = 0;
    const PrincipalFunction f = table.stress(principal_strain(Vec3(p.e1, p.e2, 0)), unused);
    p.s1 -= p.e1 >= p.e2 ? f.s1 : f.s2;
    p.s2 -= p.e1 >= p.e2 ? f.s2 : f.s1;
  }
  return rest;
}

// A table of surfaces over the strains through the first `reported` of the points and those that fill; with `yield`
// through what that leaves of them.
PdFit pd_fit(std::span<const StressPoint> points, std::size_t reported, StrainRange range, std::optional<double> knee,
             double smoothing, const NurbsOptions& options, const std::optional<YieldTable>& yield = {}) {
  const std::vector<double> ends = strain_breaks(range, options.net[0] - options.degree, knee);
  const nurbs::Knots of_potential = nurbs::from_breaks(options.degree + 1, ends);
  auto table = std::make_shared<PdTable>();
  PdFit fit;
  fit.report.smoothing = smoothing;
  table->yield = yield;
  std::vector<nurbs::SurfaceObservation> observations = yield ? gradients(less(points, *yield)) : gradients(points);
  nurbs::SurfaceFit potential = fit_potential(of_potential, of_potential, observations, true, smoothing);
  fit.report.uncovered = potential.residuals.uncovered;
  table->potential = std::move(potential.surface);
  table->domain = domain_of(points, range, true);
  // rounding of the difference against kinks of the second derivatives within it
  table->near = 1e-4 * smallest_span(ends);
  if (!options.potential) {
    for (nurbs::SurfaceObservation& o : observations) { // S2(a, b) = S1(b, a)
      if (o.order_v == 1) std::swap(o.u, o.v);
      o.order_u = o.order_v = 0;
    }
    const nurbs::Knots of_stress = nurbs::from_breaks(options.degree, ends);
    nurbs::SurfaceFit stress = fit_stress(of_stress, of_stress, observations, smoothing);
    fit.report.uncovered = stress.residuals.uncovered;
    table->stress = std::move(stress.surface);
  }
  fit.table = std::move(table);
  const std::vector<double> places = places_in(ends);
  report(fit.table, points, reported, pairs(places, places), fit.report);
  return fit;
}

// What of a law's table is known without a fit, if the law yields; `beyond` is empty.
std::optional<YieldTable> until_yield(const Law& law) {
  const auto of = [](const auto& m) -> std::optional<YieldTable> {
    using M = std::decay_t<decltype(m)>;
    if constexpr (std::is_same_v<M, J2> || std::is_same_v<M, Logarithmic>) {
      const double yield = m.flow.onset(0);
      if (yield > 0 && std::isfinite(yield)) return YieldTable{m.elasticity, yield, std::is_same_v<M, Logarithmic>, {}};
    }
    return std::nullopt;
  };
  return std::visit(
      [&]<class M>(const M& m) {
        if constexpr (requires { m.law; }) {
          return of(m.law);
        } else {
          return of(m);
        }
      },
      law);
}

// Coordinates of a YieldTable.
Vec2 around_yield(const YieldTable& table, double e1, double e2) {
  const double a = table.logarithmic ? logarithmic(e1) : e1;
  const double b = table.logarithmic ? logarithmic(e2) : e2;
  const double x = table.of_sum() * (a + b);
  const double r = std::hypot(x, table.of_difference() * (a - b));
  return {r, x / r};
}

Vec2 strains_at(const YieldTable& table, double r, double v) {
  const double half_sum = 0.5 * r * v / table.of_sum();
  const double half_difference = 0.5 * r * std::sqrt(1 - v * v) / table.of_difference();
  const Vec2 e(half_sum + half_difference, half_sum - half_difference);
  return table.logarithmic ? Vec2(0.5 * std::expm1(2 * e[0]), 0.5 * std::expm1(2 * e[1])) : e;
}

// The largest r of a range of strains.
double reach(const YieldTable& table, StrainRange range) {
  return std::max({around_yield(table, range.max, range.max)[0], around_yield(table, range.max, range.min)[0],
                   around_yield(table, range.min, range.min)[0]});
}

// The table of a law that yields, and where it was asked for.
struct BeyondYield {
  YieldTable table;
  std::vector<Vec2> strains;
  double uncovered = 0;
};

// Over r up to `reach` > 1 with spans that grow with it.
BeyondYield fit_beyond_yield(const Law& law, YieldTable yield, double reach, const NurbsOptions& options, double time) {
  const int spans = options.net[0] - options.degree;
  std::vector<double> in_r;
  std::vector<double> in_v;
  for (int i = 0; i <= spans; ++i) {
    in_r.push_back(std::pow(reach, static_cast<double>(i) / spans));
    in_v.push_back(-1 + 2.0 * i / spans);
  }
  // in the middles of the parts: not at v = -1 and 1, where a direction is lost
  const int parts = parts_of_span(options.net[0], options.degree);
  std::vector<Vec2> strains;
  for (int i = 0; i < parts * spans; ++i) {
    for (int j = 0; j < parts * spans; ++j) {
      const auto in = [&](const std::vector<double>& ends, int place) {
        const auto span = static_cast<std::size_t>(place / parts);
        return ends[span] + (place % parts + 0.5) / parts * (ends[span + 1] - ends[span]);
      };
      const Vec2 e = strains_at(yield, in(in_r, i), in(in_v, j));
      if (e.minCoeff() > -0.5) strains.push_back(e);
    }
  }
  const std::vector<StressPoint> points = sample(law, strains, time);
  std::vector<nurbs::SurfaceObservation> observations;
  for (const StressPoint& p : points) {
    const Vec2 at = around_yield(yield, p.e1, p.e2);
    const double r = at[0];
    const double v = at[1];
    const double s = std::sqrt(1 - v * v);
    const double t1 = yield.logarithmic ? p.s1 * (1 + 2 * p.e1) : p.s1;
    const double t2 = yield.logarithmic ? p.s2 * (1 + 2 * p.e2) : p.s2;
    const double by_x = 0.5 * (t1 + t2) / yield.of_sum();
    const double by_y = 0.5 * (t1 - t2) / yield.of_difference();
    observations.push_back({r, v, 1, 0, v * by_x + s * by_y - 2 * yield.on_curve(v), p.weight});
    observations.push_back(
        {r, v, 0, 1, r * (by_x - v / s * by_y) - (2 * r - 1) * yield.slope_on_curve(v), p.weight / (r * r)});
  }
  observations.push_back({1, 0, 0, 0, 0, 1}); // the constant, seen by nothing else
  nurbs::SurfaceFit beyond =
      nurbs::fit(nurbs::from_breaks(options.degree + 1, in_r), nurbs::from_breaks(options.degree + 1, in_v),
                 observations, {smoothing_of_law, 3, true, false, 2});
  yield.beyond = std::move(beyond.surface);
  return {std::move(yield), std::move(strains), beyond.residuals.uncovered};
}

// A table that is no more than that, and how it follows the law.
PdFit with_report(const Law& law, BeyondYield beyond, StrainRange range, const NurbsOptions& options, double time) {
  auto table = std::make_shared<PdTable>();
  table->yield = std::move(beyond.table);
  table->domain.range = range;
  PdFit fit{std::move(table), {}};
  fit.report.smoothing = smoothing_of_law;
  fit.report.uncovered = beyond.uncovered;
  std::vector<Vec2> strains = std::move(beyond.strains);
  // where it was not fitted, too, and at the corners of the range
  const std::vector<double> places = places_in(strain_breaks(range, options.net[0], {}));
  const std::vector<Vec2> between = pairs(places, places);
  strains.insert(strains.end(), between.begin(), between.end());
  std::erase_if(strains, [&](const Vec2& e) { return !fit.table->domain.holds(e[0], e[1]); });
  const std::vector<StressPoint> held = sample(law, strains, time);
  // where the law is level it has no slope whose sign a table could keep
  std::erase_if(strains, [&](const Vec2& e) {
    Response response;
    constexpr double level = 1e-3; // of the elastic stiffness
    return !ask(law, Vec3(e[0], e[1], 0), time, response) ||
           !(least_slope(along_axes(response), e, fit.table->yield->logarithmic) >
             level * fit.table->yield->elasticity.youngs_modulus);
  });
  report(fit.table, held, held.size(), strains, fit.report);
  return fit;
}

LeFit le_fit(std::span<const StressPoint> points, std::span<const ShearPoint> shear, StrainRange range,
             std::optional<double> knee, double smoothing, const NurbsOptions& options) {
  auto table = std::make_shared<LeTable>();
  LeFit fit;
  fit.report.smoothing = fit.shear_report.smoothing = smoothing;
  const std::vector<double> ends1 = strain_breaks(range, options.net[0] - options.degree, knee);
  const std::vector<double> ends2 = strain_breaks(range, options.net[1] - options.degree, knee);
  const std::vector<nurbs::SurfaceObservation> observations = gradients(points);
  nurbs::SurfaceFit potential =
      fit_potential(nurbs::from_breaks(options.degree + 1, ends1), nurbs::from_breaks(options.degree + 1, ends2),
                    observations, false, smoothing);
  fit.report.uncovered = potential.residuals.uncovered;
  table->potential = std::move(potential.surface);
  table->domain = domain_of(points, range, false);
  if (!options.potential) {
    std::vector<nurbs::SurfaceObservation> first;
    std::vector<nurbs::SurfaceObservation> second;
    for (const nurbs::SurfaceObservation& o : observations) {
      (o.order_u == 1 ? first : second).push_back({o.u, o.v, 0, 0, o.value, o.weight});
    }
    const nurbs::Knots knots1 = nurbs::from_breaks(options.degree, ends1);
    const nurbs::Knots knots2 = nurbs::from_breaks(options.degree, ends2);
    nurbs::SurfaceFit s11 = fit_stress(knots1, knots2, std::move(first), smoothing);
    nurbs::SurfaceFit s22 = fit_stress(knots1, knots2, std::move(second), smoothing);
    fit.report.uncovered = std::max(s11.residuals.uncovered, s22.residuals.uncovered);
    table->first = std::move(s11.surface);
    table->second = std::move(s22.surface);
  }
  const auto stress = [&](double e1, double e2) {
    if (!table->first) {
      const nurbs::SurfaceJet<1> w = nurbs::evaluate(table->potential, e1, e2);
      return TableStress{w.u[0], w.v[0], w.uu[0], w.uv[0], w.uv[0], w.vv[0]};
    }
    const nurbs::SurfaceJet<1> s1 = nurbs::evaluate(*table->first, e1, e2);
    const nurbs::SurfaceJet<1> s2 = nurbs::evaluate(*table->second, e1, e2);
    return TableStress{s1.value[0], s2.value[0], s1.u[0], s1.v[0], s2.u[0], s2.v[0]};
  };
  report_misfit(stress, points, points.size(), fit.report);
  judge(stress, true, table->domain, pairs(places_in(ends1), places_in(ends2)), fit.report);

  double largest = 0;
  for (const ShearPoint& point : shear) {
    if (!std::isfinite(point.gamma) || !std::isfinite(point.s12) || !(point.weight >= 0)) {
      throw std::invalid_argument(
          fmt::format("shear point with strain {}, stress {} and weight {}", point.gamma, point.s12, point.weight));
    }
    largest = std::max(largest, std::abs(point.gamma));
  }
  if (!(largest > 0)) throw std::invalid_argument("le_nurbs needs points of shear strain and stress");
  // as many spans on each side of zero as the surface has in all
  const int half = options.net[0] - options.degree;
  std::vector<double> ends;
  for (int i = -half; i <= half; ++i) {
    const double part = static_cast<double>(i) / half;
    const double size = knee ? 2 * *knee : 0; // 2 E12 of the strain at the knee
    ends.push_back(i == half ? largest : knee ? size * std::sinh(part * std::asinh(largest / size)) : largest * part);
  }
  ends.front() = -largest;
  const nurbs::Knots knots = nurbs::from_breaks(options.degree + 1, ends);
  std::vector<nurbs::CurveObservation> slopes;
  double sum = 0;
  for (const ShearPoint& point : shear) {
    slopes.push_back({point.gamma, 1, point.s12, point.weight});
    slopes.push_back({-point.gamma, 1, -point.s12, point.weight});
    sum += 2 * point.weight;
  }
  slopes.push_back({0, 0, 0, sum / (largest * largest)});
  nurbs::CurveFit curve = nurbs::fit(knots, slopes, {smoothing, 3, true, false});
  for (std::size_t i = 0, j = curve.curve.points.size() - 1; i < j; ++i, --j) { // even to rounding
    curve.curve.points[i] = curve.curve.points[j] = 0.5 * (curve.curve.points[i] + curve.curve.points[j]);
  }
  const double left = nurbs::evaluate(curve.curve, 0).value[0];
  for (nurbs::Point<1>& point : curve.curve.points) point[0] -= left;
  table->shear = std::move(curve.curve);
  fit.shear_report.rms = curve.residuals.rms;
  fit.shear_report.max = curve.residuals.max;
  fit.shear_report.where = Vec2(std::abs(slopes[curve.residuals.where].u), 0);
  fit.shear_report.uncovered = curve.residuals.uncovered;
  for (const ShearPoint& point : shear) {
    fit.shear_report.largest_stress = std::max(fit.shear_report.largest_stress, std::abs(point.s12));
  }
  double least = std::numeric_limits<double>::infinity();
  for (const double gamma : places_in(ends)) {
    const double stiffness = nurbs::evaluate(table->shear, gamma).second[0];
    if (stiffness >= least) continue;
    least = stiffness;
    fit.shear_report.not_monotone = Vec2(gamma, 0);
  }
  fit.shear_report.monotone = least >= 0;
  fit.table = std::move(table);
  return fit;
}

StrainRange range_for_law(const NurbsOptions& options) {
  if (!options.range) throw std::invalid_argument("a table of a law needs its range of strains");
  return *options.range;
}

} // namespace

std::vector<double> strain_breaks(StrainRange range, int spans, std::optional<double> knee) {
  const double first = logarithmic(range.min);
  const double last = logarithmic(range.max);
  std::vector<double> ends;
  for (int i = 0; i <= spans; ++i) {
    const double part = static_cast<double>(i) / spans;
    const double strain =
        knee ? *knee * std::sinh((1 - part) * std::asinh(first / *knee) + part * std::asinh(last / *knee))
             : (1 - part) * first + part * last;
    ends.push_back(0.5 * std::expm1(2 * strain));
  }
  ends.front() = range.min;
  ends.back() = range.max;
  return ends;
}

std::vector<StressPoint> sample(const Law& law, std::span<const Vec2> strains, double time) {
  std::vector<StressPoint> points;
  Response response;
  for (const Vec2& e : strains) {
    if (!ask(law, Vec3(e[0], e[1], 0), time, response)) continue;
    points.push_back({e[0], e[1], response.stress[0], response.stress[1], 1});
  }
  if (points.empty()) throw std::invalid_argument("the law to fit has no state in the range of strains");
  std::vector<double> sizes;
  for (const StressPoint& point : points) sizes.push_back(std::hypot(point.s1, point.s2));
  const double usual = median(sizes);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].weight = weight_of(sizes[i], usual);
  return points;
}

namespace {

void check_pd(std::span<const StressPoint> points, const NurbsOptions& options) {
  check(options);
  if (options.net[0] != options.net[1]) {
    throw std::invalid_argument(
        fmt::format("pd_nurbs is symmetric: the net must have as many rows as columns, not {} x {}", options.net[0],
                    options.net[1]));
  }
  for (std::size_t i = 0; i < points.size(); ++i) check(points[i], i, options.range);
}

} // namespace

PdFit fit_pd_nurbs(std::span<const StressPoint> points, const NurbsOptions& options) {
  check_pd(points, options);
  const StrainRange range = range_of(points, options.range);
  const std::optional<double> knee = options.knee ? options.knee : best_knee(points, range, true, options);
  return smooth(options.smoothing, smoothing_of_points,
                [&](double smoothing) { return pd_fit(points, points.size(), range, knee, smoothing, options); });
}

PdFit fit_pd_nurbs(const Law& law, const NurbsOptions& options, double time, std::span<const StressPoint> points) {
  check_pd(points, options);
  const StrainRange range = range_for_law(options);
  check_isotropic(law, range, time);
  std::optional<YieldTable> yield = options.potential ? until_yield(law) : std::nullopt;
  std::optional<double> knee = options.knee;
  if (const double largest = yield ? reach(*yield, range) : 0; largest > 1) {
    BeyondYield beyond = fit_beyond_yield(law, *yield, largest, options, time);
    if (points.empty()) return with_report(law, std::move(beyond), range, options, time);
    yield = std::move(beyond.table);
  } else {
    yield.reset();
    if (!knee) knee = best_knee(law, range, options.net[0] - options.degree, time);
  }
  const double fill = yield ? fill_of_rest : fill_of_law;
  const std::vector<double> places = places_in(strain_breaks(range, options.net[0] - options.degree, knee),
                                               parts_of_span(options.net[0], options.degree));
  std::vector<StressPoint> all(points.begin(), points.end());
  for (StressPoint& point : sample(law, pairs(places, places), time)) {
    if (point.e2 > point.e1) continue; // its mirror image is there
    if (point.e2 < point.e1) point.weight *= 2;
    if (!points.empty()) point.weight *= fill;
    all.push_back(point);
  }
  if (points.empty()) {
    return pd_fit(all, all.size(), range, knee, options.smoothing.value_or(smoothing_of_law), options);
  }
  return smooth(options.smoothing, yield ? smoothing_of_rest : smoothing_of_law,
                [&](double smoothing) { return pd_fit(all, points.size(), range, knee, smoothing, options, yield); });
}

LeFit fit_le_nurbs(std::span<const StressPoint> points, std::span<const ShearPoint> shear,
                   const NurbsOptions& options) {
  check(options);
  for (std::size_t i = 0; i < points.size(); ++i) check(points[i], i, options.range);
  const StrainRange range = range_of(points, options.range);
  const std::optional<double> knee = options.knee ? options.knee : best_knee(points, range, false, options);
  return smooth(options.smoothing, smoothing_of_points,
                [&](double smoothing) { return le_fit(points, shear, range, knee, smoothing, options); });
}

LeFit fit_le_nurbs(const Law& law, const NurbsOptions& options, double time) {
  check(options);
  const StrainRange range = range_for_law(options);
  const int spans = std::max(options.net[0], options.net[1]) - options.degree;
  const std::optional<double> knee = options.knee ? options.knee : best_knee(law, range, spans, time);
  const std::vector<StressPoint> points =
      sample(law,
             pairs(places_in(strain_breaks(range, options.net[0] - options.degree, knee),
                             parts_of_span(options.net[0], options.degree)),
                   places_in(strain_breaks(range, options.net[1] - options.degree, knee),
                             parts_of_span(options.net[1], options.degree))),
             time);
  std::vector<ShearPoint> shear;
  const double largest = range.max - range.min; // 2 E12 of the principal strains max and min
  const int count = 6 * (options.net[0] - options.degree);
  const double size = 2 * knee.value_or(largest);
  for (int i = 1; i <= count; ++i) {
    const double gamma = i < count ? size * std::sinh(std::asinh(largest / size) * i / count) : largest;
    Response response;
    if (ask(law, Vec3(0, 0, gamma), time, response)) shear.push_back({gamma, response.stress[2], 1});
  }
  std::vector<double> sizes;
  for (const ShearPoint& point : shear) sizes.push_back(std::abs(point.s12));
  if (shear.empty()) throw std::invalid_argument("the law to fit has no state in shear");
  const double usual = median(std::move(sizes));
  for (ShearPoint& point : shear) point.weight = weight_of(std::abs(point.s12), usual);
  return le_fit(points, shear, range, knee, options.smoothing.value_or(smoothing_of_law), options);
}

} // namespace pneuma::solver::material
