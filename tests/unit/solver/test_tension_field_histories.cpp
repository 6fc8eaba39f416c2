// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <Eigen/Eigenvalues>

#include "tests/unit/solver/histories.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const Flow plastic{etfe_hardening(), {}};
const Flow creeping{etfe_hardening(), {Overstress::perzyna, 1e4, 0.3, 1.5e6}};

template <class M>
struct PlasticTensionField : testing::Test {};
using Laws = testing::Types<J2, Logarithmic>;
TYPED_TEST_SUITE(PlasticTensionField, Laws);

template <class M>
constexpr bool logarithmic = std::is_base_of_v<Logarithmic, M>;

// Strain of principal strains in the measure in which the law is linear.
template <class M>
Vec3 turned(double e1, double e2, double angle) {
  if constexpr (logarithmic<M>) return strain_of(std::exp(e1), std::exp(e2), angle);
  return strain_of(std::sqrt(1 + 2 * e1), std::sqrt(1 + 2 * e2), angle);
}

Eigen::Vector2d principal(double a, double b, double off) {
  Mat2 m;
  m << a, off, off, b;
  return Eigen::SelfAdjointEigenSolver<Mat2>(m).eigenvalues();
}

TYPED_TEST(PlasticTensionField, StretchedAlongOneDirectionFollowsOneDimensionalPlasticityWithoutCompression) {
  // slack -> taut -> yielded -> slack, twice, folded across: T = E (e - p), nothing where e < p
  const double E = etfe_elasticity.youngs_modulus;
  const double angle = 0.4;
  Path<TensionField<TypeParam>> path{{{etfe_elasticity, plastic}}};
  double p = 0;
  double alpha = 0;
  const Hardening h = etfe_hardening();
  for (const double e1 : {-0.05, 0.01, 0.05, 0.045, 0.02, 0.0449, 0.06, 0.02, 0.068, -0.01}) {
    const double trial = E * (e1 - p);
    const double increment = std::max(0.0, trial - h.stress(alpha)) / (E + 160e6);
    alpha += increment;
    p += increment;
    const Vec3 strain = turned<TypeParam>(e1, -0.3, angle);
    const Response r = path.accept(strain);
    const double T = std::max(0.0, E * (e1 - p));
    const double s = logarithmic<TypeParam> ? T / std::exp(2 * e1) : T;
    const Vec3 expected =
        s * Vec3(std::pow(std::cos(angle), 2), std::pow(std::sin(angle), 2), std::cos(angle) * std::sin(angle));
    EXPECT_LT((r.stress - expected).norm(), 1e-13 * E) << e1;
    EXPECT_NEAR(path.alpha(), alpha, 1e-14) << e1;
    EXPECT_NEAR(r.energy, 0.5 * T * T / E, 1e-13 * E) << e1;
    const Relaxed relaxed = path.law.relaxed(strain, path.history.data());
    EXPECT_EQ(relaxed.surface, T > 0 ? Surface::wrinkled : Surface::slack) << e1;
    if (logarithmic<TypeParam> && T > 0) { // the width of uniaxial tension
      EXPECT_NEAR(std::log(path.thickness(strain)), -0.43 * (e1 - p) - 0.5 * p, 1e-13);
    }
  }
  EXPECT_GT(alpha, 0.04);
}

// Steps of any kind, taut, wrinkled and slack.
template <Material M>
Vec3 walk(Path<TensionField<M>>& path, std::mt19937& random, double size) {
  std::uniform_real_distribution<double> d(-size, size);
  const Vec3 strain = turned<M>(d(random), d(random), 50 * d(random));
  path.accept(strain, 10);
  return strain;
}

