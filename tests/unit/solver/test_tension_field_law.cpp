// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

#include "solver/material/prestress.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const TensionField<StVenantKirchhoff> foil{{900e6, 0.45}};
const TensionField<MooneyRivlin> rubber{{0.4e6, 0.1e6}};
const TensionField<Orthotropic> fabric{{1000e6, 300e6, 0.4, 50e6}}; // principal axes of strain and stress differ
const TensionField<Ogden> treloar{{3, {{{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}}}}};

base::Mat2 symmetric(double a, double b, double off) {
  base::Mat2 m;
  m << a, off, off, b;
  return m;
}
Eigen::Vector2d principal(const base::Mat2& m) {
  return Eigen::SelfAdjointEigenSolver<base::Mat2>(m).eigenvalues();
}

// Strain of principal values along axes turned by `angle`.
Vec3 turned(double e1, double e2, double angle) {
  return strain_of(std::sqrt(1 + 2 * e1), std::sqrt(1 + 2 * e2), angle);
}

template <class F>
void for_strains(const F& f) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> d(-0.02, 0.02);
  for (int i = 0; i < 2000; ++i) f(Vec3(d(random), d(random), 2 * d(random)));
}

// What defines a tension field, whatever the law: no compression; the strain that wrinkles take up is not negative; the
// two do no work on each other.
template <Material M>
void expect_tension_field(const TensionField<M>& law, const Vec3& strain) {
  const Response at = answer(law, strain);
  const Relaxed r = law.relaxed(strain, nullptr);
  const Vec3 p = r.strain - strain;
  const Eigen::Vector2d stress = principal(symmetric(at.stress[0], at.stress[1], at.stress[2]));
  const Eigen::Vector2d wrinkle = principal(symmetric(p[0], p[1], 0.5 * p[2]));
  const double modulus = answer(law.law, Vec3::Zero()).tangent.cwiseAbs().maxCoeff();
  const double size = strain.cwiseAbs().maxCoeff();
  EXPECT_GE(stress[0], -1e-14 * modulus * size) << strain.transpose();
  EXPECT_GE(wrinkle[0], -1e-14 * size) << strain.transpose();
  EXPECT_NEAR(at.stress.dot(p), 0, 1e-13 * modulus * size * size) << strain.transpose();
  const Response felt = answer(law.law, r.strain);
  EXPECT_LT((felt.stress - at.stress).cwiseAbs().maxCoeff(), 1e-13 * modulus * size) << strain.transpose();
  EXPECT_NEAR(felt.energy, at.energy, 1e-13 * modulus * size * size);
}

// However else wrinkles lie, the law's potential is not less.
template <Material M>
void expect_least_potential(const TensionField<M>& law, const Vec3& strain, std::mt19937& random) {
  const double least = answer(law, strain).potential;
  const Vec3 best = law.relaxed(strain, nullptr).strain - strain;
  std::uniform_real_distribution<double> unit(-1, 1);
  const double modulus = answer(law.law, Vec3::Zero()).tangent.cwiseAbs().maxCoeff();
  const double size = strain.cwiseAbs().maxCoeff();
  for (const double apart : {1e-3, 0.1, 1.0}) {
    for (int i = 0; i < 5; ++i) {
      const Vec3 other = best + apart * size * Vec3(unit(random), unit(random), unit(random));
      if (principal(symmetric(other[0], other[1], 0.5 * other[2]))[0] < 0) continue;
      Response r;
      if (law.law.evaluate(strain + other, nullptr, nullptr, 0, r) != Status::ok) continue;
      EXPECT_GE(r.potential, least - 1e-14 * modulus * size * size) << strain.transpose();
    }
  }
}

TEST(TensionField, CarriesNoCompressionAndWrinklesDoNoWork) {
  int wrinkled = 0;
  for_strains([&](const Vec3& strain) {
    expect_tension_field(foil, strain);
    expect_tension_field(rubber, strain);
    expect_tension_field(fabric, strain);
    expect_tension_field(treloar, strain);
    expect_tension_field(rubber, 20 * strain); // a fold of 0.4, a stretch of 1.3
    expect_tension_field(treloar, 20 * strain);
    wrinkled += fabric.relaxed(strain, nullptr).surface == Surface::wrinkled ? 1 : 0;
  });
  EXPECT_GT(wrinkled, 500);
}

TEST(TensionField, HasTheLeastPotentialOfAllWrinkles) {
  std::mt19937 random(7);
  for_strains([&](const Vec3& strain) {
    expect_least_potential(foil, strain, random);
    expect_least_potential(fabric, strain, random);
    expect_least_potential(treloar, 20 * strain, random);
  });
}

template <Material M>
void expect_few_evaluations(const M& law, double size, int most) {
  const TensionField<Counted<M>> counted{{law}};
  for_strains([&](const Vec3& strain) {
    Counted<M>::asked = 0;
    answer(counted, size * strain);
    EXPECT_LE(Counted<M>::asked, most) << strain.transpose();
  });
}

