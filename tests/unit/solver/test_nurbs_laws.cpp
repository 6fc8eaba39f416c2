// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>

#include "solver/material/nurbs_fit.h"
#include "tests/unit/message_of.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const StVenantKirchhoff elastic{900e6, 0.45};
const MooneyRivlin neo_hooke{250e6 / 2.6 / 2, 0};
const MooneyRivlin rubber{25e6, 7e6};
const StrainRange wide{-0.3, 1.5};

NurbsOptions net(int points, int degree = 3, StrainRange range = wide) {
  NurbsOptions options;
  options.net = {points, points};
  options.degree = degree;
  options.range = range;
  return options;
}

const PdNurbs table_of_rubber{fit_pd_nurbs(Law(neo_hooke), net(25)).table};

// Largest difference of stress from a law's at places between those of the fit, over the stress there and `floor`.
double difference(const PdNurbs& table, const auto& law, StrainRange range, double floor) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> logarithmic(std::log1p(2 * range.min), std::log1p(2 * range.max));
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 strain(0.5 * std::expm1(logarithmic(random)), 0.5 * std::expm1(logarithmic(random)), 0);
    const Vec3 expected = answer(law, strain).stress;
    const Vec3 miss = answer(table, strain).stress - expected;
    largest = std::max(largest, miss.norm() / (floor + expected.norm()));
  }
  return largest;
}

Vec3 turned(const Vec3& strain, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * c * strain[0] + s * s * strain[1], s * s * strain[0] + c * c * strain[1],
          2 * c * s * (strain[0] - strain[1])};
}

TEST(PdNurbs, FollowsNeoHookeAndMooneyRivlinBetterWithEveryNet) {
  // thesis: 0.15 % for neo-Hooke with 25 x 25; 5.6, 0.18, 0.07, 0.01 % for Mooney-Rivlin with 20 to 100 squared. Here
  // over strains up to 4, in tension and compression, relative to the stress at the point, of which 1 % of C1 is not
  // asked
  const StrainRange range{-0.35, 4};
  const PdNurbs neo{fit_pd_nurbs(Law(neo_hooke), net(25, 3, range)).table};
  EXPECT_LT(difference(neo, neo_hooke, range, 0.01 * neo_hooke.c1), 1.5e-3);
  const std::pair<int, double> nets[] = {{15, 1.5e-2}, {20, 5e-3}, {40, 5e-4}, {70, 5e-5}};
  for (const auto& [points, bound] : nets) {
    const PdFit fit = fit_pd_nurbs(Law(rubber), net(points, 3, range));
    EXPECT_LT(difference({fit.table}, rubber, range, 0.01 * rubber.c1), bound) << points;
    EXPECT_TRUE(fit.report.monotone);
    EXPECT_EQ(fit.report.uncovered, 0);
    EXPECT_EQ(fit.report.integrability_defect, 0);
  }
}

TEST(PdNurbs, ErrorFallsWithTheOrderOfItsDegree) {
  for (const int degree : {2, 3, 4}) {
    double errors[2] = {};
    for (int k = 0; k < 2; ++k) {
      const PdFit fit = fit_pd_nurbs(Law(neo_hooke), net(degree + (k == 0 ? 20 : 40), degree));
      errors[k] = difference({fit.table}, neo_hooke, wide, 0.1 * neo_hooke.c1);
    }
    EXPECT_GT(std::log2(errors[0] / errors[1]), degree + 0.5) << degree << ": " << errors[0] << " " << errors[1];
  }
}

TEST(PdNurbs, StressIsTheDerivativeOfThePotentialAndTangentOfTheStress) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in(-0.25, 1.4);
  std::uniform_real_distribution<double> angle(0, 3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 strain = turned(Vec3(in(random), in(random), 0), angle(random));
    EXPECT_LT(tangent_error(table_of_rubber, strain, 2e-4), 1e-7) << strain.transpose();
    if (answer(table_of_rubber, strain).stress.norm() < 1e-2 * neo_hooke.c1) continue; // a minimum of the potential
    EXPECT_LT(stress_error(table_of_rubber, strain, 2e-4), 1e-7) << strain.transpose();
    const Mat3 tangent = answer(table_of_rubber, strain).tangent;
    EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-14);
  }
}

