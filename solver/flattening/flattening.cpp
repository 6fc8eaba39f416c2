// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/flattening/flattening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "geometry/shape_functions.h"
#include "solver/element/reference.h"
#include "solver/linear/cholesky.h"

namespace pneuma::solver::flattening {

namespace {

using base::Mat2;
using base::MatX;
using base::VecX;
using Points = std::span<const Vec2>;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Everything about a problem that does not change while its points move.
class Equations {
public:
  explicit Equations(const Problem& problem)
      : problem_(problem), nodes_(geometry::nodes_per_element(problem.element)),
        reference_(element::make_reference(
            problem.element, problem.rule, element::corner_coordinates(problem.nodes->connectivity, problem.form),
            Vec3::UnitX())) { // a frame without meaning of its own; no foil stands upright
    double area = 0;
    for (const double part : reference_.area) area += part;
    area_ = area;
    weight_ = problem.weight / problem.weight(0, 0);
    for (const LengthTie& tie : problem.ties) {
      side_ = std::max(side_, (problem.form[at(tie.a[1])] - problem.form[at(tie.a[0])]).norm());
    }
  }

  double area() const { return area_; }

  // Unknowns of an element or tie at most: rows of their matrices.
  int stride() const { return std::max(2 * nodes_, 8); }

  // A tie that is missed by c over a side l strains a strip of width b by c/l: an energy of c^2 b / l. This many times
  // stiffer than the strips.
  double penalty() const { return side_ > 0 ? 100 * std::sqrt(area_) / side_ : 0; }

  // Value, and `take(part)` for every element and tie; the matrix is column major with `stride` rows. None (infinite
  // value) where a stress point is folded.
  struct Part {
    const Index* nodes;     // flat nodes
    int count;              // of them
    const double* gradient; // [node][2]
    const double* matrix;   // [2 count][stride], symmetric, upper triangle
  };
  template <class Take>
  double evaluate(Points points, std::span<const double> multipliers, double penalty, int stride,
                  const Take& take) const {
    double value = 0;
    geometry::dispatch(problem_.element, [&]<ElementType E>() {
      value = evaluate_elements<geometry::nodes_per_element(E)>(points, stride, take);
    });
    if (!std::isfinite(value)) return value;
    return value + evaluate_ties(points, multipliers, penalty, stride, take);
  }

  double tie(std::size_t k, Points points) const {
    const LengthTie& tie = problem_.ties[k];
    double c = (points[at(tie.a[1])] - points[at(tie.a[0])]).norm() - tie.value;
    if (tie.b[0] >= 0) c -= (points[at(tie.b[1])] - points[at(tie.b[0])]).norm();
    return c;
  }

  // f, of one stress point: d plane / d form
  template <int N>
  Mat2 gradient_at(std::size_t element, std::size_t point, Points points) const {
    Mat2 f = Mat2::Zero();
    const double* dn = reference_.derivatives.data() + point * at(nodes_) * 2;
    for (int a = 0; a < N; ++a) {
      const Vec2& x = points[at(problem_.nodes->connectivity[element * N + static_cast<std::size_t>(a)])];
      f += x * Vec2(dn[2 * a], dn[2 * a + 1]).transpose();
    }
    return f;
  }

  Mat2 wanted_at(std::size_t point) const {
    if (problem_.stretch.empty()) return Mat2::Identity();
    const double* g = problem_.stretch.data() + 3 * point;
    Mat2 stretch;
    stretch << g[0], g[2], g[2], g[1];
    return stretch;
  }

