// SPDX-License-Identifier: GPL-3.0-or-later
// The assembled equations of small cushions, and one Newton step of the bordered system against dense algebra.
#include <cmath>
#include <numeric>

#include <Eigen/LU>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/volume.h"
#include "solver/material/nurbs_fit.h"
#include "tests/unit/finite_differences.h"
#include "tests/unit/solver/cushions.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::MatX;
using base::Vec3;
using base::VecX;
using tests::Cushion;
using tests::finite_difference_jacobian;
using tests::model_of;
using tests::relative_difference;
using tests::start_of;

using geometry::ElementType;

class SystemOfEveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(System, SystemOfEveryElement, tests::every_element, tests::element_name);

Cushion small(ElementType element) {
  Cushion c;
  c.element = element;
  c.divisions = geometry::is_quadratic(element) ? std::array{2, 2} : std::array{4, 3};
  c.prestress = 900;
  return c;
}

VecX free_coordinates(const assembly::FoilEquations& foil, const std::vector<Vec3>& positions) {
  VecX x(static_cast<Eigen::Index>(foil.coordinate.size()));
  for (Eigen::Index u = 0; u < x.size(); ++u) {
    const Index k = foil.coordinate[static_cast<std::size_t>(u)];
    x[u] = positions[static_cast<std::size_t>(k / 3)][k % 3];
  }
  return x;
}

void set_free(const assembly::FoilEquations& foil, const VecX& x, std::vector<Vec3>& positions) {
  for (Eigen::Index u = 0; u < x.size(); ++u) {
    const Index k = foil.coordinate[static_cast<std::size_t>(u)];
    positions[static_cast<std::size_t>(k / 3)][k % 3] = x[u];
  }
}

MatX dense(const linear::SymmetricPattern& pattern, const std::vector<double>& values) {
  MatX a(pattern.size, pattern.size);
  for (Index j = 0; j < pattern.size; ++j) a.col(j) = linear::multiply(pattern, values, VecX::Unit(pattern.size, j));
  return a;
}

// d residual / d x of one foil by differences
MatX differences(assembly::System& system, const assembly::Configuration& at, std::size_t foil) {
  const VecX x = free_coordinates(system.foils()[foil], at.positions);
  return finite_difference_jacobian(
      [&](const VecX& y) {
        assembly::Configuration there = at;
        set_free(system.foils()[foil], y, there.positions);
        system.evaluate(there, false);
        return VecX(system.foils()[foil].residual);
      },
      x, 1e-4);
}

TEST_P(SystemOfEveryElement, TangentIsTheDerivativeOfTheResidualAndTheLoadStiffnessOfAClampedFoilIsSymmetric) {
  assembly::Model model = model_of(small(GetParam()), 700);
  model.face_pressure = {{-300, -300}, {50, 50}};
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model, 1);
  tests::shake(model, at.positions, 0.03);
  system.evaluate(at, true);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_DOUBLE_EQ(system.foils()[f].pressure, f == 0 ? 700.0 - 300 : -700.0 + 50);
    const MatX tangent = dense(system.foils()[f].pattern, system.foils()[f].tangent);
    const MatX load = system.dense_load_stiffness(static_cast<Index>(f), at);
    EXPECT_LT(relative_difference(load.transpose(), load), 1e-13);
    EXPECT_LT(relative_difference(differences(system, at, f), tangent), 1e-8);
    system.evaluate(at, true);
  }
}

TEST_P(SystemOfEveryElement, LoadStiffnessAloneIsTheDerivativeOfThePressureForceWithItsSign) {
  // beside E h of a foil a load stiffness of 1 kPa hides in the eighth digit: the force of a unit pressure shows it
  const assembly::Model model = model_of(small(GetParam()), 1);
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model, 1);
  tests::shake(model, at.positions, 0.03);
  system.evaluate(at, false);
  const VecX x = free_coordinates(system.foils()[0], at.positions);
  const MatX derivative = finite_difference_jacobian(
      [&](const VecX& y) {
        assembly::Configuration there = at;
        set_free(system.foils()[0], y, there.positions);
        system.evaluate(there, false);
        return VecX(system.foils()[0].pressure_gradient);
      },
      x, 1e-3);
  const MatX load = system.dense_load_stiffness(0, at);
  EXPECT_LT(relative_difference(derivative, load), 1e-10);
  // and it stands in the tangent with the minus sign: the difference of two pressures, -1 x load
  system.evaluate(at, true);
  const MatX with_one = dense(system.foils()[0].pattern, system.foils()[0].tangent);
  assembly::Model more = model;
  more.chambers[0].gas = chamber::Regulated{1e6 + 1, 1e6 + 1};
  assembly::System loaded(more, 1);
  loaded.evaluate(at, true);
  const MatX with_more = dense(loaded.foils()[0].pattern, loaded.foils()[0].tangent);
  EXPECT_LT(relative_difference((with_one - with_more) / 1e6, load), 1e-9);
}