TEST(PdNurbs, EqualStrainsZeroStrainAndKnotsAreNothingSpecial) {
  // kinks of the second derivatives (degree 2) and of the third (degree 3) lie on knots: differences with a short step
  const PdNurbs quadratic{fit_pd_nurbs(Law(neo_hooke), net(25, 2)).table};
  for (const auto& [law, bound] : {std::pair<const PdNurbs&, double>(table_of_rubber, 1e-8), {quadratic, 1e-6}}) {
    const std::vector<double> knots = geometry::nurbs::breaks(law.table->potential->u);
    for (const double strain : {0.0, 0.013, knots[4], 0.8}) {
      EXPECT_LT(tangent_error(law, Vec3(strain, strain, 0), 1e-6), 100 * bound) << strain;
      const Response equal = answer(law, Vec3(strain, strain, 0));
      EXPECT_EQ(equal.stress[0], equal.stress[1]);
      for (const double apart : {1e-14, 1e-12, 1e-9, 1e-7, 0.49 * law.table->near, 0.51 * law.table->near, 1e-4}) {
        for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
          const Vec3 near = turned(Vec3(strain + apart, strain - apart, 0), angle);
          const Response at = answer(law, near);
          // the tangent of a stress ~ C^-7 changes by 14 / C of itself; where knots meet it has a kink of its own
          EXPECT_LT(relative_difference(at.tangent, equal.tangent), 50 * apart + bound) << strain << " " << apart;
          const Vec3 linear = equal.stress + equal.tangent * (near - Vec3(strain, strain, 0));
          const double rounding = 1e-14 * (equal.stress.norm() + equal.tangent.norm() * 1e-2);
          EXPECT_LT((at.stress - linear).norm(), equal.tangent.norm() * apart * (50 * apart + bound) + rounding)
              << strain << " " << apart;
        }
      }
    }
    for (const double knot : {knots[2], knots[5], knots[9]}) {
      EXPECT_LT(tangent_error(law, turned(Vec3(knot, 0.2, 0), 0.4), 1e-6), 100 * bound) << knot;
    }
  }
}

TEST(PdNurbs, HasNoStressWithoutStrainAndTurnsWithTheStrain) {
  const Response zero = answer(table_of_rubber, Vec3::Zero());
  EXPECT_LT(zero.stress.norm(), 1e-14 * neo_hooke.c1);
  EXPECT_LT(std::abs(zero.energy), 1e-14 * neo_hooke.c1);
  const Vec3 strain(0.7, -0.1, 0);
  const Response straight = answer(table_of_rubber, strain);
  EXPECT_EQ(answer(table_of_rubber, Vec3(-0.1, 0.7, 0)).stress[1], straight.stress[0]);
  for (const double angle : {0.2, 0.8, 1.9}) {
    const Response at = answer(table_of_rubber, turned(strain, angle));
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const Vec3 expected(c * c * straight.stress[0] + s * s * straight.stress[1],
                        s * s * straight.stress[0] + c * c * straight.stress[1],
                        c * s * (straight.stress[0] - straight.stress[1]));
    EXPECT_LT((at.stress - expected).norm(), 1e-13 * straight.stress.norm());
    EXPECT_NEAR(at.energy / straight.energy, 1, 1e-13);
  }
}

TEST(PdNurbs, ReportsStrainOutsideItsDataOrGoesOnLinearly) {
  Response response;
  const Vec3 beyond(1.7, 0.3, 0);
  EXPECT_TRUE(table_of_rubber.outside(beyond));
  EXPECT_FALSE(table_of_rubber.outside(Vec3(1.5, -0.3, 0)));
  EXPECT_EQ(table_of_rubber.evaluate(beyond, nullptr, nullptr, 0, response), Status::outside_data);
  EXPECT_EQ(table_of_rubber.evaluate(Vec3(-0.6, 0, 0), nullptr, nullptr, 0, response), Status::failed);
  EXPECT_EQ(table_of_rubber.evaluate(Vec3(std::nan(""), 0, 0), nullptr, nullptr, 0, response), Status::failed);
  const Law law = table_of_rubber;
  EXPECT_TRUE(outside_data(law, beyond, nullptr));
  EXPECT_EQ(data_range(law)->max, wide.max);
  Batch batch;
  batch.count = 2;
  batch.strain = {Vec3::Zero(), beyond};
  EXPECT_EQ(evaluate(law, batch), 1);
  EXPECT_EQ(batch.status, Status::outside_data);

  PdNurbs continued = table_of_rubber;
  continued.continued = true;
  EXPECT_TRUE(continued.outside(beyond));
  const Response border = answer(continued, Vec3(1.5, 0.3, 0));
  const Response at = answer(continued, beyond);
  EXPECT_NEAR(at.stress[0], border.stress[0] + 0.2 * border.tangent(0, 0), 1e-12 * border.stress[0]);
  EXPECT_NEAR(at.tangent(0, 0) / border.tangent(0, 0), 1, 1e-12);
  // beyond the border parabolas of large coefficients, whose rounding wants long steps; on it a kink wants short ones
  for (const Vec3& strain : {beyond, Vec3(1.7, 1.7, 1e-9), Vec3(-0.35, 1.6, 0.1), Vec3(2, 1.8, 0.3)}) {
    EXPECT_LT(tangent_error(continued, strain, 1e-3), 1e-6) << strain.transpose();
    EXPECT_LT(stress_error(continued, strain, 1e-3), 1e-6) << strain.transpose();
  }
  EXPECT_LT(tangent_error(continued, Vec3(1.5, 0.3, 0), 1e-5), 1e-6);
  EXPECT_LT(stress_error(continued, Vec3(1.5, 0.3, 0), 1e-4), 1e-7);
}

