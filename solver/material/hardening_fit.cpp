// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/hardening_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "geometry/base/types.h"

namespace pneuma::solver::material {

namespace {

using base::MatX;
using base::VecX;

// Corners in strain, from small to large, and the slopes between them.
struct Polygon {
  std::vector<double> corners; // -
  VecX slopes;                 // corners + 1, Pa
  double cost = std::numeric_limits<double>::infinity();
};

// Strain that lies between corner k - 1 and corner k.
double share(const std::vector<double>& corners, std::size_t k, double strain) {
  const double low = k == 0 ? 0 : corners[k - 1];
  const double high = k < corners.size() ? corners[k] : std::numeric_limits<double>::infinity();
  if (k == 0) return std::min(strain, high);
  return std::clamp(strain, low, high) - low;
}

// x >= 0 with the least |A x - b|: Lawson and Hanson's active set, for a few unknowns.
VecX non_negative(const MatX& A, const VecX& b) {
  const Eigen::Index n = A.cols();
  const double smallest = 1e-14 * A.colwise().norm().maxCoeff() * b.norm(); // of a gradient, rounding
  std::vector<Eigen::Index> used;
  VecX x = VecX::Zero(n);
  for (Eigen::Index round = 0; round < 3 * n; ++round) {
    VecX gradient = A.transpose() * (b - A * x);
    for (const Eigen::Index i : used) gradient[i] = 0;
    Eigen::Index next = 0;
    if (gradient.maxCoeff(&next) <= smallest) break;
    used.push_back(next);
    for (double way = 0; way < 1;) {
      const VecX trial = A(Eigen::all, used).colPivHouseholderQr().solve(b);
      // as far towards the trial as all stay non-negative
      way = 1;
      Eigen::Index first = -1;
      for (std::size_t i = 0; i < used.size(); ++i) {
        const double to = trial[static_cast<Eigen::Index>(i)];
        const double part = x[used[i]] / (x[used[i]] - to);
        if (to >= 0 || part >= way) continue;
        way = part;
        first = used[i];
      }
      for (std::size_t i = 0; i < used.size(); ++i) {
        x[used[i]] += way * (trial[static_cast<Eigen::Index>(i)] - x[used[i]]);
      }
      if (first < 0) break;
      x[first] = 0;
      std::erase(used, first);
    }
  }
  return x;
}

class Fit {
public:
  Fit(std::span<const CurvePoint> points, bool softening) : points_(points), softening_(softening) {
    const auto n = static_cast<Eigen::Index>(points.size());
    stress_.resize(n);
    weight_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const CurvePoint& point = points[static_cast<std::size_t>(i)];
      weight_[i] = std::sqrt(point.weight);
      stress_[i] = weight_[i] * point.stress;
    }
  }

  // Slopes and cost of given corners; an infinite cost where the corners cannot be those of a law.
  Polygon with_corners(std::vector<double> corners) const {
    Polygon polygon;
    std::sort(corners.begin(), corners.end());
    polygon.corners = std::move(corners);
    const MatX A = shares(polygon.corners);
    if (A.colwise().norm().minCoeff() <= 0) return polygon; // a part without a point
    // branches begin at their stresses, so that only the last one may be level; one that softens is a difference of two
    const Eigen::Index last = A.cols() - 1;
    const Eigen::Index softer = softening_ ? last - 1 : 0;
    MatX both_ways(A.rows(), A.cols() + softer);
    both_ways << A, -A.middleCols(1, softer);
    const VecX slopes = non_negative(both_ways, stress_);
    polygon.slopes = slopes.head(A.cols());
    polygon.slopes.segment(1, softer) -= slopes.tail(softer);
    const double elastic = polygon.slopes[0];
    const double smallest =
        softening_ ? polygon.slopes.head(last).cwiseAbs().minCoeff() : polygon.slopes.head(last).minCoeff();
    if (!(elastic > 0 && smallest > 0 && polygon.slopes.tail(last).maxCoeff() < elastic)) return polygon;
    polygon.cost = (A * polygon.slopes - stress_).squaredNorm();
    return polygon;
  }

