// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "solver/chamber/gas.h"
#include "solver/linear/cholesky.h"
#include "solver/linear/ldlt.h"
#include "tests/unit/finite_differences.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::MatX;
using base::VecX;
using tests::relative_difference;

// elements of three unknowns each over twelve, some held; unknown 11 belongs to none
struct Assembled {
  static constexpr Index size = 12;
  static constexpr Index per_element = 3;
  std::vector<Index> unknowns{0, 1, 2, 2, 3, 4, 4, -1, 5, 9, 8, 7, 7, 6, 5, 10, 0, -1, 3, 9, 10, -1, -1, -1};
  linear::PatternAndScatter made = linear::make_pattern(size, unknowns, per_element);
  std::vector<double> values;
  MatX dense = MatX::Zero(size, size);

  // sum of B B^T of random B, plus `diagonal` on the diagonal
  explicit Assembled(double diagonal) : values(made.pattern.row.size(), 0.0) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> d(-1, 1);
    for (Index e = 0; e < static_cast<Index>(unknowns.size()) / per_element; ++e) {
      Eigen::Matrix3d B;
      for (Eigen::Index i = 0; i < 9; ++i) B.data()[i] = d(random);
      Eigen::Matrix3d K = B * B.transpose();
      for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
          const Index row = unknowns[static_cast<std::size_t>(e * 3 + i)];
          const Index column = unknowns[static_cast<std::size_t>(e * 3 + j)];
          if (row >= 0 && column >= 0) dense(row, column) += K(i, j);
        }
      }
      K.triangularView<Eigen::StrictlyLower>().setConstant(std::nan("")); // only the upper triangle may be read
      linear::scatter_add(made.scatter, e, K.data(), values);
    }
    for (Index i = 0; i < size; ++i) {
      values[static_cast<std::size_t>(made.pattern.column_start[static_cast<std::size_t>(i) + 1] - 1)] += diagonal;
      dense(i, i) += diagonal;
    }
  }
};

VecX some_vector(Index size) {
  VecX x(size);
  for (Index i = 0; i < size; ++i) x[i] = std::sin(1.0 + i);
  return x;
}

TEST(SymmetricPattern, HoldsTheUpperTriangleSortedAndADiagonalForEveryUnknown) {
  const Assembled a(0);
  const linear::SymmetricPattern& p = a.made.pattern;
  for (std::size_t column = 0; column < Assembled::size; ++column) {
    const Index begin = p.column_start[column];
    const Index end = p.column_start[column + 1];
    ASSERT_LT(begin, end);
    EXPECT_EQ(p.row[static_cast<std::size_t>(end) - 1], static_cast<Index>(column));
    for (Index k = begin + 1; k < end; ++k) {
      EXPECT_LT(p.row[static_cast<std::size_t>(k) - 1], p.row[static_cast<std::size_t>(k)]);
    }
  }
}

TEST(SymmetricPattern, ScatteredElementsMultiplyLikeTheDenseSum) {
  const Assembled a(0.5);
  const VecX x = some_vector(Assembled::size);
  const VecX dense = a.dense * x;
  EXPECT_LT(relative_difference(linear::multiply(a.made.pattern, a.values, x), dense), 1e-14);
}

TEST(Ldlt, SolvesAndCountsNegativeEigenvaluesOfMatricesThatAreNotDefinite) {
  for (const double diagonal : {0.5, -0.4, -1.0, -5.0}) {
    const Assembled a(diagonal);
    linear::Ldlt factor(a.made.pattern);
    ASSERT_TRUE(factor.factorize(a.made.pattern, a.values));
    const VecX eigenvalues = Eigen::SelfAdjointEigenSolver<MatX>(a.dense).eigenvalues();
    EXPECT_EQ(factor.negative_pivots(), (eigenvalues.array() < 0).count()) << diagonal;
    MatX b(Assembled::size, 2);
    b << some_vector(Assembled::size), VecX::Unit(Assembled::size, 4);
    EXPECT_LT(relative_difference(factor.solve(b), a.dense.fullPivLu().solve(b)), 1e-11) << diagonal;
  }
}

TEST(Ldlt, SaysThatAMatrixIsSingular) {
  const Assembled a(0); // unknown 11 belongs to no element
  linear::Ldlt factor(a.made.pattern);
  EXPECT_FALSE(factor.factorize(a.made.pattern, a.values));
  EXPECT_GE(factor.null_pivots(), 1);
}

