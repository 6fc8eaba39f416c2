// SPDX-License-Identifier: GPL-3.0-or-later
// Paths through limit points by displacement, volume and arc length, against a closed form.
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "solver/analytical/balloon.h"
#include "solver/path/controlled_path.h"
#include "tests/verification/pyramid.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using base::Index;
using base::MatX;
using base::Vec3;
using base::VecX;
using geometry::ElementType;
using tests::Pyramid;

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

// However it is walked.
TEST(ControlledPath, LoadControlEndsAtTheLimitPointWhateverItsSteps) {
  const Pyramid pyramid;
  for (const double top : {1.05, 1.2, 3.0}) {
    for (const int parts : {1, 2, 5, 10, 20, 100}) {
      assembly::System system(pyramid.model(top * pyramid.limit()), 1);
      path::Newton newton(system, {});
      assembly::Configuration at = tests::start_of(system.model());
      path::LoadPathOptions options;
      options.parts = parts;
      const path::PathResult result = path::follow_load(system, newton, at, options, {}, tests::tell);
      EXPECT_EQ(result.end, path::PathEnd::stuck) << top << " in " << parts;
      ASSERT_EQ(result.critical.size(), 1u) << result.reason;
      EXPECT_NEAR(result.critical[0].load_factor, 1 / top, 1e-6);
      EXPECT_LE(result.load_factor, 1 / top + 1e-9);
      EXPECT_GT(result.load_factor, 1 / top - 2e-3);
    }
  }
}

TEST(ControlledPath, LoadControlSnapsToTheStableBranchBeyondTheLimitPointWhereItMay) {
  const Pyramid pyramid;
  const double top = 1.2 * pyramid.limit();
  assembly::System system(pyramid.model(top), 1);
  path::Newton newton(system, {});
  assembly::Configuration at = tests::start_of(system.model());
  path::LoadPathOptions options;
  options.parts = 10;
  options.snaps = true;
  const path::PathResult result = path::follow_load(system, newton, at, options, {}, tests::tell);
  ASSERT_EQ(result.end, path::PathEnd::reached) << result.reason;
  ASSERT_EQ(result.snaps.size(), 1u);
  EXPECT_NEAR(result.snaps[0].from, 1 / 1.2, 2e-3);
  EXPECT_GT(result.snaps[0].to, 1 / 1.2);
  double lowest = 0;
  for (const Vec3& x : at.positions) lowest = std::min(lowest, x.z());
  EXPECT_LT(lowest, -0.1);
  EXPECT_NEAR(-top, pyramid.pressure(lowest), 1e-7 * top);
  EXPECT_EQ(newton.tangent().stability(at, nullptr).load_held, 0);
}

TEST(ControlledPath, MovedEdgeIsFollowedByEveryControl) {
  // a sheet between a held and a moved edge, which narrows in its middle
  tests::Cushion c;
  c.element = ElementType::Q4;
  c.divisions = {8, 4};
  c.heights = {0};
  assembly::Model model = tests::model_of(c, 0);
  model.move = VecX::Zero(static_cast<Eigen::Index>(3 * model.mesh.nodes.size()));
  Index middle = -1;
  for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i) {
    const Vec3& x = model.mesh.nodes[i];
    const bool end = std::abs(std::abs(x.x()) - 1) < 1e-9;
    model.fixed[3 * i] = model.fixed[3 * i + 1] = end ? 1 : 0;
    model.fixed[3 * i + 2] = 1;
    if (end && x.x() > 0) model.move[static_cast<Eigen::Index>(3 * i)] = 0.4;
    if (std::abs(x.x()) < 1e-9 && x.y() > 0.5 - 1e-9) middle = static_cast<Index>(i);
  }
  ASSERT_GE(middle, 0);
  const tests::Solved by_load(model, 4);
  ASSERT_TRUE(by_load.converged()) << by_load.path.reason;
  const double narrowed = 0.5 - by_load.at.positions[static_cast<std::size_t>(middle)].y();
  EXPECT_GT(narrowed, 0.05);
  path::ArcLengthPath arc;
  arc.load_factor = 1;
  const Index moved = model.mesh.blocks[0].connectivity[model.mesh.blocks[0].connectivity.size() - 2];
  ASSERT_EQ(model.move[3 * moved], 0.4);
  for (const path::PathControl& control :
       {path::PathControl(path::DisplacementPath{path::displacement_of(middle, Vec3(0, -1, 0)), narrowed}),
        path::PathControl(path::DisplacementPath{path::displacement_of(moved, Vec3(1, 0, 0)), 0.4}),
        path::PathControl(arc)}) {
    assembly::System system(model, 1);
    path::Newton newton(system, {});
    assembly::Configuration at = tests::start_of(model);
    const path::PathResult result = path::follow_control(system, newton, at, control, {}, {}, tests::tell);
    ASSERT_EQ(result.end, path::PathEnd::reached) << control.index() << result.reason;
    EXPECT_NEAR(result.load_factor, 1, 1e-7);
    for (std::size_t i = 0; i < at.positions.size(); ++i) {
      EXPECT_LT((at.positions[i] - by_load.at.positions[i]).norm(), 1e-7);
    }
  }
}

