// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/hardening_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace pneuma::tests {
namespace {

using solver::material::CurvePoint;
using solver::material::fit_hardening;
using solver::material::HardeningFit;

std::vector<CurvePoint> curve_of(const HardeningFit& law, double to, int count) {
  std::vector<CurvePoint> points;
  for (int i = 0; i <= count; ++i) {
    const double strain = to * i / count;
    points.push_back({strain, law.stress_at(strain)});
  }
  return points;
}

double worst(const HardeningFit& fit, const std::vector<CurvePoint>& points) {
  double largest = 0;
  for (const CurvePoint& p : points) largest = std::max(largest, std::abs(fit.stress_at(p.strain) - p.stress));
  return largest;
}

const HardeningFit etfe{1100e6, {{16e6, 160e6}, {27e6, 80e6}}, 0}; // thesis table 6.1

TEST(HardeningFit, CurveBendsWhereItsBranchesBegin) {
  EXPECT_DOUBLE_EQ(etfe.stress_at(0.01), 11e6);
  // plastic strain 11 / 160 at 27 MPa, and from there 8 MPa in 0.1
  EXPECT_NEAR(etfe.stress_at(27.0 / 1100 + 11.0 / 160), 27e6, 1e-6);
  EXPECT_NEAR(etfe.stress_at(35.0 / 1100 + 11.0 / 160 + 0.1), 35e6, 1e-6);
}

TEST(HardeningFit, KnownLawsAreFoundAgain) {
  const std::vector<HardeningFit> laws = {{900e6, {{15e6, 72e6}}, 0},
                                          etfe,
                                          {417e6, {{14e6, 120e6}, {32e6, 30e6}}, 0},
                                          {1000e6, {{10e6, 300e6}, {15e6, 60e6}, {24e6, 150e6}}, 0}};
  for (const HardeningFit& law : laws) {
    for (const int count : {37, 100, 1000}) {
      const std::vector<CurvePoint> points = curve_of(law, 0.3, count);
      const auto fit = fit_hardening(points, static_cast<int>(law.branches.size()));
      ASSERT_TRUE(fit);
      EXPECT_NEAR(fit->youngs_modulus / law.youngs_modulus, 1, 1e-9) << count;
      for (std::size_t i = 0; i < law.branches.size(); ++i) {
        EXPECT_NEAR(fit->branches[i].stress / law.branches[i].stress, 1, 1e-9) << count << " " << i;
        EXPECT_NEAR(fit->branches[i].modulus / law.branches[i].modulus, 1, 1e-9) << count << " " << i;
      }
    }
  }
  const auto level = fit_hardening(curve_of({70e9, {{0.243e9, 0}}, 0}, 0.02, 100), 1);
  ASSERT_TRUE(level);
  EXPECT_NEAR(level->branches[0].stress, 0.243e9, 1);
  EXPECT_NEAR(level->branches[0].modulus, 0, 1e3);
}

TEST(HardeningFit, LeastSquaresAreNearerThanTheTrueLawUnderNoise) {
  // white noise of 0.1 MPa on 400 points; standard errors of the branches are about 0.5 %
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.1e6);
  std::vector<CurvePoint> points = curve_of(etfe, 0.3, 400);
  double true_cost = 0;
  for (CurvePoint& p : points) {
    const double error = noise(random);
    p.stress += error;
    true_cost += error * error;
  }
  const auto fit = fit_hardening(points, 2);
  ASSERT_TRUE(fit);
  EXPECT_LE(fit->cost, true_cost);
  EXPECT_GE(fit->cost, true_cost * (1 - 5.0 * 5 / 400)); // 5 unknowns take 5/400 of it on average
  EXPECT_NEAR(fit->branches[0].stress / 16e6, 1, 0.02);
  EXPECT_NEAR(fit->branches[1].modulus / 80e6, 1, 0.02);
}

TEST(HardeningFit, MoreBranchesFitASmoothCurveBetter) {
  // Ramberg-Osgood like; the misfit of the best polygon falls with the square of the number of its sides
  std::vector<CurvePoint> points;
  for (int i = 0; i <= 300; ++i) {
    const double strain = 0.001 * i;
    points.push_back({strain, 30e6 * std::tanh(30 * strain) + 60e6 * strain});
  }
  double before = 1e300;
  for (int n = 1; n <= 5; ++n) {
    const auto fit = fit_hardening(points, n);
    ASSERT_TRUE(fit) << n;
    EXPECT_LT(fit->cost, 0.5 * before) << n;
    before = fit->cost;
  }
  EXPECT_LT(worst(*fit_hardening(points, 5), points), 0.3e6);
}

TEST(HardeningFit, NoMoreBranchesThanTheCurveHas) {
  const auto fit = fit_hardening(curve_of(etfe, 0.3, 100), 5);
  ASSERT_TRUE(fit);
  ASSERT_EQ(fit->branches.size(), 2U);
  EXPECT_NEAR(fit->branches[1].stress / 27e6, 1, 1e-9);
}

TEST(HardeningFit, NoBranchesForTheNoiseOfRoundedOrScatteredPoints) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.2e6);
  std::vector<CurvePoint> rounded_9 = curve_of(etfe, 0.3, 100), rounded_4 = rounded_9, scattered = rounded_9;
  const auto round_to = [](double value, double step) { return step * std::round(value / step); };
  for (std::size_t i = 0; i < rounded_9.size(); ++i) {
    rounded_9[i].stress = round_to(rounded_9[i].stress, 0.1); // nine digits
    rounded_4[i].stress = round_to(rounded_4[i].stress, 1e4); // four
    scattered[i].stress += noise(random);
  }
  for (const auto& points : {rounded_9, rounded_4, scattered}) {
    const auto fit = fit_hardening(points, 6);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->branches.size(), 2U);
  }
}

TEST(HardeningFit, SofteningOnlyWhereItIsAskedFor) {
  const HardeningFit law{1000e6, {{20e6, 100e6}, {30e6, -40e6}, {26e6, 20e6}}, 0};
  const std::vector<CurvePoint> points = curve_of(law, 0.35, 140);
  const auto rising = fit_hardening(points, 3);
  ASSERT_TRUE(rising);
  for (const auto& branch : rising->branches) EXPECT_GE(branch.modulus, 0);
  const auto falling = fit_hardening(points, 3, true);
  ASSERT_TRUE(falling);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(falling->branches[i].stress / law.branches[i].stress, 1, 1e-9) << i;
    EXPECT_NEAR(falling->branches[i].modulus / law.branches[i].modulus, 1, 1e-9) << i;
  }
}

TEST(HardeningFit, WeightsChooseWhichPointsCount) {
  std::vector<CurvePoint> points = curve_of(etfe, 0.3, 100);
  for (std::size_t i = 3; i < points.size(); i += 7) {
    points[i].stress += 5e6;
    points[i].weight = 0;
  }
  const auto fit = fit_hardening(points, 2);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->branches[1].stress / 27e6, 1, 1e-9);
}

TEST(HardeningFit, TooFewPointsGiveNone) {
  EXPECT_FALSE(fit_hardening({}, 1));
  EXPECT_FALSE(fit_hardening(curve_of(etfe, 0.3, 4), 2));
  EXPECT_FALSE(fit_hardening(curve_of(etfe, 0.3, 100), 0));
  const std::vector<CurvePoint> falling = {{0.01, -1e6}, {0.02, -2e6}, {0.03, -3e6}, {0.04, -4e6}};
  EXPECT_FALSE(fit_hardening(falling, 1));
}

} // namespace
} // namespace pneuma::tests
