// SPDX-License-Identifier: GPL-3.0-or-later
// Paths through limit points by displacement, volume and arc length, against a closed form.
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "solver/path/controlled_path.h"
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

// A pyramid of linear triangles over a square of 2 a, free of stress at height z0, one free node: the surface's
// counterpart of von Mises' truss. Strain across the base only, E22 = (z^2 - z0^2) / (2 (a^2 + z0^2)), and a pressure p
// pushes the apex with p 4 a^2 / 3. So
//   p(z) 4 a^2 / 3 = A0 h c z (z^2 - z0^2) / (2 (a^2 + z0^2)^2),  c = E / (1 - nu^2),  A0 = 4 a sqrt(a^2 + z0^2),
// with extremes at z = +- z0 / sqrt(3).
struct Pyramid {
  double a = 1, z0 = 0.1, h = 250e-6, E = 900e6, nu = 0.45;

  double pressure(double z) const {
    const double side = a * a + z0 * z0;
    return 4 * a * std::sqrt(side) * h * E / (1 - nu * nu) * z * (z * z - z0 * z0) / (2 * side * side) /
           (4 * a * a / 3);
  }
  double limit() const { return pressure(-z0 / std::numbers::sqrt3); }

  // load factor 1: the pressure `top` pushes down
  assembly::Model model(double top) const {
    Cushion c;
    c.plan = geometry::Rectangle{2 * a, 2 * a};
    c.element = ElementType::T3;
    c.divisions = {2, 2};
    c.heights = {z0};
    c.base = true;
    c.thickness = {h};
    c.law = {E, nu};
    assembly::Model model = model_of(c, 0);
    model.face_pressure = {{0, -top}, {0, 0}};
    return model;
  }
};

struct Point {
  double load_factor, height, volume;
};

// A path and what was seen on it.
struct Followed {
  assembly::System system;
  path::Newton newton;
  assembly::Configuration at;
  path::PathResult path;
  std::vector<Point> points;
  Index apex = -1;

  Followed(assembly::Model model, const path::PathControl& control, path::ControlledPathOptions options = {})
      : system(std::move(model), 1), newton(system, {}), at(tests::start_of(system.model())) {
    for (std::size_t i = 0; i < at.positions.size(); ++i) {
      if (system.model().fixed[3 * i] == 0 && std::abs(at.positions[i].x()) + std::abs(at.positions[i].y()) < 1e-9) {
        apex = static_cast<Index>(i);
      }
    }
    path = path::follow_control(
        system, newton, at, control, options,
        [&](const path::Step& step, const assembly::Configuration& c) {
          points.push_back(
              {step.load_factor, c.positions[static_cast<std::size_t>(apex)].z(), system.chamber_volume(0)});
          return path::Verdict::go_on;
        },
        tests::tell);
  }
  bool reached() const { return path.end == path::PathEnd::reached; }
};

path::DisplacementPath down(const Followed& like, double until) {
  return {path::displacement_of(like.apex, Vec3(0, 0, -1)), until};
}

void expect_on_the_closed_form(const Pyramid& pyramid, double top, const Followed& f) {
  for (const Point& p : f.points) {
    EXPECT_NEAR(-p.load_factor * top, pyramid.pressure(p.height), 1e-7 * pyramid.limit()) << p.height;
  }
}

void expect_both_limits(const Pyramid& pyramid, double top, const Followed& f) {
  std::vector<double> limits;
  for (const path::CriticalPoint& point : f.path.critical) {
    if (point.kind == path::CriticalPoint::Kind::limit) limits.push_back(point.load_factor * top);
  }
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_NEAR(limits[0], pyramid.limit(), 1e-9 * pyramid.limit());
  EXPECT_NEAR(limits[1], -pyramid.limit(), 1e-9 * pyramid.limit());
}

TEST(ControlledPath, DisplacementControlTakesThePyramidThroughBothLimitPoints) {
  const Pyramid pyramid;
  const double top = pyramid.limit();
  const Followed probe(pyramid.model(top), path::VolumePath{0, 0.13});
  for (const int parts : {1, 7, 40}) {
    path::ControlledPathOptions options;
    options.parts = parts;
    const Followed f(pyramid.model(top), down(probe, 0.23), options);
    ASSERT_TRUE(f.reached()) << f.path.reason;
    expect_on_the_closed_form(pyramid, top, f);
    expect_both_limits(pyramid, top, f);
    EXPECT_NEAR(f.points.back().height, 0.1 - 0.23, 1e-12);
    std::printf("displacement, %d parts: %d steps, %d iterations, %d factorisations\n", parts, f.path.steps,
                f.newton.work().iterations, f.newton.work().factorizations);
  }
}