  // Gauss-Newton on corners and slopes, downhill.
  void move_together(Polygon& polygon) const {
    constexpr int enough = 100;
    const auto n = static_cast<Eigen::Index>(polygon.corners.size());
    for (int iteration = 0; iteration < enough; ++iteration) {
      MatX A(stress_.size(), 2 * n + 1);
      A.leftCols(n + 1) = shares(polygon.corners);
      for (Eigen::Index j = 0; j < n; ++j) {
        const double corner = polygon.corners[static_cast<std::size_t>(j)];
        const double change = polygon.slopes[j] - polygon.slopes[j + 1];
        for (Eigen::Index i = 0; i < stress_.size(); ++i) {
          const bool beyond = points_[static_cast<std::size_t>(i)].strain > corner;
          A(i, n + 1 + j) = beyond ? weight_[i] * change : 0;
        }
      }
      const VecX step = A.colPivHouseholderQr().solve(stress_ - A.leftCols(n + 1) * polygon.slopes).tail(n);
      if (!step.allFinite()) return;
      bool better = false;
      for (double part = 1; part > 1e-4 && !better; part /= 2) {
        std::vector<double> corners = polygon.corners;
        for (Eigen::Index j = 0; j < n; ++j) corners[static_cast<std::size_t>(j)] += part * step[j];
        if (!std::is_sorted(corners.begin(), corners.end()) || !(corners.front() > 0)) continue;
        Polygon next = with_corners(std::move(corners));
        better = next.cost < polygon.cost;
        if (better) polygon = std::move(next);
      }
      if (!better) return;
    }
  }

  // Each corner by golden section between its neighbours' points: the cost has kinks where a corner meets a point.
  void move_one_by_one(Polygon& polygon, double reach) const {
    const double golden = 0.5 * (std::sqrt(5.0) - 1);
    for (std::size_t j = 0; j < polygon.corners.size(); ++j) {
      const auto moved = [&](double corner) {
        std::vector<double> corners = polygon.corners;
        corners[j] = corner;
        return with_corners(std::move(corners));
      };
      double low = polygon.corners[j] - reach;
      double high = polygon.corners[j] + reach;
      Polygon best = polygon;
      for (int i = 0; i < 60; ++i) {
        const double a = high - golden * (high - low);
        const double b = low + golden * (high - low);
        Polygon at_a = moved(a);
        Polygon at_b = moved(b);
        const bool left = at_a.cost < at_b.cost;
        (left ? high : low) = left ? b : a;
        Polygon& better = left ? at_a : at_b;
        if (better.cost < best.cost) best = std::move(better);
      }
      polygon = std::move(best);
    }
  }

private:
  MatX shares(const std::vector<double>& corners) const {
    MatX A(stress_.size(), static_cast<Eigen::Index>(corners.size()) + 1);
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index k = 0; k < A.cols(); ++k) {
        A(i, k) = weight_[i] * share(corners, static_cast<std::size_t>(k), points_[static_cast<std::size_t>(i)].strain);
      }
    }
    return A;
  }

  std::span<const CurvePoint> points_;
  bool softening_ = false;
  VecX stress_, weight_; // stress times root of the weight; root of the weight
};

// Places for corners: halfway between different strains above 0, at most so many.
std::vector<double> places(std::span<const CurvePoint> points) {
  std::vector<double> strains;
  for (const CurvePoint& point : points) {
    if (point.strain > 0 && point.weight > 0) strains.push_back(point.strain);
  }
  std::sort(strains.begin(), strains.end());
  strains.erase(std::unique(strains.begin(), strains.end()), strains.end());
  std::vector<double> between;
  for (std::size_t i = 0; i + 1 < strains.size(); ++i) between.push_back(0.5 * (strains[i] + strains[i + 1]));
  constexpr std::size_t most = 80;
  if (between.size() <= most) return between;
  std::vector<double> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(between[i * (between.size() - 1) / (most - 1)]);
  return some;
}

