// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "geometry/nurbs/surface.h"
#include "tests/unit/finite_differences.h"

namespace pneuma::tests {
namespace {

using namespace geometry::nurbs;
using base::Vec2;
using base::Vec3;

// The NURBS Book, example 2.3: degree 2 on {0, 0, 0, 1, 2, 3, 4, 4, 5, 5, 5}
const Knots book{2, {0, 0, 0, 1, 2, 3, 4, 4, 5, 5, 5}};

// a quarter of the unit circle (The NURBS Book, example 7.1, weights 1, 1, 2)
const Curve<2> quarter{{2, {0, 0, 0, 1, 1, 1}}, {Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}, {1, 1, 2}};

Knots uneven(int degree) {
  return from_breaks(degree, std::vector<double>{-1, -0.9, -0.2, 0, 0.1, 0.7, 2});
}

// a rational surface whose first two coordinates cover a bent square
Surface<3> bent(int degree_u, int degree_v) {
  Surface<3> surface{uneven(degree_u), uniform(degree_v, degree_v + 4, 0, 1), {}, {}};
  const std::vector<double> us = greville(surface.u);
  const std::vector<double> vs = greville(surface.v);
  for (const double u : us) {
    for (const double v : vs) {
      surface.points.push_back(Vec3(u + 0.2 * v * v, v + 0.1 * std::sin(u), std::exp(u) * v));
      surface.weights.push_back(1 + 0.3 * std::sin(3 * u + v));
    }
  }
  return surface;
}

TEST(Knots, GiveTheBasisFunctionsOfTheNurbsBook) {
  // example 2.3 and 2.4 at u = 5/2: N = 1/8, 6/8, 1/8, N' = -1/2, 0, 1/2, N'' = 1, -2, 1
  Basis basis;
  evaluate_basis(book, 2.5, 3, basis);
  EXPECT_EQ(basis.first, 2);
  const double expected[4][3] = {{0.125, 0.75, 0.125}, {-0.5, 0, 0.5}, {1, -2, 1}, {0, 0, 0}};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(basis.functions[k][j], expected[k][j], 1e-15) << k << " " << j;
  }
}

TEST(Knots, EveryDegreeSumsToOneIsPositiveAndHasItsDerivatives) {
  for (int degree = 1; degree <= max_degree; ++degree) {
    const Knots knots = uneven(degree);
    for (const double u : {-1.0, -0.95, -0.2, 0.05, 0.3, 1.999, 2.0}) {
      Basis basis;
      evaluate_basis(knots, u, 3, basis);
      double sums[4] = {};
      for (std::size_t k = 0; k < 4; ++k) {
        double size = 0;
        for (std::size_t j = 0; j <= static_cast<std::size_t>(degree); ++j) {
          sums[k] += basis.functions[k][j];
          size = std::max(size, std::abs(basis.functions[k][j]));
          EXPECT_GE(basis.functions[0][j], 0);
        }
        EXPECT_NEAR(sums[k], k == 0 ? 1 : 0, 2e-15 * std::max(size, 1.0)) << degree << " " << k << " " << u;
      }
    }
    // inside a span polynomials, of which fourth-order differences leave rounding / step and, from degree 5, step^4
    for (const double u : {-0.95, -0.5, 0.4, 1.5}) {
      Basis at;
      evaluate_basis(knots, u, 3, at);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto functions = [&](const Eigen::VectorXd& x) {
          Basis b;
          evaluate_basis(knots, x[0], 2, b);
          return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(b.functions[k].data(), degree + 1));
        };
        const Eigen::MatrixXd slope = finite_difference_jacobian(functions, Eigen::VectorXd::Constant(1, u), 2e-4);
        const Eigen::Map<const Eigen::VectorXd> exact(at.functions[k + 1].data(), degree + 1);
        const Eigen::Map<const Eigen::VectorXd> size(at.functions[k].data(), degree + 1);
        EXPECT_LT((slope - exact).cwiseAbs().maxCoeff(), 1e-9 * std::max(1.0, 100 * size.cwiseAbs().maxCoeff()))
            << degree << " " << k << " " << u;
      }
    }
  }
}

