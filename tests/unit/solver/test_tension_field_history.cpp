// SPDX-License-Identifier: GPL-3.0-or-later
// Foils that yield and wrinkle: plastic strain whose axes are not those of the strain, cycles through every state.
#include <cmath>

#include <Eigen/Eigenvalues>

#include "tests/unit/solver/histories.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const Flow plastic{etfe_hardening(), {}};
const Flow peric{etfe_hardening(), {Overstress::peric, 100, 0.2, {}}};
const Flow creeping{etfe_hardening(), {Overstress::perzyna, 1e4, 0.3, 1.5e6}};
const std::vector<std::pair<const char*, Flow>> flows{{"plastic", plastic}, {"peric", peric}, {"creeping", creeping}};
const double modulus = etfe_elasticity.youngs_modulus;

template <class M>
struct PlasticTensionField : testing::Test {};
using Laws = testing::Types<J2, Logarithmic>;
TYPED_TEST_SUITE(PlasticTensionField, Laws);

Eigen::Vector2d principal(double a, double b, double off) {
  Mat2 m;
  m << a, off, off, b;
  return Eigen::SelfAdjointEigenSolver<Mat2>(m).eigenvalues();
}

template <Material M>
Relaxed relaxed(const Path<TensionField<M>>& path, const Vec3& strain, double dt) {
  // of the history that the step leaves: without time it answers as the step did
  return path.law.relaxed(strain, path.at(strain, dt).history.data());
}

// Calls f(path after up to three steps of any directions, strain, dt).
template <Material M, class F>
void for_histories(double size, const F& f) {
  std::mt19937 random(19);
  std::uniform_real_distribution<double> d(-size, size);
  std::uniform_real_distribution<double> decade(-2, 4);
  const auto strain = [&] { return strain_of(std::exp(d(random)), std::exp(d(random)), 50 * d(random)); };
  for (const auto& [name, flow] : flows) {
    for (int i = 0; i < 150; ++i) {
      Path<TensionField<M>> path{{{etfe_elasticity, flow}}};
      for (int k = 0; k < i % 4; ++k) path.accept(strain(), std::pow(10, decade(random)));
      f(path, strain(), std::pow(10, decade(random)));
    }
  }
}

TYPED_TEST(PlasticTensionField, CarriesNoCompressionAndWrinklesDoNoWorkAfterAnyHistory) {
  for (const double size : {0.03, 0.3}) {
    int wrinkled = 0, slack = 0;
    for_histories<TypeParam>(size, [&](const Path<TensionField<TypeParam>>& path, const Vec3& strain, double dt) {
      const Response at = path.at(strain, dt).response;
      const Relaxed r = relaxed(path, strain, dt);
      const Vec3 p = r.strain - strain;
      EXPECT_GE(principal(at.stress[0], at.stress[1], at.stress[2])[0], -1e-14 * modulus * size);
      EXPECT_GE(principal(p[0], p[1], 0.5 * p[2])[0], -1e-14);
      EXPECT_NEAR(at.stress.dot(p), 0, 1e-14 * modulus * size * size);
      wrinkled += r.surface == Surface::wrinkled ? 1 : 0;
      slack += r.surface == Surface::slack ? 1 : 0;
      // the law itself, laid flat, feels the same
      const Path<TypeParam> felt{path.law.law, path.history};
      const auto flat = felt.at(r.strain, dt);
      EXPECT_LT((flat.response.stress - at.stress).norm(), 1e-14 * modulus);
      EXPECT_NEAR(flat.response.potential, at.potential, 1e-14 * modulus * size);
      EXPECT_NEAR(flat.history[3], path.at(strain, dt).history[3], 1e-13);
    });
    EXPECT_GT(wrinkled, 150);
    EXPECT_GT(slack, 30);
  }
}

TYPED_TEST(PlasticTensionField, HasTheLeastPotentialOfAllWrinkles) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double size : {0.03, 0.3}) {
    for_histories<TypeParam>(size, [&](const Path<TensionField<TypeParam>>& path, const Vec3& strain, double dt) {
      const double least = path.at(strain, dt).response.potential;
      const Vec3 best = relaxed(path, strain, dt).strain - strain;
      const Path<TypeParam> felt{path.law.law, path.history};
      for (const double apart : {1e-3, 0.1, 1.0}) {
        for (int i = 0; i < 5; ++i) {
          const Vec3 other = best + apart * size * Vec3(unit(random), unit(random), unit(random));
          if (principal(other[0], other[1], 0.5 * other[2])[0] < 0) continue;
          EXPECT_GE(felt.at(strain + other, dt).response.potential, least - 1e-14 * modulus * size);
        }
      }
    });
  }
}

