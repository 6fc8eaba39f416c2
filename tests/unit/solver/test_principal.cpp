// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic functions of a strain, and the logarithmic strain with both derivatives.
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

#include "solver/material/principal.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

LogStrain log_of(const Vec3& strain) {
  LogStrain log;
  EXPECT_TRUE(log_strain(strain, log)) << strain.transpose();
  return log;
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

// Largest relative errors of both derivatives against differences.
double slope_error(const Vec3& strain, double step) {
  const auto value = [](const Eigen::VectorXd& e) { return Eigen::VectorXd(log_of(Vec3(e)).strain); };
  return relative_difference(finite_difference_jacobian(value, strain, step), log_of(strain).slope);
}
double curvature_error(const Vec3& strain, const Vec3& stress, double step) {
  const auto slope = [&](const Eigen::VectorXd& e) {
    return Eigen::VectorXd(log_of(Vec3(e)).slope.transpose() * stress);
  };
  return relative_difference(finite_difference_jacobian(slope, strain, step), log_of(strain).curvature(stress));
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
  const Vec3 stress(3, -1, 2);
  for_stretches([&](double a, double b, double angle) {
    const Vec3 strain = strain_of(a, b, angle);
    // 1e-16 of the larger strain over the step, relative to the smaller stretch's terms
    const double size = std::max(a * a, b * b) / std::min(a * a, b * b);
    EXPECT_LT(slope_error(strain, step_of(a, b)), 1e-9 + 1e-12 * size) << a << " " << b;
    EXPECT_LT(curvature_error(strain, stress, step_of(a, b)), 1e-9 + 1e-12 * size) << a << " " << b;
    const Mat3 curvature = log_of(strain).curvature(stress);
    EXPECT_LT(relative_difference(curvature.transpose(), curvature), 1e-15);
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
        for (const Vec3& stress : {Vec3(3, -1, 2), Vec3(0, 0, 1), Vec3(1, 1, 0)}) {
          EXPECT_LT(slope_error(strain, step_of(stretch, stretch)), 1e-9) << stretch << " " << apart << " " << angle;
          EXPECT_LT(curvature_error(strain, stress, step_of(stretch, stretch)), 1e-9)
              << stretch << " " << apart << " " << angle;
        }
      }
    }
  }
}

TEST(LogStrain, HasNoJumpWhereItsSeriesEnds) {
  // y = 0.25: C = 1.25, 0.75, from either side
  const Vec3 stress(3, -1, 2);
  for (const double y : {0.25 * (1 - 1e-15), 0.25 * (1 + 1e-15)}) {
    const Mat3 here = log_of({0.5 * y, -0.5 * y, 0}).curvature(stress);
    const Mat3 there = log_of({0.125, -0.125, 0}).curvature(stress);
    EXPECT_LT(relative_difference(here, there), 1e-14);
  }
}

TEST(LogStrain, OfSmallStrainsIsTheStrainToTheLastDigit) {
  // ln(I + 2 E)/2 = E - E E + ..
  const Vec3 strain(1e-9, -3e-9, 4e-9);
  const Vec3 squares(1e-18 + 4e-18, 9e-18 + 4e-18, 2 * 2e-9 * (1e-9 - 3e-9));
  EXPECT_LT((log_of(strain).strain - (strain - squares)).cwiseAbs().maxCoeff(), 1e-24);
}

TEST(LogStrain, CarriesHenckysElasticity) {
  // T = D e: S = slope^T T, tangent slope^T D slope + curvature(T), against the law that has it in closed form
  const Elasticity elasticity{1100e6, 0.43};
  const Mat3 D = StVenantKirchhoff{1100e6, 0.43}.stiffness();
  const Logarithmic law{elasticity, {}};
  for_stretches([&](double a, double b, double angle) {
    if (std::min(a, b) < 0.5 || std::max(a, b) > 3) return;
    const Vec3 strain = strain_of(a, b, angle);
    const LogStrain log = log_of(strain);
    const Vec3 T = D * log.strain;
    const std::array<double, 5> old_history{};
    std::array<double, 5> history{};
    Response at;
    ASSERT_EQ(law.evaluate(strain, old_history.data(), history.data(), 0, at), Status::ok);
    const double rounding = 2e-14; // the strain's by slopes up to 1 / 0.5^2 and the tangent's up to that squared
    EXPECT_LT((log.slope.transpose() * T - at.stress).cwiseAbs().maxCoeff(), rounding * 1100e6);
    const Mat3 tangent = log.slope.transpose() * D * log.slope + log.curvature(T);
    EXPECT_LT(relative_difference(tangent, at.tangent), rounding);
    EXPECT_NEAR(0.5 * T.dot(log.strain), at.energy, rounding * 1100e6);
  });
}

TEST(LogStrain, RefusesAStrainWithoutArea) {
  LogStrain log;
  for (const Vec3& strain : {Vec3(-0.5, 0, 0), Vec3(0, 0, 1.1), Vec3(std::nan(""), 0, 0)}) {
    EXPECT_FALSE(log_strain(strain, log));
  }
}

} // namespace
} // namespace pneuma::tests