TEST_P(SystemOfEveryElement, ChamberVolumeIsTheIntegralOfThePressureForceAndKnowsNoOrigin) {
  Cushion cushion = small(GetParam());
  const assembly::Model here = model_of(cushion, 0);
  cushion.place = Vec3(300, -200, 100);
  assembly::Model there = model_of(cushion, 0);
  there.chambers[0].dead_volume = 0.25;
  assembly::System a(here, 1);
  assembly::System b(there, 1);
  assembly::Configuration at = start_of(here, 1);
  tests::shake(here, at.positions, 0.03);
  assembly::Configuration moved = at;
  for (Vec3& x : moved.positions) x += cushion.place;
  a.evaluate(at, false);
  b.evaluate(moved, false);
  EXPECT_NEAR(b.chamber_volume(0) - 0.25, a.chamber_volume(0), 1e-12 * a.chamber_volume(0));
  // dV/du of both foils
  for (std::size_t f = 0; f < 2; ++f) {
    const VecX x = free_coordinates(a.foils()[f], at.positions);
    const MatX slope = finite_difference_jacobian(
        [&](const VecX& y) {
          assembly::Configuration c = at;
          set_free(a.foils()[f], y, c.positions);
          a.evaluate(c, false);
          return VecX(VecX::Constant(1, a.chamber_volume(0)));
        },
        x, 1e-3);
    a.evaluate(at, false);
    const double sign = f == 0 ? 1 : -1; // the lower foil's normal points into the chamber
    EXPECT_LT(relative_difference(sign * slope.transpose(), a.foils()[f].pressure_gradient), 1e-10);
  }
}

// a zone over half a foil: the elements whose centre lies at positive x, so that the pressure jumps inside the foil
assembly::PressureZone half_zone(const assembly::Model& model, double pressure) {
  assembly::PressureZone zone;
  zone.block = 0;
  zone.pressure = {pressure, pressure};
  zone.offset = {0};
  const geometry::Block& block = model.mesh.blocks[0];
  for (Index e = 0; e < model.mesh.element_count(block); ++e) {
    Vec3 centre = Vec3::Zero();
    for (const Index node : model.mesh.element_nodes(block, e))
      centre += model.mesh.nodes[static_cast<std::size_t>(node)];
    if (centre.x() > 0) {
      for (const geometry::QuadraturePoint& q : geometry::pressure_rule(model.mesh.element)) zone.points.push_back(q);
    }
    zone.offset.push_back(static_cast<Index>(zone.points.size()));
  }
  return zone;
}

TEST_P(SystemOfEveryElement, PressureZoneHasTheSymmetricPartOfItsDerivativeInTheTangent) {
  assembly::Model model = model_of(small(GetParam()), 0);
  model.zones.push_back(half_zone(model, 4e5)); // large enough to stand out beside E h
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model, 1);
  tests::shake(model, at.positions, 0.03);
  system.evaluate(at, true);
  const MatX tangent = dense(system.foils()[0].pattern, system.foils()[0].tangent);
  const MatX whole = differences(system, at, 0);
  EXPECT_LT(relative_difference(MatX(0.5 * (whole + whole.transpose())), tangent), 1e-8);
  // the skew part lives on the border of the zone alone (numerics 2)
  const MatX skew = 0.5 * (whole - whole.transpose());
  EXPECT_GT(skew.cwiseAbs().maxCoeff(), 1e-3 * 4e5 * 0.1);
  const assembly::FoilEquations& foil = system.foils()[0];
  for (Eigen::Index i = 0; i < skew.rows(); ++i) {
    const auto node = static_cast<std::size_t>(foil.coordinate[static_cast<std::size_t>(i)] / 3);
    if (std::abs(model.mesh.nodes[node].x()) > 1e-9) {
      EXPECT_LT(skew.row(i).cwiseAbs().maxCoeff(), 1e-8 * whole.cwiseAbs().maxCoeff());
    }
  }
}

