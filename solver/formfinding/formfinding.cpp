// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/formfinding/formfinding.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/place.h"
#include "geometry/volume.h"
#include "solver/element/film.h"
#include "solver/linear/cholesky.h"

namespace pneuma::solver::formfinding {

using base::MatX;
using base::VecX;

namespace {

constexpr double runaway_area = 30;     // times the start's: the film blows up without bound
constexpr double collapsed_area = 1e-4; // of an element, against its start

struct Forces {
  VecX force; // film less pressure, [3 free node + component], N
  double area = 0;
  bool degenerate = false;
};

// The film of one block: its free nodes, and the two matrices of the homotopy's ends.
class FilmProblem {
public:
  FilmProblem(const geometry::Mesh& mesh, const std::vector<std::uint8_t>& fixed, const Target& target,
              geometry::StressRule rule)
      : mesh_(mesh), block_(mesh.blocks[static_cast<std::size_t>(target.block)]),
        target_(target), film_{mesh.element, rule, block_.connectivity, target.tension},
        number_(mesh.nodes.size(), -1) {
    for (const Index node : block_.connectivity) {
      const auto k = static_cast<std::size_t>(node);
      if (number_[k] >= 0 || fixed[3 * k] != 0 || fixed[3 * k + 1] != 0 || fixed[3 * k + 2] != 0) continue;
      number_[k] = static_cast<Index>(nodes_.size());
      nodes_.push_back(node);
    }
    std::vector<Index> scalar;
    std::vector<Index> vector;
    for (const Index node : block_.connectivity) {
      const Index number = number_[static_cast<std::size_t>(node)];
      scalar.push_back(number);
      for (Index c = 0; c < 3; ++c) vector.push_back(number < 0 ? -1 : 3 * number + c);
    }
    const Index n = geometry::nodes_per_element(mesh.element);
    const auto free = static_cast<Index>(nodes_.size());
    scalar_ = linear::make_pattern(free, scalar, n);
    vector_ = linear::make_pattern(3 * free, vector, 3 * n);
  }

  const std::vector<Index>& nodes() const { return nodes_; }
  const linear::SymmetricPattern& vector_pattern() const { return vector_.pattern; }
  const linear::SymmetricPattern& scalar_pattern() const { return scalar_.pattern; }

  // Unit normals at the free nodes: mean of the normals that the elements around have there.
  std::vector<Vec3> directors(const std::vector<Vec3>& positions) const {
    std::vector<Vec3> sum(nodes_.size(), Vec3::Zero());
    geometry::dispatch(mesh_.element, [&]<geometry::ElementType E>() {
      constexpr auto at = geometry::node_coordinates<E>();
      for (Index e = 0; e < mesh_.element_count(block_); ++e) {
        const std::span<const Index> nodes = mesh_.element_nodes(block_, e);
        const geometry::ElementPositions<E> x = geometry::gather<E>(nodes, positions);
        for (std::size_t a = 0; a < at.size(); ++a) {
          const Index number = number_[static_cast<std::size_t>(nodes[a])];
          if (number < 0) continue;
          const base::Mat32 g = x * geometry::shape_functions<E>(at[a][0], at[a][1]).derivative;
          sum[static_cast<std::size_t>(number)] += g.col(0).cross(g.col(1)).normalized();
        }
      }
    });
    for (Vec3& d : sum) d.normalize();
    return sum;
  }

  // Forces; if asked for, `values` of the vector pattern: tangent on the reference stress, less the load stiffness if
  // `with_load`.
  Forces reference_system(const std::vector<Vec3>& positions, bool with_load, std::vector<double>& values) const {
    values.assign(vector_.pattern.row.size(), 0.0);
    return assemble(positions, 0.0, [&](Index e, const double* film, const double* load, Index) {
      linear::scatter_add(vector_.scatter, e, film, values);
      if (with_load) linear::scatter_add(vector_.scatter, e, load, values);
    });
  }

