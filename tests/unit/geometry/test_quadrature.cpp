// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"
#include "tests/unit/finite_differences.h"

namespace {

using namespace pneuma::geometry;

class EveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(Types, EveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

double factorial(int n) {
  return n < 2 ? 1.0 : n * factorial(n - 1);
}

// exact integral of xi^a eta^b over the reference element
double monomial(ElementType type, int a, int b) {
  if (corners_per_element(type) == 3) return factorial(a) * factorial(b) / factorial(a + b + 2);
  return a % 2 || b % 2 ? 0.0 : 4.0 / ((a + 1) * (b + 1));
}

TEST_P(EveryElement, PressureRuleIntegratesItsDegreeExactly) {
  const int degree[] = {1, 4, 3, 5}; // T3, T6, Q4, Q9
  const int d = degree[static_cast<int>(GetParam())];
  const bool triangle = corners_per_element(GetParam()) == 3;
  for (int a = 0; a <= d; ++a) {
    for (int b = 0; b <= (triangle ? d - a : d); ++b) {
      double sum = 0;
      for (const QuadraturePoint& q : pressure_rule(GetParam()))
        sum += q.weight * std::pow(q.xi, a) * std::pow(q.eta, b);
      EXPECT_NEAR(sum, monomial(GetParam(), a, b), 1e-15) << "xi^" << a << " eta^" << b;
    }
  }
}

TEST_P(EveryElement, ShapeFunctionsArePartitionOfUnityAndTheirDerivativesMatchDifferences) {
  dispatch(GetParam(), [&]<ElementType E>() {
    const auto value = [](const Eigen::VectorXd& x) { return Eigen::VectorXd(shape_functions<E>(x[0], x[1]).value); };
    const Eigen::Vector2d at(0.27, 0.31);
    const auto s = shape_functions<E>(at[0], at[1]);
    EXPECT_NEAR(s.value.sum(), 1.0, 1e-15);
    EXPECT_LT(
        pneuma::tests::relative_difference(pneuma::tests::finite_difference_jacobian(value, at, 1e-3), s.derivative),
        1e-11);
  });
}

TEST(StressRule, ReducedExistsForQ9Only) {
  EXPECT_EQ(stress_rule(ElementType::Q9, StressRule::reduced).size(), 4u);
  EXPECT_THROW(stress_rule(ElementType::T6, StressRule::reduced), std::invalid_argument);
}

} // namespace
