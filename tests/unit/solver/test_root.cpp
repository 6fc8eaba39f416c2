// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "solver/analytical/root.h"

namespace pneuma::tests {

namespace {

using solver::analytical::root_between;

TEST(RootBetween, FindsARootToRoundingInAFewEvaluations) {
  // bisection would take fifty; the second and third function curve away from one end, where plain regula falsi creeps
  int evaluations = 0;
  const auto counted = [&](auto f) {
    return [&evaluations, f](double x) {
      ++evaluations;
      return f(x);
    };
  };
  EXPECT_NEAR(root_between(1.2, 1.5, counted([](double x) { return x * x * x - 2.2; })), std::cbrt(2.2), 1e-15);
  EXPECT_LE(evaluations, 12);
  evaluations = 0;
  EXPECT_NEAR(root_between(0.1, 3, counted([](double x) { return std::pow(x, 10) - 1; })), 1, 1e-15);
  EXPECT_LE(evaluations, 30);
  evaluations = 0;
  EXPECT_NEAR(root_between(0.1, 8, counted([](double x) { return std::log(x); })), 1, 1e-15);
  EXPECT_LE(evaluations, 15);
}

TEST(RootBetween, TakesAnEndThatIsTheRoot) {
  EXPECT_EQ(root_between(2, 3, [](double x) { return x - 2; }), 2);
}

TEST(RootBetween, BisectsWhereTheEndIsNoNumber) {
  const auto f = [](double x) { return x > 4 ? std::numeric_limits<double>::quiet_NaN() : x * x - 2; };
  EXPECT_NEAR(root_between(1, 5, f), std::sqrt(2), 1e-15);
}

} // namespace

} // namespace pneuma::tests
