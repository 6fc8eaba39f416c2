// SPDX-License-Identifier: GPL-3.0-or-later
// The bordered tangent against dense matrices: steps, limit points, numbers of negative eigenvalues.
#include <cmath>

#include <Eigen/Eigenvalues>

#include "solver/path/control.h"
#include "tests/unit/finite_differences.h"
#include "tests/unit/solver/cushions.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::MatX;
using base::Vec3;
using base::VecX;
using geometry::ElementType;
using tests::Cushion;
using tests::model_of;
using tests::relative_difference;

// Three foils, two chambers of closed air; pressures and wind run with the load factor.
assembly::Model three_foils(double prestress) {
  Cushion c;
  c.element = ElementType::T6;
  c.divisions = {3, 2};
  c.heights = {0.12, 0.03, -0.12};
  c.prestress = prestress;
  assembly::Model model = model_of(c, 0);
  for (std::size_t i = 0; i < 2; ++i) {
    chamber::Closed gas;
    gas.kappa = 1.4;
    gas.volume0 = 0.1;
    gas.absolute0 = i == 0 ? 101800 : 101500;
    gas.ambient_from = 101325;
    gas.ambient_to = 101000;
    model.chambers[i].gas = gas;
  }
  model.face_pressure = {{0, -300}, {0, 0}, {0, 50}};
  model.dead_from = model.dead_to = VecX::Zero(static_cast<Eigen::Index>(3 * model.mesh.nodes.size()));
  for (Eigen::Index k = 2; k < model.dead_to.size(); k += 3) model.dead_to[k] = -0.7;
  return model;
}

// The system somewhere, with its matrices dense: A over (u of all foils, p), right sides b and f.
struct Dense {
  assembly::System system;
  path::Work work;
  path::Tangent tangent;
  assembly::Configuration at;
  Index free = 0;
  MatX A, Q, D;
  VecX b, f;

  explicit Dense(assembly::Model model, double shaken = 0.002)
      : system(std::move(model), 2), tangent(system, work), at(tests::start_of(system.model(), 0.4)) {
    at.pressures << 400, 180;
    tests::shake(system.model(), at.positions, shaken);
    fill();
  }
  void fill() {
    system.evaluate(at, true);
    free = system.unknowns();
    A = MatX::Zero(free + 2, free + 2);
    b = f = VecX::Zero(free + 2);
    Q = MatX::Zero(free, 2);
    D = MatX::Zero(2, 2);
    Index row = 0;
    for (std::size_t i = 0; i < system.foils().size(); ++i) {
      const assembly::FoilEquations& foil = system.foils()[i];
      const Index size = foil.pattern.size;
      A.block(row, row, size, size) = tests::dense_tangent(system, i);
      Q.middleRows(row, size) = system.volume_gradients(static_cast<Index>(i));
      b.segment(row, size) = -foil.residual;
      f.segment(row, size) = foil.load_gradient;
      row += size;
    }
    for (Index c = 0; c < 2; ++c) {
      const chamber::GasLine line = system.gas_line(c, at);
      D(c, c) = line.compliance;
      b[free + c] = line.residual;
      f[free + c] = line.drive;
    }
    A.topRightCorner(free, 2) = -Q;
    A.bottomLeftCorner(2, free) = -Q.transpose();
    A.bottomRightCorner(2, 2) = -D;
  }
  VecX flat(const path::Change& change) const {
    VecX x(free + 2);
    Index row = 0;
    for (const VecX& u : change.u) {
      x.segment(row, u.size()) = u;
      row += static_cast<Index>(u.size());
    }
    x.tail(2) = change.p;
    return x;
  }
  int negative(const MatX& m) const {
    return static_cast<int>((Eigen::SelfAdjointEigenSolver<MatX>(m).eigenvalues().array() < 0).count());
  }
};

TEST(Tangent, RankTwoUpdateOfTwoChambersAgreesWithADenseSolve) {
  Dense d(three_foils(900));
  ASSERT_TRUE(d.tangent.factorize(d.at, path::Tangent::Repair::indefinite));
  const VecX x = d.flat(d.tangent.step(d.at));
  EXPECT_LT(relative_difference(x, d.A.fullPivLu().solve(d.b)), 1e-11);
  // the same as the dense matrix K + Q D^-1 Q' that is never formed
  const MatX K = d.A.topLeftCorner(d.free, d.free) + d.Q * d.D.inverse() * d.Q.transpose();
  const VecX right = d.b.head(d.free) - d.Q * d.D.inverse() * d.b.tail(2);
  EXPECT_LT(relative_difference(x.head(d.free), K.ldlt().solve(right)), 1e-9);
}