TEST(Knots, RefuseWhatIsNoKnotVector) {
  EXPECT_THROW(check(Knots{0, {0, 1}}), std::invalid_argument);
  EXPECT_THROW(check(Knots{8, std::vector<double>(18, 0.0)}), std::invalid_argument);
  EXPECT_THROW(check(Knots{2, {0, 0, 0, 1, 1}}), std::invalid_argument);
  EXPECT_THROW(check(Knots{2, {0, 0, 0, 2, 1, 3, 3, 3}}), std::invalid_argument);
  EXPECT_THROW(check(Knots{2, {0, 0, 0.5, 1, 1, 1}}), std::invalid_argument);
  EXPECT_THROW(check(Knots{2, {0, 0, 0, 1, 1, 1, 2, 2, 2}}), std::invalid_argument);
  EXPECT_THROW(check(Knots{1, {0, 0, std::nan(""), 1, 1}}), std::invalid_argument);
  EXPECT_THROW(uniform(3, 3, 0, 1), std::invalid_argument);
  EXPECT_THROW(from_breaks(3, std::vector<double>{0, 1, 1}), std::invalid_argument);
  EXPECT_THROW(check(Curve<1>{book, {Point<1>(0)}, {}}), std::invalid_argument);
  EXPECT_THROW(check(Curve<2>{quarter.knots, quarter.points, {1, 0, 1}}), std::invalid_argument);
  EXPECT_NO_THROW(check(book));
  EXPECT_NO_THROW(check(quarter));
  EXPECT_NO_THROW(check(bent(3, 2)));
}

TEST(Knots, AveragedOnesHoldAParameterInEverySpan) {
  std::vector<double> parameters;
  for (int i = 0; i < 30; ++i) parameters.push_back(std::pow(i / 29.0, 3));
  for (int functions = 5; functions <= 30; ++functions) {
    const Knots knots = averaged(3, functions, parameters);
    EXPECT_EQ(knots.functions(), functions);
    const std::vector<double> ends = breaks(knots);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      EXPECT_TRUE(
          std::any_of(parameters.begin(), parameters.end(), [&](double u) { return u >= ends[i] && u <= ends[i + 1]; }))
          << functions << " " << i;
    }
  }
}

TEST(Curve, QuadraticWithWeightsIsACircleExactly) {
  for (int i = 0; i <= 50; ++i) {
    const CurveJet<2> at = evaluate(quarter, i / 50.0);
    EXPECT_NEAR(at.value.norm(), 1, 2e-16 * 4);
    // the curvature of a unit circle
    const double bend = at.first[0] * at.second[1] - at.first[1] * at.second[0];
    EXPECT_NEAR(bend / std::pow(at.first.norm(), 3), 1, 1e-14);
  }
}

TEST(Curve, OneDegreeMoreGivesTheSameCurve) {
  // without inner knots: Q_i = i / (p + 1) P_{i-1} + (1 - i / (p + 1)) P_i of the weighted points (eq. 5.33)
  Curve<2> cubic{{3, {0, 0, 0, 0, 1, 1, 1, 1}}, {}, {}};
  for (int i = 0; i <= 3; ++i) {
    Vec3 weighted = Vec3::Zero();
    for (const auto& [k, part] : {std::pair{i - 1, i / 3.0}, {i, 1 - i / 3.0}}) {
      if (part == 0) continue;
      const auto n = static_cast<std::size_t>(k);
      weighted += part * quarter.weights[n] * Vec3(quarter.points[n][0], quarter.points[n][1], 1);
    }
    cubic.points.push_back(weighted.head<2>() / weighted[2]);
    cubic.weights.push_back(weighted[2]);
  }
  for (int i = 0; i <= 20; ++i) {
    const CurveJet<2> a = evaluate(quarter, i / 20.0);
    const CurveJet<2> b = evaluate(cubic, i / 20.0);
    EXPECT_LT((a.value - b.value).norm(), 1e-15);
    EXPECT_LT((a.first - b.first).norm(), 1e-14);
    EXPECT_LT((a.second - b.second).norm(), 1e-13);
  }
}

TEST(Curve, WithControlPointsAtTheGrevilleAbscissaeIsTheIdentity) {
  for (int degree = 1; degree <= max_degree; ++degree) {
    Curve<1> line{uneven(degree), {}, {}};
    for (const double g : greville(line.knots)) line.points.push_back(Point<1>(g));
    for (const double u : {-1.0, -0.5, 0.1, 1.3, 2.0, 2.3, -1.1}) {
      // beyond the ends second derivatives, degree^2 / span^2, times the distance squared are rounded
      const bool inside = u >= -1 && u <= 2;
      const CurveJet<1> at = evaluate(line, u);
      EXPECT_NEAR(at.value[0], u, inside ? 4e-15 : 1e-13);
      EXPECT_NEAR(at.first[0], 1, inside ? 4e-14 : 1e-12);
      if (inside) {
        EXPECT_NEAR(*parameter_at(line, 0, u), u, 4e-15);
      }
    }
  }
}