TEST(Cholesky, SolvesSeveralColumnsLikeTheDenseMatrix) {
  const Assembled a(0.5);
  linear::Cholesky factor(a.made.pattern);
  ASSERT_TRUE(factor.factorize(a.made.pattern, a.values));
  MatX b(Assembled::size, 3);
  b << some_vector(Assembled::size), VecX::Ones(Assembled::size), VecX::Unit(Assembled::size, 4);
  EXPECT_LT(relative_difference(factor.solve(b), a.dense.llt().solve(b)), 1e-12);
  EXPECT_GT(factor.pivot_ratio(), 1e-4);
}

TEST(Cholesky, SaysWhatIsNotPositiveDefiniteAndWorksAfterwards) {
  const Assembled good(0.5);
  const Assembled indefinite(-0.3);
  ASSERT_LT(indefinite.dense.selfadjointView<Eigen::Upper>().eigenvalues().minCoeff(), 0);
  linear::Cholesky factor(good.made.pattern);
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(factor.factorize(indefinite.made.pattern, indefinite.values));
    ASSERT_TRUE(factor.factorize(good.made.pattern, good.values));
    const VecX b = some_vector(Assembled::size);
    EXPECT_LT(relative_difference(factor.solve(b), good.dense.llt().solve(b)), 1e-12);
  }
}

TEST(Cholesky, TellsASingularMatrixByItsPivots) {
  // unknown 11 belongs to no element: its pivot is the added diagonal alone
  const Assembled nearly(1e-13);
  linear::Cholesky factor(nearly.made.pattern);
  if (factor.factorize(nearly.made.pattern, nearly.values)) {
    EXPECT_LT(factor.pivot_ratio(), 1e-10);
  }
}

TEST(Cholesky, EmptySystemIsSolvedByNothing) {
  const linear::PatternAndScatter none = linear::make_pattern(0, std::vector<Index>{-1, -1, -1}, 3);
  linear::Cholesky factor(none.pattern);
  EXPECT_TRUE(factor.factorize(none.pattern, {}));
  EXPECT_EQ(factor.solve(MatX(0, 2)).rows(), 0);
}

// --- gas
// ---------------------------------------------------------------------------------------------------------------

using namespace solver::chamber;

// the line's two coefficients against differences of its residual: d residual / dV = 1 and d residual / dp = compliance
// where the residual is small, which is where Newton's method needs them
void expect_linearisation(const Gas& gas, double p, double V, double load_factor) {
  const GasLine line = gas_line(gas, p, V, load_factor);
  ASSERT_TRUE(line.possible);
  ASSERT_TRUE(line.pressure_is_unknown);
  const auto residual = [&](const VecX& x) {
    return VecX::Constant(1, gas_line(gas, x[0], x[1] * V, load_factor).residual / V);
  };
  const double h = 1e-3;
  VecX x(2);
  x << p, 1.0;
  const MatX byVolume = tests::finite_difference_jacobian(
      [&](const VecX& y) { return residual((VecX(2) << p, y[0]).finished()); }, VecX::Ones(1), h);
  EXPECT_NEAR(byVolume(0, 0), 1.0, 1e-9 + 2 * std::abs(line.relative));
  if (line.compliance > 0) {
    const double scale = V / line.compliance; // Pa
    const MatX byPressure = tests::finite_difference_jacobian(
        [&](const VecX& y) { return residual((VecX(2) << p + y[0] * scale, 1.0).finished()); }, VecX::Zero(1), h);
    EXPECT_NEAR(byPressure(0, 0), 1.0, 1e-9);
  }
}

TEST(Gas, LinesAreTheDerivativesOfTheLaws) {
  Closed closed{1.4, 101725, 2.0, 293, 293, 101325, 95000};
  for (const double load_factor : {0.0, 0.4, 1.0}) {
    // a state on the law, so that the residual is zero
    const double ambient = 101325 + load_factor * (95000 - 101325);
    const double V = 1.7;
    const double p = 101725 * std::pow(2.0 / V, 1.4) - ambient;
    EXPECT_NEAR(gas_line(closed, p, V, load_factor).relative, 0, 1e-14);
    expect_linearisation(closed, p, V, load_factor);
  }
  expect_linearisation(Closed{1, 400, 2.0, 1, 1, 0, 0}, 300, 2.0 * 400 / 300, 0.5);
  expect_linearisation(PrescribedVolume{1.0, 3.0}, 250, 2.0, 0.5);
  EXPECT_FALSE(gas_line(Regulated{0, 400}, 400, 1, 1).pressure_is_unknown);
  EXPECT_EQ(gas_line(Regulated{0, 400}, 400, 1, 1).residual, 0);
}

// gauge pressure that puts the line's residual to zero, by bisection: no formula of the law is used
double pressure_of(const Gas& gas, double V, double load_factor, double low, double high) {
  for (int i = 0; i < 200; ++i) {
    const double p = 0.5 * (low + high);
    (gas_line(gas, p, V, load_factor).residual > 0 ? high : low) = p;
  }
  return 0.5 * (low + high);
}

