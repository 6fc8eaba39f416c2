// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using solver::material::MooneyRivlin;
using solver::material::Status;

const MooneyRivlin rubber{0.4e6, 0.1e6};
const MooneyRivlin neo_hooke{0.5e6, 0};

// Nominal stress F S of uniaxial tension, pure shear and equal stretches in closed form (Treloar 1975, The Physics of
// Rubber Elasticity, ch. 5).
double uniaxial(const MooneyRivlin& m, double a) {
  return 2 * (a - 1 / (a * a)) * (m.c1 + m.c2 / a);
}
double pure_shear(const MooneyRivlin& m, double a) {
  return 2 * (a - 1 / (a * a * a)) * (m.c1 + m.c2);
}
double equibiaxial(const MooneyRivlin& m, double a) {
  return 2 * (a - std::pow(a, -5)) * (m.c1 + m.c2 * a * a);
}

TEST(MooneyRivlin, MatchesUniaxialTensionPureShearAndEqualStretchesInClosedForm) {
  for (const MooneyRivlin& law : {rubber, neo_hooke}) {
    for (const double a : {0.5, 0.9, 1.0 + 1e-6, 1.1, 2.0, 4.0}) {
      const double scale = law.c1 * std::pow(std::max(a, 1 / a), 5); // of the largest term
      const Response tension = answer(law, strain_of(a, 1 / std::sqrt(a)));
      EXPECT_NEAR(a * tension.stress[0], uniaxial(law, a), 1e-14 * scale) << a;
      EXPECT_NEAR(tension.stress[1], 0, 1e-14 * scale) << a;
      EXPECT_NEAR(a * answer(law, strain_of(a, 1)).stress[0], pure_shear(law, a), 1e-14 * scale) << a;
      const Response equal = answer(law, strain_of(a, a));
      EXPECT_NEAR(a * equal.stress[0], equibiaxial(law, a), 1e-14 * scale) << a;
      EXPECT_EQ(equal.stress[0], equal.stress[1]);
      EXPECT_EQ(equal.stress[2], 0);
    }
  }
}

TEST(MooneyRivlin, StressIsTheDerivativeOfTheEnergyAndTangentOfTheStress) {
  // fourth-order differences; the step is relative to the smaller of C's principal values, the law's own scale
  for (const MooneyRivlin& law : {rubber, neo_hooke}) {
    EXPECT_LT(tangent_error(law, Vec3::Zero(), 1e-3), 1e-9);
    for (const auto& [a, b] : {std::pair{1.3, 0.9}, {2.0, 1.5}, {4.0, 4.0}, {4.0, 0.6}, {1.001, 0.998}}) {
      const Vec3 strain = strain_of(a, b, 0.4);
      const double step = 3e-4 * b * b;
      EXPECT_LT(tangent_error(law, strain, step), 1e-9) << a << " " << b;
      EXPECT_LT(stress_error(law, strain, step), 1e-9) << a << " " << b;
      const Mat3 tangent = answer(law, strain).tangent;
      EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15);
    }
  }
}

TEST(MooneyRivlin, EqualStretchesAreNothingSpecial) {
  for (const double stretch : {1.0, 1.02, 1.5, 4.0}) {
    const Response equal = answer(rubber, strain_of(stretch, stretch));
    for (const double apart : {1e-12, 1e-10, 1e-8}) {
      for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
        const Vec3 strain = strain_of(stretch * (1 + apart), stretch, angle);
        EXPECT_LT(tangent_error(rubber, strain, 1e-4), 1e-9) << stretch << " " << apart << " " << angle;
        const Response near = answer(rubber, strain);
        EXPECT_LT(relative_difference(near.tangent, equal.tangent), 20 * apart);
        EXPECT_LT((near.stress - equal.stress).norm(), 40 * apart * rubber.c1 * stretch * stretch + 1e-9);
      }
    }
  }
}

TEST(MooneyRivlin, SmallStrainsLoseNoDigits) {
  // incompressible isotropic, E = 6 (C1 + C2): S11 = 4/3 E (e11 + e22 / 2), what is left is of second order
  const double e = 1e-9;
  const double modulus = 6 * (rubber.c1 + rubber.c2);
  const Response at = answer(rubber, Vec3(e, 0, 0));
  EXPECT_NEAR(at.stress[0] / (4.0 / 3 * modulus * e), 1, 10 * e);
  EXPECT_NEAR(at.stress[1] / (2.0 / 3 * modulus * e), 1, 10 * e);
  EXPECT_NEAR(at.energy / (2.0 / 3 * modulus * e * e), 1, 10 * e);
}

TEST(MooneyRivlin, KeepsItsVolume) {
  EXPECT_NEAR(rubber.thickness_stretch(strain_of(2, 1.25, 0.7), nullptr), 1 / 2.5, 1e-15);
  const solver::material::Law law = rubber;
  EXPECT_NEAR(solver::material::thickness_stretch(law, strain_of(4, 4), nullptr), 1.0 / 16, 1e-15);
}

TEST(MooneyRivlin, RefusesAStrainWithoutArea) {
  Response a;
  for (const Vec3& strain : {Vec3(-0.5, 0, 0), Vec3(0, 0, 1.1), Vec3(std::nan(""), 0, 0)}) {
    EXPECT_EQ(rubber.evaluate(strain, nullptr, nullptr, 0, a), Status::failed);
  }
  solver::material::Batch batch;
  batch.count = 2;
  batch.strain[0] = Vec3::Zero();
  batch.strain[1] = Vec3(-0.5, 0, 0);
  EXPECT_EQ(solver::material::evaluate(rubber, batch), 1);
}

} // namespace
} // namespace pneuma::tests