// --- a spherical balloon, one octant by symmetry
// ----------------------------------------------------------------------------

constexpr double radius = 0.1, film = 1e-3, shear = 0.4e6; // m, m, Pa

// A triangle of the plan onto the octant; the planes of symmetry hold their normal direction. Load factor 1: 1 kPa.
assembly::Model balloon(ElementType element, int divisions, const material::Law& law) {
  const double high = std::sqrt(0.75);
  const geometry::Triangle plan{{{0, 0}, {1, 0}, {0.5, high}}};
  assembly::Model model;
  model.mesh = geometry::meshing::stack(
      geometry::meshing::mesh_plan(plan, {element, {}, std::array{divisions, divisions}}), {{"octant"}});
  for (Vec3& x : model.mesh.nodes) {
    const double w = x.y() / high;
    const double v = x.x() - 0.5 * w;
    x = radius * Vec3(1 - v - w, v, w).normalized();
    for (int c = 0; c < 3; ++c) model.fixed.push_back(std::abs(x[c]) < 1e-9 * radius ? 1 : 0);
  }
  model.mesh.blocks.push_back({"nothing", geometry::BlockKind::base, {}}); // the planes are the other walls
  model.foils.push_back(assembly::Foil{
      element::make_reference(element, geometry::StressRule::full,
                              element::corner_coordinates(model.mesh.blocks[0].connectivity, model.mesh.nodes),
                              Vec3(0.3, 0.5, 0.1)),
      law, film});
  model.foils.emplace_back();
  model.chambers.push_back({"inside", 0, 1, 0.0, chamber::Regulated{0, 1000}, 0.0});
  model.origin = Vec3::Zero();
  return model;
}

analytical::Balloon exact_of(const material::MooneyRivlin& law) {
  return {analytical::BalloonShape::sphere, radius, film, analytical::MooneyRivlin{law.c1, law.c2}};
}

double stretch_of(double octant) {
  return std::cbrt(octant * 6 / std::numbers::pi) / radius;
}

struct Blown {
  assembly::System system;
  path::Newton newton;
  assembly::Configuration at;
  path::PathResult path;
  std::vector<std::pair<double, double>> points; // stretch, pressure

  Blown(assembly::Model model, const path::PathControl& control, path::ControlledPathOptions options = {})
      : system(std::move(model), 1), newton(system, {}), at(tests::start_of(system.model())) {
    path = path::follow_control(
        system, newton, at, control, options,
        [&](const path::Step&, const assembly::Configuration& c) {
          points.emplace_back(stretch_of(system.chamber_volume(0)), c.pressures[0]);
        },
        tests::tell);
  }
};

std::vector<double> limits_of(const path::PathResult& path) {
  std::vector<double> limits;
  for (const path::CriticalPoint& point : path.critical) {
    if (point.kind == path::CriticalPoint::Kind::limit) limits.push_back(point.pressures[0]);
  }
  return limits;
}