  const element::Reference& reference() const { return reference_; }

private:
  template <int N, class Take>
  double evaluate_elements(Points points, int stride, const Take& take) const {
    const auto per_element = at(reference_.points);
    const std::size_t elements = problem_.nodes->connectivity.size() / N;
    std::array<double, 2 * N> gradient;
    std::vector<double> matrix(at(2 * N * stride));
    double value = 0;
    for (std::size_t e = 0; e < elements; ++e) {
      gradient.fill(0);
      std::fill(matrix.begin(), matrix.end(), 0.0);
      for (std::size_t k = e * per_element; k < (e + 1) * per_element; ++k) {
        const double* dn = reference_.derivatives.data() + k * N * 2;
        const double area = reference_.area[k];
        const Mat2 f = gradient_at<N>(e, k, points);
        if (!(f.determinant() > 0)) return std::numeric_limits<double>::infinity();
        const Mat2 g = wanted_at(k);
        const Mat2 p = g * f;
        const Mat2 q = p * p.transpose();
        const Vec3 strain(0.5 * (1 - q(0, 0)), 0.5 * (1 - q(1, 1)), -q(0, 1));
        const Vec3 stress = weight_ * strain;
        value += 0.5 * area * stress.dot(strain);
        // d strain / d X_ai = -(g_1i v_1, g_2i v_2, g_1i v_2 + g_2i v_1), v = P grad N_a
        Eigen::Matrix<double, 3, 2 * N> b;
        for (int a = 0; a < N; ++a) {
          const Vec2 v = p * Vec2(dn[2 * a], dn[2 * a + 1]);
          for (int i = 0; i < 2; ++i) {
            b.col(2 * a + i) << -g(0, i) * v[0], -g(1, i) * v[1], -(g(0, i) * v[1] + g(1, i) * v[0]);
          }
        }
        Eigen::Map<Eigen::Matrix<double, 2 * N, 1>>(gradient.data()) += area * (b.transpose() * stress);
        const Eigen::Matrix<double, 3, 2 * N> wb = area * (weight_ * b);
        for (int j = 0; j < 2 * N; ++j) {
          for (int i = 0; i <= j; ++i) matrix[at(j * stride + i)] += b.col(i).dot(wb.col(j));
        }
      }
      take(Part{problem_.nodes->connectivity.data() + e * N, N, gradient.data(), matrix.data()});
    }
    return value;
  }

  template <class Take>
  double evaluate_ties(Points points, std::span<const double> multipliers, double penalty, int stride,
                       const Take& take) const {
    double value = 0;
    std::vector<double> matrix(at(8 * stride));
    for (std::size_t k = 0; k < problem_.ties.size(); ++k) {
      const LengthTie& tie = problem_.ties[k];
      const Index nodes[4] = {tie.a[0], tie.a[1], tie.b[0], tie.b[1]};
      const int count = tie.b[0] >= 0 ? 4 : 2;
      const double c = this->tie(k, points);
      const double force = multipliers[k] + penalty * c;
      value += (multipliers[k] + 0.5 * penalty * c) * c;
      Eigen::Matrix<double, 8, 1> direction = Eigen::Matrix<double, 8, 1>::Zero();
      for (int s = 0; s < count; s += 2) {
        const double sign = s == 0 ? 1 : -1;
        const Vec2 side = points[at(nodes[s + 1])] - points[at(nodes[s])];
        const Vec2 u = side.normalized();
        direction.segment<2>(2 * s) = -sign * u;
        direction.segment<2>(2 * s + 2) = sign * u;
      }
      for (int j = 0; j < 2 * count; ++j) {
        for (int i = 0; i <= j; ++i) matrix[at(j * stride + i)] = penalty * direction[i] * direction[j];
      }
      direction *= force;
      take(Part{nodes, count, direction.data(), matrix.data()});
    }
    return value;
  }

