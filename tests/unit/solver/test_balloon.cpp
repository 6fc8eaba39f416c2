// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres and tubes under inner pressure: derivatives, work, equilibrium of cuts, limit points of the literature.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "solver/analytical/balloon.h"
#include "solver/material/material.h"
#include "tests/unit/finite_differences.h"

namespace pneuma::tests {

namespace {

using namespace solver::analytical;
using base::VecX;

constexpr double R = 0.5, h = 2e-3; // m
constexpr double mega = 1e6;        // Pa

// The laws of the house: ETFE as St. Venant-Kirchhoff foil, and rubber (thesis B4 for the ratio of Mooney-Rivlin).
const SaintVenantKirchhoff saint_venant{900 * mega, 0.45};
const MooneyRivlin neo_hooke{25 * mega, 0};
const MooneyRivlin mooney{25 * mega, 2 * mega};

struct Case {
  const char* law;
  Balloon balloon;
};

std::vector<Case> every_case() {
  std::vector<Case> all;
  const std::pair<const char*, StretchLaw> laws[] = {
      {"StVenant", saint_venant}, {"NeoHooke", neo_hooke}, {"MooneyRivlin", mooney}};
  for (const auto& [name, law] : laws) {
    for (const BalloonShape shape : {BalloonShape::sphere, BalloonShape::held_tube, BalloonShape::capped_tube}) {
      all.push_back({name, {shape, R, h, law}});
    }
  }
  return all;
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  const char* shapes[] = {"Sphere", "HeldTube", "CappedTube"};
  return std::string(shapes[static_cast<std::size_t>(info.param.balloon.shape)]) + info.param.law;
}

class EveryBalloon : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Balloon, EveryBalloon, testing::ValuesIn(every_case()), name_of);

TEST_P(EveryBalloon, SlopeIsTheDerivativeOfThePressure) {
  for (const double stretch : {1.1, 1.38, 2.0, 4.0}) {
    const auto pressure = [&](const VecX& x) { return VecX::Constant(1, inflate(GetParam().balloon, x[0])->pressure); };
    const double by_differences = finite_difference_jacobian(pressure, VecX::Constant(1, stretch), 1e-3)(0, 0);
    const InflatedBalloon state = inflate(GetParam().balloon, stretch).value();
    // 1e-12 of difference over 1e-3 of step
    EXPECT_NEAR(state.slope, by_differences, 1e-8 * (std::abs(state.slope) + state.pressure)) << stretch;
  }
}

TEST_P(EveryBalloon, EnergyIsTheWorkOfThePressure) {
  // Gauss-Legendre, three points an interval, of p dV against the energy
  const Balloon& balloon = GetParam().balloon;
  constexpr int intervals = 100;
  constexpr double last = 2.5;
  const double point = std::sqrt(0.6);
  double work = 0;
  for (int i = 0; i < intervals; ++i) {
    const double half = 0.5 * (last - 1) / intervals;
    for (const auto& [at, weight] : {std::pair{-point, 5.0 / 9}, {0.0, 8.0 / 9}, {point, 5.0 / 9}}) {
      const double stretch = 1 + half * (2 * i + 1 + at);
      const auto volume = [&](const VecX& x) { return VecX::Constant(1, inflate(balloon, x[0])->volume); };
      const double dv = finite_difference_jacobian(volume, VecX::Constant(1, stretch), 1e-4)(0, 0);
      work += weight * half * inflate(balloon, stretch)->pressure * dv;
    }
  }
  EXPECT_NEAR(inflate(balloon, last)->energy, work, 1e-8 * work);
}

TEST_P(EveryBalloon, CutsThroughTheWallAreInBalance) {
  // by Cauchy stress and current thickness on the cut, and the pressure on what it opens
  const Balloon& balloon = GetParam().balloon;
  for (const double stretch : {1.02, 1.2}) { // St. Venant's wall has a thickness up to 1.27
    const InflatedBalloon s = inflate(balloon, stretch).value();
    const double r = R * s.stretch, t = h * s.thickness_stretch;
    const double on_section = std::numbers::pi * r * r * s.pressure;
    if (balloon.shape == BalloonShape::sphere) {
      EXPECT_NEAR(2 * std::numbers::pi * r * t * s.hoop, on_section, 1e-13 * on_section);
      EXPECT_NEAR(s.axial, s.hoop, 1e-13 * s.hoop);
    } else {
      EXPECT_NEAR(t * s.hoop, s.pressure * r, 1e-13 * s.pressure * r);
      if (balloon.shape == BalloonShape::capped_tube) {
        EXPECT_NEAR(2 * std::numbers::pi * r * t * s.axial, on_section, 1e-12 * on_section);
      } else {
        EXPECT_EQ(s.axial_stretch, 1);
      }
    }
  }
}

TEST_P(EveryBalloon, StartsWithTheLinearStiffnessOfItsShape) {
  // dp/dl at 1: 2 h E / (R (1 - nu)) sphere, h E / (R (1 - nu^2)) held, h E / (R (1 - nu/2)) capped; rubber: nu 1/2
  const Balloon& balloon = GetParam().balloon;
  double E = saint_venant.youngs_modulus, nu = saint_venant.poissons_ratio;
  if (const auto* rubber = std::get_if<MooneyRivlin>(&balloon.law)) {
    E = 6 * (rubber->c1 + rubber->c2);
    nu = 0.5;
  }
  const double softness[] = {(1 - nu) / 2, 1 - nu * nu, 1 - nu / 2};
  const double wanted = h * E / (R * softness[static_cast<std::size_t>(balloon.shape)]);
  const InflatedBalloon start = inflate(balloon, 1).value();
  EXPECT_EQ(start.pressure, 0);
  EXPECT_NEAR(start.slope, wanted, 1e-12 * wanted);
}

TEST(Balloon, NeoHookeanSphereHasItsLimitAtTheSixthRootOfSeven) {
  // p = 4 C1 h/R (1/l - 1/l^7): Holzapfel (2000), sec. 6.5; p max = 4 C1 h/R (6/7) 7^(-1/6)
  const std::vector<InflatedBalloon> limits = limit_points({BalloonShape::sphere, R, h, neo_hooke});
  ASSERT_EQ(limits.size(), 1u);
  const InflatedBalloon& limit = limits[0];
  EXPECT_NEAR(limit.stretch, std::pow(7, 1.0 / 6), 1e-12);
  EXPECT_NEAR(limit.pressure, 4 * neo_hooke.c1 * h / R * 6 / 7 * std::pow(7, -1.0 / 6), 1e-12 * limit.pressure);
  std::printf("neo-Hookean sphere: limit at stretch %.6f, p R / (C1 h) = %.6f\n", limit.stretch,
              limit.pressure * R / (neo_hooke.c1 * h));
}

TEST(Balloon, MooneyRivlinSphereLosesItsLimitPointsAtARatioOf021446) {
  // slope 0 where C2/C1 = (x^3 - 7) / (x (x^3 + 5)), x = l^2; its largest value at x^3 = 19 + sqrt(396)
  const auto ratio_of = [](double l) {
    const double x = l * l, cube = x * x * x;
    return (cube - 7) / (x * (cube + 5));
  };
  const double ratio = ratio_of(std::pow(19 + std::sqrt(396), 1.0 / 6));
  EXPECT_NEAR(ratio, 0.21446, 5e-6);
  std::printf("Mooney-Rivlin sphere: limits up to C2 / C1 = %.6f\n", ratio);
  EXPECT_EQ(limit_points({BalloonShape::sphere, R, h, MooneyRivlin{1, ratio - 1e-4}}).size(), 2u);
  EXPECT_TRUE(limit_points({BalloonShape::sphere, R, h, MooneyRivlin{1, ratio + 1e-4}}).empty());
  // a maximum, and the minimum behind which the balloon stiffens
  const std::vector<InflatedBalloon> limits = limit_points({BalloonShape::sphere, R, h, mooney});
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_GT(limits[0].pressure, limits[1].pressure);
  for (const InflatedBalloon& limit : limits) EXPECT_NEAR(ratio_of(limit.stretch), mooney.c2 / mooney.c1, 1e-12);
}

TEST(Balloon, HeldTubeOfRubberNearsAPressureItNeverReaches) {
  // p = 2 (C1 + C2) h/R (1 - l^-4)
  const Balloon balloon{BalloonShape::held_tube, R, h, mooney};
  const double bound = 2 * (mooney.c1 + mooney.c2) * h / R;
  for (const double l : {1.5, 3.0, 10.0}) {
    EXPECT_NEAR(inflate(balloon, l)->pressure, bound * (1 - std::pow(l, -4)), 1e-13 * bound);
  }
  EXPECT_TRUE(limit_points(balloon).empty());
}

TEST(Balloon, CappedTubeOfNeoHookeanRubberFollowsItsClosedForm) {
  // 2 lz^4 - l^2 lz^2 - l^-2 = 0 and p = 2 C1 h/R (1 - l^-4 lz^-2) / lz, largest where scanning finds it
  const Balloon balloon{BalloonShape::capped_tube, R, h, neo_hooke};
  const auto axial = [](double l) { return std::sqrt((l * l + std::sqrt(std::pow(l, 4) + 8 / (l * l))) / 4); };
  const auto pressure = [&](double l) {
    const double lz = axial(l);
    return 2 * neo_hooke.c1 * h / R * (1 - std::pow(l, -4) / (lz * lz)) / lz;
  };
  double best = 1;
  for (double l = 1; l < 3; l += 1e-4) {
    if (pressure(l) > pressure(best)) best = l;
    const InflatedBalloon s = inflate(balloon, l).value();
    ASSERT_NEAR(s.axial_stretch, axial(l), 1e-13);
    ASSERT_NEAR(s.pressure, pressure(l), 1e-13 * 2 * neo_hooke.c1 * h / R);
  }
  const InflatedBalloon limit = limit_points(balloon).at(0);
  EXPECT_NEAR(limit.stretch, best, 1e-4);
  std::printf("capped neo-Hookean tube: limit at stretch %.6f (axial %.6f), p R / (C1 h) = %.6f\n", limit.stretch,
              limit.axial_stretch, limit.pressure * R / (neo_hooke.c1 * h));
}

TEST(Balloon, SaintVenantsSphereAndHeldTubeHaveNoLimit) {
  // p = h E / (R (1 - nu)) (l - 1/l) and h E / (2 R (1 - nu^2)) (l^2 - 1): growing for all l
  const double E = saint_venant.youngs_modulus, nu = saint_venant.poissons_ratio;
  for (const double l : {1.2, 2.0, 9.0}) {
    const double sphere = h * E / (R * (1 - nu)) * (l - 1 / l);
    const double tube = h * E / (2 * R * (1 - nu * nu)) * (l * l - 1);
    EXPECT_NEAR(inflate({BalloonShape::sphere, R, h, saint_venant}, l)->pressure, sphere, 1e-13 * sphere);
    EXPECT_NEAR(inflate({BalloonShape::held_tube, R, h, saint_venant}, l)->pressure, tube, 1e-13 * tube);
  }
  for (const BalloonShape shape : {BalloonShape::sphere, BalloonShape::held_tube, BalloonShape::capped_tube}) {
    EXPECT_TRUE(limit_points({shape, R, h, saint_venant}).empty());
  }
}

TEST(Balloon, SaintVenantsStressIsThatOfTheSolversLaw) {
  const solver::material::StVenantKirchhoff law{saint_venant.youngs_modulus, saint_venant.poissons_ratio};
  const InflatedBalloon s = inflate({BalloonShape::held_tube, R, h, saint_venant}, 1.2).value();
  solver::material::Response r;
  const base::Vec3 strain(0.5 * (1.2 * 1.2 - 1), 0, 0);
  law.evaluate(strain, nullptr, nullptr, 0, r);
  const double thickness = law.thickness_stretch(strain, nullptr);
  EXPECT_NEAR(s.thickness_stretch, thickness, 1e-15);
  EXPECT_NEAR(s.hoop, 1.2 * r.stress[0] / thickness, 1e-12 * s.hoop); // F S F^T / det F
  EXPECT_NEAR(s.axial, r.stress[1] / (1.2 * thickness), 1e-12 * s.axial);
  EXPECT_NEAR(s.energy, 2 * std::numbers::pi * R * h * r.energy, 1e-12 * s.energy);
}

TEST(Balloon, ThatShrinksOrHasNoStretchIsRefused) {
  EXPECT_FALSE(inflate({BalloonShape::sphere, R, h, neo_hooke}, 0.99));
  EXPECT_FALSE(inflate({BalloonShape::sphere, R, h, neo_hooke}, std::numeric_limits<double>::quiet_NaN()));
}

} // namespace

} // namespace pneuma::tests