// The best place for one more corner.
Polygon with_one_more(const Fit& fit, const std::vector<double>& corners, const std::vector<double>& grid) {
  Polygon best;
  for (const double place : grid) {
    std::vector<double> more = corners;
    more.push_back(place);
    Polygon next = fit.with_corners(std::move(more));
    if (next.cost < best.cost) best = std::move(next);
  }
  return best;
}

// Takes each corner out and puts it back where it is best, until none wants to move.
void exchange(const Fit& fit, const std::vector<double>& grid, Polygon& polygon) {
  constexpr int enough = 20;
  for (int round = 0; round < enough; ++round) {
    bool better = false;
    for (std::size_t j = 0; j < polygon.corners.size(); ++j) {
      std::vector<double> others = polygon.corners;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(j));
      Polygon next = with_one_more(fit, others, grid);
      if (!(next.cost < polygon.cost)) continue;
      polygon = std::move(next);
      better = true;
    }
    if (!better) return;
  }
}

} // namespace

double HardeningFit::stress_at(double strain) const {
  double slope = youngs_modulus;
  double corner = 0; // strain and stress where the slope begins
  double stress = 0;
  for (const HardeningBranch& branch : branches) {
    const double next = corner + (branch.stress - stress) / slope;
    if (strain <= next) break;
    corner = next;
    stress = branch.stress;
    slope = branch.modulus * youngs_modulus / (youngs_modulus + branch.modulus);
  }
  return stress + slope * (strain - corner);
}

std::optional<HardeningFit> fit_hardening(std::span<const CurvePoint> points, int branches, bool softening) {
  const std::vector<double> grid = places(points);
  if (branches < 1 || static_cast<int>(grid.size()) < 2 * branches) return std::nullopt;
  const Fit fit(points, softening);
  Polygon polygon;
  double rounding = 0; // cost of an exact fit
  double count = 0;
  for (const CurvePoint& point : points) {
    rounding += 1e-24 * point.weight * point.stress * point.stress;
    count += point.weight > 0 ? 1 : 0;
  }
  // Schwarz (1978), Ann. Stat. 6: what a branch more must gain, n log(cost), to be more than noise; as three unknowns,
  // for the place of a corner finds more noise to fit than an unknown of its own does
  const double worth = std::pow(count, -3 / count);
  for (int i = 0; i < branches; ++i) {
    Polygon next = with_one_more(fit, polygon.corners, grid);
    if (!std::isfinite(next.cost)) break;
    exchange(fit, grid, next);
    fit.move_together(next);
    if (!(next.cost < worth * polygon.cost)) break;
    polygon = std::move(next);
    if (polygon.cost <= rounding) break;
  }
  if (polygon.corners.empty()) return std::nullopt;
  constexpr double straight = 0.99; // of the elastic slope
  if (polygon.slopes[1] > straight * polygon.slopes[0]) return std::nullopt;
  const double reach = grid.back() / static_cast<double>(grid.size());
  for (int i = 0; i < 3; ++i) {
    fit.move_one_by_one(polygon, reach);
    fit.move_together(polygon);
  }
  HardeningFit result;
  result.youngs_modulus = polygon.slopes[0];
  result.cost = polygon.cost;
  double stress = 0;
  for (std::size_t j = 0; j < polygon.corners.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    stress += polygon.slopes[k] * (polygon.corners[j] - (j == 0 ? 0 : polygon.corners[j - 1]));
    const double tangent = polygon.slopes[k + 1];
    result.branches.push_back({stress, tangent * polygon.slopes[0] / (polygon.slopes[0] - tangent)});
  }
  return result;
}

} // namespace pneuma::solver::material