TYPED_TEST(PlasticTensionField, StressAndTangentAreDerivativesAfterAnyHistory) {
  int wrinkled = 0;
  for (const double size : {0.03, 0.3}) {
    for_histories<TypeParam>(size, [&](const Path<TensionField<TypeParam>>& path, const Vec3& strain, double dt) {
      // the same surface and the same branch of the hardening all around
      const Hardening& h = path.law.law.flow.hardening;
      const auto piece = [&](const Vec3& other) {
        const double alpha = path.at(other, dt).history[3];
        const auto branch = alpha == path.alpha() ? -1 : h.branch(alpha) - h.branches->data();
        return std::pair(relaxed(path, other, dt).surface, branch);
      };
      const auto here = piece(strain);
      for (int k = 0; k < 3; ++k) {
        if (piece(strain + 1e-4 * Vec3::Unit(k)) != here || piece(strain - 1e-4 * Vec3::Unit(k)) != here) return;
      }
      const Mat3 tangent = path.at(strain, dt).response.tangent;
      if (here.first == Surface::slack) {
        EXPECT_TRUE(tangent.isZero(0));
        return;
      }
      EXPECT_LT(path.tangent_error(strain, dt, 1e-6), 1e-7);
      EXPECT_LT(path.stress_error(strain, dt, 1e-6), 1e-7);
      EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-14);
      wrinkled += here.first == Surface::wrinkled ? 1 : 0;
    });
  }
  EXPECT_GT(wrinkled, 200);
}

TYPED_TEST(PlasticTensionField, AnswersTheSameFromItsAcceptedHistoryWithoutTime) {
  for (const double size : {0.03, 0.3}) {
    for_histories<TypeParam>(size, [&](Path<TensionField<TypeParam>> path, const Vec3& strain, double dt) {
      const Response first = path.accept(strain, dt);
      const auto again = path.at(strain, 0);
      EXPECT_LT((again.response.stress - first.stress).norm(), 4e-15 * modulus);
      EXPECT_NEAR(again.history[3], path.alpha(), 1e-14);
    });
  }
}

TYPED_TEST(PlasticTensionField, GoesFromSlackToTautToYieldedToSlackAndBack) {
  Path<TensionField<TypeParam>> path{{{etfe_elasticity, plastic}}};
  const auto at = [](double e1, double e2, double angle) { return strain_of(1 + e1, 1 + e2, angle); };
  EXPECT_TRUE(path.accept(at(-0.01, -0.02, 0.3)).stress.isZero(0));
  EXPECT_EQ(path.alpha(), 0);
  path.accept(at(0.005, 0.004, 0.3)); // taut, elastic
  EXPECT_EQ(path.alpha(), 0);
  const Response yielded = path.accept(at(0.12, 0.03, 0.3));
  EXPECT_GT(path.alpha(), 0.05);
  path.accept(at(0.1, 0.08, 1.1)); // and along other axes
  const double dissipated = path.dissipated();
  EXPECT_GT(dissipated, 0);
  const Vec3 longer = path.law.stress_free_strain(path.history.data());
  EXPECT_GT(longer[2], 0.01);

  // back at its first length it is too long by what has flowed: no stress, no energy, nothing flows, by any way
  const auto history = path.history;
  for (const Vec3& strain : {at(0, 0, 0), at(-0.2, 0.001, 0.7), at(-0.3, -0.3, 0), at(0, 0, 0)}) {
    const Response slack = path.accept(strain, 1);
    EXPECT_TRUE(slack.stress.isZero(0));
    EXPECT_LT(slack.energy, 1e-16 * modulus);
    EXPECT_EQ(path.law.relaxed(strain, path.history.data()).surface, Surface::slack);
    EXPECT_EQ(path.history, history);
  }
  // pulled along one of its axes alone it wrinkles, elastically, with no more than it carried before
  const Response wrinkled = path.accept(Vec3(longer[0] + 0.005, 0, 0));
  EXPECT_GT(wrinkled.stress[0], 1e6);
  EXPECT_EQ(path.law.relaxed(Vec3(longer[0] + 0.005, 0, 0), path.history.data()).surface, Surface::wrinkled);
  EXPECT_EQ(path.dissipated(), dissipated);
  // stretched again to where it was it carries what it carried
  Path<TensionField<TypeParam>> held = path;
  held.history = history;
  const Response before = held.at(at(0.1, 0.08, 1.1)).response;
  EXPECT_LT((path.accept(at(0.1, 0.08, 1.1)).stress - before.stress).norm(), 4e-15 * modulus);
  EXPECT_EQ(path.dissipated(), dissipated);
  EXPECT_GT(yielded.potential, yielded.energy);
}

template <class M>
constexpr bool logarithmic = std::is_base_of_v<Logarithmic, M>;

// Strain of principal strains in the measure in which the law is linear.
template <class M>
Vec3 turned(double e1, double e2, double angle) {
  if constexpr (logarithmic<M>) return strain_of(std::exp(e1), std::exp(e2), angle);
  return strain_of(std::sqrt(1 + 2 * e1), std::sqrt(1 + 2 * e2), angle);
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

TYPED_TEST(PlasticTensionField, AsksItsLawAFewTimes) {
  for (const double size : {0.03, 0.3}) {
    int sum = 0, wrinkled = 0;
    for_histories<TypeParam>(size, [&](const Path<TensionField<TypeParam>>& path, const Vec3& strain, double dt) {
      const TensionField<Counted<TypeParam>> law{{path.law.law}};
      std::array<double, 5> history;
      Response response;
      Counted<TypeParam>::asked = 0;
      law.evaluate(strain, path.history.data(), history.data(), dt, response);
      EXPECT_LE(Counted<TypeParam>::asked, 25);
      if (relaxed(path, strain, dt).surface != Surface::wrinkled) return;
      sum += Counted<TypeParam>::asked;
      ++wrinkled;
    });
    std::printf("%.2f: %.1f evaluations a wrinkled point\n", size, double(sum) / wrinkled);
    EXPECT_LT(sum, 12 * wrinkled);
  }
}

} // namespace
} // namespace pneuma::tests
