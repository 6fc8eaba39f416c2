// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic functions of a strain: its logarithm, and the stress that comes from that.
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

#include "solver/material/principal.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

// ln(C)/2 = (11, 22, 2 12) and its derivatives.
struct Logarithm {
  Vec3 strain;
  Mat3 slope;
};
Logarithm log_of(const Vec3& strain) {
  const PrincipalStrain e = principal_strain(strain);
  const PrincipalLogarithm l = principal_logarithm(e);
  PrincipalFunction f;
  f.s1 = l.second + l.difference;
  f.s2 = l.second;
  f.d11 = 1 / l.c1;
  f.d22 = 1 / l.c2;
  f.quotient = l.quotient;
  Logarithm log;
  in_frame(e, f, log.strain, log.slope);
  log.strain[2] *= 2;
  log.slope.row(2) *= 2;
  return log;
}

// Hencky's elasticity: its stress takes the logarithm's slope, its tangent the second derivatives, too.
constexpr Elasticity elasticity{1100e6, 0.43};
Response hencky(const Vec3& strain) {
  const std::array<double, 5> old_history{};
  std::array<double, 5> history{};
  Response r;
  EXPECT_EQ(Logarithmic({elasticity, {}}).evaluate(strain, old_history.data(), history.data(), 0, r), Status::ok)
      << strain.transpose();
  return r;
}

// Strains of stretches 0.1 to 10 along axes of any direction.
template <class F>
void for_stretches(const F& f) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-1, 1);
  std::uniform_real_distribution<double> turn(0, std::acos(-1.0));
  for (int i = 0; i < 2000; ++i) {
    const double a = std::pow(10, exponent(random));
    const double b = std::pow(10, exponent(random));
    f(a, b, turn(random));
  }
}

// Steps for differences: relative to the smaller principal value of C, the logarithm's own scale.
double step_of(double a, double b) {
  return 1e-3 * std::pow(std::min(a, b), 2);
}

// Largest errors of both derivatives against differences.
double slope_error(const Vec3& strain, double step) {
  const auto value = [](const Eigen::VectorXd& e) { return Eigen::VectorXd(log_of(Vec3(e)).strain); };
  return relative_difference(finite_difference_jacobian(value, strain, step), log_of(strain).slope);
}
double tangent_error(const Vec3& strain, double step) {
  const auto stress = [](const Eigen::VectorXd& e) { return Eigen::VectorXd(hencky(Vec3(e)).stress); };
  const Mat3 tangent = hencky(strain).tangent;
  // relative to the modulus' term, too, which that of the stress may cancel
  const double term = elasticity.youngs_modulus / std::pow(1 + 2 * principal_strain(strain).second, 2);
  return (finite_difference_jacobian(stress, strain, step) - tangent).cwiseAbs().maxCoeff() /
         std::max(term, tangent.cwiseAbs().maxCoeff());
}

TEST(PrincipalStrain, IsThatOfTheEigenSolver) {
  for_stretches([](double a, double b, double angle) {
    const Vec3 strain = strain_of(a, b, angle);
    Mat2 tensor;
    tensor << strain[0], 0.5 * strain[2], 0.5 * strain[2], strain[1];
    const Eigen::SelfAdjointEigenSolver<Mat2> exact(tensor);
    const PrincipalStrain p = principal_strain(strain);
    const double rounding = 4e-16 * strain.cwiseAbs().maxCoeff();
    EXPECT_NEAR(p.first, exact.eigenvalues()[1], 2 * rounding);
    EXPECT_NEAR(p.second, exact.eigenvalues()[0], 2 * rounding);
    EXPECT_NEAR(p.difference, p.first - p.second, 2 * rounding);
    EXPECT_NEAR(p.along1.dot(strain), p.first, 2 * rounding);
    EXPECT_NEAR(p.along2.dot(strain), p.second, 2 * rounding);
    EXPECT_NEAR(p.shear.dot(strain), 0, 2 * rounding);
  });
}

TEST(PrincipalStrain, AlongTheFrameLosesNoDigits) {
  const PrincipalStrain p = principal_strain({49.5, -0.4999999999999, 0});
  EXPECT_EQ(p.first, 49.5);
  EXPECT_EQ(p.second, -0.4999999999999);
  const PrincipalStrain q = principal_strain({-0.4999999999999, 49.5, 0});
  EXPECT_EQ(q.first, 49.5);
  EXPECT_EQ(q.second, -0.4999999999999);
  EXPECT_EQ(q.along1, Vec3(0, 1, 0));
}

