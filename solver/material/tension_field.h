// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "solver/material/concept.h"

namespace pneuma::solver::material {

// What a foil without bending stiffness does at a point: pulled in all directions, in one, in none.
enum class Surface : std::uint8_t { taut, wrinkled, slack };

// What the material itself feels at a point: its strain with the wrinkles laid flat, E* = E + wrinkle strain.
struct Relaxed {
  Surface surface = Surface::taut;
  Vec3 strain = Vec3::Zero();
};

// Tension field over a law: a foil that cannot carry compression. It feels E* = E + P, P the positive semidefinite
// strain that wrinkles take up, with the least potential W*(E) = min W(E + P) (Pipkin 1986, IMA J. Appl. Math. 36);
// E0 is the strain at which its history leaves no stress:
//   taut      S(E) has no negative principal value: P = 0
//   wrinkled  P = a m (x) m, a > 0, no traction across: S* m = 0, so that S* = s t (x) t, s > 0
//   slack     no direction t is stretched, E <= E0: E* = E0, S* = 0
// Potential, stress and tangent are those of W*; it is once continuously differentiable. m is not assumed to be a
// principal direction of E (it is for isotropic laws); a by Newton in a bracket (W is convex in it), from there both by
// Newton, and where that leads nowhere the angle from many starts with a line search on the potential. History is
// updated from E*; the wrinkles leave none. Fails only where the strain is not finite or the law fails however far the
// wrinkles are laid flat.
template <Material M>
struct TensionField {
  static constexpr auto history_names = M::history_names;

  M law;

  Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                  Response& response) const noexcept {
    const Solution solution = solve({strain, old_history, new_history, dt});
    if (solution.status != Status::ok) return solution.status;
    response = solution.law;
    Vec3& stress = response.stress;
    Mat3& tangent = response.tangent;
    if (solution.surface == Surface::slack) {
      stress.setZero();
      tangent.setZero();
      return Status::ok;
    }
    if (solution.surface == Surface::wrinkled) {
      // d(S* m) = 0 with dE* = dE + da m (x) m - 2 a dtheta sym(t (x) m), condensed: the second unknown is scaled by
      // sqrt(2 a), which keeps the matrix finite where wrinkles begin (a = 0) and where the tension ends (s = 0)
      const double s = std::max(solution.along.dot(stress), 0.0);
      const double root = std::sqrt(2 * solution.amount);
      const Vec3 u = tangent * solution.across;
      const Vec3 v = root * (tangent * solution.shear);
      const double h11 = solution.across.dot(u);
      const double h12 = solution.across.dot(v);
      const double h22 = root * solution.shear.dot(v) + s;
      const Vec3 w = v - (h12 / h11) * u;
      const double h = h22 - h12 * h12 / h11;
      tangent -= u * u.transpose() / h11;
      if (h > 0) tangent -= w * w.transpose() / h;
      stress = s * Vec3(solution.along[0], solution.along[1], 0.5 * solution.along[2]); // S* = s t (x) t
    }
    return Status::ok;
  }

  double thickness_stretch(const Vec3& strain, const double* history) const noexcept {
    return law.thickness_stretch(relaxed(strain, history).strain, history);
  }

  bool is_rate_dependent() const noexcept { return flows_with_time(law); }

  Vec3 stress_free_strain(const double* history) const noexcept { return law.stress_free_strain(history); }

  Relaxed relaxed(const Vec3& strain, const double* history) const noexcept {
    std::array<double, std::max(history_size<M>, 1)> scratch;
    const Solution solution = solve({strain, history, scratch.data(), 0.0});
    if (solution.surface == Surface::slack) return {Surface::slack, law.stress_free_strain(history)};
    return {solution.surface, strain + solution.amount * solution.across};
  }

private:
  struct Point {
    const Vec3& strain;
    const double* old_history;
    double* new_history;
    double dt;
  };