  // Forces and the tangent on the current stress, seen by moves along the directors only; and the shift for it.
  Forces current_system(const std::vector<Vec3>& positions, const std::vector<Vec3>& directors,
                        std::vector<double>& values) const {
    values.assign(scalar_.pattern.row.size(), 0.0);
    const auto n = static_cast<std::size_t>(geometry::nodes_per_element(mesh_.element));
    std::vector<double> small(n * n);
    return assemble(positions, 1.0, [&](Index e, const double* film, const double* load, Index size) {
      const std::span<const Index> nodes = mesh_.element_nodes(block_, e);
      const Eigen::Map<const MatX> K(film, size, size);
      const Eigen::Map<const MatX> L(load, size, size);
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t a = 0; a <= b; ++a) {
          const Index i = number_[static_cast<std::size_t>(nodes[a])];
          const Index j = number_[static_cast<std::size_t>(nodes[b])];
          if (i < 0 || j < 0) continue;
          const auto row = static_cast<Eigen::Index>(3 * a);
          const auto column = static_cast<Eigen::Index>(3 * b);
          const base::Mat3 block = K.block<3, 3>(row, column) + L.block<3, 3>(row, column);
          small[b * n + a] = directors[static_cast<std::size_t>(i)].dot(block * directors[static_cast<std::size_t>(j)]);
        }
      }
      linear::scatter_add(scalar_.scatter, e, small.data(), values);
    });
  }

  // n int grad N . grad N on the scalar pattern
  std::vector<double> scalar_laplacian(const std::vector<Vec3>& positions) const {
    std::vector<double> values(scalar_.pattern.row.size(), 0.0);
    const auto n = static_cast<std::size_t>(geometry::nodes_per_element(mesh_.element));
    std::vector<double> small(n * n);
    assemble(positions, 0.0, [&](Index e, const double* film, const double*, Index size) {
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t a = 0; a <= b; ++a) small[b * n + a] = film[3 * b * static_cast<std::size_t>(size) + 3 * a];
      }
      linear::scatter_add(scalar_.scatter, e, small.data(), values);
    });
    return values;
  }

  Forces forces(const std::vector<Vec3>& positions) const {
    return assemble(positions, 0.0, [](Index, const double*, const double*, Index) {});
  }

  // smallest area of an element against its area at `start`, and where
  std::pair<double, Vec3> smallest_area_ratio(const std::vector<Vec3>& start, const std::vector<Vec3>& now) const {
    std::pair<double, Vec3> smallest{1e300, Vec3::Zero()};
    geometry::dispatch(mesh_.element, [&]<geometry::ElementType E>() {
      for (Index e = 0; e < mesh_.element_count(block_); ++e) {
        const geometry::ElementPositions<E> x0 = geometry::gather<E>(mesh_.element_nodes(block_, e), start);
        const geometry::ElementPositions<E> x1 = geometry::gather<E>(mesh_.element_nodes(block_, e), now);
        for (const geometry::QuadraturePoint& q : geometry::stress_rule(E, film_.rule)) {
          const auto d = geometry::shape_functions<E>(q.xi, q.eta).derivative;
          const base::Mat32 g0 = x0 * d;
          const base::Mat32 g1 = x1 * d;
          const double ratio = g1.col(0).cross(g1.col(1)).norm() / g0.col(0).cross(g0.col(1)).norm();
          if (ratio < smallest.first) smallest = {ratio, x1.rowwise().mean()};
        }
      }
    });
    return smallest;
  }