TEST(TensionField, AsksItsLawAFewTimes) {
  expect_few_evaluations(foil.law, 1, 3); // plain, as wide as without stress, and where it is linear there is the goal
  expect_few_evaluations(rubber.law, 1, 12);
  expect_few_evaluations(rubber.law, 20, 12);
  expect_few_evaluations(treloar.law, 20, 12);
  expect_few_evaluations(fabric.law, 1, 20); // it turns
}

TEST(TensionField, OfAnIsotropicFoilIsTheClosedForm) {
  // principal strains e1 > e2: taut above e2 = -nu e1, wrinkled below it with S = E e1 along, slack where e1 <= 0
  const double nu = foil.law.poissons_ratio;
  for_strains([&](const Vec3& strain) {
    const Eigen::SelfAdjointEigenSolver<base::Mat2> e(symmetric(strain[0], strain[1], 0.5 * strain[2]));
    const double e1 = e.eigenvalues()[1];
    const double e2 = e.eigenvalues()[0];
    base::Mat2 expected = base::Mat2::Zero();
    if (e1 > 0 && e2 >= -nu * e1) {
      EXPECT_EQ(foil.relaxed(strain, nullptr).surface, Surface::taut);
      const Vec3 s = foil.law.stiffness() * strain;
      expected = symmetric(s[0], s[1], s[2]);
    } else if (e1 > 0) {
      EXPECT_EQ(foil.relaxed(strain, nullptr).surface, Surface::wrinkled);
      expected = foil.law.youngs_modulus * e1 * e.eigenvectors().col(1) * e.eigenvectors().col(1).transpose();
    } else {
      EXPECT_EQ(foil.relaxed(strain, nullptr).surface, Surface::slack);
    }
    const Vec3 s = answer(foil, strain).stress;
    EXPECT_LT((symmetric(s[0], s[1], s[2]) - expected).cwiseAbs().maxCoeff(), 1e-14 * foil.law.youngs_modulus * 0.04);
  });
}

TEST(TensionField, OfRubberLetsItBecomeNarrowAsInUniaxialTension) {
  for (const double stretch : {1.001, 1.3, 4.0}) {
    for (const double width : {1e-6, 0.3, 0.999}) { // part of the natural one
      const double angle = 0.7;
      const Vec3 strain = strain_of(stretch, width / std::sqrt(stretch), angle);
      const Relaxed r = rubber.relaxed(strain, nullptr);
      EXPECT_EQ(r.surface, Surface::wrinkled);
      const Vec3 natural = strain_of(stretch, 1 / std::sqrt(stretch), angle);
      EXPECT_LT((r.strain - natural).norm(), 1e-14 * stretch * stretch) << stretch << " " << width;
      EXPECT_NEAR(rubber.thickness_stretch(strain, nullptr), 1 / std::sqrt(stretch), 1e-13);
    }
  }
}

// Strains in each state, and near the borders between them from either side: there the distance is to be larger than
// the differences' step.
struct At {
  const char* name;
  Vec3 strain;
  double step;
};

TEST(TensionField, StressIsTheDerivativeOfTheEnergyAndTangentOfTheStressInEveryStateAndNearTheBorders) {
  const double nu = foil.law.poissons_ratio;
  const double e = 0.01;
  for (const double angle : {0.0, 0.4, 1.2, -0.7}) {
    for (const At& at :
         {At{"taut", turned(e, 0.5 * e, angle), 1e-5}, At{"wrinkled", turned(e, -e, angle), 1e-5},
          At{"far wrinkled", turned(e, -0.4, angle), 1e-5}, At{"just taut", turned(e, -nu * e + 1e-6, angle), 2e-7},
          At{"just wrinkled", turned(e, -nu * e - 1e-6, angle), 2e-7},
          At{"just not slack", turned(1e-6, -e, angle), 2e-7},
          At{"hardly strained", turned(1e-6, -0.3e-6, angle), 2e-8}}) {
      // rounding of the differences: 1e-16 size / step of the modulus
      const double rounding = 1e-15 * at.strain.cwiseAbs().maxCoeff() / at.step;
      EXPECT_LT(tangent_error(foil, at.strain, at.step), 1e-9 + rounding) << at.name << " " << angle;
      EXPECT_LT(stress_error(foil, at.strain, at.step), 1e-6) << at.name << " " << angle;
      const Mat3 tangent = answer(foil, at.strain).tangent;
      EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15) << at.name;
    }
    EXPECT_TRUE(answer(foil, turned(-1e-6, -e, angle)).tangent.isZero(0));
    EXPECT_TRUE(answer(foil, turned(-1e-6, -e, angle)).stress.isZero(0));
  }
}

TEST(TensionField, OfRubberHasItsConsistentTangentToo) {
  for (const Vec3& strain : {strain_of(2, 0.3, 0.4), strain_of(4, 0.49, 0.4), strain_of(1.01, 0.9, 1.1),
                             strain_of(1.01, 0.9949, 1.1), strain_of(1.5, 1.2, 0.2)}) {
    EXPECT_LT(tangent_error(rubber, strain, 1e-5), 1e-8) << strain.transpose();
    EXPECT_LT(stress_error(rubber, strain, 1e-5), 1e-7) << strain.transpose();
    EXPECT_LT(tangent_error(treloar, strain, 1e-5), 1e-8) << strain.transpose();
    EXPECT_LT(stress_error(treloar, strain, 1e-5), 1e-7) << strain.transpose();
  }
}