TEST(Balloon, NeoHookeanSpherePassesItsLimitPointByEveryControl) {
  const material::MooneyRivlin law{shear / 2, 0};
  const double exact = analytical::limit_points(exact_of(law)).at(0).pressure;
  double last_error = 1;
  for (const int divisions : {4, 8}) {
    path::ArcLengthPath arc;
    arc.displacement = 2 * radius;
    const Blown a(balloon(ElementType::T6, divisions, law), arc);
    const Blown v(balloon(ElementType::T6, divisions, law), path::VolumePath{0, 27 * std::numbers::pi / 6 * 1e-3});
    const Blown d(balloon(ElementType::T6, divisions, law), path::LargestDisplacementPath{0, 2 * radius});
    for (const Blown* b : {&a, &v, &d}) {
      ASSERT_EQ(b->path.end, path::PathEnd::reached) << b->path.reason;
      const std::vector<double> limits = limits_of(b->path);
      ASSERT_EQ(limits.size(), 1u);
      EXPECT_NEAR(limits[0], limits_of(a.path)[0], 1e-8 * exact); // the mesh's limit point, whatever the control
      double worst = 0;
      for (const auto& [s, p] : b->points)
        worst = std::max(worst, std::abs(p - analytical::inflate(exact_of(law), s)->pressure) / exact);
      EXPECT_LT(worst, 0.02 / divisions);
      std::printf("T6 %d: limit %.6f Pa (exact %.6f), worst %.1e of it on the way, %d steps, %d iterations, %d "
                  "factorisations, %zu critical points\n",
                  divisions, limits[0], exact, worst, b->path.steps, b->newton.work().iterations,
                  b->newton.work().factorizations, b->path.critical.size());
    }
    const double error = std::abs(limits_of(a.path)[0] / exact - 1);
    EXPECT_LT(error, last_error / 8); // third order or better
    last_error = error;
  }
  EXPECT_LT(last_error, 1e-4);
}

TEST(Balloon, MooneyRivlinSphereFallsAndRisesAgain) {
  const material::MooneyRivlin law{0.45 * shear, 0.05 * shear};
  const std::vector<analytical::InflatedBalloon> exact = analytical::limit_points(exact_of(law));
  ASSERT_EQ(exact.size(), 2u);
  const double most = exact[0].pressure, least = exact[1].pressure;
  path::ArcLengthPath arc;
  arc.pressure = 1.2 * most; // on the rising branch far out
  const Blown b(balloon(ElementType::T6, 8, law), arc);
  ASSERT_EQ(b.path.end, path::PathEnd::reached) << b.path.reason;
  const std::vector<double> limits = limits_of(b.path);
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_NEAR(limits[0], most, 1e-4 * most);
  EXPECT_NEAR(limits[1], least, 1e-4 * most);
  EXPECT_NEAR(b.points.back().second, 1.2 * most, 1e-9 * most);
  std::printf("Mooney-Rivlin: %.6f, %.6f Pa (exact %.6f, %.6f), last stretch %.3f, %d steps, %d iterations, %d "
              "factorisations\n",
              limits[0], limits[1], most, least, b.points.back().first, b.path.steps, b.newton.work().iterations,
              b.newton.work().factorizations);
}

TEST(Balloon, PressureControlStopsAtTheLimitPointAndNamesIt) {
  const material::MooneyRivlin law{shear / 2, 0};
  const double exact = analytical::limit_points(exact_of(law)).at(0).pressure;
  assembly::Model model = balloon(ElementType::T6, 8, law);
  model.chambers[0].gas = chamber::Regulated{0, 2 * exact};
  for (const int parts : {1, 20}) {
    assembly::System system(model, 1);
    path::Newton newton(system, {});
    assembly::Configuration at = tests::start_of(model);
    path::LoadPathOptions options;
    options.parts = parts;
    const path::PathResult result = path::follow_load(system, newton, at, options, {}, tests::tell);
    std::printf("%s (%d iterations, %d factorisations)\n", result.reason.c_str(), newton.work().iterations,
                newton.work().factorizations);
    ASSERT_EQ(result.end, path::PathEnd::stuck);
    ASSERT_EQ(result.critical.size(), 1u);
    EXPECT_NEAR(result.critical[0].pressures[0], exact, 1e-4 * exact);
    EXPECT_NE(result.reason.find("limit point at load factor 0.5"), std::string::npos) << result.reason;
    EXPECT_NEAR(result.load_factor, 0.5, 1e-3);
    EXPECT_LE(result.load_factor, 0.5 + 1e-4);
  }
}