TEST(PdNurbs, StressesFittedApartSayHowFarTheyAreFromAPotential) {
  NurbsOptions options = net(12);
  options.potential = false;
  const PdFit fit = fit_pd_nurbs(Law(neo_hooke), options);
  EXPECT_GT(fit.report.integrability_defect, 1e-5);
  EXPECT_LT(fit.report.integrability_defect, 5e-2);
  const PdNurbs law{fit.table};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in(-0.25, 1.4);
  for (int i = 0; i < 50; ++i) {
    const Vec3 strain = turned(Vec3(in(random), in(random), 0), 3 * in(random));
    EXPECT_LT(tangent_error(law, strain, 2e-4), 1e-7) << strain.transpose();
  }
  for (const double apart : {0.0, 1e-12, 1e-8, 1e-5}) {
    EXPECT_LT(tangent_error(law, turned(Vec3(0.4 + apart, 0.4, 0), 0.5), 1e-5), 1e-6) << apart;
  }
  EXPECT_LT(answer(law, Vec3::Zero()).stress.norm(), 1e-14 * neo_hooke.c1);
  // a law that is linear is a potential's in any case
  EXPECT_LT(fit_pd_nurbs(Law(elastic), options).report.integrability_defect, 1e-12);
}

TEST(PdNurbs, ThicknessKeepsTheVolumeUnlessToldOtherwise) {
  const Vec3 strain = strain_of(1.2, 1.1, 0.3);
  EXPECT_NEAR(table_of_rubber.thickness_stretch(strain, nullptr), 1 / 1.32, 1e-14);
  PdNurbs other = table_of_rubber;
  other.poissons_ratio = 0.3;
  const double e = 1e-5;
  EXPECT_NEAR(other.thickness_stretch(Vec3(e, e, 0), nullptr), 1 - 0.3 / 0.7 * 2 * e, 10 * e * e);
}

TEST(PdNurbs, UnderATensionFieldWrinklesAsTheLawItWasFittedTo) {
  const TensionField<PdNurbs> table{table_of_rubber};
  const TensionField<MooneyRivlin> law{neo_hooke};
  // the table errs by 1e-3 of the stress and the modulus (6 C1) at most
  const double modulus = 6 * neo_hooke.c1;
  for (const Vec3& strain : {Vec3(0.5, -0.25, 0), Vec3(0.5, -0.45, 0.1), Vec3(0.02, -0.2, 0.03), Vec3(0.4, 0.2, 0.1),
                             Vec3(-0.1, -0.2, 0.05), Vec3(1e-6, -0.4, 0)}) {
    const Response a = answer(table, strain);
    const Response b = answer(law, strain);
    const double largest = strain.cwiseAbs().maxCoeff();
    EXPECT_LT((a.stress - b.stress).norm(), 1e-3 * (b.stress.norm() + 1e-2 * modulus * largest)) << strain.transpose();
    EXPECT_EQ(table.relaxed(strain, nullptr).surface, law.relaxed(strain, nullptr).surface) << strain.transpose();
    EXPECT_LT((a.tangent - b.tangent).norm(), 1e-2 * modulus) << strain.transpose();
  }
  Response response;
  EXPECT_EQ(table.evaluate(Vec3(1.7, 0.3, 0), nullptr, nullptr, 0, response), Status::outside_data);
  EXPECT_TRUE(outside_data(Law(table), Vec3(1.7, 0.3, 0), nullptr));
  // wrinkles deeper than the table: the material itself is strained within it
  EXPECT_FALSE(outside_data(Law(table), Vec3(0.5, -0.45, 0.1), nullptr));
  // a tension field is not part of a table
  const PdNurbs again{fit_pd_nurbs(Law(law), net(25)).table};
  EXPECT_EQ(answer(again, Vec3(0.3, -0.2, 0)).stress, answer(table_of_rubber, Vec3(0.3, -0.2, 0)).stress);
}