TEST(Gas, FollowsTheClosedForms) {
  // Boyle: half the volume, twice the absolute pressure
  EXPECT_NEAR(pressure_of(Closed{1, 101725, 2, 1, 1, 101325, 101325}, 1, 1, -101000, 1e6), 2 * 101725 - 101325, 1e-6);
  // Poisson, adiabatic air
  EXPECT_NEAR(pressure_of(Closed{1.4, 101725, 2, 1, 1, 101325, 101325}, 1, 1, -101000, 1e6),
              101725 * std::pow(2, 1.4) - 101325, 1e-6);
  // Gay-Lussac: 293 K -> 303 K at constant volume; half way along the path half of it
  EXPECT_NEAR(pressure_of(Closed{1, 101725, 2, 293, 303, 101325, 101325}, 2, 1, -101000, 1e6),
              101725 * 303.0 / 293.0 - 101325, 1e-6);
  EXPECT_NEAR(pressure_of(Closed{1, 101725, 2, 293, 303, 101325, 101325}, 2, 0.5, -101000, 1e6),
              101725 * 298.0 / 293.0 - 101325, 1e-6);
  // falling ambient pressure at constant volume raises the gauge pressure by as much
  EXPECT_NEAR(pressure_of(Closed{1, 101725, 2, 1, 1, 101325, 100325}, 2, 1, -100000, 1e6), 1400, 1e-6);
  // the thesis' law: gauge pressure itself, ambient pressure 0
  EXPECT_NEAR(pressure_of(Closed{1, 400, 2, 1, 1, 0, 0}, 1, 1, 1, 1e6), 800, 1e-9);
}

TEST(Gas, SmallPressureChangesKeepTheirDigits) {
  // 1 uPa in 1e7 Pa is a relative error of 1e-13: a plain difference of logarithms would lose it in rounding of 16.1
  const Closed gas{1, 1e7 + 400, 2, 1, 1, 1e7, 1e7};
  EXPECT_NEAR(gas_line(gas, 400 + 1e-6, 2, 1).relative, 1e-13, 0.02e-13);
}

TEST(Gas, VanishingVolumeOrAbsolutePressureIsRejectedNotOverflowed) {
  const Closed gas{1.4, 101725, 2, 1, 1, 101325, 101325};
  for (const double V : {0.0, -1.0, -1e300, std::nan("")}) EXPECT_FALSE(gas_line(gas, 400, V, 1).possible) << V;
  for (const double p : {-101325.0, -2e5, -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(gas_line(gas, p, 2, 1).possible) << p;
  }
  for (const double V : {1e-12, 1e-100, 1e-300}) {
    const GasLine line = gas_line(gas, 400, V, 1);
    EXPECT_TRUE(line.possible);
    EXPECT_TRUE(std::isfinite(line.residual) && std::isfinite(line.compliance) && std::isfinite(line.relative)) << V;
  }
}

TEST(Gas, AirThatCannotExistIsRejected) {
  // no volume, no pressure or no temperature at the start: nothing follows from the law (it said 'converged': NaN <
  // tol)
  for (const Closed& gas : {Closed{1, 400, 0, 1, 1, 0, 0}, Closed{1, 0, 2, 1, 1, 0, 0}, Closed{1, 400, 2, 0, 1, 0, 0},
                            Closed{1, 400, 2, 1, -1, 0, 0}, Closed{0, 400, 2, 1, 1, 0, 0}}) {
    EXPECT_FALSE(gas_line(gas, 400, 2, 1).possible);
  }
  EXPECT_FALSE(gas_line(PrescribedVolume{1, 0}, 400, 2, 1).possible);
}

TEST(Gas, PrescribedVolumeMayStartFromAFlatChamber) {
  const GasLine line = gas_line(PrescribedVolume{0, 3}, 0, 0, 0.5);
  EXPECT_TRUE(line.possible);
  EXPECT_DOUBLE_EQ(line.residual, -1.5);
  EXPECT_TRUE(gas_line(PrescribedVolume{0, 3}, 0, 0, 0).possible); // nothing is wanted, nothing is there
}

TEST(Gas, PrescribedPressureIsTheRampAndOtherLawsKeepTheirs) {
  EXPECT_DOUBLE_EQ(prescribed_pressure(Regulated{100, 500}, 7, 0.25), 200);
  EXPECT_EQ(prescribed_pressure(PrescribedVolume{1, 2}, 7, 0.25), 7);
  EXPECT_DOUBLE_EQ(ambient_pressure(Closed{1, 1, 1, 1, 1, 100, 200}, 5, 0.5), 150);
  EXPECT_EQ(ambient_pressure(Regulated{}, 5, 0.5), 5);
}

} // namespace