TEST(Curve, BeyondItsEndsGoesOnAsAParabola) {
  Curve<1> curve{uneven(3), {}, {}};
  for (const double g : greville(curve.knots)) curve.points.push_back(Point<1>(std::exp(g)));
  for (const double end : {-1.0, 2.0}) {
    const CurveJet<1> at = evaluate(curve, end);
    const double away = end < 0 ? -0.3 : 0.3;
    const CurveJet<1> beyond = evaluate(curve, end + away);
    EXPECT_NEAR(beyond.value[0], at.value[0] + away * at.first[0] + 0.5 * away * away * at.second[0], 1e-14);
    EXPECT_NEAR(beyond.first[0], at.first[0] + away * at.second[0], 1e-14);
    EXPECT_NEAR(beyond.second[0], at.second[0], 1e-13);
  }
}

TEST(Curve, GivesBackTheParameterOfACoordinate) {
  for (int i = 0; i <= 40; ++i) {
    const double u = i / 40.0;
    const CurveJet<2> at = evaluate(quarter, u);
    // a coordinate that does not move tells nothing of the parameter: its error is rounding over the slope
    for (const int coordinate : {0, 1}) {
      const std::optional<double> found = parameter_at(quarter, coordinate, at.value[coordinate]);
      ASSERT_TRUE(found);
      EXPECT_NEAR(evaluate(quarter, *found).value[coordinate], at.value[coordinate], 4e-16) << u;
    }
  }
  EXPECT_FALSE(parameter_at(quarter, 0, 1.1));
  EXPECT_FALSE(parameter_at(quarter, 0, std::nan("")));
}

TEST(Surface, HasItsDerivatives) {
  for (const auto& [p, q] : {std::pair{3, 2}, {2, 5}, {7, 4}}) {
    const Surface<3> surface = bent(p, q);
    for (const auto& [u, v] : {std::pair{-0.5, 0.1}, {0.05, 0.55}, {1.4, 0.9}}) {
      const SurfaceJet<3> at = evaluate(surface, u, v);
      const auto jet = [&](const Eigen::VectorXd& x) {
        const SurfaceJet<3> s = evaluate(surface, x[0], x[1]);
        return Eigen::VectorXd((Eigen::VectorXd(9) << s.value, s.u, s.v).finished());
      };
      const Eigen::MatrixXd slope = finite_difference_jacobian(jet, Vec2(u, v), 5e-4);
      const Eigen::MatrixXd exact = (Eigen::MatrixXd(9, 2) << at.u, at.v, at.uu, at.uv, at.uv, at.vv).finished();
      EXPECT_LT(relative_difference(slope, exact), 1e-9) << p << " " << q << " " << u;
    }
  }
}

TEST(Surface, OfRevolutionHasTheRadiusOfTheCylinderExactly) {
  Surface<3> cylinder{quarter.knots, uniform(1, 2, 0, 1), {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double z : {0.0, 2.0}) {
      cylinder.points.push_back(Vec3(quarter.points[i][0], quarter.points[i][1], z));
      cylinder.weights.push_back(quarter.weights[i]);
    }
  }
  for (const double u : {0.0, 0.2, 0.7, 1.0}) {
    const SurfaceJet<3> at = evaluate(cylinder, u, 0.25);
    EXPECT_NEAR(at.value.head<2>().norm(), 1, 1e-15);
    EXPECT_NEAR(at.value[2], 0.5, 1e-15);
    EXPECT_NEAR(at.vv.norm(), 0, 1e-14);
  }
}

TEST(Surface, GivesBackTheParametersOfAPlace) {
  const Surface<3> surface = bent(3, 2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in_u(-1, 2);
  std::uniform_real_distribution<double> in_v(0, 1);
  for (int i = 0; i < 100; ++i) {
    const Vec2 at(in_u(random), in_v(random));
    const std::optional<Vec2> found = parameters_at(surface, evaluate(surface, at[0], at[1]).value.head<2>());
    ASSERT_TRUE(found) << at.transpose();
    EXPECT_LT((*found - at).norm(), 1e-13) << at.transpose();
  }
  for (const Vec2& corner : {Vec2(-1, 0), Vec2(2, 1), Vec2(-1, 1)}) {
    const std::optional<Vec2> found = parameters_at(surface, evaluate(surface, corner[0], corner[1]).value.head<2>());
    ASSERT_TRUE(found) << corner.transpose();
    EXPECT_LT((*found - corner).norm(), 1e-13);
  }
  EXPECT_FALSE(parameters_at(surface, Vec2(5, 0.5)));
}

} // namespace
} // namespace pneuma::tests