TEST(Tangent, StepWithTheLoadFactorUnknownAgreesWithADenseSolve) {
  for (const double prestress : {900.0, 0.0}) { // definite and not
    Dense d(three_foils(prestress), prestress > 0 ? 0.002 : 0.02);
    ASSERT_TRUE(d.tangent.factorize(d.at, path::Tangent::Repair::indefinite));
    EXPECT_EQ(d.tangent.artificial_tension(), 0);
    const path::Row row = path::row_of(path::HeldVolume{0}, 0.09, d.system, d.at);
    const auto change = d.tangent.step(d.at, row);
    ASSERT_TRUE(change);
    MatX bordered(d.free + 3, d.free + 3);
    bordered << d.A, -d.f, d.flat(row.form).transpose(), MatX::Constant(1, 1, row.form.load_factor);
    VecX right(d.free + 3);
    right << d.b, -row.residual;
    const VecX x = bordered.fullPivLu().solve(right);
    EXPECT_LT(relative_difference(d.flat(*change), x.head(d.free + 2)), 1e-8) << prestress;
    EXPECT_NEAR(change->load_factor, x[d.free + 2], 1e-8 * std::abs(x[d.free + 2]));
    // the way on leaves every residual as it is
    const auto way = d.tangent.along(d.at);
    ASSERT_TRUE(way);
    EXPECT_LT((d.A * d.flat(*way) - d.f * way->load_factor).norm(), 1e-7 * (d.f * way->load_factor).norm());
    EXPECT_NEAR(path::dot_u(*way, *way), 1, 1e-12);
  }
}

TEST(Tangent, StepIsRightWhereTheTangentIsSingularToRounding) {
  Dense d(three_foils(900));
  // K - mu I with mu its smallest eigenvalue is singular
  assembly::FoilEquations& foil = d.system.foils()[0];
  const VecX eigenvalues =
      Eigen::SelfAdjointEigenSolver<MatX>(d.A.topLeftCorner(foil.pattern.size, foil.pattern.size)).eigenvalues();
  for (const double relative : {1e-6, 1e-10, 1e-14, 0.0}) {
    d.fill();
    const double shift = eigenvalues[0] * (1 - relative);
    for (Index j = 0; j < foil.pattern.size; ++j) {
      foil.tangent[static_cast<std::size_t>(foil.pattern.column_start[static_cast<std::size_t>(j) + 1]) - 1] -= shift;
      d.A(j, j) -= shift;
    }
    ASSERT_TRUE(d.tangent.factorize(d.at, path::Tangent::Repair::indefinite)) << relative;
    EXPECT_EQ(d.tangent.artificial_tension(), 0) << relative;
    const path::Row row =
        path::row_of(path::displacement_of(foil.coordinate[3] / 3, Vec3(0.3, 0.2, 1)), 0.01, d.system, d.at);
    const auto change = d.tangent.step(d.at, row);
    ASSERT_TRUE(change) << relative;
    MatX bordered(d.free + 3, d.free + 3);
    bordered << d.A, -d.f, d.flat(row.form).transpose(), MatX::Constant(1, 1, row.form.load_factor);
    VecX right(d.free + 3);
    right << d.b, -row.residual;
    VecX x(d.free + 3);
    x << d.flat(*change), change->load_factor;
    EXPECT_LT((bordered * x - right).norm(), 1e-8 * right.norm()) << relative;
    EXPECT_LT(relative_difference(x, bordered.fullPivLu().solve(right)), 1e-6) << relative;
  }
}

TEST(Tangent, CountsNegativeEigenvaluesLikeDenseMatrices) {
  for (const double shaken : {0.0, 0.02}) {
    for (const double prestress : {0.0, 300.0, -300.0}) {
      Dense d(three_foils(prestress), shaken);
      const path::Row row = path::row_of(path::HeldVolume{1}, 0.09, d.system, d.at);
      const path::Stability count = d.tangent.stability(d.at, &row);
      ASSERT_TRUE(count.load_held) << shaken << ' ' << prestress;
      const MatX K = d.A.topLeftCorner(d.free, d.free) + d.Q * d.D.inverse() * d.Q.transpose();
      EXPECT_EQ(*count.load_held, d.negative(K)) << shaken << ' ' << prestress;
      MatX held(d.free + 1, d.free + 1);
      const VecX c = d.flat(row.form).head(d.free);
      held << K, c, c.transpose(), MatX::Zero(1, 1);
      EXPECT_EQ(*count.control_held, d.negative(held) - 1) << shaken << ' ' << prestress;
    }
  }
}

