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

TEST(PlaneStressReturn, NeverFailsForAnyStrainStepAndRate) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto power = [&](double from, double to) { return std::pow(10, from + (to - from) * unit(random)); };
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
    if (!flow.onset_stays_positive()) continue;
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
    // those of the increment and of the yield stress, of which a threshold leaves a part, are rounded too
    const double scale =
        equivalent + std::abs(y.slope) * (step.increment + alpha) + flow.hardening.stress(alpha + step.increment);
    EXPECT_NEAR(equivalent, y.value, 1e-14 * scale) << i;
  }
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
        // measured: 1e-10 and 3e-11
        EXPECT_LT(path.tangent_error(strain, dt, step), 1e-9) << name << " " << size << " " << i;
        EXPECT_LT(path.stress_error(strain, dt, step), 1e-9) << name << " " << size << " " << i;
        const Mat3 tangent = path.at(strain, dt).response.tangent;
        EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-15);
      }
    }
  }
  EXPECT_GT(plastic_points, 250);
}

TYPED_TEST(PlasticLaw, HasItsElasticTangentAtZeroStrainAndNoStress) {
  for (const auto& [name, flow] : flows) {
    const Path<TypeParam> path{{etfe_elasticity, flow}};
    const auto at = path.at(Vec3::Zero(), 1);
    EXPECT_TRUE(at.response.stress.isZero(0) && at.response.energy == 0 && at.response.potential == 0);
    const StVenantKirchhoff elastic{etfe_elasticity.youngs_modulus, etfe_elasticity.poissons_ratio};
    EXPECT_LT(relative_difference(at.response.tangent, elastic.stiffness()), 1e-15);
    EXPECT_LT(path.tangent_error(Vec3::Zero(), 1, 1e-5), 1e-9);
    EXPECT_EQ(path.thickness(Vec3::Zero()), 1);
  }
}

TYPED_TEST(PlasticLaw, EqualStretchesAreNothingSpecial) {
  for (const auto& [name, flow] : flows) {
    for (const bool loaded : {false, true}) {
      Path<TypeParam> path{{etfe_elasticity, flow}};
      if (loaded) path.accept(of_logarithms(0.05, 0.05, 0), 10);
      for (const double stretch : {0.004, 0.052, 0.2}) {
        const Vec3 same = of_logarithms(stretch, stretch, 0);
        const Response equal = path.at(same, 10).response;
        for (const double apart : {1e-160, 1e-100, 1e-15, 1e-12, 1e-8}) {
          for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
            // 1e-160 is less than rounding beside the mean: there as a shear alone
            Vec3 strain = of_logarithms(stretch + apart, stretch, angle);
            if (angle == 0) strain[2] = apart;
            // the law itself is of order 1 over the elastic range
            EXPECT_LT(path.tangent_error(strain, 10, 1e-5), 1e-9) << name << stretch << " " << apart << " " << angle;
            const Response near = path.at(strain, 10).response;
            // where flow begins and where branches meet the tangent jumps, but not here
            EXPECT_LT(relative_difference(near.tangent, equal.tangent), 1e3 * apart + 2e-15);
            EXPECT_LT((near.stress - equal.stress).norm(),
                      1.001 * equal.tangent.norm() * (strain - same).norm() + 1e-16 * etfe_elasticity.youngs_modulus);
          }
        }
      }
    }
  }
}

TYPED_TEST(PlasticLaw, TangentIsRightOnBothSidesOfYieldAndOfACorner) {
  // uniaxial strain to the corner, found by bisection; beside it by 2e-6 of strain, differences of 5e-7
  for (const double wanted : {0.0, (27e6 - 16e6) / 160e6}) {
    Path<TypeParam> path{{etfe_elasticity, plastic}};
    const auto strain = [](double e) { return of_logarithms(e, 0.1 * e, 0.4); };
    double low = 0;
    double high = 0.5;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (path.at(strain(middle)).history[3] > wanted ? high : low) = middle;
    }
    for (const double side : {-2e-6, 2e-6}) {
      ASSERT_TRUE(smooth_around(path, strain(low + side), 0, 5e-7));
      EXPECT_LT(path.tangent_error(strain(low + side), 0, 5e-7), 1e-8) << wanted << " " << side;
    }
    EXPECT_NE(piece(path, strain(low - 2e-6), 0), piece(path, strain(low + 2e-6), 0));
  }
}

