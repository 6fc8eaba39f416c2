// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/nurbs/fit.h"
#include "tests/unit/message_of.h"

namespace pneuma::tests {
namespace {

using namespace geometry::nurbs;

std::vector<CurveObservation> sampled(double (*f)(double), int count, double first, double last) {
  std::vector<CurveObservation> observations;
  for (int i = 0; i < count; ++i) {
    const double u = first + (last - first) * i / (count - 1);
    observations.push_back({u, 0, f(u), 1});
  }
  return observations;
}

TEST(CurveFit, ReproducesASplineFromScatteredPoints) {
  const Knots knots = from_breaks(3, std::vector<double>{0, 0.2, 0.3, 0.7, 1});
  Curve<1> spline{knots, {}, {}};
  for (int i = 0; i < knots.functions(); ++i) spline.points.push_back(Point<1>(std::sin(2.0 * i)));
  std::vector<CurveObservation> observations;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(0, 1);
  for (int i = 0; i < 60; ++i) {
    const double u = anywhere(random);
    observations.push_back({u, 0, evaluate(spline, u).value[0], 0.5 + anywhere(random)});
  }
  const CurveFit found = fit(knots, observations, {.smoothing = 0});
  for (std::size_t i = 0; i < spline.points.size(); ++i) {
    EXPECT_NEAR(found.curve.points[i][0], spline.points[i][0], 1e-13);
  }
  EXPECT_LT(found.residuals.max, 1e-14);
  EXPECT_EQ(found.residuals.uncovered, 0);
}

TEST(CurveFit, ErrorFallsWithTheOrderOfTheSpline) {
  // least squares are quasi-optimal: error ~ h^(degree + 1)
  const auto f = [](double x) { return std::exp(std::sin(3 * x)); };
  for (const int degree : {2, 3, 5}) {
    double errors[2];
    for (int k = 0; k < 2; ++k) {
      const Knots knots = uniform(degree, degree + (k == 0 ? 10 : 20), 0, 1);
      errors[k] = fit(knots, sampled(f, 400, 0, 1), {.smoothing = 0}).residuals.max;
    }
    EXPECT_GT(std::log2(errors[0] / errors[1]), degree + 0.5) << degree << ": " << errors[0] << " " << errors[1];
  }
}

TEST(CurveFit, ResidualsSayWhereTheWorstPointLies) {
  std::vector<CurveObservation> observations = sampled([](double x) { return x; }, 40, 0, 1);
  observations[17].value += 0.1;
  const Residuals found = fit(uniform(3, 6, 0, 1), observations, {}).residuals;
  EXPECT_EQ(found.where, 17u);
  EXPECT_GT(found.max, 0.08);
  EXPECT_LT(found.rms, found.max);
  observations[17].weight = 0; // what has no weight is not followed and not the worst
  const Residuals without = fit(uniform(3, 6, 0, 1), observations, {}).residuals;
  EXPECT_LT(without.max, 1e-12);
  EXPECT_NEAR(without.each[17], -0.1, 1e-12);
}

TEST(CurveFit, HolesAreFilledByWhatThePenaltyDoesNotSee) {
  // second derivatives penalised: the line through both ends of the hole; a straight line exactly
  std::vector<CurveObservation> observations;
  for (const CurveObservation& o : sampled([](double x) { return 2 * x - 1; }, 50, 0, 1)) {
    if (o.u < 0.3 || o.u > 0.8) observations.push_back(o);
  }
  const CurveFit found = fit(uniform(3, 23, 0, 1), observations, {});
  EXPECT_GT(found.residuals.uncovered, 0.4);
  for (const double u : {0.0, 0.35, 0.5, 0.7, 1.0}) EXPECT_NEAR(evaluate(found.curve, u).value[0], 2 * u - 1, 1e-9);
}

TEST(CurveFit, SmoothingCalmsNoise) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<CurveObservation> observations = sampled([](double x) { return x * x; }, 200, 0, 1);
  for (CurveObservation& o : observations) o.value += noise(random);
  double errors[2];
  double slopes[2];
  for (int k = 0; k < 2; ++k) {
    const Curve<1> curve = fit(uniform(3, 40, 0, 1), observations, {.smoothing = k == 0 ? 1e-7 : 20}).curve;
    errors[k] = 0;
    for (int i = 0; i <= 100; ++i) {
      const double u = 0.01 * i;
      errors[k] = std::max(errors[k], std::abs(evaluate(curve, u).value[0] - u * u));
    }
    slopes[k] = least_slope(curve).least;
  }
  EXPECT_LT(errors[1], errors[0] / 2);
  EXPECT_LT(slopes[0], -0.5); // the unsmoothed one follows the noise down
  EXPECT_GT(slopes[1], -0.1);
}

TEST(CurveFit, AntiderivativeFollowsItsDerivativesToAConstant) {
  std::vector<CurveObservation> observations = {{0, 0, 0, 1}};
  for (int i = 0; i <= 50; ++i) observations.push_back({i / 50.0, 1, std::cos(i / 50.0), 1});
  const Curve<1> curve = fit(uniform(4, 14, 0, 1), observations, {.smoothing = 0}).curve;
  for (const double u : {0.1, 0.5, 1.0}) EXPECT_NEAR(evaluate(curve, u).value[0], std::sin(u), 1e-7);
}

TEST(CurveFit, RefusesWhatTheDataDoNotDetermine) {
  const Knots knots = uniform(3, 8, 0, 1);
  const std::vector<CurveObservation> one = {{0.5, 0, 1, 1}, {0.5, 0, 2, 1}};
  EXPECT_THAT(message_of([&] { fit(knots, one, {}); }), testing::HasSubstr("1 of its 2 freedoms"));
  EXPECT_THAT(message_of([&] { fit(knots, one, {.smoothing = 0}); }), testing::HasSubstr("control points free"));
  const std::vector<CurveObservation> slopes = {{0.2, 1, 1, 1}, {0.5, 1, 1, 1}};
  EXPECT_THAT(message_of([&] { fit(knots, slopes, {}); }), testing::HasSubstr("do not determine the curve"));
  EXPECT_THAT(message_of([&] { fit(knots, std::vector<CurveObservation>{}, {}); }), testing::HasSubstr("needs an obs"));
  const std::vector<CurveObservation> holes = {{0.2, 0, std::nan(""), 1}, {0.5, 0, 1, 1}};
  EXPECT_THAT(message_of([&] { fit(knots, holes, {}); }), testing::HasSubstr("observation 0"));
}

double hill(double u, double v) {
  return std::exp(-u * u) * std::cos(v) + 0.3 * u * v;
}

TEST(SurfaceFit, ErrorFallsWithTheOrderOfTheSpline) {
  for (const int degree : {2, 3}) {
    double errors[2];
    for (int k = 0; k < 2; ++k) {
      const Knots knots = uniform(degree, degree + (k == 0 ? 5 : 10), -1, 1);
      std::vector<SurfaceObservation> observations;
      for (int i = 0; i <= 60; ++i) {
        for (int j = 0; j <= 60; ++j) {
          const double u = i / 30.0 - 1;
          const double v = j / 30.0 - 1;
          observations.push_back({u, v, 0, 0, hill(u, v), 1});
        }
      }
      errors[k] = fit(knots, knots, observations, {.smoothing = 0}).residuals.max;
    }
    EXPECT_GT(std::log2(errors[0] / errors[1]), degree + 0.5) << degree << ": " << errors[0] << " " << errors[1];
  }
}

TEST(SurfaceFit, SymmetricFromOneSideOfTheDiagonal) {
  const auto f = [](double u, double v) { return std::exp(u * v) + u + v; };
  const Knots knots = uniform(3, 9, 0, 1);
  std::vector<SurfaceObservation> observations;
  for (int i = 0; i <= 30; ++i) {
    for (int j = 0; j <= i; ++j) observations.push_back({i / 30.0, j / 30.0, 0, 0, f(i / 30.0, j / 30.0), 1});
  }
  const SurfaceFit found = fit(knots, knots, observations, {.symmetric = true});
  EXPECT_EQ(found.residuals.uncovered, 0);
  for (const auto& [u, v] : {std::pair{0.9, 0.2}, {0.3, 0.31}, {0.5, 1.0}}) {
    const SurfaceJet<1> at = evaluate(found.surface, u, v);
    const SurfaceJet<1> mirrored = evaluate(found.surface, v, u);
    EXPECT_NEAR(at.value[0], f(u, v), 1e-5);
    EXPECT_NEAR(mirrored.value[0], at.value[0], 1e-15);
    EXPECT_NEAR(mirrored.u[0], at.v[0], 1e-14);
  }
}

TEST(SurfaceFit, PotentialFollowsItsGradient) {
  const Knots u = uniform(4, 12, -1, 1);
  const Knots v = uniform(3, 10, -1, 1);
  std::vector<SurfaceObservation> observations = {{0, 0, 0, 0, 1, 1}};
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      const double a = i / 20.0 - 1;
      const double b = j / 20.0 - 1;
      observations.push_back({a, b, 1, 0, -2 * a * std::exp(-a * a) * std::cos(b) + 0.3 * b, 1});
      observations.push_back({a, b, 0, 1, -std::exp(-a * a) * std::sin(b) + 0.3 * a, 1});
    }
  }
  const SurfaceFit found = fit(u, v, observations, {.penalized = 3, .of_gradient = true});
  EXPECT_LT(found.residuals.max, 2e-3);
  for (const auto& [a, b] : {std::pair{0.9, 0.2}, {-0.3, 0.31}, {0.5, -1.0}}) {
    EXPECT_NEAR(evaluate(found.surface, a, b).value[0], hill(a, b), 2e-4);
  }
}