  // The law's answer at strain + amount m (x) m.
  struct Solution {
    Status status = Status::failed;
    Surface surface = Surface::taut;
    double amount = 0; // a
    // t (x) t, m (x) m, sym(t (x) m) as strains: times a stress, its components in t and m
    Vec3 along = Vec3::Zero(), across = Vec3::Zero(), shear = Vec3::Zero();
    Response law;
  };

  bool ask_law(const Point& p, Solution& at) const noexcept {
    const Vec3 strain = p.strain + at.amount * at.across;
    at.status = law.evaluate(strain, p.old_history, p.new_history, p.dt, at.law);
    return at.status == Status::ok && at.law.stress.allFinite();
  }

  static constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

  static void aim(double angle, Solution& at) noexcept {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    at.along = Vec3(c * c, s * s, 2 * c * s);
    at.across = Vec3(s * s, c * c, -2 * c * s);
    at.shear = Vec3(-c * s, c * s, c * c - s * s);
  }

  // Wrinkles across t = (cos, sin) of `angle` laid flat: the amount at which m S m = 0, or none where m S m >= 0
  // without. `plain` is the law's answer without wrinkles.
  Solution lay_flat(const Point& p, const Solution& plain, double angle) const noexcept {
    Solution at = plain;
    aim(angle, at);
    if (plain.status == Status::ok && at.across.dot(plain.law.stress) >= 0) return at;
    // m S m < 0 (or the law fails) at `low`, > 0 at `high`; begin where the foil is as wide as without stress
    const Vec3 missing = law.stress_free_strain(p.old_history) - p.strain;
    const double shortening = Vec3(at.across[0], at.across[1], 0.5 * at.across[2]).dot(missing);
    const double smallest = rounding * p.strain.cwiseAbs().maxCoeff();
    double low = 0;
    double high = -1;
    at.amount = std::max(shortening, smallest);
    constexpr int enough = 200; // doubling and halving alone need about 100
    for (int i = 0; i < enough; ++i) {
      const bool possible = ask_law(p, at);
      const double force = possible ? at.across.dot(at.law.stress) : -1;
      const double slope = possible ? at.across.dot(at.law.tangent * at.across) : 0;
      (force < 0 ? low : high) = at.amount;
      const double newton = at.amount - force / slope;
      if (possible && std::abs(newton - at.amount) <= smallest + rounding * at.amount) break;
      if (newton > low && (high < 0 || newton < high)) { // false for NaN
        at.amount = newton;
      } else if (high < 0) {
        at.amount *= 2;
      } else if (high - low <= smallest) {
        break;
      } else {
        at.amount = 0.5 * (low + high);
      }
    }
    return at;
  }

  Solution solve(const Point& p) const noexcept {
    Solution plain;
    if (!p.strain.allFinite()) return plain;
    if (ask_law(p, plain)) {
      const Vec3& s = plain.law.stress;
      if (s[0] + s[1] >= 0 && s[0] * s[1] >= s[2] * s[2]) return plain;
    }
    const Vec3 free = law.stress_free_strain(p.old_history);
    const Vec3 stretch = p.strain - free;
    const double mean = 0.5 * (stretch[0] + stretch[1]);
    const double half = 0.5 * (stretch[0] - stretch[1]);
    if (mean + std::hypot(half, 0.5 * stretch[2]) <= 0) {
      plain.surface = Surface::slack;
      plain.status = law.evaluate(free, p.old_history, p.new_history, p.dt, plain.law);
      return plain;
    }
    // the direction of the larger principal stretch: exact for isotropic laws without history
    double angle = 0.5 * std::atan2(0.5 * stretch[2], half);
    Solution best = lay_flat(p, plain, angle);
    if (!balanced(p, best) && !settle(p, angle, best)) {
      constexpr int directions = 12;
      const double first = angle;
      for (int i = 1; i < directions; ++i) {
        const double other = first + std::acos(-1.0) * i / directions;
        const Solution at = lay_flat(p, plain, other);
        if (at.status != Status::ok || (best.status == Status::ok && !(at.law.potential < best.law.potential)))
          continue;
        best = at;
        angle = other;
      }
      turn(p, plain, angle, best);
      ask_law(p, best); // the history of the best, not of the last
    }
    // however flat: what is missing is missing without
    if (best.status != Status::ok && plain.status != Status::ok) best.status = plain.status;
    best.surface = Surface::wrinkled;
    return best;
  }