private:
  // take(element, film tangent, minus pressure x symmetric load stiffness, size)
  template <class Take>
  Forces assemble(const std::vector<Vec3>& positions, double current, const Take& take) const {
    Forces result;
    result.force = VecX::Zero(static_cast<Eigen::Index>(3 * nodes_.size()));
    geometry::dispatch(mesh_.element, [&]<geometry::ElementType E>() {
      constexpr int n = geometry::nodes_per_element(E);
      geometry::PressureElement<E> p;
      const Index failed =
          element::film_forces(film_, positions, current, result.area, [&](const element::ElementBatch& batch) {
            const std::span<const Index> nodes = mesh_.element_nodes(block_, batch.first);
            geometry::pressure_element<E>(geometry::gather<E>(nodes, positions), geometry::pressure_rule(E),
                                          target_.pressure != 0, p);
            for (int a = 0; a < n; ++a) {
              const Index number = number_[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])];
              if (number < 0) continue;
              for (int c = 0; c < 3; ++c) {
                result.force[3 * number + c] += batch.force[3 * a + c] - target_.pressure * p.force[3 * a + c];
              }
            }
            if (target_.pressure != 0) {
              p.derivative = (-0.5 * target_.pressure * (p.derivative + p.derivative.transpose())).eval();
            } else {
              p.derivative.setZero();
            }
            take(batch.first, batch.tangent, p.derivative.data(), 3 * n);
          });
      result.degenerate = failed >= 0 || !result.force.allFinite();
    });
    return result;
  }

  const geometry::Mesh& mesh_;
  const geometry::Block& block_;
  Target target_;
  element::Film film_;
  std::vector<Index> number_; // of free nodes, per node of the mesh
  std::vector<Index> nodes_;  // the free ones
  linear::PatternAndScatter scalar_, vector_;
};

VecX across(const VecX& force, const std::vector<Vec3>& directors) {
  VecX result(static_cast<Eigen::Index>(directors.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result[i] = directors[static_cast<std::size_t>(i)].dot(force.segment<3>(3 * i));
  }
  return result;
}

} // namespace