// Points of a test: proportional stretching at a ratio E2 / E1.
void add_test(std::vector<StressPoint>& points, const auto& law, double ratio, double last, int count = 20) {
  for (int i = 1; i <= count; ++i) {
    const double e1 = last * i / count;
    const Vec3 s = answer(law, Vec3(e1, ratio * e1, 0)).stress;
    points.push_back({e1, ratio * e1, s[0], s[1], 1});
  }
}

TEST(PdNurbsFit, ContinuesWhatFewTestsLeaveOpenLinearly) {
  // uniaxial stress alone tells both constants of linear elasticity
  std::vector<StressPoint> points;
  add_test(points, elastic, -elastic.poissons_ratio, 0.1);
  NurbsOptions options = net(12);
  options.range.reset();
  const PdFit one = fit_pd_nurbs(points, options);
  EXPECT_GT(one.report.uncovered, 0.5);
  EXPECT_LT(one.report.max, 1e-6 * one.report.largest_stress);
  EXPECT_NEAR(one.table->domain.range.max, 0.1, 1e-15);
  PdNurbs law{one.table};
  law.continued = true;
  for (const Vec3& strain : {Vec3(0.02, 0.01, 0.03), Vec3(0.1, 0.1, 0), Vec3(-0.03, 0.05, 0.01)}) {
    EXPECT_LT((answer(law, strain).stress - answer(elastic, strain).stress).norm(), 1e-6 * 9e8 * 0.1);
  }
  // the data end at the hull of the tests and of a small square
  law.continued = false;
  EXPECT_FALSE(law.outside(Vec3(0.004, -0.004, 0)));
  EXPECT_FALSE(law.outside(Vec3(0.0999, -0.0999 * elastic.poissons_ratio, 0)));
  EXPECT_TRUE(law.outside(Vec3(0.09, 0.09, 0)));
  add_test(points, elastic, 1, 0.1);
  law.table = fit_pd_nurbs(points, options).table;
  EXPECT_FALSE(law.outside(Vec3(0.09, 0.09, 0)));
}

TEST(PdNurbsFit, RefusesPointsThatLeaveTheLawOpen) {
  std::vector<StressPoint> points;
  add_test(points, elastic, 1, 0.1);
  NurbsOptions options = net(12);
  options.range.reset();
  EXPECT_THAT(message_of([&] { fit_pd_nurbs(points, options); }), testing::HasSubstr("do not determine"));
  EXPECT_THAT(message_of([&] { fit_pd_nurbs(std::vector<StressPoint>{}, options); }), testing::HasSubstr("points"));
  add_test(points, elastic, 0.5, 0.1);
  EXPECT_NO_THROW(fit_pd_nurbs(points, options));
  for (StressPoint& p : points) p.s2 = std::nan(""); // not measured
  EXPECT_NO_THROW(fit_pd_nurbs(points, options));
  points[3].e1 = std::nan("");
  EXPECT_THAT(message_of([&] { fit_pd_nurbs(points, options); }), testing::HasSubstr("point 4"));
  points[3].e1 = 0.2;
  options.range = StrainRange{-0.1, 0.15};
  EXPECT_THAT(message_of([&] { fit_pd_nurbs(points, options); }), testing::HasSubstr("outside the range"));
}

TEST(PdNurbsFit, RefusesOptionsWithoutSense) {
  const auto with = [](const std::function<void(NurbsOptions&)>& change) {
    NurbsOptions options = net(12);
    change(options);
    return message_of([&] { fit_pd_nurbs(Law(neo_hooke), options); });
  };
  EXPECT_THAT(with([](NurbsOptions& o) { o.net = {12, 13}; }), testing::HasSubstr("12 x 13"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.net = {3, 3}; }), testing::HasSubstr("4 to 200"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.degree = 1; }), testing::HasSubstr("degree"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.range = StrainRange{-0.5, 1}; }), testing::HasSubstr("range"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.range = StrainRange{0.1, 1}; }), testing::HasSubstr("range"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.range.reset(); }), testing::HasSubstr("range"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.smoothing = -1; }), testing::HasSubstr("smoothing"));
  EXPECT_THAT(with([](NurbsOptions& o) { o.knee = 0; }), testing::HasSubstr("knee"));
}