  // No traction across the wrinkles, to rounding.
  static bool balanced(const Point& p, const Solution& at) noexcept {
    const double size = std::max(p.strain.cwiseAbs().maxCoeff(), at.amount);
    const double digits = rounding * size * at.law.tangent.cwiseAbs().maxCoeff();
    return at.status == Status::ok && std::abs(at.across.dot(at.law.stress)) <= digits &&
           std::abs(at.shear.dot(at.law.stress)) <= digits;
  }

  // Newton on amount and angle at once, m S m = t S m = 0, from `best` at `angle`; false where that leads nowhere. With
  // tension along t it is the minimum wherever the potential is convex.
  bool settle(const Point& p, double angle, Solution& best) const noexcept {
    Solution at = best;
    constexpr int soon = 10;
    for (int i = 0; i < soon && at.status == Status::ok; ++i) {
      const Vec3& stress = at.law.stress;
      const double across = at.across.dot(stress);
      const double shear = at.shear.dot(stress);
      const double along = at.along.dot(stress);
      if (balanced(p, at)) {
        if (along < 0) return false;
        best = at;
        return true;
      }
      const Vec3 u = at.law.tangent * at.across;
      const Vec3 v = -2 * at.amount * (at.law.tangent * at.shear);
      const double a11 = at.across.dot(u), a12 = at.across.dot(v) - 2 * shear; // of m S m
      const double a21 = at.shear.dot(u), a22 = at.shear.dot(v) + across - along;
      const double determinant = a11 * a22 - a12 * a21;
      const double turn = (a21 * across - a11 * shear) / determinant;
      at.amount += (a12 * shear - a22 * across) / determinant;
      constexpr double largest = 0.5;
      if (!(at.amount > 0 && std::abs(turn) < largest)) return false; // NaN too
      angle += turn;
      aim(angle, at);
      ask_law(p, at);
    }
    return false;
  }

  // Newton on the wrinkles' angle, dW/dangle = -2 a t S m, downhill on the potential.
  void turn(const Point& p, const Solution& plain, double& angle, Solution& best) const noexcept {
    constexpr int enough = 50;
    for (int i = 0; i < enough && !balanced(p, best); ++i) {
      const Response& r = best.law;
      const double force = best.shear.dot(r.stress);
      const Vec3 u = r.tangent * best.across;
      const double k = best.shear.dot(r.tangent * best.shear) - std::pow(best.shear.dot(u), 2) / best.across.dot(u);
      const double stiffness = best.along.dot(r.stress) + 2 * best.amount * k;
      constexpr double largest = 0.2;
      double step = stiffness > 0 ? std::clamp(force / stiffness, -largest, largest) : std::copysign(largest, force);
      Solution next = lay_flat(p, plain, angle + step);
      const auto better = [&] {
        if (next.status != Status::ok) return false;
        // of the energy: those of the strain come in by the stress
        const double digits =
            rounding * (r.potential + r.stress.cwiseAbs().maxCoeff() * p.strain.cwiseAbs().maxCoeff());
        return next.law.potential < r.potential - digits ||
               (next.law.potential <= r.potential + digits &&
                std::abs(next.shear.dot(next.law.stress)) < std::abs(force));
      };
      for (int halvings = 0; halvings < 30 && std::abs(step) > rounding && !better(); ++halvings) {
        step /= 2;
        next = lay_flat(p, plain, angle + step);
      }
      if (!better()) return; // to the last digit
      best = next;
      angle += step;
    }
  }
};

} // namespace pneuma::solver::material