TEST(TensionField, OfAnOrthotropicFabricTurnsItsWrinklesOutOfThePrincipalAxesOfStrain) {
  double largest = 0;
  for_strains([&](const Vec3& strain) {
    const Relaxed r = fabric.relaxed(strain, nullptr);
    if (r.surface != Surface::wrinkled) return;
    const Vec3 p = r.strain - strain;
    const double wrinkles = 0.5 * std::atan2(p[2], p[0] - p[1]);
    const double strains = 0.5 * std::atan2(strain[2], strain[0] - strain[1]);
    largest = std::max(largest, std::abs(std::cos(wrinkles - strains))); // 0: across the larger strain
    // the borders lie anywhere: a step that stays on this side is one that gives the same from either side
    const auto state = [&](const Vec3& other) { return fabric.relaxed(other, nullptr).surface; };
    for (int k = 0; k < 3; ++k) {
      if (state(strain + 1e-4 * Vec3::Unit(k)) != r.surface || state(strain - 1e-4 * Vec3::Unit(k)) != r.surface)
        return;
    }
    EXPECT_LT(tangent_error(fabric, strain, 1e-6), 1e-6) << strain.transpose();
  });
  EXPECT_GT(largest, 0.3);
}

TEST(TensionField, StressIsContinuousAcrossTheBorders) {
  const double nu = foil.law.poissons_ratio;
  const auto jump = [](const Vec3& a, const Vec3& b) {
    return (answer(foil, a).stress - answer(foil, b).stress).cwiseAbs().maxCoeff() / foil.law.youngs_modulus;
  };
  for (const double angle : {0.0, 0.4, 1.2, -0.7}) {
    for (const double apart : {1e-6, 1e-9, 1e-12}) { // E e over 1 - nu^2 = 1.25 at most
      EXPECT_LT(jump(turned(0.01, -nu * 0.01 + apart, angle), turned(0.01, -nu * 0.01 - apart, angle)), 4 * apart);
      EXPECT_LT(jump(turned(apart, -0.01, angle), turned(-apart, -0.01, angle)), 4 * apart);
      EXPECT_LT(jump(turned(apart, apart, angle), turned(-apart, -apart, angle)), 4 * apart);
    }
  }
}

TEST(TensionField, OfIsotropicLawsTurnsWithTheStrain) {
  for (const double angle : {0.1, 0.5, 1.0, 1.5, 2.5}) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    base::Mat2 turn;
    turn << c, -s, s, c;
    for (const double e2 : {0.002, -0.004, -0.02, -0.3}) {
      const Vec3 stress = answer(foil, turned(0.01, e2, 0.3)).stress;
      const Vec3 other = answer(foil, turned(0.01, e2, 0.3 + angle)).stress;
      const base::Mat2 expected = turn * symmetric(stress[0], stress[1], stress[2]) * turn.transpose();
      const base::Mat2 difference = symmetric(other[0], other[1], other[2]) - expected;
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-14 * foil.law.youngs_modulus * std::max(0.01, -e2));
    }
  }
}

TEST(TensionField, NeverFailsHoweverTheFoilIsFolded) {
  for (const double angle : {0.0, 0.3, 0.785398163397448, 1.9}) {
    for (const double width : {0.0, 1e-12, 1e-6, 0.1}) {
      for (const double length : {0.0, 1e-9, 0.5, 1 - 1e-12, 1.0, 1 + 1e-12, 1 + 1e-6, 1.2, 4.0}) {
        const Vec3 strain = strain_of(length, width, angle);
        for (const Response& at :
             {answer(foil, strain), answer(rubber, strain), answer(fabric, strain), answer(treloar, strain)}) {
          EXPECT_TRUE(at.stress.allFinite() && at.tangent.allFinite()) << length << " " << width;
        }
      }
    }
  }
  Response a;
  EXPECT_EQ(foil.evaluate(Vec3(std::nan(""), 0, 0), nullptr, nullptr, 0, a), Status::failed);
}

TEST(TensionField, LeavesAPrestressedFoilAsItsLawHasIt) {
  const Vec3 wanted(890, 650, 40); // N/m
  const auto plain = predeformation(foil.law, 250e-6, wanted);
  const auto field = predeformation(foil, 250e-6, wanted);
  ASSERT_TRUE(plain && field);
  EXPECT_LT((*plain - *field).norm(), 1e-14);
  EXPECT_FALSE(predeformation(foil, 250e-6, Vec3(890, -10, 0))); // nobody can
  EXPECT_TRUE(has_tension_field(foil));
  EXPECT_FALSE(has_tension_field(foil.law));
}

} // namespace
} // namespace pneuma::tests