TYPED_TEST(PlasticLaw, AnswersTheSameFromItsAcceptedHistoryWithoutTime) {
  std::mt19937 random(11);
  for (const auto& [name, flow] : flows) {
    for (int i = 0; i < 200; ++i) {
      Path<TypeParam> path{{etfe_elasticity, flow}};
      walk(path, random, i % 2 == 0 ? 0.02 : 0.3, 1 + i % 3);
      Path<TypeParam> last = path;
      const Vec3 strain = walk(last, random, 0.1, 1);
      const double dt = 3;
      const Response first = path.accept(strain, dt);
      const auto again = path.at(strain, 0);
      EXPECT_LT((again.response.stress - first.stress).norm(),
                1e-15 * etfe_elasticity.youngs_modulus); // C's own digits
      EXPECT_NEAR(again.response.energy, first.energy, 1e-12 * first.energy + 1e-9);
      EXPECT_NEAR(again.history[3], path.alpha(), 1e-14);
    }
  }
}

TYPED_TEST(PlasticLaw, HasNoStressWhereItSaysSo) {
  std::mt19937 random(13);
  for (int i = 0; i < 200; ++i) {
    Path<TypeParam> path{{etfe_elasticity, plastic}};
    walk(path, random, 0.3, 4);
    const auto at = path.at(path.law.stress_free_strain(path.history.data()));
    EXPECT_LT(at.response.stress.norm(), 1e-15 * etfe_elasticity.youngs_modulus);
    EXPECT_LT(at.response.energy, 1e-20 * etfe_elasticity.youngs_modulus);
    EXPECT_EQ(at.history, path.history);
  }
}

TYPED_TEST(PlasticLaw, DissipationIsNeverNegativeAndMonotonic) {
  std::mt19937 random(17);
  for (const auto& [name, flow] : flows) {
    Path<TypeParam> path{{etfe_elasticity, flow}};
    for (int i = 0; i < 2000; ++i) {
      const double alpha = path.alpha();
      const double dissipated = path.dissipated();
      walk(path, random, 0.15, 1);
      ASSERT_GE(path.dissipated(), dissipated);
      ASSERT_GE(path.alpha(), alpha);
      ASSERT_EQ(path.dissipated() > dissipated, path.alpha() > alpha);
    }
    EXPECT_GT(path.alpha(), 1);
  }
}

TYPED_TEST(PlasticLaw, TurnsWithTheMaterialFrame) {
  const double turn = 0.7;
  const double c = std::cos(turn);
  const double s = std::sin(turn);
  Mat3 strains; // components of a strain in the turned frame
  strains << c * c, s * s, c * s, s * s, c * c, -c * s, -2 * c * s, 2 * c * s, c * c - s * s;
  std::mt19937 random(19);
  std::uniform_real_distribution<double> d(-0.2, 0.2);
  for (const auto& [name, flow] : flows) {
    Path<TypeParam> path{{etfe_elasticity, flow}};
    Path<TypeParam> turned = path;
    for (int i = 0; i < 50; ++i) {
      const Vec3 strain = of_logarithms(d(random), d(random), 10 * d(random));
      const Response a = path.accept(strain, 5);
      const Response b = turned.accept(strains * strain, 5);
      // rounding of fifty steps
      EXPECT_LT((strains.transpose() * b.stress - a.stress).norm(), 1e-12 * a.stress.norm() + 1e-5) << name;
      EXPECT_LT(relative_difference(strains.transpose() * b.tangent * strains, a.tangent), 1e-10);
      EXPECT_NEAR(turned.alpha(), path.alpha(), 1e-13 * path.alpha());
    }
  }
}

TEST(Logarithmic, KeepsTheVolumeOfItsPlasticStrainExactly) {
  // ln J = (1 - 2 nu) / E tr T with tr T = S : C, whatever has flowed; J = 1 with nu = 1/2
  std::mt19937 random(23);
  for (const double nu : {0.0, 0.43, 0.5}) {
    Path<Logarithmic> path{{{1100e6, nu}, plastic}};
    for (int i = 0; i < 500; ++i) {
      const Vec3 strain = walk(path, random, 0.3, 1);
      const Vec3 s = path.at(strain).response.stress;
      const double trace = s[0] * (1 + 2 * strain[0]) + s[1] * (1 + 2 * strain[1]) + 2 * s[2] * strain[2];
      const double area = std::sqrt((1 + 2 * strain[0]) * (1 + 2 * strain[1]) - strain[2] * strain[2]);
      EXPECT_NEAR(std::log(area * path.thickness(strain)), (1 - 2 * nu) / 1100e6 * trace, 1e-14);
    }
    EXPECT_GT(path.alpha(), 5);
  }
}

TEST(J2, ThicknessStrainIsElasticAndPlasticWithoutVolumeOfTheLatter) {
  Path<J2> path{{etfe_elasticity, plastic}};
  const Vec3 strain(0.06, 0.02, 0.01);
  const Vec3 s = path.accept(strain).stress;
  const double nu = etfe_elasticity.poissons_ratio;
  const Vec3 plastic_strain = path.law.stress_free_strain(path.history.data());
  const double elastic = -nu / etfe_elasticity.youngs_modulus * (s[0] + s[1]);
  const double area =
      std::sqrt((1 + 2 * plastic_strain[0]) * (1 + 2 * plastic_strain[1]) - std::pow(plastic_strain[2], 2));
  EXPECT_NEAR(path.thickness(strain), std::sqrt(1 + 2 * elastic) / area, 1e-15);
}