TEST(PdNurbsFit, PointsCountAndTheLawFillsWhatTheyLeaveOpen) {
  // tests on a stiffer material along two paths, the law elsewhere
  const MooneyRivlin stiffer{1.1 * neo_hooke.c1, 0};
  std::vector<StressPoint> points;
  for (const double ratio : {1.0, 0.4}) add_test(points, stiffer, ratio, 1.2, 60);
  const PdFit fit = fit_pd_nurbs(Law(neo_hooke), net(25), 0, points);
  const PdNurbs law{fit.table};
  for (const Vec3& strain : {Vec3(0.8, 0.8, 0), Vec3(0.6, 0.24, 0), Vec3(1.1, 0.44, 0)}) {
    const Vec3 expected = answer(stiffer, strain).stress;
    EXPECT_LT((answer(law, strain).stress - expected).norm(), 0.01 * expected.norm()) << strain.transpose();
  }
  const Vec3 far(0.9, -0.25, 0);
  const Vec3 filled = answer(neo_hooke, far).stress;
  // one potential: the tests stiffen what lies beside them, too, at most as much
  EXPECT_LT((answer(law, far).stress - filled).norm(), 0.1 * filled.norm());
  EXPECT_LT(fit.report.max, 0.02 * fit.report.largest_stress); // of the points alone
  EXPECT_GT(fit.report.max_from_fill, 0.05 * fit.report.largest_stress);
}

TEST(PdNurbsFit, SeesStressThatFalls) {
  std::vector<StressPoint> points;
  for (const double ratio : {1.0, 0.3, -0.4}) {
    add_test(points, elastic, ratio, 0.1, 30);
    for (StressPoint& p : points) p.s1 = std::min(p.s1, 60e6 - 400e6 * p.e1);
  }
  NurbsOptions options = net(14);
  options.range.reset();
  const PdFit fit = fit_pd_nurbs(points, options);
  EXPECT_FALSE(fit.report.monotone);
  EXPECT_GT(fit.report.not_monotone.maxCoeff(), 0.02);
}

Flow hardening(std::vector<HardeningBranch> branches) {
  Flow flow;
  flow.hardening = *piecewise_linear(branches);
  return flow;
}

// A plastic law's answer to monotonic strain in one step.
Response loaded(const auto& law, const Vec3& strain, double& plastic) {
  std::array<double, 5> old_history{};
  std::array<double, 5> new_history{};
  Response response;
  EXPECT_EQ(law.evaluate(strain, old_history.data(), new_history.data(), 0, response), Status::ok);
  plastic = new_history[3];
  return response;
}

// the steel of the thesis' perforated strip
const J2 steel{{70e9, 0.2}, hardening({{0.243e9, 0.2e9}})};
const Logarithmic etfe{{1100e6, 0.43}, hardening({{16e6, 160e6}, {27e6, 80e6}})};

// The largest error of a table's stress relative to the law's stress, at strains of all sizes in its range.
double largest_error(const PdNurbs& table, const auto& law) {
  const StrainRange range = table.table->domain.range;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double error = 0;
  for (int i = 0; i < 5000; ++i) {
    const double size = std::pow(range.max / 1e-3, unit(random)) * 1e-3 / range.max;
    const auto strain = [&] { return size * (range.min + unit(random) * (range.max - range.min)); };
    const Vec3 at(strain(), strain(), 0);
    double plastic = 0;
    const Vec3 expected = loaded(law, at, plastic).stress;
    error = std::max(error, (answer(table, at).stress - expected).norm() / expected.norm());
  }
  return error;
}

TEST(PdNurbsFit, FollowsMonotonicPlasticityBesideTheCornerOfYieldToo) {
  // with the thesis' net, 70 x 70 of degree 2, of which it prints 0.04 % of the strip's stress
  const PdFit fit = fit_pd_nurbs(Law(steel), net(70, 2, {-0.05, 0.1}));
  EXPECT_LT(largest_error(PdNurbs{fit.table}, steel), 1e-5);
  EXPECT_TRUE(fit.report.monotone);
  EXPECT_LT(fit.report.max, 1e-5 * fit.report.largest_stress);
  EXPECT_EQ(fit.report.uncovered, 0);
  // at the second branch of ETFE the modulus halves along a curve that no knots follow: half of 80 MPa times a span
  const PdFit of_etfe = fit_pd_nurbs(Law(etfe), net(70, 2, {-0.15, 0.4}));
  EXPECT_LT(largest_error(PdNurbs{of_etfe.table}, etfe), 2e-3);
  EXPECT_TRUE(of_etfe.report.monotone);
}

