// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "tests/unit/solver/histories.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const Flow plastic{etfe_hardening(), {}};
const Flow peric{etfe_hardening(), {Overstress::peric, 100, 0.2, {}}};
const Flow perzyna{etfe_hardening(), {Overstress::perzyna, 100, 0.5, {}}};
const Flow creeping{etfe_hardening(), {Overstress::perzyna, 1e4, 0.3, 1.5e6}};
const std::vector<std::pair<const char*, Flow>> flows{
    {"plastic", plastic}, {"peric", peric}, {"perzyna", perzyna}, {"creeping", creeping}};

// Green-Lagrange strain of logarithmic principal strains.
Vec3 of_logarithms(double e1, double e2, double angle) {
  return strain_of(std::exp(e1), std::exp(e2), angle);
}

TEST(Hardening, GoesFromBranchToBranchAndOnWithTheLast) {
  const Hardening h = etfe_hardening();
  const double corner = (27e6 - 16e6) / 160e6;
  EXPECT_EQ(h.stress(0), 16e6);
  EXPECT_NEAR(h.stress(corner), 27e6, 1e-8);
  EXPECT_NEAR(h.stress(corner + 0.1), 27e6 + 80e6 * 0.1, 1e-8);
  EXPECT_EQ(h.branch(std::nextafter(corner, 0))->modulus, 160e6);
  EXPECT_EQ(h.branch(corner)->modulus, 80e6);
  const double mean = 0.5 * (16e6 + 27e6) * corner; // the area under the first branch
  EXPECT_NEAR(h.work(0, corner + 0.1), mean + 0.1 * (27e6 + 4e6), 1e-8);
  EXPECT_NEAR(h.work(0.01, 0.03), 0.03 * (16e6 + 160e6 * 0.025), 1e-9);
  EXPECT_EQ(Hardening().stress(3), std::numeric_limits<double>::infinity());
}

TEST(Hardening, RefusesBranchesThatLeadNowhere) {
  EXPECT_FALSE(piecewise_linear({}));
  const auto refused = [](std::vector<HardeningBranch> b) { return !piecewise_linear(b); };
  EXPECT_TRUE(refused({{0, 1e6}}));
  EXPECT_TRUE(refused({{16e6, 0}, {27e6, 1e6}}));
  EXPECT_TRUE(refused({{16e6, -1e6}, {27e6, 1e6}}));
  EXPECT_TRUE(refused({{16e6, 1e6}, {16e6, 2e6}}));
  EXPECT_TRUE(refused({{16e6, -1e6}}));
  EXPECT_TRUE(refused({{16e6, std::nan("")}, {27e6, 1e6}}));
  EXPECT_FALSE(refused({{16e6, -100e6}, {12e6, 0}})); // softens to a rest
}

TEST(Viscosity, IntegralsOfTheOverstressAreThoseOfTheOverstress) {
  for (const Viscosity& v : {Viscosity{Overstress::peric, 1, 0.2, {}}, Viscosity{Overstress::perzyna, 1, 0.2, {}},
                             Viscosity{Overstress::peric, 1, 1.0, {}}, Viscosity{Overstress::peric, 1, 3.5, {}}}) {
    for (const double z : {1e-9, 1e-3, 0.0999999, 0.1000001, 1.0, 1e6}) {
      // d(z once)/dz = g, d(z^2 twice)/dz = z once: differences of fourth order
      const double h = 1e-3 * z;
      const auto slope = [&](auto f) { return (8 * (f(z + h) - f(z - h)) - (f(z + 2 * h) - f(z - 2 * h))) / (12 * h); };
      const double g = overstress_ratio(v, z).value;
      const auto once = [&](double x) { return x * overstress_integrals(v, x).once; };
      EXPECT_NEAR(slope(once), g, 1e-9 * g + 1e-12) << z;
      EXPECT_NEAR(slope([&](double x) { return x * x * overstress_integrals(v, x).twice; }) / z, once(z) / z,
                  1e-9 * g + 1e-12)
          << z;
      EXPECT_NEAR(inverse_overstress_ratio(v, g), z, 1e-12 * z) << z;
    }
  }
}