Form find_form(const geometry::Mesh& mesh, const std::vector<std::uint8_t>& fixed, std::vector<Vec3> positions,
               const Target& target, const Options& options, const std::function<void(const Update&)>& report) {
  const FilmProblem problem(mesh, fixed, target, options.rule);
  const std::vector<Index>& nodes = problem.nodes();
  Form form;
  const std::vector<Vec3> start = positions;
  double span = 0;
  for (const Vec3& x : positions) span = std::max(span, (x - positions.front()).norm());
  double start_area = 0;

  const auto finish = [&](Verdict verdict, std::string reason) {
    form.verdict = verdict;
    form.reason = std::move(reason);
    form.positions = std::move(positions);
    return form;
  };
  const auto collapsed = [&](const std::vector<Vec3>& now) -> std::optional<std::string> {
    const auto [ratio, at] = problem.smallest_area_ratio(start, now);
    if (ratio > collapsed_area) return std::nullopt;
    return fmt::format("the surface collapses at {} m", base::place_text(at));
  };
  const auto measure = [&](const Forces& f, const std::vector<Vec3>& directors) {
    const double scale = target.tension * std::sqrt(f.area);
    const VecX normal = across(f.force, directors);
    form.area = f.area;
    form.residual = normal.norm() / scale;
    form.residual_along = std::sqrt(std::max(f.force.squaredNorm() - normal.squaredNorm(), 0.0)) / scale;
  };

  // 1. Updates on the reference stress: robust, linear; the nodes move in all directions.
  {
    linear::Cholesky factor(problem.vector_pattern());
    std::vector<double> values;
    constexpr int most = 30;
    for (int k = 0; k < most; ++k) {
      Forces f = problem.reference_system(positions, true, values);
      if (f.degenerate) return finish(Verdict::no_equilibrium, "the surface degenerates");
      if (k == 0) start_area = f.area;
      if (f.area > runaway_area * start_area) return finish(Verdict::no_equilibrium, "the film grows without bound");
      measure(f, problem.directors(positions));
      ++form.factorizations;
      if (!factor.factorize(problem.vector_pattern(), values)) {
        problem.reference_system(positions, false, values);
        ++form.factorizations;
        if (!factor.factorize(problem.vector_pattern(), values)) {
          return finish(Verdict::no_equilibrium, "the surface degenerates");
        }
      }
      const VecX du = factor.solve(-f.force);
      const double move = du.size() == 0 ? 0.0 : du.cwiseAbs().maxCoeff();
      if (move < 1e-2 * span && k > 0) break; // near: Newton takes over
      const double length = std::min(1.0, 0.5 * span / std::max(move, 1e-300));
      std::vector<Vec3> next = positions;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        next[static_cast<std::size_t>(nodes[i])] += length * du.segment<3>(3 * static_cast<Eigen::Index>(i));
      }
      ++form.updates;
      if (report) report({form.updates, form.residual, length * move, 0.0});
      if (const auto where = collapsed(next)) return finish(Verdict::no_equilibrium, *where);
      positions = std::move(next);
    }
  }

  // 2. Updates on the current stress, across the surface only.
  linear::Cholesky factor(problem.scalar_pattern());
  std::vector<double> values;
  std::vector<double> shifted;
  double shift = 0; // parts of the film's own Laplacian added to the tangent
  double last_move = span;
  int unstable = 0; // updates in a row whose tangent was not positive definite
  for (;;) {
    const std::vector<Vec3> directors = problem.directors(positions);
    const Forces f = problem.current_system(positions, directors, values);
    if (f.degenerate) return finish(Verdict::no_equilibrium, "the surface degenerates");
    if (f.area > runaway_area * start_area) return finish(Verdict::no_equilibrium, "the film grows without bound");
    measure(f, directors);
    const VecX residual = across(f.force, directors);
    ++form.factorizations;
    form.stable = factor.factorize(problem.scalar_pattern(), values);
    const bool at_rounding = last_move < 1e-13 * span && form.residual < 1e3 * options.tolerance;
    if (form.residual <= options.tolerance || at_rounding) {
      if (form.stable) return finish(Verdict::converged, "");
      return finish(Verdict::no_equilibrium, "the form found is unstable: a film would leave it");
    }
    if (form.updates >= options.max_updates) {
      if (unstable > 5) return finish(Verdict::no_equilibrium, "the form has lost its stiffness");
      return finish(Verdict::swimming, fmt::format("the form still moves by {:.2g} m an update", last_move));
    }
    unstable = form.stable ? 0 : unstable + 1;
    if (!form.stable) {
      const std::vector<double> laplacian = problem.scalar_laplacian(positions);
      shift = std::max(shift / 4, 1e-3);
      for (;; shift *= 4) {
        shifted = values;
        for (std::size_t i = 0; i < shifted.size(); ++i) shifted[i] += shift * laplacian[i];
        ++form.factorizations;
        if (factor.factorize(problem.scalar_pattern(), shifted)) break;
        if (shift > 1e6) return finish(Verdict::no_equilibrium, "the form has lost its stiffness");
      }
    }
    const VecX s = factor.solve(-residual);
    const double slope0 = s.dot(residual);
    double length = std::min(1.0, 0.2 * span / std::max(s.cwiseAbs().maxCoeff(), 1e-300));
    std::vector<Vec3> next;
    for (int attempt = 0; attempt < 12; ++attempt, length *= 0.4) {
      next = positions;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        next[static_cast<std::size_t>(nodes[i])] += length * s[static_cast<Eigen::Index>(i)] * directors[i];
      }
      const Forces there = problem.forces(next);
      if (there.degenerate) continue;
      const double slope1 = s.dot(across(there.force, directors));
      // downhill still (slope1 of the sign of slope0), or not far beyond the bottom
      if (slope1 * slope0 > 0 || std::abs(slope1) < 0.9 * std::abs(slope0)) break;
    }
    last_move = length * s.cwiseAbs().maxCoeff();
    ++form.updates;
    if (report) report({form.updates, form.residual, last_move, 1.0});
    if (const auto where = collapsed(next)) return finish(Verdict::no_equilibrium, *where);
    positions = std::move(next);
  }
}

std::optional<Limit> find_limit(const geometry::Mesh& mesh, const std::vector<std::uint8_t>& fixed,
                                const std::vector<Vec3>& positions, const Target& target, const Options& options) {
  double low = 0;
  double high = 1; // parts of the pressure
  while (high - low > 0.01 * high) {
    if (high < 0.01) return std::nullopt;
    const double middle = 0.5 * (low + high);
    const Target tried{target.block, target.tension, middle * target.pressure};
    const bool exists = find_form(mesh, fixed, positions, tried, options).verdict == Verdict::converged;
    (exists ? low : high) = middle;
  }
  return Limit{low * std::abs(target.pressure), target.tension / low};
}

} // namespace pneuma::solver::formfinding