TEST(PdNurbsFit, DoesNotBlameATableForALevelLaw) {
  const Elasticity elasticity{900e6, 0.45};
  const Flow level = hardening({{15e6, 0}});
  EXPECT_TRUE(fit_pd_nurbs(Law(Logarithmic{elasticity, level}), net(25, 3, {-0.1, 0.2})).report.monotone);
  EXPECT_TRUE(fit_pd_nurbs(Law(J2{elasticity, level}), net(25, 3, {-0.1, 0.2})).report.monotone);
  const Flow falling = hardening({{15e6, -100e6}, {10e6, 0}});
  EXPECT_FALSE(fit_pd_nurbs(Law(Logarithmic{elasticity, falling}), net(25, 3, {-0.1, 0.2})).report.monotone);
}

TEST(PdNurbsFit, ConvergesBeyondYieldWithTheOrderOfItsDegree) {
  for (const int degree : {2, 3}) {
    double errors[2] = {};
    for (const int k : {0, 1}) {
      const PdFit fit = fit_pd_nurbs(Law(steel), net(degree + (k == 0 ? 24 : 48), degree, {-0.05, 0.1}));
      errors[k] = largest_error(PdNurbs{fit.table}, steel);
    }
    EXPECT_GT(std::log2(errors[0] / errors[1]), degree + 0.8) << degree;
  }
}

TEST(PdNurbsFit, ReportsItsErrorInAllOfTheRangeForEveryNet) {
  const auto reports = [](const auto& law, const NurbsOptions& options) {
    const PdFit fit = fit_pd_nurbs(Law(law), options);
    const PdNurbs table{fit.table};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
      const StrainRange range = *options.range;
      const auto strain = [&] { return range.min + std::round(30 * unit(random)) / 30 * (range.max - range.min); };
      const Vec3 at(strain(), strain(), 0);
      std::array<double, 10> history{};
      Response expected;
      EXPECT_EQ(law.evaluate(at, history.data(), history.data() + 5, 0, expected), Status::ok);
      largest = std::max(largest, (answer(table, at).stress - expected.stress).cwiseAbs().maxCoeff());
    }
    // what rounding leaves, and less than twice between the places that the report looks at
    EXPECT_LT(largest, 2 * fit.report.max + 1e-12 * fit.report.largest_stress)
        << options.net[0] << ' ' << options.degree;
    EXPECT_GT(fit.report.largest_stress, 0);
    return fit.report.max / fit.report.largest_stress;
  };
  const double yield = 16e6 * (1 - 0.43) / 1100e6; // equal strains at which ETFE yields
  for (const StrainRange range : {StrainRange{-0.1, 0.2}, {0, 1.02 * yield}}) {
    for (const auto& [size, degree] : {std::pair(4, 3), {5, 3}, {7, 6}, {25, 3}}) {
      EXPECT_LT(reports(etfe, net(size, degree, range)), 0.02) << size; // of one span in each direction, too
    }
  }
  reports(MooneyRivlin{1e6, 0}, net(7, 6, {-0.3, 1}));
  reports(MooneyRivlin{1e6, 0}, net(5, 3, {-0.3, 1}));
}

TEST(PdNurbs, OfALawThatYieldsIsTheLawUntilThen) {
  const PdNurbs table{fit_pd_nurbs(Law(etfe), net(12, 2, {-0.05, 0.1})).table};
  for (const Vec3& strain : {Vec3(0.01, 0.002, 0.003), Vec3(-0.006, 0.004, 0), Vec3(0.007, 0.007, 0), Vec3(0, 0, 0)}) {
    double plastic = 0;
    const Response law = loaded(etfe, strain, plastic);
    ASSERT_EQ(plastic, 0);
    const Response at = answer(table, strain);
    EXPECT_LT((at.stress - law.stress).norm(), 1e-14 * 1100e6) << strain.transpose();
    EXPECT_LT(relative_difference(at.tangent, law.tangent), 1e-13) << strain.transpose();
    EXPECT_NEAR(at.energy, law.energy, 1e-14 * 1100e6);
  }
}