// A state of stress on the yield surface to rounding: the equation that the return solves.
TEST(PlaneStressReturn, NeverFailsForAnyStrainStepAndRate) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto power = [&](double from, double to) { return std::pow(10, from + (to - from) * unit(random)); };
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const Elasticity elasticity{1e9, 0.5 * unit(random)};
    const double first = power(5, 8);
    Flow flow;
    flow.hardening = i % 3 == 0   ? hardening({{first, 0}})
                     : i % 3 == 1 ? hardening({{first, power(5, 10)}, {2 * first, power(4, 8)}})
                                  : hardening({{first, -0.4 * elasticity.youngs_modulus}, {0.5 * first, 1e6}});
    flow.viscosity.model = i % 5 == 0 ? Overstress::none : i % 2 == 0 ? Overstress::peric : Overstress::perzyna;
    flow.viscosity.mu = power(-6, 6);
    flow.viscosity.epsilon = power(-2.5, 0.3);
    if (i % 7 == 0) flow.viscosity.threshold = i % 14 == 0 ? 0 : 0.1 * first;
    const double size = power(-5, 0);
    const double sum = elasticity.sum_modulus() * size * (2 * unit(random) - 1) * (i % 11 == 0 ? 1e-12 : 1);
    const double difference = 2 * elasticity.shear_modulus() * size * unit(random);
    const double alpha = i % 4 == 0 ? 0 : power(-6, 0);
    if (flow.threshold_shift() + flow.hardening.stress(alpha) < 0) continue; // softened below the threshold's shift
    const double dt = power(-6, 9);
    const PlasticStep step = plane_stress_return(elasticity, flow, sum, difference * difference, alpha, dt);
    if (!step.flows) {
      const double excess = std::sqrt(0.25 * sum * sum + 0.75 * difference * difference) / flow.onset(alpha) - 1;
      if (flow.viscous()) continue; // it may flow less than there are numbers for
      EXPECT_LT(excess, 1e-14);
      continue;
    }
    ASSERT_TRUE(std::isfinite(step.increment) && step.increment >= 0 && std::isfinite(step.softening)) << i;
    const double equivalent = std::hypot(0.5 * sum * step.sum, std::sqrt(0.75) * difference * step.difference);
    const Flow::Stress y = flow.stress(alpha, step.increment, step.time_ratio);
    // the digits of the increment, too, are rounded
    const double scale = equivalent + std::abs(y.slope) * (step.increment + alpha);
    worst = std::max(worst, std::abs(equivalent - y.value) / scale);
    EXPECT_NEAR(equivalent, y.value, 1e-14 * scale) << i;
  }
  RecordProperty("worst", std::to_string(worst));
}

template <class M>
struct PlasticLaw : testing::Test {};
using Laws = testing::Types<J2, Logarithmic>;
TYPED_TEST_SUITE(PlasticLaw, Laws);

// Walks some random steps of the given size; returns the strain it ends at.
template <Material M>
Vec3 walk(Path<M>& path, std::mt19937& random, double size, int steps) {
  std::uniform_real_distribution<double> d(-size, size);
  std::uniform_real_distribution<double> decade(-2, 4);
  Vec3 strain = Vec3::Zero();
  for (int i = 0; i < steps; ++i) {
    strain = of_logarithms(d(random), d(random), 50 * d(random));
    path.accept(strain, std::pow(10, decade(random)));
  }
  return strain;
}

// Which of its smooth pieces a law is on: -1 elastic, else the hardening branch it ends in.
template <Material M>
int piece(const Path<M>& path, const Vec3& strain, double dt) {
  const double alpha = path.at(strain, dt).history[3];
  const Hardening& h = path.law.flow.hardening;
  return alpha == path.alpha() ? -1 : static_cast<int>(h.branch(alpha) - h.branches->data());
}

template <Material M>
bool smooth_around(const Path<M>& path, const Vec3& strain, double dt, double step) {
  const int here = piece(path, strain, dt);
  for (int k = 0; k < 3; ++k) {
    if (piece(path, strain + 3 * step * Vec3::Unit(k), dt) != here) return false;
    if (piece(path, strain - 3 * step * Vec3::Unit(k), dt) != here) return false;
  }
  return true;
}

TYPED_TEST(PlasticLaw, TangentAndStressAreDerivativesAfterAnyHistory) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> decade(-2, 4);
  double worst_tangent = 0;
  double worst_stress = 0;
  int plastic_points = 0;
  for (const auto& [name, flow] : flows) {
    for (const double size : {0.03, 0.3}) {
      for (int i = 0; i < 60; ++i) {
        Path<TypeParam> path{{etfe_elasticity, flow}};
        walk(path, random, size, i % 4);
        Path<TypeParam> other = path;
        const Vec3 strain = walk(other, random, size, 1);
        const double dt = std::pow(10, decade(random));
        const double step = 1e-5;
        if (!smooth_around(path, strain, dt, 2 * step)) continue;
        plastic_points += piece(path, strain, dt) >= 0 ? 1 : 0;
        const double tangent_error = path.tangent_error(strain, dt, step);
        const double stress_error = path.stress_error(strain, dt, step);
        worst_tangent = std::max(worst_tangent, tangent_error);
        worst_stress = std::max(worst_stress, stress_error);
        EXPECT_LT(tangent_error, 1e-7) << name << " " << size << " " << i;
        EXPECT_LT(stress_error, 1e-7) << name << " " << size << " " << i;
        const Mat3 tangent = path.at(strain, dt).response.tangent;
        EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15);
      }
    }
  }
  EXPECT_GT(plastic_points, 250);
  std::printf("[ measured ] tangent %.1e stress %.1e\n", worst_tangent, worst_stress);
}

} // namespace
} // namespace pneuma::tests