TEST(PlasticLaws, FailRatherThanOverflow) {
  const HardeningBranch branches[] = {{14e6, 120e6}, {32e6, 30e6}};
  const Flow flow{piecewise_linear(branches).value(), {}};
  const Law laws[] = {J2{{417e6, 0.45}, flow}, Logarithmic{{417e6, 0.45}, flow}};
  for (const Law& law : laws) {
    for (const double size : {1e3, 1e100, 1e140, 1e155, 1e200, 1e308, std::numeric_limits<double>::infinity()}) {
      for (const Vec3& direction : {Vec3(1, 0.3, 0.2), Vec3(0.967, 1, -0.033), Vec3(1, 1, 0), Vec3(0.2, 0.1, 0.01)}) {
        const std::array<double, 5> virgin{};
        std::array<double, 5> history{};
        Batch batch;
        batch.count = 1;
        batch.strain[0] = size * direction;
        batch.old_history = virgin.data();
        batch.new_history = history.data();
        if (evaluate(law, batch) >= 0) continue;
        EXPECT_TRUE(batch.response[0].stress.allFinite()) << size;
        EXPECT_TRUE(std::isfinite(history[3])) << size;
      }
    }
  }
}

TEST(PlasticLaws, AgreeAtSmallStrainsToSecondOrder) {
  // the same path of strain, at a half and a quarter of the size with the yield stress in proportion
  std::vector<double> apart;
  for (const double size : {0.02, 0.01, 0.005}) {
    const Flow flow{hardening({{size * 1e9, 200e6}}), {}};
    Path<J2> small{{etfe_elasticity, flow}};
    Path<Logarithmic> large{{etfe_elasticity, flow}};
    double difference = 0;
    for (const Vec3& e : {Vec3(3, 1, 0.5), Vec3(1, 4, 2), Vec3(-2, 1, -3), Vec3(-1, -1, 0)}) {
      const Vec3 a = small.accept(size * e).stress;
      const Vec3 b = large.accept(size * e).stress;
      difference = std::max(difference, (a - b).norm() / 1e9);
    }
    apart.push_back(difference);
  }
  EXPECT_NEAR(apart[0] / apart[1], 4, 0.4);
  EXPECT_NEAR(apart[1] / apart[2], 4, 0.2);
}

TEST(Logarithmic, WithoutAYieldStressIsHenckysElasticity) {
  // T = E / (1 - nu^2) (e1 + nu e2) on a path and back, S = T / c
  Path<Logarithmic> path{{etfe_elasticity, {}}};
  const double nu = etfe_elasticity.poissons_ratio;
  const double modulus = etfe_elasticity.youngs_modulus / (1 - nu * nu);
  for (const auto& [e1, e2] : {std::pair{0.4, -0.1}, {-0.3, 0.7}, {1e-9, -3e-9}}) {
    const Vec3 s = path.accept(of_logarithms(e1, e2, 0)).stress;
    const double size = modulus * std::max(std::abs(e1), std::abs(e2));
    EXPECT_NEAR(s[0], modulus * (e1 + nu * e2) / std::exp(2 * e1), 2e-15 * size + 1e-6);
    EXPECT_NEAR(s[1], modulus * (e2 + nu * e1) / std::exp(2 * e2), 2e-15 * size + 1e-6);
  }
  EXPECT_EQ(path.alpha(), 0);
}

TYPED_TEST(PlasticLaw, NeverFailsWhereTheStrainHasAnArea) {
  std::mt19937 random(29);
  for (const auto& [name, flow] : flows) {
    Path<TypeParam> path{{etfe_elasticity, flow}};
    for (int i = 0; i < 1000; ++i) {
      walk(path, random, 1.0, 1); // `at` checks the status
      ASSERT_TRUE(Eigen::Map<const Eigen::VectorXd>(path.history.data(), 5).allFinite());
    }
  }
  const TypeParam law{etfe_elasticity, plastic};
  std::array<double, 5> history{};
  Response response;
  EXPECT_EQ(law.evaluate(Vec3(std::nan(""), 0, 0), history.data(), history.data(), 0, response), Status::failed);
  EXPECT_EQ(J2(etfe_elasticity, plastic).evaluate(Vec3(1e200, 0, 0), history.data(), history.data(), 0, response),
            Status::failed);
  EXPECT_EQ(
      Logarithmic(etfe_elasticity, plastic).evaluate(Vec3(-0.5, 0, 0), history.data(), history.data(), 0, response),
      Status::failed);
}

} // namespace
} // namespace pneuma::tests
