// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

Ogden ogden(std::initializer_list<Ogden::Term> terms) {
  Ogden law;
  for (const Ogden::Term& term : terms) law.terms[static_cast<std::size_t>(law.count++)] = term;
  return law;
}

// Treloar's vulcanised rubber (Ogden 1972, Proc. R. Soc. Lond. A 326, 565; Holzapfel 2000, eq. 6.121).
const Ogden treloar = ogden({{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}});
const MooneyRivlin mooney{0.4e6, 0.1e6};
const Ogden mooney_by_terms = ogden({{0.8e6, 2}, {-0.2e6, -2}});

double modulus_of(const Ogden& law) { // mu alpha summed: twice the shear modulus
  double sum = 0;
  for (const Ogden::Term& term : law.terms) sum += term.mu * term.alpha;
  return sum;
}

// Nominal stress F S where the other direction keeps l2 = l^across.
double nominal(const Ogden& law, double l, double across) {
  double sum = 0;
  for (const Ogden::Term& term : law.terms) {
    sum += term.mu * (std::pow(l, term.alpha) - std::pow(l, -term.alpha * (1 + across)));
  }
  return sum / l;
}

TEST(Ogden, MatchesUniaxialTensionEqualStretchesAndPureShearInClosedForm) {
  for (const Ogden& law : {treloar, mooney_by_terms}) {
    for (const double l : {0.5, 0.9, 1 + 1e-6, 1.1, 2.0, 7.0}) {
      const double scale = answer(law, strain_of(l, l)).tangent.cwiseAbs().maxCoeff() * l * l; // of the largest term
      const Response tension = answer(law, strain_of(l, 1 / std::sqrt(l)));
      EXPECT_NEAR(l * tension.stress[0], nominal(law, l, -0.5), 1e-14 * scale) << l;
      EXPECT_NEAR(tension.stress[1], 0, 1e-14 * scale) << l;
      EXPECT_NEAR(l * answer(law, strain_of(l, 1)).stress[0], nominal(law, l, 0), 1e-14 * scale) << l;
      const Response equal = answer(law, strain_of(l, l));
      EXPECT_NEAR(l * equal.stress[0], nominal(law, l, 1), 1e-14 * scale) << l;
      EXPECT_EQ(equal.stress[0], equal.stress[1]);
      EXPECT_EQ(equal.stress[2], 0);
    }
  }
}

TEST(Ogden, OfTwoAndMinusTwoIsMooneyRivlin) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> stretch(0.4, 5);
  std::uniform_real_distribution<double> turn(0, std::acos(-1.0));
  for (int i = 0; i < 2000; ++i) {
    const double a = stretch(random), b = stretch(random);
    const Vec3 strain = strain_of(a, b, turn(random));
    const Response one = answer(mooney_by_terms, strain);
    const Response other = answer(mooney, strain);
    // rounding of the strain, and of a^2 - b^2 beside the smaller one
    const double rounding = 4e-15 * std::max({1.0, a * a, b * b}) / std::min(a * a, b * b);
    EXPECT_LT(relative_difference(one.tangent, other.tangent), rounding) << a << " " << b;
    EXPECT_LT((one.stress - other.stress).norm(), rounding * other.tangent.norm() * std::max(1.0, strain.norm()));
    EXPECT_NEAR(one.energy, other.energy, rounding * other.energy);
  }
}

TEST(Ogden, StressIsTheDerivativeOfTheEnergyAndTangentOfTheStress) {
  for (const Ogden& law : {treloar, mooney_by_terms}) {
    EXPECT_LT(tangent_error(law, Vec3::Zero(), 1e-3), 1e-9);
    for (const auto& [a, b] : {std::pair{1.3, 0.9}, {2.0, 1.5}, {4.0, 4.0}, {4.0, 0.6}, {1.001, 0.998}, {7.0, 7.0}}) {
      for (const double angle : {0.0, 0.4, 1.3}) {
        const Vec3 strain = strain_of(a, b, angle);
        const double step = 3e-4 * b * b; // relative to the smaller principal value of C, the law's own scale
        EXPECT_LT(tangent_error(law, strain, step), 1e-9) << a << " " << b;
        EXPECT_LT(stress_error(law, strain, step), 1e-9) << a << " " << b;
        const Mat3 tangent = answer(law, strain).tangent;
        EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15);
      }
    }
  }
}

TEST(Ogden, EqualStretchesAreNothingSpecial) {
  for (const double stretch : {1.0, 1.02, 1.5, 4.0}) {
    const Response equal = answer(treloar, strain_of(stretch, stretch));
    for (const double apart : {1e-300, 1e-150, 1e-15, 1e-12, 1e-10, 1e-8}) {
      for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
        const double e = 0.5 * (stretch * stretch - 1);
        const double d = apart * stretch * stretch;
        const Vec3 strain(e + d * std::cos(2 * angle), e - d * std::cos(2 * angle), 2 * d * std::sin(2 * angle));
        EXPECT_LT(tangent_error(treloar, strain, 1e-4), 1e-9) << stretch << " " << apart << " " << angle;
        const Response near = answer(treloar, strain);
        EXPECT_LT(relative_difference(near.tangent, equal.tangent), 20 * apart + 2e-15);
        EXPECT_LT((near.stress - equal.stress).norm(), 4 * d * equal.tangent.cwiseAbs().maxCoeff() + 1e-9);
      }
    }
  }
}

