// SPDX-License-Identifier: GPL-3.0-or-later
// The series solutions of the circular membrane, against their printed coefficients and the exact problem.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "solver/analytical/small_slope.h"

namespace pneuma::tests {

namespace {

using namespace solver::analytical;

constexpr double kPa = 1e3;

// example B8 of the thesis
CircularMembrane membrane(double pretension = 0) {
  return {0.1425, 311488, 0.34, pretension};
}

// b_2n of N = (E h) q^(2/3) / 4 sum b_2n rho^2n
double hencky_coefficient(const SmallSlopeSolution& solution, std::size_t n, double q) {
  return 4 * solution.coefficients[n] / std::cbrt(q * q);
}

TEST(SmallSlope, HenckysCoefficientsAreThePrintedOnes) {
  const double pressure = 100 * kPa;
  const double q = pressure * 0.1425 / 311488;
  const SmallSlopeSolution s = small_slope(Theory::hencky, membrane(), pressure).value();
  const double b0 = hencky_coefficient(s, 0, q);
  // Fichter (1997), eq. 14; thesis 5-41
  const double printed[] = {b0,
                            -1 / std::pow(b0, 2),
                            -2.0 / 3 / std::pow(b0, 5),
                            -13.0 / 18 / std::pow(b0, 8),
                            -17.0 / 18 / std::pow(b0, 11),
                            -37.0 / 27 / std::pow(b0, 14),
                            -1205.0 / 567 / std::pow(b0, 17),
                            -219241.0 / 63504 / std::pow(b0, 20),
                            -6634069.0 / 1143072 / std::pow(b0, 23),
                            -51523763.0 / 5143824 / std::pow(b0, 26),
                            -998796305.0 / 56582064 / std::pow(b0, 29)};
  for (std::size_t n = 0; n < 11; ++n) {
    EXPECT_NEAR(hencky_coefficient(s, n, q) / printed[n], 1, 1e-12) << n;
  }
}

TEST(SmallSlope, HenckysPoleTensionIsThatOfTheLiterature) {
  // b0 for nu = 0.2, 0.3, 0.4: Fichter (1997), table 1, four decimals
  const std::pair<double, double> table[] = {{0.2, 1.6827}, {0.3, 1.7244}, {0.4, 1.7769}};
  for (const auto& [nu, b0] : table) {
    CircularMembrane m = membrane();
    m.poissons_ratio = nu;
    const SmallSlopeSolution s = small_slope(Theory::hencky, m, 1000).value();
    EXPECT_NEAR(hencky_coefficient(s, 0, 1000 * m.radius / m.stiffness), b0, 5e-5) << nu;
  }
}

TEST(SmallSlope, FichtersCoefficientsAreThePrintedOnes) {
  const double q = 400 * kPa * 0.1425 / 311488;
  const SmallSlopeSolution s = small_slope(Theory::fichter, membrane(), 400 * kPa).value();
  const auto n = [&](std::size_t k) { return s.coefficients[k] / q; };
  const double n0 = n(0);
  const double a = (3 + 0.34) / 2 * q * n0;
  // thesis 5-72 to 5-74
  const double n2 = -(1 + 8 * a) / (64 * q * n0 * n0);
  const double n4 = -(1 + 8 * a) * (1 + 4 * a + 4 * q * n0) / (6144 * q * q * std::pow(n0, 5));
  const double n6 = -(1 + 8 * a) *
                    (13 + 128 * a + 96 * q * n0 + 256 * a * a + 576 * a * q * n0 + 128 * q * q * n0 * n0) /
                    (4718592 * std::pow(q, 3) * std::pow(n0, 8));
  EXPECT_NEAR(n(1) / n2, 1, 1e-12);
  EXPECT_NEAR(n(2) / n4, 1, 1e-12);
  EXPECT_NEAR(n(3) / n6, 1, 1e-12);
}

TEST(SmallSlope, WithoutPretensionTheExtendedTheoriesAreTheirOriginals) {
  for (const auto& [plain, extended] :
       {std::pair{Theory::hencky, Theory::campbell}, std::pair{Theory::fichter, Theory::modified_fichter}}) {
    const SmallSlopeSolution a = small_slope(plain, membrane(), 250 * kPa).value();
    const SmallSlopeSolution b = small_slope(extended, membrane(), 250 * kPa).value();
    EXPECT_EQ(a.deflection, b.deflection);
    EXPECT_EQ(a.volume, b.volume);
  }
  EXPECT_FALSE(small_slope(Theory::hencky, membrane(1000), 250 * kPa));
}

TEST(SmallSlope, ATautDrumUnderLittlePressureIsAParaboloid) {
  // w = p (a^2 - r^2) / (4 N0), volume pi p a^4 / (8 N0)
  const CircularMembrane m = membrane(10e3);
  for (const Theory theory : {Theory::campbell, Theory::modified_fichter}) {
    const SmallSlopeSolution s = small_slope(theory, m, 10).value();
    EXPECT_NEAR(s.deflection, 10 * m.radius * m.radius / (4 * 10e3), 1e-6 * s.deflection);
    EXPECT_NEAR(s.volume, std::numbers::pi * 10 * std::pow(m.radius, 4) / (8 * 10e3), 1e-6 * s.volume);
    EXPECT_NEAR(s.apex_tension, 10e3, 1e-6 * 10e3);
  }
}

TEST(SmallSlope, TheoriesComeTogetherWithTheExactSolutionAtSmallPressure) {
  // the error of the theories falls with the square of the slope, pressure^(2/3)
  double last[2] = {};
  for (const double pressure : {8 * kPa, 1 * kPa}) {
    const double exact = inflate(membrane(), pressure, 1500)->deflection;
    const double error[2] = {small_slope(Theory::hencky, membrane(), pressure)->deflection / exact - 1,
                             small_slope(Theory::fichter, membrane(), pressure)->deflection / exact - 1};
    for (int i = 0; i < 2; ++i) {
      EXPECT_LT(std::abs(error[i]), 0.01);
      if (last[i] != 0) {
        EXPECT_NEAR(last[i] / error[i], 4, 0.4) << i; // (8 / 1)^(2/3)
      }
      last[i] = error[i];
    }
  }
}

TEST(SmallSlope, FichtersSeriesNeedsAboutTwentyTermsAt400Kilopascal) {
  const double whole = small_slope(Theory::fichter, membrane(), 400 * kPa)->deflection;
  const auto cut = small_slope(Theory::fichter, membrane(), 400 * kPa, 20);
  ASSERT_TRUE(cut);
  EXPECT_LT(std::abs(cut->deflection / whole - 1), 1e-3);
}

TEST(SmallSlope, TableOfErrorsAgainstTheExactSolution) {
  std::printf("N0, kN/m | p, kPa | exact deflection, mm, volume, l | error of deflection, volume, %%: Hencky/Campbell, "
              "Fichter\n");
  for (const double pretension : {0.0, 1e3, 10e3}) {
    for (const double pressure : {100 * kPa, 250 * kPa, 400 * kPa}) {
      const InflatedCircle exact = inflate(membrane(pretension), pressure, 1500).value();
      std::printf("| %2.0f | %3.0f | %8.4f %8.5f |", pretension / kPa, pressure / kPa, 1e3 * exact.deflection,
                  1e3 * exact.volume);
      for (const Theory theory : {Theory::campbell, Theory::modified_fichter}) {
        const auto s = small_slope(theory, membrane(pretension), pressure);
        ASSERT_TRUE(s);
        const double deflection = 100 * (s->deflection / exact.deflection - 1);
        const double volume = 100 * (s->volume / exact.volume - 1);
        std::printf(" %6.2f %6.2f |", deflection, volume);
        EXPECT_LT(std::abs(deflection), 12);
      }
      std::printf("\n");
    }
  }
}

} // namespace

} // namespace pneuma::tests