// One free node 0.1 m above the middle of a square, and the same pushed half flat.
Cushion pyramid() {
  Cushion c;
  c.plan = geometry::Rectangle{2, 2};
  c.element = ElementType::T3;
  c.divisions = {2, 2};
  c.heights = {0.1};
  c.base = true;
  return c;
}
assembly::Configuration half_flat(const assembly::Model& model) {
  assembly::Configuration at = tests::start_of(model);
  for (std::size_t i = 0; i < at.positions.size(); ++i) {
    if (model.fixed[3 * i] == 0) at.positions[i].z() = 0.03;
  }
  return at;
}

TEST(Tangent, AirCanHoldAFoilThatIsUnstableByItself) {
  // a pyramid with one free node, pushed half flat: alone it would snap through, but the air below it resists
  const Cushion c = pyramid();
  for (const bool closed : {false, true}) {
    assembly::Model model = model_of(c, 0);
    if (closed) model.chambers[0].gas = chamber::Closed{1.4, 101325, 0.2 / 3, 1, 1, 101325, 101325};
    assembly::System system(model, 1);
    path::Work work;
    path::Tangent tangent(system, work);
    assembly::Configuration at = half_flat(model);
    system.evaluate(at, true);
    const path::Stability count = tangent.stability(at, nullptr);
    ASSERT_TRUE(count.load_held);
    EXPECT_LT(Eigen::SelfAdjointEigenSolver<MatX>(tests::dense_tangent(system, 0)).eigenvalues()[0], 0);
    EXPECT_EQ(*count.load_held, closed ? 0 : 1);
  }
}

TEST(Tangent, DoesNotCountWhereAirAndFoilsCancel) {
  // a foil pushed half flat over air as stiff as the foil is unstable: the smallest compliance that does not hold it
  const Cushion c = pyramid();
  assembly::Model model = model_of(c, 0);
  model.chambers[0].gas = chamber::Closed{1, 1e5, 0.04, 1, 1, 1e5, 1e5};
  const auto count_at = [&](double absolute) {
    auto& air = std::get<chamber::Closed>(model.chambers[0].gas);
    air.absolute0 = air.ambient_from = air.ambient_to = absolute;
    assembly::System system(model, 1);
    path::Work work;
    path::Tangent tangent(system, work);
    assembly::Configuration at = half_flat(model);
    system.evaluate(at, true);
    const VecX q = system.volume_gradients(0).col(0);
    const double stiffness = -1 / q.dot(tests::dense_tangent(system, 0).ldlt().solve(q)); // Pa/m3, what is missing
    return std::pair(tangent.stability(at, nullptr).load_held, stiffness * system.chamber_volume(0));
  };
  const double critical = count_at(1e5).second;
  ASSERT_GT(critical, 0);
  EXPECT_EQ(count_at(0.999 * critical).first, 1);
  EXPECT_EQ(count_at(1.001 * critical).first, 0);
  EXPECT_FALSE(count_at(critical).first);
}

// Differences of the residuals by the load factor, at 0.4.
VecX slope_by_load(Dense& d) {
  const auto residuals = [&](double load_factor) {
    d.at.load_factor = load_factor;
    d.fill();
    return VecX(d.b);
  };
  constexpr double step = 1e-4;
  return (residuals(0.4 + step) - residuals(0.4 - step)) / (2 * step);
}

