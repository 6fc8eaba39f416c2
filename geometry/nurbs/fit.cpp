// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/nurbs/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <fmt/format.h>

namespace pneuma::geometry::nurbs {

using base::MatX;
using base::VecX;

namespace {

// Normal equations, gathered span by span (cell by cell): the linear forms of one share their unknowns.
struct Normal {
  Normal(std::size_t cells, Eigen::Index locals)
      : matrices(cells, MatX::Zero(locals, locals)), rights(cells, VecX::Zero(locals)) {}

  void add(std::size_t cell, const VecX& form, double value, double weight) {
    matrices[cell].selfadjointView<Eigen::Lower>().rankUpdate(form, weight);
    rights[cell] += weight * value * form;
  }

  std::vector<MatX> matrices; // lower halves
  std::vector<VecX> rights;
};

void check(const FitSettings& settings) {
  if (!(settings.smoothing >= 0) || settings.penalized < 1 || settings.penalized > 3) {
    throw std::invalid_argument(fmt::format("smoothing must be >= 0, not {}, of derivatives of order 1 to 3, not {}",
                                            settings.smoothing, settings.penalized));
  }
}

void check_order(int order) {
  if (order < 0 || order > 3) throw std::invalid_argument("derivatives of order 0 to 3 can be observed");
}

template <class Observation>
double sum_of_weights(std::span<const Observation> observations) {
  double sum = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    if (!std::isfinite(o.value) || !(o.weight >= 0) || !std::isfinite(o.weight)) {
      throw std::invalid_argument(fmt::format(
          "observation {}: value {} and weight {} must be finite, the weight not negative", i, o.value, o.weight));
    }
    sum += o.weight;
  }
  if (!(sum > 0)) throw std::invalid_argument("a fit needs an observation with a weight");
  return sum;
}

// d^order / du^order of u^power
double monomial(double u, int power, int order) {
  double factor = 1;
  for (int k = 0; k < order; ++k) factor *= power - k;
  return factor == 0 ? 0 : factor * std::pow(u, power - order);
}

// The smoothed problem has one solution if the observations determine the polynomials that the penalty does not see;
// `forms` are the observations of these, one a column, of length one each.
void check_determined(MatX forms, const std::string& what) {
  for (Eigen::Index j = 0; j < forms.cols(); ++j) {
    const double length = forms.col(j).norm();
    if (length > 0) forms.col(j) /= length;
  }
  const VecX singular = Eigen::JacobiSVD<MatX>(forms.transpose() * forms).singularValues();
  constexpr double noise = 1e-12; // of squares: a part of 1e-6 of what is told apart
  if (forms.rows() == 0 || singular[singular.size() - 1] < noise * singular[0]) {
    throw std::invalid_argument(fmt::format("the data do not determine {}: {} of its {} freedoms can be seen; add data "
                                            "elsewhere or of another kind",
                                            what, (singular.array() > noise * singular[0]).count(), forms.cols()));
  }
}

// `unknown(cell, local)` is the number of an unknown; some of a cell may be one. A negative one is known to be zero.
template <class F>
VecX solve(const Normal& normal, int unknowns, const F& unknown, bool smoothed) {
  std::vector<Eigen::Triplet<double>> triplets;
  VecX right = VecX::Zero(unknowns);
  for (std::size_t cell = 0; cell < normal.matrices.size(); ++cell) {
    const MatX& local = normal.matrices[cell];
    for (Eigen::Index a = 0; a < local.rows(); ++a) {
      const int i = unknown(cell, static_cast<int>(a));
      if (i < 0) continue;
      right[i] += normal.rights[cell][a];
      for (Eigen::Index b = 0; b <= a; ++b) {
        const int j = unknown(cell, static_cast<int>(b));
        if (j < 0) continue;
        const double twice = i == j && a != b ? 2 : 1; // both halves fall on the diagonal
        triplets.emplace_back(std::max(i, j), std::min(i, j), twice * local(a, b));
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
  constexpr double noise = 1e-13; // of the largest pivot: below it a pivot is rounding
  if (factor.info() != Eigen::Success ||
      (!smoothed && factor.vectorD().minCoeff() < noise * factor.vectorD().maxCoeff())) {
    throw std::invalid_argument("the data leave control points free: smooth, use fewer of them or add data");
  }
  VecX solution = factor.solve(right);
  const VecX residual = right - matrix.selfadjointView<Eigen::Lower>() * solution;
  solution += factor.solve(residual);
  return solution;
}

// Three points a span, exact to degree 5.
constexpr std::array<double, 3> gauss_points = {0.11270166537925831, 0.5, 0.88729833462074169};
constexpr std::array<double, 3> gauss_weights = {5.0 / 18, 8.0 / 18, 5.0 / 18};

// Residuals from those of each observation.
template <class Observation>
Residuals summary(std::span<const Observation> observations, std::vector<double> each) {
  Residuals result;
  double sum = 0;
  double weights = 0;
  for (std::size_t k = 0; k < each.size(); ++k) {
    sum += observations[k].weight * each[k] * each[k];
    weights += observations[k].weight;
    if (observations[k].weight > 0 && std::abs(each[k]) > result.max) {
      result.max = std::abs(each[k]);
      result.where = k;
    }
  }
  result.rms = std::sqrt(sum / weights);
  result.each = std::move(each);
  return result;
}

// number of the span among the distinct knots
std::size_t span_number(const std::vector<double>& breaks, double u) {
  const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, u);
  return static_cast<std::size_t>(after - breaks.begin()) - 1;
}

double part_without(const std::vector<bool>& covered) {
  return static_cast<double>(std::count(covered.begin(), covered.end(), false)) / static_cast<double>(covered.size());
}

} // namespace

CurveFit fit(const Knots& knots, std::span<const CurveObservation> observations, const FitSettings& settings) {
  check(knots);
  check(settings);
  const double weights = sum_of_weights(observations);
  const std::vector<double> ends = breaks(knots);
  const auto spans = static_cast<double>(ends.size() - 1);
  Normal normal(static_cast<std::size_t>(knots.functions() - knots.degree), knots.degree + 1);
  std::vector<bool> covered(ends.size() - 1, false);
  MatX seen(static_cast<Eigen::Index>(observations.size()), settings.penalized);
  Basis basis;
  VecX form(knots.degree + 1);
  const auto form_of = [&](double u, int order) {
    evaluate_basis(knots, u, order, basis);
    for (int j = 0; j <= knots.degree; ++j) {
      form[j] = basis.functions[static_cast<std::size_t>(order)][static_cast<std::size_t>(j)];
    }
  };
  const double middle = 0.5 * (knots.first() + knots.last());
  const double half = 0.5 * (knots.last() - knots.first());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const CurveObservation& o = observations[i];
    check_order(o.order);
    for (int k = 0; k < settings.penalized; ++k) {
      seen(static_cast<Eigen::Index>(i), k) = o.weight > 0 ? monomial((o.u - middle) / half, k, o.order) : 0.0;
    }
    form_of(o.u, o.order);
    normal.add(static_cast<std::size_t>(basis.first), form, o.value, o.weight * spans / weights);
    if (o.weight > 0) covered[span_number(ends, o.u)] = true;
  }
  if (settings.smoothing > 0) {
    check_determined(seen, "the curve");
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double size = ends[i + 1] - ends[i];
      for (std::size_t k = 0; k < gauss_points.size(); ++k) {
        form_of(ends[i] + gauss_points[k] * size, settings.penalized);
        normal.add(static_cast<std::size_t>(basis.first), form, 0,
                   settings.smoothing * gauss_weights[k] *
                       std::pow(size, 2 * (settings.penalized - (settings.of_gradient ? 1 : 0))));
      }
    }
  }
  const VecX solution = solve(
      normal, knots.functions(), [](std::size_t cell, int local) { return static_cast<int>(cell) + local; },
      settings.smoothing > 0);
  CurveFit result;
  result.curve.knots = knots;
  for (const double value : solution) result.curve.points.push_back(Point<1>(value));
  std::vector<double> each;
  for (const CurveObservation& o : observations) {
    form_of(o.u, o.order);
    each.push_back(form.dot(solution.segment(basis.first, form.size())) - o.value);
  }
  result.residuals = summary(observations, std::move(each));
  result.residuals.uncovered = part_without(covered);
  return result;
}

