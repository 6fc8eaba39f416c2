// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace pneuma::solver::material {

// Isotropic hardening, piecewise linear: yield stress against accumulated equivalent plastic strain alpha. The table is
// built once by `piecewise_linear` and shared by all copies of a law; without one the material never yields.
struct Hardening {
  // From alpha on the yield stress is stress + modulus (alpha - own alpha), until the next branch begins.
  struct Branch {
    double alpha = 0;   // equivalent plastic strain, -
    double stress = 0;  // yield stress, Pa
    double modulus = 0; // d stress / d alpha (plastic modulus), Pa
  };

  std::shared_ptr<const std::vector<Branch>> branches;

  // The branch at alpha >= 0; at a corner the one that loading leads into.
  const Branch* branch(double alpha) const noexcept {
    const auto next = std::upper_bound(branches->begin() + 1, branches->end(), alpha,
                                       [](double a, const Branch& b) { return a < b.alpha; });
    return &*(next - 1);
  }

  static double stress(const Branch& b, double alpha) noexcept { return b.stress + b.modulus * (alpha - b.alpha); }

  double stress(double alpha) const noexcept {
    return branches ? stress(*branch(alpha), alpha) : std::numeric_limits<double>::infinity();
  }

  // The parts of alpha .. alpha + increment that lie within one branch each: take(from, to, yield stress at `from`,
  // modulus), `from` and `to` counted from alpha on.
  template <class F>
  void for_each_part(double alpha, double increment, const F& take) const {
    const Branch* last = branches->data() + branches->size() - 1;
    double from = 0;
    for (const Branch* b = branch(alpha);; ++b) {
      const double to = b == last ? increment : std::min(increment, b[1].alpha - alpha);
      take(from, to, stress(*b, alpha + from), b->modulus);
      if (b == last || to == increment) return;
      from = to;
    }
  }

  // Work of the yield stress from alpha to alpha + increment, J/m3.
  double work(double alpha, double increment) const noexcept {
    double sum = 0;
    for_each_part(alpha, increment, [&sum](double from, double to, double stress_at_from, double modulus) {
      sum += (to - from) * (stress_at_from + 0.5 * modulus * (to - from));
    });
    return sum;
  }
};

// A branch as its user states it: from this yield stress on, its modulus; both Pa.
struct HardeningBranch {
  double stress = 0;
  double modulus = 0; // d stress / d alpha (plastic modulus), unless it is said to be another
};

// The plastic modulus of a branch whose d stress / d strain under tension is given, Pa: 1/Et = 1/E + 1/K.
inline double plastic_modulus(double tangent, double youngs_modulus) noexcept {
  return youngs_modulus * tangent / (youngs_modulus - tangent);
}

// The plastic strain over which a branch leads to the next one's yield stress; none where it does not: its modulus is
// zero or of the other sign.
inline std::optional<double> length_of(const HardeningBranch& branch, const HardeningBranch& next) noexcept {
  const double length = (next.stress - branch.stress) / branch.modulus;
  if (!(length > 0 && length < std::numeric_limits<double>::infinity())) return std::nullopt;
  return length;
}

// The table of branches, the first of which begins at alpha = 0 and whose plastic moduli lead from stress to stress;
// the last goes on without end. None if there is no branch, a yield stress is not positive, a branch does not lead to
// the next one's stress or the last one softens (the yield stress would end below zero).
inline std::optional<Hardening> piecewise_linear(std::span<const HardeningBranch> stated) {
  if (stated.empty()) return std::nullopt;
  std::vector<Hardening::Branch> branches;
  double alpha = 0;
  for (std::size_t i = 0; i < stated.size(); ++i) {
    const HardeningBranch& b = stated[i];
    if (!(b.stress > 0)) return std::nullopt;
    branches.push_back({alpha, b.stress, b.modulus});
    if (i + 1 == stated.size()) break;
    const std::optional<double> to_next = length_of(b, stated[i + 1]);
    if (!to_next) return std::nullopt;
    alpha += *to_next;
  }
  if (!(branches.back().modulus >= 0)) return std::nullopt;
  return Hardening{std::make_shared<const std::vector<Hardening::Branch>>(std::move(branches))};
}

} // namespace pneuma::solver::material