TEST(Tangent, LoadFactorDrivesWhatTheResidualsShow) {
  assembly::Model model = three_foils(900);
  std::get<chamber::Closed>(model.chambers[1].gas).kappa = 1;
  std::get<chamber::Closed>(model.chambers[1].gas).temperature0 = 283;
  std::get<chamber::Closed>(model.chambers[1].gas).temperature = 300;
  model.chambers[0].gas = chamber::Regulated{200, 700};
  assembly::PressureZone zone{2, {0}, {}, {0, 80}};
  for (Index e = 0; e < model.mesh.element_count(model.mesh.blocks[2]); ++e) {
    if (e % 3 == 0) {
      for (const geometry::QuadraturePoint& q : geometry::pressure_rule(ElementType::T6)) zone.points.push_back(q);
    }
    zone.offset.push_back(static_cast<Index>(zone.points.size()));
  }
  model.zones.push_back(zone);
  Dense d(model);
  const VecX f = d.f;
  const VecX slope = slope_by_load(d);
  EXPECT_LT(relative_difference(slope.head(d.free), f.head(d.free)), 1e-9);
  EXPECT_LT(relative_difference(-slope.tail(2), -f.tail(2)), 1e-6) << slope.tail(2) << " | " << f.tail(2);
}

// Rims move in every direction, each coordinate its own way.
assembly::Model with_moving_rims(assembly::Model model) {
  model.move = VecX::Zero(static_cast<Eigen::Index>(3 * model.mesh.nodes.size()));
  for (const geometry::Edge& edge : model.mesh.edges) {
    for (const Index node : edge.nodes) {
      for (Index c = 0; c < 3; ++c) model.move[3 * node + c] = 0.03 * std::sin(1.7 * node + 2.3 * c);
    }
  }
  return model;
}

TEST(Tangent, MovedRimsDriveWhatTheResidualsShow) {
  assembly::Model model = with_moving_rims(three_foils(900));
  model.chambers[0].gas = chamber::Regulated{2e5, 7e5}; // large enough to stand out beside E h
  model.chambers[1].gas = chamber::PrescribedVolume{0.1, 0.2};
  Dense d(model);
  const VecX f = d.f;
  const VecX slope = slope_by_load(d);
  EXPECT_LT(relative_difference(slope.head(d.free), f.head(d.free)), 1e-7);
  EXPECT_LT(relative_difference(-slope.tail(2), -f.tail(2)), 1e-6) << slope.tail(2) << " | " << f.tail(2);
}

TEST(Tangent, MovedRimsEnterTheRowsOfWhatIsHeld) {
  Dense d(with_moving_rims(three_foils(900)));
  const Index rim = d.system.model().mesh.edges[0].nodes[1];
  const Index free = d.system.foils()[1].coordinate[4];
  std::vector<Vec3> from = d.at.positions;
  tests::shake(d.system.model(), from, 0.01);
  path::HeldDisplacement displacement = path::displacement_of(rim, Vec3(0.6, 0, 0.8));
  displacement.weights.emplace_back(free, 2.0);
  for (const path::Held& held :
       {path::Held(path::HeldVolume{1}), path::Held(displacement), path::Held(path::HeldArc{from})}) {
    const path::Row row = path::row_of(held, 0, d.system, d.at);
    path::Change way = row.form; // any direction
    for (std::size_t i = 0; i < way.u.size(); ++i)
      way.u[i] = VecX::Constant(way.u[i].size(), 0.01 + 0.02 * static_cast<double>(i));
    way.load_factor = 1;
    const auto value = [&](double step) {
      assembly::Configuration there = path::moved(d.system, d.at, step * way);
      d.system.evaluate(there, false);
      return path::value_of(held, d.system, there);
    };
    constexpr double step = 1e-4;
    const double slope = (value(step) - value(-step)) / (2 * step);
    EXPECT_NEAR(slope, path::dot(row.form, way), 1e-6 * std::abs(slope)) << held.index();
    d.fill();
  }
}

TEST(Tangent, ConnectedChambersShareOnePressureAndTheSumOfTheirVolumes) {
  assembly::Model model = three_foils(900);
  model.chambers[1].connected_to = 0;
  assembly::System system(model, 1);
  assembly::Configuration at = tests::start_of(model, 0.4);
  at.pressures << 400, 180;
  system.evaluate(at, true);
  EXPECT_EQ(at.pressures[1], 400);
  const chamber::GasLine line = system.gas_line(0, at);
  const chamber::GasLine alone =
      chamber::gas_line(model.chambers[0].gas, 400, system.chamber_volume(0) + system.chamber_volume(1), 0.4);
  EXPECT_EQ(line.residual, alone.residual);
  EXPECT_FALSE(system.gas_line(1, at).pressure_is_unknown);
  // the middle foil's two faces cancel
  EXPECT_EQ(system.volume_gradients(1).norm(), 0);
  EXPECT_EQ(system.volume_gradients(0).col(1).norm(), 0);
}

} // namespace
