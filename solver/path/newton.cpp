// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/newton.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "geometry/base/parallel.h"

namespace pneuma::solver::path {

namespace {

class Stopwatch {
public:
  explicit Stopwatch(double& total) : total_(total) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

private:
  double& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

constexpr double shift_growth = 8;
constexpr int max_shift_tries = 25;

} // namespace

Newton::Newton(System& system, NewtonOptions options) : system_(system), options_(options) {
  const Stopwatch watch(work_.analysis);
  for (const assembly::FoilEquations& foil : system_.foils()) factors_.emplace_back(foil.pattern);
  shift_.assign(factors_.size(), 0.0);
}

double Newton::reference_tension(const Configuration& configuration) const {
  // A film that carries the load with a sag of the order of its span has a tension of load per area x span. What is not
  // in balance counts as a load: a slack foil between moved edges has no other.
  Vec3 low = configuration.positions.front();
  Vec3 high = low;
  for (const Vec3& x : configuration.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  double tension = 0;
  for (const assembly::FoilEquations& foil : system_.foils()) {
    const double area =
        std::max(foil.pressure_gradient.norm() * std::sqrt(static_cast<double>(foil.pattern.size)), 1e-300);
    const double load =
        std::max(foil.external.norm(), foil.residual.norm()) * std::sqrt(static_cast<double>(foil.pattern.size)) / area;
    tension = std::max(tension, 0.1 * load * (high - low).norm());
  }
  if (tension > 0) return tension;
  // No force at all, yet a tangent to be made positive (a flat chamber is to get a volume): any small tension serves.
  for (const assembly::FoilEquations& foil : system_.foils()) {
    if (foil.pattern.size == 0) continue;
    tension = std::max(tension, 1e-6 * foil.stiffness / std::sqrt(static_cast<double>(foil.pattern.size)));
  }
  return tension;
}

bool Newton::factorize(const Configuration& configuration) {
  const Stopwatch watch(work_.factorization);
  std::vector<char> done(factors_.size(), 0);
  std::vector<int> tries(factors_.size(), 0);
  const double tension = reference_tension(configuration);
  base::parallel_chunks(system_.threads(), factors_.size(), [&](std::size_t i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    double& shift = shift_[i];
    shift = shift < 1e-6 * tension ? 0.0 : shift / shift_growth;
    std::vector<double> shifted;
    while (tries[i]++ < max_shift_tries) {
      std::span<const double> values = foil.tangent;
      if (shift > 0) {
        shifted = foil.tangent;
        for (std::size_t k = 0; k < shifted.size(); ++k) shifted[k] += shift * foil.laplacian[k];
        values = shifted;
      }
      if (factors_[i].factorize(foil.pattern, values)) {
        done[i] = 1;
        return;
      }
      shift = shift > 0 ? shift * shift_growth : 1e-3 * tension;
      if (!(shift > 0)) return; // no load, no tension: nothing to scale with
    }
  });
  for (const int t : tries) work_.factorizations += t;
  return std::all_of(done.begin(), done.end(), [](char d) { return d != 0; });
}

MatX Newton::borders(std::size_t foil) const {
  const assembly::FoilEquations& equations = system_.foils()[foil];
  const auto& chambers = system_.model().chambers;
  MatX q = MatX::Zero(equations.pattern.size, static_cast<Eigen::Index>(chambers.size()));
  for (std::size_t c = 0; c < chambers.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    if (chambers[c].outer == equations.block) q.col(column) += equations.pressure_gradient;
    if (chambers[c].inner == equations.block) q.col(column) -= equations.pressure_gradient;
  }
  return q;
}

Newton::Direction Newton::direction(const Configuration& configuration) {
  const Stopwatch watch(work_.solve);
  const auto chambers = static_cast<Eigen::Index>(system_.model().chambers.size());
  const std::size_t count = factors_.size();
  std::vector<MatX> q(count);
  std::vector<MatX> solution(count); // K^-1 [R, Q]
  base::parallel_chunks(system_.threads(), count, [&](std::size_t i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    q[i] = borders(i);
    MatX right(foil.pattern.size, 1 + chambers);
    right << foil.residual, q[i];
    solution[i] = factors_[i].solve(right);
  });

  // (D + Q^T K^-1 Q) dp = -r + Q^T K^-1 R over the chambers with unknown pressure, scaled to a diagonal of one:
  // chambers of any size stand side by side
  MatX small = MatX::Zero(chambers, chambers);
  VecX right = VecX::Zero(chambers);
  for (std::size_t i = 0; i < count; ++i) {
    small += q[i].transpose() * solution[i].rightCols(chambers);
    right += q[i].transpose() * solution[i].col(0);
  }
  VecX scale = VecX::Zero(chambers); // 0 where the pressure is prescribed: dp = 0
  for (Eigen::Index c = 0; c < chambers; ++c) {
    const chamber::GasLine line = system_.gas_line(static_cast<Index>(c), configuration);
    if (!line.pressure_is_unknown) continue;
    small(c, c) += line.compliance;
    right[c] -= line.residual;
    scale[c] = small(c, c) > 0 ? 1 / std::sqrt(small(c, c)) : 0.0;
  }
  small = (scale.asDiagonal() * small * scale.asDiagonal()).eval();
  for (Eigen::Index c = 0; c < chambers; ++c) small(c, c) = 1;
  Direction result;
  result.dp = chambers > 0 ? VecX(scale.cwiseProduct(small.fullPivLu().solve(scale.cwiseProduct(right)))) : VecX();
  for (std::size_t i = 0; i < count; ++i) {
    result.du.emplace_back(-solution[i].col(0) + solution[i].rightCols(chambers) * result.dp);
    result.shift = std::max(result.shift, shift_[i]);
  }
  return result;
}

double Newton::slope(const Direction& direction) const {
  double sum = 0;
  for (std::size_t i = 0; i < factors_.size(); ++i) sum += direction.du[i].dot(system_.foils()[i].residual);
  return sum;
}

Configuration Newton::moved(const Configuration& from, const Direction& direction, double length) const {
  Configuration to = from;
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    for (std::size_t u = 0; u < foil.coordinate.size(); ++u) {
      const Index k = foil.coordinate[u];
      to.positions[static_cast<std::size_t>(k / 3)][k % 3] += length * direction.du[i][static_cast<Eigen::Index>(u)];
    }
  }
  if (direction.dp.size() > 0) to.pressures += length * direction.dp;
  return to;
}

Newton::Outcome Newton::solve(Configuration& configuration, const std::function<void(const Iteration&)>& report) {
  const auto evaluate = [&](Configuration& at, bool with_tangent) {
    const Stopwatch watch(work_.assembly);
    return system_.evaluate(at, with_tangent);
  };
  const auto relative = [](const assembly::Balance& b) { return b.residual == 0 ? 0.0 : b.residual / b.force_scale; };
  double span = 0;
  for (const Vec3& x : configuration.positions) span = std::max(span, (x - configuration.positions.front()).norm());

  std::fill(shift_.begin(), shift_.end(), 0.0);
  Outcome outcome;
  assembly::Balance balance = evaluate(configuration, true);
  if (!balance.possible) {
    outcome.reason = balance.reason;
    return outcome;
  }
  double last_move = span; // largest displacement of the last iteration's whole step, if no artificial tension acted
  for (int number = 0;; ++number) {
    outcome.iterations = number;
    outcome.residual = relative(balance);
    // Where nothing acts (forces that cancel, moved edges, far from the origin, very fine meshes) rounding keeps the
    // relative residual above the tolerance: then the residual, or a move, at rounding level decides.
    const bool at_rounding = balance.residual <= balance.rounding ||
                             (last_move < 1e-13 * span && outcome.residual < 1e3 * options_.tolerance);
    if ((outcome.residual <= options_.tolerance || at_rounding) && balance.gas <= options_.tolerance) {
      outcome.converged = true;
      return outcome;
    }
    if (number == options_.max_iterations) {
      outcome.reason = "the iterations ran out";
      return outcome;
    }
    if (!factorize(configuration)) {
      outcome.reason = "no artificial tension makes the tangent positive definite";
      return outcome;
    }
    const Direction step = direction(configuration);
    ++work_.iterations;

    const double slope0 = slope(step);
    double length = 1;
    Configuration trial = moved(configuration, step, length);
    assembly::Balance next = evaluate(trial, true);
    double slope1 = next.possible ? slope(step) : 0;
    const auto good = [&] {
      if (!next.possible) return false;
      if (slope0 >= 0) return true; // the step serves a gas law first: along it the residual is no measure
      if (std::abs(slope1) <= 0.8 * std::abs(slope0)) return true;
      return step.shift == 0 && relative(next) < 0.5 * relative(balance);
    };
    if (!good()) {
      // Find where the residual is orthogonal to the direction: shorten, or (only with an artificial tension, whose
      // size is a guess) lengthen, then regula falsi (Illinois).
      double low = 0, slope_low = slope0;
      double high = -1, slope_high = 0;
      for (int search = 0; search < options_.max_line_searches; ++search) {
        ++work_.line_searches;
        if (!next.possible) {
          high = -1;
          length = low + (length - low) / 4;
        } else if (slope1 * slope0 < 0) {
          if (high > 0) slope_low /= 2;
          high = length;
          slope_high = slope1;
          length = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.05, 0.95);
        } else {
          low = length;
          slope_low = slope1;
          if (high > 0) {
            slope_high /= 2;
            length = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.05, 0.95);
          } else if (step.shift > 0 && length < 1e4) {
            length *= 4;
          } else {
            break; // a plain Newton step that is too short is good enough
          }
        }
        trial = moved(configuration, step, length);
        next = evaluate(trial, false);
        slope1 = next.possible ? slope(step) : 0;
        if (good()) break;
      }
      next = evaluate(trial, true);
    }
    if (report) {
      report({configuration.load_factor, number, relative(balance), balance.gas, length, step.shift});
    }
    if (!next.possible) {
      outcome.reason = next.reason;
      return outcome;
    }
    last_move = step.shift > 0 ? span : 0;
    for (const VecX& du : step.du) {
      if (du.size() > 0) last_move = std::max(last_move, du.cwiseAbs().maxCoeff());
    }
    configuration = std::move(trial);
    balance = next;
  }
}