TEST(PdNurbs, OfALawThatYieldsHasItsDerivatives) {
  const PdNurbs of_steel{fit_pd_nurbs(Law(steel), net(20, 3, {-0.05, 0.1})).table, true};
  const PdNurbs of_etfe{fit_pd_nurbs(Law(etfe), net(20, 3, {-0.15, 0.4})).table, true};
  for (const PdNurbs& law : {of_steel, of_etfe}) {
    const double size = law.table->domain.range.max;
    // inside, beside the curve of yield, far beyond, past the table's end; equal strains; a pull and a push
    for (const double part : {1e-3, 0.029, 0.05, 0.3, 0.9, 1.7}) {
      for (const Vec3& direction : {Vec3(1, 0.2, 0.3), Vec3(1, 1, 0), Vec3(1, 1, 1e-9), Vec3(1, -0.3, 0),
                                    Vec3(0.1, -0.35, 0.2), Vec3(-0.2, -0.2, 0)}) {
        const Vec3 strain = part * size * direction;
        const double step = 1e-4 * strain.norm();
        EXPECT_LT(tangent_error(law, strain, step), 1e-6) << strain.transpose();
        EXPECT_LT(stress_error(law, strain, step), 1e-6) << strain.transpose();
        const Mat3 tangent = answer(law, strain).tangent;
        EXPECT_LT(relative_difference(tangent.transpose(), tangent), 1e-13);
      }
    }
    for (const double apart : {1e-14, 1e-12, 1e-9, 1e-7}) {
      const Vec3 strain(0.3 * size, 0.3 * size, 0);
      const Response equal = answer(law, strain);
      const Response at = answer(law, turned(strain + Vec3(apart, -apart, 0), 0.4));
      EXPECT_LT(relative_difference(at.tangent, equal.tangent), 1e3 * apart + 1e-13) << apart;
    }
  }
}

TEST(PdNurbs, OfALawThatYieldsGoesOnLinearlyPastItsEnd) {
  const PdNurbs law{fit_pd_nurbs(Law(steel), net(20, 3, {-0.05, 0.1})).table, true};
  // along a ray past the largest r of the table
  const double far = law.table->yield->beyond.u.last();
  const Vec3 unit = Vec3(1, 1, 0) / (2 * law.table->yield->of_sum()); // r = 1
  const Response border = answer(law, far * unit);
  const Response at = answer(law, 1.5 * far * unit);
  const double expected = border.stress[0] + 0.5 * far * unit.dot(border.tangent.row(0));
  EXPECT_NEAR(at.stress[0] / expected, 1, 1e-12);
}

TEST(PdNurbsFit, SmoothsPointsUntilTheirStressRises) {
  // ETFE in strains of which the second is 1, 0.2 and -0.35 of the first
  std::vector<StressPoint> points;
  for (const double ratio : {1.0, 0.2, -0.35}) {
    for (int i = 1; i <= 40; ++i) {
      const double e1 = 0.15 * i / 40;
      double plastic = 0;
      const Vec3 stress = loaded(etfe, Vec3(e1, ratio * e1, 0), plastic).stress;
      points.push_back({e1, ratio * e1, stress[0], stress[1], 1});
    }
  }
  NurbsOptions options; // all of them left open
  const PdFit chosen = fit_pd_nurbs(points, options);
  EXPECT_TRUE(chosen.report.monotone);
  EXPECT_GT(chosen.report.smoothing, 1e-7);
  EXPECT_LT(chosen.report.max, 0.03 * chosen.report.largest_stress); // at yield, which a smooth surface rounds off
  EXPECT_LT(chosen.report.rms, 0.01 * chosen.report.largest_stress);
  options.smoothing = 1e-7; // as told
  const PdFit told = fit_pd_nurbs(points, options);
  EXPECT_EQ(told.report.smoothing, 1e-7);
  EXPECT_FALSE(told.report.monotone);
  EXPECT_LT(told.report.max, chosen.report.max);
}

TEST(PdNurbsFit, FillsBiaxialTestsOfEtfeWithItsLaw) {
  // tests along 1:1 and two other paths, 3 % above the law that fills; net 40 x 40
  std::vector<StressPoint> points;
  for (const double ratio : {1.0, 0.2, -0.35}) {
    for (int i = 1; i <= 60; ++i) {
      const double e1 = 0.25 * i / 60;
      double plastic = 0;
      const Vec3 stress = 1.03 * loaded(etfe, Vec3(e1, ratio * e1, 0), plastic).stress;
      points.push_back({e1, ratio * e1, stress[0], stress[1], 1});
    }
  }
  const PdFit fit = fit_pd_nurbs(Law(etfe), net(40, 3, {-0.12, 0.26}), 0, points);
  EXPECT_LT(fit.report.rms, 0.003 * fit.report.largest_stress);
  EXPECT_LT(fit.report.max, 0.02 * fit.report.largest_stress);
  EXPECT_LT(fit.report.max_from_fill, 0.1 * fit.report.largest_stress);
  EXPECT_EQ(fit.report.uncovered, 0);
  const PdNurbs law{fit.table};
  for (const Vec3& strain : {Vec3(0.2, 0.12, 0), Vec3(0.1, 0.06, 0), Vec3(0.2, 0, 0), Vec3(0.05, 0.03, 0)}) {
    double plastic = 0;
    const Vec3 expected = loaded(etfe, strain, plastic).stress;
    EXPECT_LT((answer(law, strain).stress - expected).norm(), 0.05 * expected.norm()) << strain.transpose();
  }
}