SurfaceFit fit(const Knots& u, const Knots& v, std::span<const SurfaceObservation> observations,
               const FitSettings& settings) {
  check(u);
  check(v);
  check(settings);
  if (settings.symmetric && (u.degree != v.degree || u.values != v.values)) {
    throw std::invalid_argument("a symmetric surface has the same knots in both directions");
  }
  const int flat = settings.flat_start;
  if (flat < 0 || flat > u.degree || (flat > 0 && settings.symmetric)) {
    throw std::invalid_argument(
        fmt::format("a flat start takes 0 to {} rows of a surface that is not symmetric, not {}", u.degree, flat));
  }
  const double weights = sum_of_weights(observations);
  const int columns = v.functions();
  const int unknowns = settings.symmetric ? columns * (columns + 1) / 2 : (u.functions() - flat) * columns;
  const auto unknown = [&](int i, int j) { // of a control value; symmetric: those with j <= i
    if (!settings.symmetric) return i < flat ? -1 : (i - flat) * columns + j;
    return std::max(i, j) * (std::max(i, j) + 1) / 2 + std::min(i, j);
  };
  const int firsts_v = columns - v.degree;
  const std::vector<double> ends_u = breaks(u);
  const std::vector<double> ends_v = breaks(v);
  const std::size_t cells_v = ends_v.size() - 1;
  std::vector<bool> covered((ends_u.size() - 1) * cells_v, false);
  const auto cells = static_cast<double>(covered.size());
  Normal normal(static_cast<std::size_t>((u.functions() - u.degree) * firsts_v), (u.degree + 1) * (v.degree + 1));
  Basis in_u;
  Basis in_v;
  VecX form((u.degree + 1) * (v.degree + 1));
  const auto form_of = [&](int order_u, int order_v) {
    Eigen::Index k = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(u.degree); ++i) {
      for (std::size_t j = 0; j <= static_cast<std::size_t>(v.degree); ++j) {
        form[k++] =
            in_u.functions[static_cast<std::size_t>(order_u)][i] * in_v.functions[static_cast<std::size_t>(order_v)][j];
      }
    }
  };
  const auto cell = [&] { return static_cast<std::size_t>(in_u.first * firsts_v + in_v.first); };
  std::vector<std::pair<int, int>> powers; // of the polynomials that the penalty does not see
  for (int a = 0; a < settings.penalized; ++a) {
    for (int b = 0; a + b < settings.penalized; ++b) {
      if (!settings.symmetric || b <= a) powers.emplace_back(a, b);
    }
  }
  MatX seen(static_cast<Eigen::Index>(observations.size()), static_cast<Eigen::Index>(powers.size()));
  const double middle_u = 0.5 * (u.first() + u.last());
  const double middle_v = 0.5 * (v.first() + v.last());
  const double half = 0.5 * std::max(u.last() - u.first(), v.last() - v.first());
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const SurfaceObservation& o = observations[n];
    check_order(o.order_u);
    check_order(o.order_v);
    const double x = (o.u - middle_u) / half;
    const double y = (o.v - middle_v) / half;
    for (std::size_t k = 0; k < powers.size(); ++k) {
      const auto [a, b] = powers[k];
      double value = monomial(x, a, o.order_u) * monomial(y, b, o.order_v);
      if (settings.symmetric && a != b) value += monomial(x, b, o.order_u) * monomial(y, a, o.order_v);
      seen(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(k)) = o.weight > 0 ? value : 0.0;
    }
    evaluate_basis(u, o.u, o.order_u, in_u);
    evaluate_basis(v, o.v, o.order_v, in_v);
    form_of(o.order_u, o.order_v);
    normal.add(cell(), form, o.value, o.weight * cells / weights);
    if (o.weight > 0) {
      const std::size_t i = span_number(ends_u, o.u);
      const std::size_t j = span_number(ends_v, o.v);
      covered[i * cells_v + j] = true;
      if (settings.symmetric) covered[j * cells_v + i] = true;
    }
  }
  if (settings.smoothing > 0) {
    check_determined(seen, "the surface");
    for (std::size_t i = 0; i + 1 < ends_u.size(); ++i) {
      const double size_u = ends_u[i + 1] - ends_u[i];
      for (std::size_t j = 0; j < cells_v; ++j) {
        const double size_v = ends_v[j + 1] - ends_v[j];
        for (std::size_t k = 0; k < gauss_points.size(); ++k) {
          evaluate_basis(u, ends_u[i] + gauss_points[k] * size_u, settings.penalized, in_u);
          for (std::size_t l = 0; l < gauss_points.size(); ++l) {
            evaluate_basis(v, ends_v[j] + gauss_points[l] * size_v, settings.penalized, in_v);
            // the norm of all derivatives of f, or of both its first ones
            const auto penalise = [&](int first_u, int first_v) {
              const int order = settings.penalized - first_u - first_v;
              double binomial = 1;
              for (int a = 0; a <= order; ++a) {
                form_of(a + first_u, order - a + first_v);
                normal.add(cell(), form, 0,
                           binomial * settings.smoothing * gauss_weights[k] * gauss_weights[l] *
                               std::pow(size_u, 2 * a) * std::pow(size_v, 2 * (order - a)));
                binomial *= static_cast<double>(order - a) / (a + 1);
              }
            };
            if (settings.of_gradient) {
              penalise(1, 0);
              penalise(0, 1);
            } else {
              penalise(0, 0);
            }
          }
        }
      }
    }
  }
  const VecX solution = solve(
      normal, unknowns,
      [&](std::size_t number, int local) {
        const int row = static_cast<int>(number) / firsts_v + local / (v.degree + 1);
        return unknown(row, static_cast<int>(number) % firsts_v + local % (v.degree + 1));
      },
      settings.smoothing > 0);
  SurfaceFit result;
  result.surface.u = u;
  result.surface.v = v;
  for (int i = 0; i < u.functions(); ++i) {
    for (int j = 0; j < columns; ++j) {
      result.surface.points.push_back(Point<1>(i < flat ? 0.0 : solution[unknown(i, j)]));
    }
  }
  std::vector<double> each;
  for (const SurfaceObservation& o : observations) {
    evaluate_basis(u, o.u, o.order_u, in_u);
    evaluate_basis(v, o.v, o.order_v, in_v);
    form_of(o.order_u, o.order_v);
    double r = -o.value;
    for (int k = 0; k < form.size(); ++k) {
      const int row = in_u.first + k / (v.degree + 1);
      const int column = in_v.first + k % (v.degree + 1);
      r += form[k] * result.surface.points[static_cast<std::size_t>(row * columns + column)][0];
    }
    each.push_back(r);
  }
  result.residuals = summary(observations, std::move(each));
  result.residuals.uncovered = part_without(covered);
  return result;
}

Slope least_slope(const Curve<1>& curve, int points) {
  const std::vector<double> ends = breaks(curve.knots);
  Slope slope{std::numeric_limits<double>::infinity(), ends.front()};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    for (int k = 0; k < points; ++k) {
      const double u = ends[i] + (ends[i + 1] - ends[i]) * k / std::max(points - 1, 1);
      const double first = evaluate(curve, u).first[0];
      if (first < slope.least) slope = {first, u};
    }
  }
  return slope;
}

} // namespace pneuma::geometry::nurbs