// A square sheet of Mooney-Rivlin rubber pulled with equal dead forces along both sides: up to a stretch it stays
// square, beyond it could as well become oblong (Kearsley 1986, Int. J. Solids Structures 22, 111). With W of the
// stretches,
//   W11 = W12:  C1 (1 + s^-6) = C2 (s^2 - 3 s^-4),  traction 2 C1 (s - s^-5) + 2 C2 (s^3 - s^-3).
TEST(ControlledPath, BifurcationOfAnEquallyPulledSheetIsFoundAndNamed) {
  const material::MooneyRivlin law{0.2e6, 0.1e6};
  double low = 1.2, high = 2;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    (law.c1 * (1 + std::pow(s, -6)) > law.c2 * (s * s - 3 * std::pow(s, -4)) ? low : high) = s;
  }
  const auto traction = [&](double s) {
    return 2 * law.c1 * (s - std::pow(s, -5)) + 2 * law.c2 * (s * s * s - std::pow(s, -3));
  };
  const double side = 0.5;
  for (const ElementType element : {ElementType::Q4, ElementType::T3, ElementType::T6}) {
    assembly::Model model;
    model.mesh = geometry::meshing::stack(
        geometry::meshing::mesh_plan(geometry::Rectangle{side, side}, {element, {}, std::array{2, 2}}), {{"quarter"}});
    const std::size_t nodes = model.mesh.nodes.size();
    model.dead_to = VecX::Zero(static_cast<Eigen::Index>(3 * nodes));
    for (Vec3& x : model.mesh.nodes) x += Vec3(side / 2, side / 2, 0);
    for (const geometry::Edge& edge : model.mesh.edges) {
      if (edge.name != "east" && edge.name != "north") continue;
      const std::vector<double> weights = geometry::is_quadratic(element) ? std::vector{1.0 / 6, 4.0 / 6, 1.0 / 6}
                                                                          : std::vector{0.5, 0.5}; // of one side
      const std::size_t along = weights.size() - 1;
      for (std::size_t k = 0; k + along < edge.nodes.size(); k += along) {
        for (std::size_t a = 0; a <= along; ++a) {
          model.dead_to[3 * edge.nodes[k + a] + (edge.name == "east" ? 0 : 1)] += weights[a] * film * side / 2;
        }
      }
    }
    for (const Vec3& x : model.mesh.nodes) {
      for (int c = 0; c < 3; ++c) model.fixed.push_back(c == 2 || std::abs(x[c]) < 1e-9 ? 1 : 0);
    }
    model.foils.push_back(assembly::Foil{
        element::make_reference(element, geometry::StressRule::full,
                                element::corner_coordinates(model.mesh.blocks[0].connectivity, model.mesh.nodes),
                                Vec3(1, 0, 0)),
        law, film});
    model.dead_to *= traction(2); // load factor 1

    assembly::System system(model, 1);
    path::Newton newton(system, {});
    assembly::Configuration at = tests::start_of(model);
    path::ArcLengthPath arc;
    arc.load_factor = 0.6;
    const path::PathResult result = path::follow_control(system, newton, at, arc, {}, {}, tests::tell);
    ASSERT_EQ(result.end, path::PathEnd::reached) << result.reason;
    ASSERT_GE(result.critical.size(), 1u) << name_of(element); // the mesh has others, where it becomes uneven
    EXPECT_EQ(result.critical[0].kind, path::CriticalPoint::Kind::bifurcation);
    const double exact = traction(0.5 * (low + high)) / traction(2);
    EXPECT_NEAR(result.critical[0].load_factor, exact, 1e-4 * exact); // bisected to 1e-4 of a step
    std::printf("%s: bifurcation at load factor %.6f (exact %.6f), stretch %.4f\n", name_of(element),
                result.critical[0].load_factor, exact, low);
    // it stayed square, which is not stable any more
    EXPECT_EQ(newton.tangent().stability(at, nullptr).load_held, static_cast<int>(result.critical.size()));
    const Vec3 corner = path::farthest(system, -1, at).move;
    EXPECT_NEAR(corner.x(), corner.y(), 1e-7 * side);
  }
}

} // namespace