TEST(ControlledPath, VolumeControlDoesSo) {
  const Pyramid pyramid;
  const double top = pyramid.limit();
  const Followed f(pyramid.model(top), path::VolumePath{0, -0.13 * 4 / 3});
  ASSERT_TRUE(f.reached()) << f.path.reason;
  expect_on_the_closed_form(pyramid, top, f);
  expect_both_limits(pyramid, top, f);
  EXPECT_NEAR(f.points.back().height, -0.13, 1e-12);
}

TEST(ControlledPath, ArcLengthDoesSoAndEndsWhereItIsTold) {
  const Pyramid pyramid;
  const double top = pyramid.limit();
  path::ArcLengthPath until;
  until.load_factor = 1.3; // only the third branch has it
  const Followed f(pyramid.model(top), until);
  ASSERT_TRUE(f.reached()) << f.path.reason;
  expect_on_the_closed_form(pyramid, top, f);
  expect_both_limits(pyramid, top, f);
  EXPECT_NEAR(f.points.back().load_factor, 1.3, 1e-9);
  EXPECT_LT(f.points.back().height, -0.1);
  std::printf("arc length: %d steps, %d iterations, %d factorisations\n", f.path.steps, f.newton.work().iterations,
              f.newton.work().factorizations);

  path::ArcLengthPath fallen;
  fallen.after_peak = 0.5;
  const Followed g(pyramid.model(top), fallen);
  ASSERT_TRUE(g.reached()) << g.path.reason;
  EXPECT_NEAR(g.points.back().load_factor, 0.5, 1e-9);
  EXPECT_LT(g.points.back().height, 0.1 / std::numbers::sqrt3); // behind the peak

  path::ArcLengthPath far;
  far.displacement = 0.15;
  const Followed h(pyramid.model(top), far);
  ASSERT_TRUE(h.reached()) << h.path.reason;
  EXPECT_NEAR(h.points.back().height, -0.05, 1e-10);

  path::ArcLengthPath empty;
  empty.volume = -0.05;
  const Followed v(pyramid.model(top), empty);
  ASSERT_TRUE(v.reached()) << v.path.reason;
  EXPECT_NEAR(v.points.back().volume, -0.05, 1e-9);
}

TEST(ControlledPath, CountsSeeTheLimitPointsAndTheControlHoldsWhatTheLoadDoesNot) {
  const Pyramid pyramid;
  const double top = pyramid.limit();
  const Followed probe(pyramid.model(top), path::VolumePath{0, 0.13});
  // 0.07 m down: between the limit points
  Followed f(pyramid.model(top), down(probe, 0.07));
  ASSERT_TRUE(f.reached()) << f.path.reason;
  ASSERT_TRUE(f.path.held);
  const path::Row row = path::row_of(*f.path.held, 0, f.system, f.at);
  const path::Stability count = f.newton.tangent().stability(f.at, &row);
  const MatX dense = tests::dense_tangent(f.system, 0);
  const VecX eigenvalues = Eigen::SelfAdjointEigenSolver<MatX>(dense).eigenvalues();
  const auto negative = static_cast<int>((eigenvalues.array() < 0).count());
  EXPECT_GE(negative, 1);
  EXPECT_EQ(count.load_held, negative);
  EXPECT_EQ(count.control_held, negative - 1);
}

TEST(ControlledPath, LoadControlSnapsToTheStableBranchBeyondTheLimitPoint) {
  const Pyramid pyramid;
  const double top = 1.2 * pyramid.limit();
  assembly::System system(pyramid.model(top), 1);
  path::Newton newton(system, {});
  assembly::Configuration at = tests::start_of(system.model());
  path::LoadPathOptions options;
  options.parts = 10;
  const path::PathResult result = path::follow_load(system, newton, at, options, {}, tests::tell);
  ASSERT_EQ(result.end, path::PathEnd::reached) << result.reason;
  double lowest = 0;
  for (const Vec3& x : at.positions) lowest = std::min(lowest, x.z());
  EXPECT_LT(lowest, -0.1);
  EXPECT_NEAR(-top, pyramid.pressure(lowest), 1e-7 * top);
  EXPECT_EQ(newton.tangent().stability(at, nullptr).load_held, 0);
}

} // namespace
