// SPDX-License-Identifier: GPL-3.0-or-later
// The exact flat disc of any law: agreement with the one of given pressure, scales, limit points.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "solver/analytical/circular_membrane.h"

namespace pneuma::tests {

namespace {

using namespace solver::analytical;

CircularDisc rubber(double ratio) { // of C2 and C1
  return {0.1, 1e-3, MooneyRivlin{0.2e6, ratio * 0.2e6}};
}

// p R / (C1 h)
double dimensionless(const InflatedCircle& circle) {
  return circle.pressure * 0.1 / (0.2e6 * 1e-3);
}

TEST(CircularDisc, OfSaintVenantsLawIsTheMembraneOfThatPressure) {
  const CircularMembrane membrane{0.1425, 311488, 0.34, 0};
  const CircularDisc disc{0.1425, 1e-3, SaintVenantKirchhoff{311488e3, 0.34}};
  for (const double pressure : {1e3, 400e3}) {
    const InflatedCircle shot = inflate(membrane, pressure).value();
    const InflatedCircle direct = inflate_to(disc, shot.pole_stretch).value();
    EXPECT_NEAR(direct.pressure, pressure,
                1e-8 * pressure); // p goes with the root of the pole's strain, 1e-4 for 1 kPa
    EXPECT_NEAR(direct.deflection, shot.deflection, 1e-9 * shot.deflection);
    EXPECT_NEAR(direct.volume, shot.volume, 1e-9 * shot.volume);
    EXPECT_NEAR(direct.apex_tension, shot.apex_tension, 1e-12 * shot.apex_tension);
    EXPECT_NEAR(direct.meridian.back().radius, disc.radius, 1e-13);
    EXPECT_NEAR(direct.meridian.back().reference_radius, disc.radius, 1e-13);
    EXPECT_NEAR(direct.meridian.back().height, 0, 1e-15);
    EXPECT_NEAR(direct.meridian.front().height, direct.deflection, 1e-15);
    EXPECT_NEAR(direct.meridian.back().meridional, shot.meridian.back().meridional,
                1e-8 * shot.meridian.back().meridional);
  }
}

TEST(CircularDisc, ConvergesWithItsSteps) {
  for (const double stretch : {1.01, 1.5, 3.0, 8.0}) {
    const double fine = inflate_to(rubber(0), stretch, 8000)->pressure;
    EXPECT_NEAR(inflate_to(rubber(0), stretch)->pressure, fine, 1e-9 * fine) << stretch;
    EXPECT_NEAR(inflate_to(rubber(0), stretch, 1000)->pressure, fine, 4e-8 * fine) << stretch;
  }
}

TEST(CircularDisc, PoleIsInBalanceWithItsCurvature) {
  // p = 2 T / radius of curvature, by the meridian near the pole: depth = r^2 / (2 radius), less O(r^2) of it
  for (const double stretch : {1.05, 2.0, 6.0}) {
    const InflatedCircle circle = inflate_to(rubber(0.05), stretch).value();
    for (const MeridianPoint& point : circle.meridian) {
      if (point.radius < 1e-3 * 0.1 || point.radius > 2e-3 * 0.1) continue;
      const double curvature_radius = point.radius * point.radius / (2 * (circle.deflection - point.height));
      EXPECT_NEAR(circle.pressure * curvature_radius / (2 * circle.apex_tension), 1, 1e-5) << stretch;
    }
  }
}

TEST(CircularDisc, WorkOfThePressureIsTheEnergyOfTheSkin) {
  // p dV from the pole's stretch 1.2 to 3 against the energy W(l_s, l_h) over the disc, both by Simpson's rule
  const CircularDisc disc = rubber(0.05);
  const auto stored = [&](double stretch) {
    const InflatedCircle circle = inflate_to(disc, stretch).value();
    const std::vector<MeridianPoint>& m = circle.meridian;
    double sum = 0; // over areas of the flat disc between neighbours, by the chord's stretch in their middle
    for (std::size_t i = 1; i < m.size(); ++i) {
      const double dR = m[i].reference_radius - m[i - 1].reference_radius;
      const double R = 0.5 * (m[i].reference_radius + m[i - 1].reference_radius);
      const double along = std::hypot(m[i].radius - m[i - 1].radius, m[i].height - m[i - 1].height) / dR;
      const double around = 0.5 * (m[i].radius + m[i - 1].radius) / R;
      sum += 2 * std::numbers::pi * R * dR * disc.thickness * energy(disc.law, along, around).w;
    }
    return sum;
  };
  double work = 0;
  constexpr int intervals = 100;
  const auto at = [&](int i) { return inflate_to(disc, 1.2 + 1.8 * i / intervals).value(); };
  InflatedCircle before = at(0);
  for (int i = 1; i <= intervals; ++i) {
    const InflatedCircle now = at(i);
    work += 0.5 * (before.pressure + now.pressure) * (now.volume - before.volume);
    before = now;
  }
  // trapezoids 1e-4, chords over steps of 0.4 % 1e-6
  EXPECT_NEAR(stored(3) - stored(1.2), work, 2e-4 * work);
}

TEST(CircularDisc, OfNeoHookeanRubberHasOneLimitPoint) {
  const std::vector<InflatedCircle> limits = limit_points(rubber(0), 20);
  ASSERT_EQ(limits.size(), 1u);
  std::printf("neo-Hookean disc: p R / (C1 h) = %.6f at a pole stretch of %.4f, deflection %.5f R\n",
              dimensionless(limits[0]), limits[0].pole_stretch, limits[0].deflection / 0.1);
  for (const double beside : {0.98, 1.02}) {
    EXPECT_LT(inflate_to(rubber(0), beside * limits[0].pole_stretch)->pressure, limits[0].pressure);
  }
  // beyond, the pressure only falls
  double last = limits[0].pressure;
  for (double stretch = limits[0].pole_stretch * 1.1; stretch < 20; stretch *= 1.1) {
    const double pressure = inflate_to(rubber(0), stretch)->pressure;
    EXPECT_LT(pressure, last);
    last = pressure;
  }
}

TEST(CircularDisc, OfMooneyRivlinRubberLosesItsLimitPointsFarSoonerThanTheSphere) {
  // at a ratio of 0.0554, where the smallest slope dp/dl of the rising curve is zero; the sphere keeps them to 0.2145
  EXPECT_EQ(limit_points(rubber(0.05)).size(), 2u);
  EXPECT_TRUE(limit_points(rubber(0.06)).empty());
  const auto least_slope = [](double ratio) {
    double least = 1;
    for (double stretch = 3.5; stretch < 4.2; stretch += 0.05) {
      const double slope =
          inflate_to(rubber(ratio), stretch + 0.02)->pressure - inflate_to(rubber(ratio), stretch - 0.02)->pressure;
      least = std::min(least, slope);
    }
    return least;
  };
  const double below = least_slope(0.0553), above = least_slope(0.0556);
  EXPECT_LT(below, 0);
  EXPECT_GT(above, 0);
  std::printf("limits up to C2 / C1 = %.5f\n", 0.0553 + 0.0003 * below / (below - above));
  for (const double ratio : {0.03, 0.05}) { // a maximum, then the minimum behind which it stiffens
    const std::vector<InflatedCircle> limits = limit_points(rubber(ratio));
    ASSERT_EQ(limits.size(), 2u);
    EXPECT_GT(limits[0].pressure, limits[1].pressure);
    EXPECT_LT(limits[0].pole_stretch, limits[1].pole_stretch);
    std::printf("C2 / C1 = %.2f: p R / (C1 h) = %.4f and %.4f at pole stretches %.3f and %.3f\n", ratio,
                dimensionless(limits[0]), dimensionless(limits[1]), limits[0].pole_stretch, limits[1].pole_stretch);
  }
}

TEST(CircularDisc, WithoutAStretchIsRefused) {
  EXPECT_FALSE(inflate_to(rubber(0), 1));
  EXPECT_FALSE(inflate_to(rubber(0), std::nan("")));
}

} // namespace

} // namespace pneuma::tests