TEST(LogStrain, IsTheMatrixFunction) {
  for_stretches([](double a, double b, double angle) {
    const Vec3 expected(0.5 * (std::log(a * b) + std::log(a / b) * std::cos(2 * angle)),
                        0.5 * (std::log(a * b) - std::log(a / b) * std::cos(2 * angle)),
                        std::log(a / b) * std::sin(2 * angle));
    // the strain's own rounding (it is C less one), by the largest slope
    const double size = std::max({1.0, a * a, b * b}) / std::min(a * a, b * b);
    EXPECT_LT((log_of(strain_of(a, b, angle)).strain - expected).cwiseAbs().maxCoeff(), 1e-15 * (1 + size));
  });
}

TEST(LogStrain, HasItsDerivativesForStretchesFromATenthToTen) {
  for_stretches([](double a, double b, double angle) {
    const Vec3 strain = strain_of(a, b, angle);
    // 1e-16 of the larger strain over the step, relative to the smaller stretch's terms
    const double size = std::max(a * a, b * b) / std::min(a * a, b * b);
    EXPECT_LT(slope_error(strain, step_of(a, b)), 1e-9 + 1e-12 * size) << a << " " << b;
    EXPECT_LT(tangent_error(strain, step_of(a, b)), 1e-9 + 1e-12 * size) << a << " " << b;
    const Mat3 tangent = hencky(strain).tangent;
    EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15);
  });
}

TEST(LogStrain, HasThemAtAndBesideEqualStretchesInEveryDirection) {
  for (const double stretch : {0.1, 0.7, 1.0, 1.02, 10.0}) {
    for (const double apart : {0.0, 1e-300, 1e-150, 1e-15, 1e-12, 1e-8, 1e-4, 0.1}) {
      for (const double angle : {0.0, 0.3, 0.785398163397448, 1.5, 2.9}) {
        const double c = std::cos(2 * angle) * apart * stretch * stretch;
        const double s = std::sin(2 * angle) * apart * stretch * stretch;
        const double e = 0.5 * (stretch * stretch - 1);
        const Vec3 strain(e + c, e - c, 2 * s);
        const double step = step_of(stretch, stretch);
        EXPECT_LT(slope_error(strain, step), 1e-9) << stretch << " " << apart << " " << angle;
        EXPECT_LT(tangent_error(strain, step), 1e-9) << stretch << " " << apart << " " << angle;
      }
    }
  }
}

TEST(LogStrain, OfSmallStrainsIsTheStrainToTheLastDigit) {
  // ln(I + 2 E)/2 = E - E E + ..
  const Vec3 strain(1e-9, -3e-9, 4e-9);
  const Vec3 squares(1e-18 + 4e-18, 9e-18 + 4e-18, 2 * 2e-9 * (1e-9 - 3e-9));
  EXPECT_LT((log_of(strain).strain - (strain - squares)).cwiseAbs().maxCoeff(), 1e-24);
}

TEST(LogStrain, CarriesHenckysElasticity) {
  // T = D e, S = slope^T T, energy T e / 2
  const Mat3 D = StVenantKirchhoff{elasticity.youngs_modulus, elasticity.poissons_ratio}.stiffness();
  for_stretches([&](double a, double b, double angle) {
    if (std::min(a, b) < 0.5 || std::max(a, b) > 3) return;
    const Vec3 strain = strain_of(a, b, angle);
    const Logarithm log = log_of(strain);
    const Vec3 T = D * log.strain;
    const Response at = hencky(strain);
    // the strain's by slopes up to 1 / 0.5^2
    const double rounding = 2e-14 * elasticity.youngs_modulus;
    EXPECT_LT((log.slope.transpose() * T - at.stress).cwiseAbs().maxCoeff(), rounding);
    EXPECT_NEAR(0.5 * T.dot(log.strain), at.energy, rounding);
  });
}

TEST(LogStrain, IsRefusedToAStrainWithoutArea) {
  const std::array<double, 5> old_history{};
  std::array<double, 5> history{};
  Response r;
  for (const Vec3& strain : {Vec3(-0.5, 0, 0), Vec3(0, 0, 1.1), Vec3(std::nan(""), 0, 0)}) {
    EXPECT_EQ(Logarithmic({elasticity, {}}).evaluate(strain, old_history.data(), history.data(), 0, r), Status::failed);
  }
}

} // namespace
} // namespace pneuma::tests