  const Problem& problem_;
  int nodes_;
  element::Reference reference_;
  double area_ = 0;
  Mat3 weight_;
  double side_ = 0; // longest tied side, m
};

// Numbers of the free coordinates: per strip, the nodes at the least and largest x keep their y, the first its x too.
std::vector<Index> number_unknowns(const FlatNodes& nodes, Points points, Index& count) {
  constexpr Index none = -1;
  std::vector<std::array<Index, 2>> ends; // per strip
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t s = at(nodes.strip[i]);
    if (s >= ends.size()) ends.resize(s + 1, {none, none});
    auto& [low, high] = ends[s];
    if (low == none || points[i].x() < points[at(low)].x()) low = static_cast<Index>(i);
    if (high == none || points[i].x() > points[at(high)].x()) high = static_cast<Index>(i);
  }
  std::vector<Index> unknown(2 * points.size(), 0);
  for (const auto& [low, high] : ends) {
    if (low == none) continue;
    unknown[2 * at(low)] = unknown[2 * at(low) + 1] = unknown[2 * at(high) + 1] = none;
  }
  count = 0;
  for (Index& u : unknown) {
    if (u != none) u = count++;
  }
  return unknown;
}

class Minimiser {
public:
  Minimiser(const Problem& problem, std::vector<Vec2> start, const Options& options)
      : problem_(problem), options_(options), equations_(problem), points_(std::move(start)),
        unknown_(number_unknowns(*problem.nodes, points_, count_)), stride_(equations_.stride()),
        assembly_(make_assembly()), cholesky_(assembly_.pattern), multipliers_(problem.ties.size(), 0.0),
        penalty_(equations_.penalty()) {}

  Flat run(const std::function<void(const Iteration&)>& report) {
    Flat flat;
    double extent = 0;
    for (const Vec2& p : points_) extent = std::max(extent, (p - points_.front()).norm());
    double move = extent;
    while (flat.iterations < options_.max_iterations && !flat.converged) {
      const double value = assemble();
      if (!std::isfinite(value)) break;
      ++flat.iterations;
      if (move > 1e-6 * extent) { // near the end the last factor is as good as a new one
        ++flat.factorizations;
        if (!cholesky_.factorize(assembly_.pattern, values_)) break;
      }
      const VecX step = cholesky_.solve(-gradient_).col(0);
      const double length = line_search(value, step);
      if (length == 0) break;
      double missed = 0;
      for (std::size_t k = 0; k < multipliers_.size(); ++k) {
        const double c = equations_.tie(k, points_);
        multipliers_[k] += penalty_ * c;
        missed = std::max(missed, std::abs(c));
      }
      move = length * step.lpNorm<Eigen::Infinity>();
      flat.converged = move <= options_.tolerance * extent;
      if (report) report({flat.iterations, std::sqrt(2 * value / equations_.area()), move, missed});
    }
    flat.points = std::move(points_);
    return flat;
  }

private:
  linear::PatternAndScatter make_assembly() const {
    const int n = geometry::nodes_per_element(problem_.element);
    std::vector<Index> unknowns;
    const auto add = [&](const Index* nodes, int count) {
      for (int a = 0; a < stride_ / 2; ++a) {
        for (std::size_t i = 0; i < 2; ++i) unknowns.push_back(a < count ? unknown_[2 * at(nodes[a]) + i] : -1);
      }
    };
    const std::vector<Index>& connectivity = problem_.nodes->connectivity;
    for (std::size_t k = 0; k < connectivity.size(); k += at(n)) add(connectivity.data() + k, n);
    for (const LengthTie& tie : problem_.ties) {
      const Index nodes[4] = {tie.a[0], tie.a[1], tie.b[0], tie.b[1]};
      add(nodes, tie.b[0] >= 0 ? 4 : 2);
    }
    return linear::make_pattern(count_, unknowns, stride_);
  }

  double assemble() {
    values_.assign(assembly_.pattern.row.size(), 0.0);
    gradient_ = VecX::Zero(count_);
    Index part_number = 0;
    return equations_.evaluate(points_, multipliers_, penalty_, stride_, [&](const Equations::Part& part) {
      linear::scatter_add(assembly_.scatter, part_number++, part.matrix, values_);
      for (int a = 0; a < part.count; ++a) {
        for (int i = 0; i < 2; ++i) {
          const Index u = unknown_[2 * at(part.nodes[a]) + static_cast<std::size_t>(i)];
          if (u >= 0) gradient_[u] += part.gradient[2 * a + i];
        }
      }
    });
  }