TEST_P(SystemOfEveryElement, ZoneOverAWholeFoilIsAFacePressure) {
  assembly::Model by_zone = model_of(small(GetParam()), 300);
  by_zone.zones.push_back(half_zone(by_zone, 250));
  assembly::PressureZone& zone = by_zone.zones[0];
  zone.points.clear();
  zone.offset = {0};
  for (Index e = 0; e < by_zone.mesh.element_count(by_zone.mesh.blocks[0]); ++e) {
    for (const geometry::QuadraturePoint& q : geometry::pressure_rule(by_zone.mesh.element)) zone.points.push_back(q);
    zone.offset.push_back(static_cast<Index>(zone.points.size()));
  }
  assembly::Model by_face = model_of(small(GetParam()), 300);
  by_face.face_pressure = {{250, 250}, {0, 0}};
  assembly::System a(by_zone, 1);
  assembly::System b(by_face, 1);
  assembly::Configuration at = start_of(by_zone, 1);
  a.evaluate(at, true);
  b.evaluate(at, true);
  EXPECT_LT(relative_difference(a.foils()[0].external, b.foils()[0].external), 1e-14);
  EXPECT_LT(relative_difference(dense(a.foils()[0].pattern, a.foils()[0].tangent),
                                dense(b.foils()[0].pattern, b.foils()[0].tangent)),
            1e-14);
}