Newton::Stability Newton::stability(const Configuration& configuration) {
  const auto chambers = static_cast<Eigen::Index>(system_.model().chambers.size());
  MatX small = MatX::Zero(chambers, chambers);
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    ++work_.factorizations;
    if (!factors_[i].factorize(foil.pattern, foil.tangent) || factors_[i].pivot_ratio() < 1e-10) return {};
    const MatX q = borders(i);
    if (chambers > 0) small += q.transpose() * factors_[i].solve(q);
  }
  // K is positive definite; neg(K + Q D^-1 Q^T) = neg(-D - Q^T K^-1 Q) - m over the chambers with a law (numerics 7)
  std::vector<Eigen::Index> with_law;
  for (Eigen::Index c = 0; c < chambers; ++c) {
    const chamber::GasLine line = system_.gas_line(static_cast<Index>(c), configuration);
    if (!line.pressure_is_unknown) continue;
    with_law.push_back(c);
    small(c, c) += line.compliance;
  }
  const auto laws = static_cast<Eigen::Index>(with_law.size());
  MatX reduced(laws, laws);
  for (std::size_t a = 0; a < with_law.size(); ++a) {
    for (std::size_t b = 0; b < with_law.size(); ++b) {
      reduced(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = -small(with_law[a], with_law[b]);
    }
  }
  int negative = 0;
  if (!with_law.empty()) {
    const VecX eigenvalues = Eigen::SelfAdjointEigenSolver<MatX>(reduced).eigenvalues();
    negative = static_cast<int>((eigenvalues.array() < 0).count());
  }
  const int count = negative - static_cast<int>(with_law.size());
  return {count, count};
}

} // namespace pneuma::solver::path