  // Halves the step until the value falls and nothing is folded; at rounding a full step is taken. 0: none found.
  double line_search(double value, const VecX& step) {
    const std::vector<Vec2> before = points_;
    const double slope = gradient_.dot(step);
    for (int halvings = 0; halvings < 20; ++halvings) {
      const double length = std::ldexp(1.0, -halvings);
      for (std::size_t i = 0; i < points_.size(); ++i) {
        for (std::size_t c = 0; c < 2; ++c) {
          const Index u = unknown_[2 * i + c];
          if (u >= 0) points_[i][static_cast<int>(c)] = before[i][static_cast<int>(c)] + length * step[u];
        }
      }
      const double now = equations_.evaluate(points_, multipliers_, penalty_, stride_, [](const Equations::Part&) {});
      const double rounding = 1e-12 * (std::abs(value) + equations_.area() * 1e-12);
      if (now <= value + 1e-4 * length * slope + rounding) return length;
    }
    points_ = before;
    return 0;
  }

  const Problem& problem_;
  const Options& options_;
  Equations equations_;
  std::vector<Vec2> points_;
  Index count_ = 0;
  std::vector<Index> unknown_; // [2 flat node + component], -1: held
  int stride_;
  linear::PatternAndScatter assembly_;
  linear::Cholesky cholesky_;
  std::vector<double> multipliers_;
  double penalty_;
  std::vector<double> values_;
  VecX gradient_;
};

} // namespace

FlatNodes flat_nodes(ElementType element, std::span<const Index> connectivity, std::span<const Index> strip_of_element,
                     Index strips) {
  const auto n = at(geometry::nodes_per_element(element));
  FlatNodes nodes;
  nodes.connectivity.resize(connectivity.size());
  for (Index strip = 0; strip < strips; ++strip) {
    std::unordered_map<Index, Index> number;
    for (std::size_t e = 0; e < strip_of_element.size(); ++e) {
      if (strip_of_element[e] != strip) continue;
      for (std::size_t k = e * n; k < (e + 1) * n; ++k) {
        const auto [found, fresh] = number.try_emplace(connectivity[k], static_cast<Index>(nodes.node.size()));
        if (fresh) {
          nodes.node.push_back(connectivity[k]);
          nodes.strip.push_back(strip);
        }
        nodes.connectivity[k] = found->second;
      }
    }
  }
  return nodes;
}

Flat flatten(const Problem& problem, std::vector<Vec2> start, const Options& options,
             const std::function<void(const Iteration&)>& report) {
  return Minimiser(problem, std::move(start), options).run(report);
}

Value evaluate(const Problem& problem, std::span<const Vec2> points, std::span<const double> multipliers,
               double penalty) {
  const Equations equations(problem);
  const auto size = static_cast<Eigen::Index>(2 * points.size());
  Value value{0, VecX::Zero(size), MatX::Zero(size, size)};
  const int stride = equations.stride();
  value.value = equations.evaluate(points, multipliers, penalty, stride, [&](const Equations::Part& part) {
    for (int j = 0; j < 2 * part.count; ++j) {
      const Eigen::Index column = 2 * part.nodes[j / 2] + j % 2;
      value.gradient[column] += part.gradient[j];
      for (int i = 0; i <= j; ++i) {
        const Eigen::Index row = 2 * part.nodes[i / 2] + i % 2;
        value.matrix(row, column) += part.matrix[j * stride + i];
        if (i != j) value.matrix(column, row) += part.matrix[j * stride + i];
      }
    }
  });
  return value;
}

std::vector<PointStretch> stretches(const Problem& problem, std::span<const Vec2> points) {
  const Equations equations(problem);
  std::vector<PointStretch> result;
  geometry::dispatch(problem.element, [&]<ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    const auto per_element = at(equations.reference().points);
    for (std::size_t k = 0; k < equations.reference().area.size(); ++k) {
      const Mat2 f = equations.gradient_at<n>(k / per_element, k, points);
      const Mat2 p = equations.wanted_at(k) * f;
      const Mat2 q = p * p.transpose(); // inverse square of the remaining stretch
      const double mean = 0.5 * q.trace();
      const double radius = std::hypot(0.5 * (q(0, 0) - q(1, 1)), q(0, 1));
      result.push_back({f * f.transpose(), 1 / std::sqrt(mean - radius), 1 / std::sqrt(mean + radius),
                        equations.reference().area[k]});
    }
  });
  return result;
}

} // namespace pneuma::solver::flattening