TEST_P(SystemOfEveryElement, SupportForcesAndAllLoadsSumToZeroAndWeightIsDensityTimesVolume) {
  Cushion cushion = small(GetParam());
  cushion.thickness = {300e-6, 50e-6};
  cushion.prestress = 0;
  assembly::Model model = model_of(cushion, 400);
  constexpr double density = 1750;
  const Vec3 gravity(0, 0.5, -9.81);
  model.dead_to = VecX::Zero(static_cast<Eigen::Index>(3 * model.mesh.nodes.size()));
  double area = 0; // of one foil; both are equal
  for (std::size_t f = 0; f < 2; ++f) {
    const assembly::Foil& foil = *model.foils[f];
    const element::Membrane membrane{model.mesh.blocks[f].connectivity, foil.reference, foil.law, foil.thickness};
    element::add_weight(membrane, density, gravity,
                        {model.dead_to.data(), static_cast<std::size_t>(model.dead_to.size())});
    if (f == 0) area = std::accumulate(foil.reference.area.begin(), foil.reference.area.end(), 0.0);
  }
  Vec3 weight = Vec3::Zero();
  for (Eigen::Index i = 0; i < model.dead_to.size() / 3; ++i) weight += model.dead_to.segment<3>(3 * i);
  EXPECT_LT((weight - density * 350e-6 * area * gravity).norm(), 1e-12 * weight.norm());

  model.face_pressure = {{0, -150}, {0, 0}};
  model.zones.push_back(half_zone(model, -220));
  tests::Solved solved(model);
  ASSERT_TRUE(solved.converged()) << solved.path.reason;
  const VecX supports = solved.system.support_forces();
  Vec3 sum = weight; // external of the foils holds the dead load of free nodes: add that of the held ones, once
  double largest = 0;
  for (std::size_t k = 0; k < model.fixed.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    double load = supports[i];
    for (const assembly::FoilEquations& foil : solved.system.foils()) load += foil.external[i];
    if (model.fixed[k] == 0) load -= model.dead_to[i];
    sum[i % 3] += load;
    largest = std::max(largest, std::abs(supports[i]));
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(sum.norm(), 1e-7 * 400 * 2); // 1e-7 of pressure x plan area; the residual's tolerance is 1e-9 in norm
}

TEST(System, RefusesToMoveWhatIsFreeOrABase) {
  Cushion cushion = small(ElementType::Q4);
  cushion.heights = {0.12};
  cushion.base = true;
  assembly::Model model = model_of(cushion, 0);
  const Index base = model.mesh.blocks[1].connectivity[0];
  Index free = 0;
  while (model.fixed[static_cast<std::size_t>(free)] != 0) ++free;
  for (const Index k : {free, 3 * base}) {
    model.move = VecX::Zero(static_cast<Eigen::Index>(3 * model.mesh.nodes.size()));
    model.move[k] = 0.1;
    EXPECT_THROW(assembly::System(model, 1), base::InputError) << k;
  }
}

TEST(System, ElasticFoilHasNoHistoryBesideOneThatYields) {
  assembly::Model model = model_of(small(ElementType::T6), 0);
  const material::HardeningBranch branch[] = {{15e6, 72e6}};
  model.foils[1]->law = material::Logarithmic{{900e6, 0.45}, {material::piecewise_linear(branch).value(), {}}};
  const std::size_t points = model.foils[1]->reference.area.size();
  const assembly::System system(std::move(model), 1);
  EXPECT_TRUE(system.history(0).empty());
  EXPECT_EQ(system.history(1).size(), points * material::Logarithmic::history_names.size());
}

TEST(System, RefusesFoilsThatShareAFreeNode) {
  assembly::Model model = model_of(small(ElementType::Q4), 0);
  model.fixed[3 * static_cast<std::size_t>(model.mesh.edges[0].nodes[1])] = 0;
  EXPECT_THROW(assembly::System(model, 1), geometry::base::InputError);
}

// --- one Newton step against dense algebra
// ------------------------------------------------------------------------------

// The full coupled system [K -Q; Q^T C] (du, dp) = -(R, r), unknown pressures only, solved densely.
VecX dense_step(assembly::System& system, const assembly::Configuration& at, double* condition = nullptr) {
  const Index unknowns = system.unknowns();
  std::vector<Index> unknown_pressures;
  for (std::size_t c = 0; c < system.model().chambers.size(); ++c) {
    if (system.gas_line(static_cast<Index>(c), at).pressure_is_unknown)
      unknown_pressures.push_back(static_cast<Index>(c));
  }
  const auto m = static_cast<Index>(unknown_pressures.size());
  MatX a = MatX::Zero(unknowns + m, unknowns + m);
  VecX b(unknowns + m);
  Index first = 0;
  for (const assembly::FoilEquations& foil : system.foils()) {
    const Index n = foil.pattern.size;
    a.block(first, first, n, n) = dense(foil.pattern, foil.tangent);
    b.segment(first, n) = -foil.residual;
    for (Index k = 0; k < m; ++k) {
      const assembly::Chamber& c =
          system.model().chambers[static_cast<std::size_t>(unknown_pressures[static_cast<std::size_t>(k)])];
      const double sign = c.outer == foil.block ? 1 : c.inner == foil.block ? -1 : 0;
      a.block(first, unknowns + k, n, 1) = -sign * foil.pressure_gradient;
      a.block(unknowns + k, first, 1, n) = sign * foil.pressure_gradient.transpose();
    }
    first += n;
  }
  for (Index k = 0; k < m; ++k) {
    const chamber::GasLine line = system.gas_line(unknown_pressures[static_cast<std::size_t>(k)], at);
    a(unknowns + k, unknowns + k) = line.compliance;
    b[unknowns + k] = -line.residual;
  }
  const Eigen::FullPivLU<MatX> lu(a);
  if (condition != nullptr) *condition = 1 / lu.rcond();
  const VecX solution = lu.solve(b);
  // refined once, so that the comparison shows the bordered solve's error and not this one's
  return solution + lu.solve(b - a * solution);
}

void expect_step_like_dense(assembly::Model model, const assembly::Configuration& from, double tolerance) {
  assembly::System system(std::move(model), 1);
  assembly::Configuration at = from;
  ASSERT_TRUE(system.evaluate(at, true).possible);
  const VecX expected = dense_step(system, at);
  path::NewtonOptions once;
  once.max_iterations = 1;
  path::Newton newton(system, once);
  assembly::Configuration after = at;
  double length = 0;
  newton.solve(after, [&](const path::Iteration& i) {
    length = i.step_length;
    tests::tell(1, i);
    EXPECT_EQ(i.shift, 0);
  });
  ASSERT_GT(length, 0);
  Index first = 0;
  for (const assembly::FoilEquations& foil : system.foils()) {
    const VecX du = (free_coordinates(foil, after.positions) - free_coordinates(foil, at.positions)) / length;
    EXPECT_LT((du - expected.segment(first, foil.pattern.size)).cwiseAbs().maxCoeff(),
              tolerance * expected.head(system.unknowns()).cwiseAbs().maxCoeff());
    first += foil.pattern.size;
  }
  for (std::size_t c = 0; c < system.model().chambers.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const double dp = (after.pressures[i] - at.pressures[i]) / length;
    if (system.gas_line(static_cast<Index>(c), at).pressure_is_unknown) {
      EXPECT_NEAR(dp, expected[first], tolerance * std::abs(expected[first])) << c;
      ++first;
    } else {
      EXPECT_EQ(dp, 0);
    }
  }
}

TEST_P(SystemOfEveryElement, BorderedStepWithOneClosedChamberIsTheDenseStep) {
  tests::Solved from(model_of(small(GetParam()), 500));
  ASSERT_TRUE(from.converged());
  for (const double ambient : {0.0, 101325.0, 1e7}) {
    assembly::Model model = model_of(small(GetParam()), 500);
    model.face_pressure = {{-200, -200}, {0, 0}};
    model.chambers[0].gas = tests::closed_now(from, 0, ambient, 1.4);
    assembly::Configuration at = from.at;
    at.pressures[0] += 30; // the law is not satisfied either
    expect_step_like_dense(model, at, 1e-9);
  }
}

TEST(Newton, BorderedStepWithTwoChambersAndAMiddleFoilIsTheDenseStep) {
  Cushion cushion = small(ElementType::T6);
  cushion.heights = {0.12, 0.03, -0.12};
  assembly::Model model = model_of(cushion, 500);
  model.chambers[1].gas = chamber::Regulated{420, 420};
  tests::Solved from(model);
  ASSERT_TRUE(from.converged());
  model.face_pressure = {{-200, -200}, {0, 0}, {0, 0}};
  using Gases = std::array<chamber::Gas, 2>;
  const chamber::Closed first = tests::closed_now(from, 0, 101325);
  const chamber::Closed second = tests::closed_now(from, 1, 101325, 1.4);
  const double v = from.system.chamber_volume(1);
  for (const Gases& gases :
       {Gases{first, second}, Gases{chamber::Regulated{500, 510}, second}, Gases{first, chamber::Regulated{420, 420}},
        Gases{first, chamber::PrescribedVolume{v, 1.001 * v}}}) {
    model.chambers[0].gas = gases[0];
    model.chambers[1].gas = gases[1];
    assembly::Configuration at = from.at;
    at.load_factor = 1;
    SCOPED_TRACE(fmt::format("laws {} and {}", gases[0].index(), gases[1].index()));
    expect_step_like_dense(model, at, 1e-9);
  }
}

TEST(Newton, SmallVolumesDoNotVanishBesideARegulatedChamber) {
  // a closed chamber's line has entries of the size V/p: 1e-16 m3/Pa in a cushion of 50 um by 25 um (or a large one in
  // other units); beside the line `dp = 0` of a regulated chamber they fell below the rank threshold of the small solve
  Cushion cushion = small(ElementType::T6);
  constexpr double scale = 1e-5;
  cushion.plan = geometry::Rectangle{2 * scale, 1 * scale};
  cushion.heights = {0.12 * scale, 0.03 * scale, -0.12 * scale};
  cushion.thickness = {250e-6 * scale};
  cushion.prestress = 900 * scale;
  assembly::Model model = model_of(cushion, 500);
  tests::Solved from(model);
  ASSERT_TRUE(from.converged());
  model.face_pressure = {{-200, -200}, {0, 0}, {0, 0}};
  model.chambers[0].gas = tests::closed_now(from, 0, 101325);
  assembly::Configuration at = from.at;
  at.load_factor = 1;
  tests::Solved wind(model, from.at);
  ASSERT_TRUE(wind.converged()) << wind.path.reason;
  EXPECT_LE(wind.iterations(), 8);
  EXPECT_GT(wind.at.pressures[0], 505); // the air is pressed; it stayed at 500
}

TEST(Newton, StabilityCountsNothingInATautCushionAndRefusesToCountUnsafely) {
  tests::Solved taut(model_of(small(ElementType::T6), 500));
  ASSERT_TRUE(taut.converged());
  const path::Stability count = taut.newton.tangent().stability(taut.at, nullptr);
  EXPECT_EQ(count.load_held, 0);
  EXPECT_EQ(count.control_held, 0);
  // a flat foil without stress has no stiffness across: no count
  Cushion flat = small(ElementType::T6);
  flat.prestress = 0;
  flat.heights = {0, -0.12};
  assembly::System system(model_of(flat, 0), 1);
  path::Newton newton(system, {});
  assembly::Configuration at = start_of(system.model());
  system.evaluate(at, true);
  EXPECT_FALSE(newton.tangent().stability(at, nullptr).load_held);
}

TEST(SystemOfTables, SaysWhereAndBetweenWhichStrainsATableEnds) {
  Cushion cushion;
  cushion.heights = {0.12};
  cushion.base = true;
  assembly::Model model = model_of(cushion, 300);
  material::NurbsOptions options;
  options.net = {8, 8};
  options.range = material::StrainRange{-0.01, 0.02};
  model.foils[0]->law = material::PdNurbs{material::fit_pd_nurbs(material::Law(cushion.law), options).table};
  assembly::System system(std::move(model), 1);
  assembly::Configuration at = start_of(system.model());
  EXPECT_TRUE(system.evaluate(at, true).possible);
  for (Vec3& x : at.positions) x.x() *= 1.05;
  const assembly::Balance balance = system.evaluate(at, true);
  EXPECT_FALSE(balance.possible);
  EXPECT_NE(balance.reason.find("foil `foil 1` has no data at strain (0.0"), std::string::npos) << balance.reason;
  EXPECT_NE(balance.reason.find("its table lies within -0.01 and 0.02"), std::string::npos) << balance.reason;
}

// A foil over a base whose stresses c (E1 + nu E2 + 10 E1 E2) have no potential; with one, the nearest that has.
assembly::Model table_of_stresses(ElementType element, double pressure, bool potential) {
  constexpr double c = 900e6, nu = 0.45, defect = 10;
  std::vector<material::StressPoint> points;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const double e1 = -0.1 + 0.025 * i;
      const double e2 = -0.1 + 0.025 * j;
      points.push_back({e1, e2, c * (e1 + nu * e2 + defect * e1 * e2), c * (e2 + nu * e1 + defect * e1 * e2)});
    }
  }
  material::NurbsOptions options;
  options.net = {8, 8};
  options.potential = potential;
  Cushion cushion = small(element);
  cushion.prestress = 0;
  cushion.heights = {0.12};
  cushion.base = true;
  assembly::Model model = model_of(cushion, 0);
  model.chambers[0].gas = chamber::Regulated{0, pressure};
  model.foils[0]->law = material::PdNurbs{material::fit_pd_nurbs(points, options).table};
  return model;
}