TYPED_TEST(PlasticTensionField, CarriesNoCompressionAndWrinklesDoNoWorkAfterAnyHistory) {
  std::mt19937 random(31);
  int wrinkled = 0;
  for (const Flow& flow : {plastic, creeping}) {
    for (int i = 0; i < 300; ++i) {
      Path<TensionField<TypeParam>> path{{{etfe_elasticity, flow}}};
      for (int k = 0; k < i % 4; ++k) walk(path, random, 0.1);
      Path<TensionField<TypeParam>> next = path;
      const Vec3 strain = walk(next, random, 0.1);
      const auto at = path.at(strain, 10);
      const Vec3& s = at.response.stress;
      const double E = etfe_elasticity.youngs_modulus;
      EXPECT_GE(principal(s[0], s[1], s[2])[0], -1e-13 * E);
      const Relaxed relaxed = path.law.relaxed(strain, at.history.data()); // of the accepted state
      const Vec3 p = relaxed.strain - strain;
      EXPECT_GE(principal(p[0], p[1], 0.5 * p[2])[0], -1e-10);
      EXPECT_NEAR(s.dot(p), 0, 1e-9 * E * strain.norm());
      wrinkled += relaxed.surface == Surface::wrinkled ? 1 : 0;
      EXPECT_GE(next.dissipated(), path.dissipated());
      // again from there, without time
      Path<TensionField<TypeParam>> accepted{path.law, at.history};
      EXPECT_LT((accepted.at(strain).response.stress - s).norm(), 1e-12 * E) << i;
    }
  }
  EXPECT_GT(wrinkled, 150);
}

TYPED_TEST(PlasticTensionField, TangentAndStressAreDerivativesAfterAnyHistory) {
  std::mt19937 random(37);
  int checked = 0;
  for (const Flow& flow : {plastic, creeping}) {
    for (int i = 0; i < 200; ++i) {
      Path<TensionField<TypeParam>> path{{{etfe_elasticity, flow}}};
      for (int k = 0; k < i % 4; ++k) walk(path, random, 0.1);
      Path<TensionField<TypeParam>> next = path;
      const Vec3 strain = walk(next, random, 0.1);
      constexpr double step = 1e-6;
      const auto piece = [&](const Vec3& e) {
        const auto at = path.at(e, 10);
        const double alpha = at.history[3];
        const long branch = alpha == path.alpha() ? -1 : flow.hardening.branch(alpha) - flow.hardening.branches->data();
        return std::pair(branch, path.law.relaxed(e, at.history.data()).surface);
      };
      bool smooth = piece(strain).second != Surface::slack;
      for (int k = 0; k < 3 && smooth; ++k) {
        smooth = piece(strain + 10 * step * Vec3::Unit(k)) == piece(strain) &&
                 piece(strain - 10 * step * Vec3::Unit(k)) == piece(strain);
      }
      if (!smooth) continue;
      ++checked;
      EXPECT_LT(path.tangent_error(strain, 10, step), 1e-8) << i; // measured: 3e-10 and 6e-11
      EXPECT_LT(path.stress_error(strain, 10, step), 1e-8) << i;
    }
  }
  EXPECT_GT(checked, 150);
}

// A law that counts how often it is asked.
template <Material M>
struct Counting : M {
  static inline int count = 0;
  Status evaluate(const Vec3& strain, const double* old_history, double* new_history, double dt,
                  Response& response) const noexcept {
    ++count;
    return M::evaluate(strain, old_history, new_history, dt, response);
  }
};

TYPED_TEST(PlasticTensionField, AsksItsLawFewTimesWhereItsHistoryLiesAslant) {
  std::mt19937 random(41);
  using Law = Counting<TypeParam>;
  int points = 0;
  int largest = 0;
  int sum = 0;
  for (int i = 0; i < 500; ++i) {
    Path<TensionField<Law>> path{{{{etfe_elasticity, plastic}}}};
    for (int k = 0; k < 3; ++k) walk(path, random, 0.1);
    Path<TensionField<Law>> next = path;
    const Vec3 strain = walk(next, random, 0.1);
    if (next.law.relaxed(strain, next.history.data()).surface != Surface::wrinkled) continue;
    Law::count = 0;
    path.at(strain, 10);
    ++points;
    sum += Law::count;
    largest = std::max(largest, Law::count);
  }
  EXPECT_GT(points, 100);
  // measured: 4.8 and 7 with J2, whose wrinkles lie across the principal elastic strain; 19 and 26 where they turn
  EXPECT_LT(static_cast<double>(sum) / points, logarithmic<TypeParam> ? 25 : 6);
  EXPECT_LT(largest, logarithmic<TypeParam> ? 50 : 10);
}

} // namespace
} // namespace pneuma::tests