TEST(SurfaceFit, BeginsFlatWhereAsked) {
  // (u - 1)^2 cos v beside something that is not flat
  const Knots u = uniform(3, 10, 1, 3);
  const Knots v = uniform(3, 10, -1, 1);
  std::vector<SurfaceObservation> flat;
  std::vector<SurfaceObservation> raised;
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      const double a = 1 + i / 20.0;
      const double b = j / 20.0 - 1;
      flat.push_back({a, b, 0, 0, (a - 1) * (a - 1) * std::cos(b), 1});
      raised.push_back({a, b, 0, 0, flat.back().value + 0.1, 1});
    }
  }
  const SurfaceFit good = fit(u, v, flat, {.smoothing = 1e-12, .flat_start = 2});
  const SurfaceFit forced = fit(u, v, raised, {.smoothing = 1e-12, .flat_start = 2});
  EXPECT_LT(good.residuals.max, 1e-4); // order 4 of spans of 2/7
  EXPECT_NEAR(forced.residuals.max, 0.1, 1e-12);
  for (const SurfaceFit& found : {good, forced}) {
    for (const double b : {-1.0, -0.2, 0.7}) {
      const SurfaceJet<1> at = evaluate(found.surface, 1, b);
      EXPECT_EQ(at.value[0], 0);
      EXPECT_EQ(at.u[0], 0);
      EXPECT_EQ(at.vv[0], 0);
    }
  }
  EXPECT_THAT(message_of([&] { fit(u, u, flat, {.symmetric = true, .flat_start = 1}); }),
              testing::HasSubstr("flat start"));
}

TEST(SurfaceFit, RefusesPointsOnALine) {
  const Knots knots = uniform(3, 8, 0, 1);
  std::vector<SurfaceObservation> observations;
  for (int i = 0; i <= 20; ++i) observations.push_back({i / 20.0, i / 20.0, 0, 0, 1.0 * i, 1});
  EXPECT_THAT(message_of([&] { fit(knots, knots, observations, {}); }), testing::HasSubstr("2 of its 3 freedoms"));
  EXPECT_THAT(message_of([&] { fit(knots, uniform(3, 9, 0, 1), observations, {.symmetric = true}); }),
              testing::HasSubstr("same knots"));
}

} // namespace
} // namespace pneuma::tests