TEST_P(SystemOfEveryElement, WithoutAPotentialTheTangentIsTheSymmetricPartOfTheDerivative) {
  const assembly::Model model = table_of_stresses(GetParam(), 50e3, false);
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model, 1);
  for (Vec3& x : at.positions) x += Vec3(0.05 * x.x(), 0.01 * x.y(), 0.2 * x.z());
  system.evaluate(at, true);
  const MatX tangent = dense(system.foils()[0].pattern, system.foils()[0].tangent);
  const MatX derivative = differences(system, at, 0);
  const double skew = relative_difference(derivative.transpose(), derivative);
  EXPECT_GT(skew, 0.01);
  std::printf("largest difference across the diagonal %.2g of the largest entry\n", skew);
  EXPECT_LT(relative_difference(0.5 * (derivative + derivative.transpose()), tangent), 1e-6);
}

TEST_P(SystemOfEveryElement, WithoutAPotentialNewtonArrivesLater) {
  const tests::Solved with(table_of_stresses(GetParam(), 1e5, true));
  const tests::Solved without(table_of_stresses(GetParam(), 1e5, false));
  ASSERT_TRUE(with.converged()) << with.path.reason;
  ASSERT_TRUE(without.converged()) << without.path.reason;
  EXPECT_EQ(without.path.steps, with.path.steps);
  EXPECT_GT(without.iterations(), with.iterations());
  std::printf("%d iterations with a potential, %d without\n", with.iterations(), without.iterations());
}

} // namespace