TEST(LeNurbs, IsLinearElasticityExactly) {
  NurbsOptions options = net(10, 3, {-0.05, 0.3});
  options.net = {10, 14};
  const LeFit fit = fit_le_nurbs(Law(elastic), options);
  EXPECT_LT(fit.report.max, 1e-10 * fit.report.largest_stress);
  EXPECT_LT(fit.shear_report.max, 1e-10 * fit.shear_report.largest_stress);
  const LeNurbs law{fit.table};
  for (const Vec3& strain : {Vec3(0.02, 0.01, 0.03), Vec3(0.3, -0.05, 0.35), Vec3(-0.03, 0.25, -0.2), Vec3(0, 0, 0)}) {
    const Response a = answer(law, strain);
    const Response b = answer(elastic, strain);
    EXPECT_LT((a.stress - b.stress).norm(), 1e-10 * 9e8) << strain.transpose();
    EXPECT_LT((a.tangent - b.tangent).norm(), 1e-8 * 9e8) << strain.transpose();
    EXPECT_NEAR(a.energy, b.energy, 1e-10 * 9e8);
  }
}

TEST(LeNurbs, HasItsDerivativesAndItsOwnAxes) {
  for (const bool potential : {true, false}) {
    NurbsOptions options = net(20);
    options.potential = potential;
    const LeFit fit = fit_le_nurbs(Law(neo_hooke), options);
    LeNurbs law{fit.table};
    law.continued = true;
    for (const Vec3& strain : {Vec3(0.3, 0.1, 0.2), Vec3(1.2, -0.2, -0.4), Vec3(0, 0, 0), Vec3(1.8, 0.2, 0.1)}) {
      EXPECT_LT(tangent_error(law, strain, 1e-4), 1e-7) << strain.transpose();
      if (!potential || strain.norm() == 0) continue;
      EXPECT_LT(stress_error(law, strain, 1e-4), 1e-7) << strain.transpose();
    }
    EXPECT_LT(answer(law, Vec3::Zero()).stress.norm(), 1e-13 * neo_hooke.c1);
    // along its axes and in pure shear the law it was fitted to
    for (const Vec3& strain : {Vec3(0.8, 0.3, 0), Vec3(0, 0, 0.5)}) {
      const Vec3 expected = answer(neo_hooke, strain).stress;
      const Vec3 found = answer(law, strain).stress;
      const double miss = strain[2] == 0 ? (found - expected).norm() : std::abs(found[2] - expected[2]);
      EXPECT_LT(miss, 1e-3 * expected.norm()) << strain.transpose();
    }
    const double shear = answer(law, Vec3(0.3, 0.1, 0.5)).stress[2];
    EXPECT_NEAR(answer(law, Vec3(0.3, 0.1, -0.5)).stress[2], -shear, 1e-13 * shear);
    EXPECT_EQ(fit.report.integrability_defect == 0, potential);
    // not across them: PD-NURBS is not fitted to it
    EXPECT_THAT(message_of([&] { fit_pd_nurbs(Law(law), net(12)); }), testing::HasSubstr("use le_nurbs"));
  }
}

TEST(LeNurbs, ReportsStrainOutsideItsData) {
  const LeNurbs law{fit_le_nurbs(Law(neo_hooke), net(12)).table};
  Response response;
  EXPECT_EQ(law.evaluate(Vec3(1.6, 0, 0), nullptr, nullptr, 0, response), Status::outside_data);
  EXPECT_EQ(law.evaluate(Vec3(1.4, 1.4, 1.9), nullptr, nullptr, 0, response), Status::outside_data);
  EXPECT_EQ(law.evaluate(Vec3(0, 0, 1.1), nullptr, nullptr, 0, response), Status::failed);
  EXPECT_TRUE(law.outside(Vec3(0, 0, 1.9)));
  EXPECT_FALSE(law.outside(Vec3(1.5, -0.3, 0.9))); // neo-Hooke has no shear above 1 without stretch
}

} // namespace
} // namespace pneuma::tests