TEST(Ogden, SmallStrainsLoseNoDigits) {
  // incompressible isotropic, E = 3/2 sum mu alpha: S11 = 4/3 E (e11 + e22 / 2), what is left is of second order
  const double e = 1e-9;
  const double modulus = 1.5 * modulus_of(treloar);
  for (const double angle : {0.0, 0.6}) {
    const double along = std::pow(std::cos(angle), 2);
    const Response at = answer(treloar, e * Vec3(along, 1 - along, std::sin(2 * angle)));
    EXPECT_NEAR(at.stress[0] / (2.0 / 3 * modulus * e * (1 + along)), 1, 20 * e);
    EXPECT_NEAR(at.energy / (2.0 / 3 * modulus * e * e), 1, 20 * e);
  }
}

TEST(Ogden, TurnsWithTheMaterialFrame) {
  const Vec3 principal = answer(treloar, strain_of(3, 1.2)).stress;
  for (const double angle : {0.2, 0.9, 1.7, 3.0}) {
    const Vec3 turned = answer(treloar, strain_of(3, 1.2, angle)).stress;
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 expected(c * c * principal[0] + s * s * principal[1], s * s * principal[0] + c * c * principal[1],
                        c * s * (principal[0] - principal[1]));
    EXPECT_LT((turned - expected).cwiseAbs().maxCoeff(), 4e-15 * answer(treloar, strain_of(3, 1.2)).tangent.norm());
  }
}

TEST(Ogden, KeepsItsVolume) {
  EXPECT_NEAR(treloar.thickness_stretch(strain_of(2, 1.25, 0.7), nullptr), 1 / 2.5, 1e-15);
  const Law law = treloar;
  EXPECT_NEAR(thickness_stretch(law, strain_of(4, 4), nullptr), 1.0 / 16, 1e-15);
}

TEST(Ogden, RefusesAStrainWithoutArea) {
  Response a;
  for (const Vec3& strain : {Vec3(-0.5, 0, 0), Vec3(0, 0, 1.1), Vec3(std::nan(""), 0, 0), Vec3(1e300, 0, 0)}) {
    EXPECT_EQ(treloar.evaluate(strain, nullptr, nullptr, 0, a), Status::failed) << strain.transpose();
  }
}

TEST(OgdenInstabilities, HaveNoneWhereEveryTermIsStable) {
  EXPECT_TRUE(instabilities(treloar).empty());
  EXPECT_TRUE(instabilities(mooney_by_terms).empty());
}

TEST(OgdenInstabilities, OfMooneyRivlinWithoutItsSignAreWhereTheClosedFormHasThem) {
  // C2 = -C1 / 4: with a_i = 2 mu alpha-sums a = 4 C1 (x + r / x), x = l^2, r = C2 / C1; pure shear a2 = 4 C1 (1 + r)
  // and a1 a2 + a2 a3 + a3 a1 = 0
  const double c1 = 0.4e6, r = -0.25;
  const Ogden law = ogden({{2 * c1, 2}, {-2 * r * c1, -2}});
  const std::vector<Instability> found = instabilities(law);
  const auto condition = [&](double l, double across) {
    const double x1 = l * l, x2 = std::pow(l, 2 * across), x3 = 1 / (x1 * x2);
    const double a1 = x1 + r / x1, a2 = x2 + r / x2, a3 = x3 + r / x3;
    return std::min(a1 + a2 + 2 * a3, a1 * a2 + a2 * a3 + a3 * a1);
  };
  ASSERT_EQ(found.size(), 6u); // each way of pulling, short and long
  for (const Instability& range : found) {
    const double across = range.pull == Pull::uniaxial ? -0.5 : range.pull == Pull::equibiaxial ? 1 : 0;
    EXPECT_LT(condition(std::sqrt(range.from * range.to), across), 0);
    if (range.from > 0.1) {
      EXPECT_GT(condition(range.from * (1 - 2e-6), across), 0);
      EXPECT_LT(condition(range.from * (1 + 2e-6), across), 0);
    }
    if (range.to < 10) {
      EXPECT_LT(condition(range.to * (1 - 2e-6), across), 0);
      EXPECT_GT(condition(range.to * (1 + 2e-6), across), 0);
    }
  }
}

TEST(OgdenInstabilities, BeginWhereTheTangentOfTheLawLosesItsSign) {
  // the tangent of T by ln l along and across the pull, from the law's own tangent: dT_i/db_j = S_ij C_i C_j + 2 T_i
  const Ogden law = ogden({{0.6e6, 1.5}, {-0.02e6, 4}});
  const std::vector<Instability> found = instabilities(law);
  ASSERT_FALSE(found.empty());
  for (const Instability& range : found) {
    if (range.from <= 0.1) continue;
    const double across = range.pull == Pull::uniaxial ? -0.5 : range.pull == Pull::equibiaxial ? 1 : 0;
    const double l2 = std::pow(range.from, across);
    const Vec3 c(range.from * range.from, l2 * l2, 0);
    const Response at = answer(law, strain_of(range.from, l2));
    Mat2 slope;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) slope(i, j) = at.tangent(i, j) * c[i] * c[j] + (i == j ? 2 * at.stress[i] * c[i] : 0);
    }
    EXPECT_NEAR(slope.determinant(), 0, 1e-4 * slope.squaredNorm());
  }
}

TEST(OgdenInstabilities, OfAMaterialWithoutStiffnessAreEverywhere) {
  const std::vector<Instability> found = instabilities(ogden({{-0.5e6, 2}}));
  ASSERT_EQ(found.size(), 3u);
  for (const Instability& range : found) {
    EXPECT_EQ(range.from, 0.1);
    EXPECT_EQ(range.to, 10);
  }
}

} // namespace
} // namespace pneuma::tests
