// SPDX-License-Identifier: GPL-3.0-or-later
// Flat discs of rubber, clamped and free of stress, blown through their limit points, against the exact solution.
#include "solver/analytical/circular_membrane.h"
#include "solver/analytical/root.h"
#include "solver/linear/blas.h"
#include "solver/path/controlled_path.h"
#include "tests/unit/solver/cushions.h"

namespace {

using namespace pneuma;
using namespace pneuma::solver;
using geometry::ElementType;

constexpr double radius = 0.1, film = 1e-3, c1 = 0.2e6; // m, m, Pa

// Load factor 1: `pressure` Pa.
assembly::Model disc_of(ElementType element, int divisions, const material::Law& law, double pressure) {
  tests::Cushion c;
  c.plan = geometry::Circle{radius};
  c.element = element;
  c.divisions = {divisions, divisions};
  c.heights = {0};
  c.base = true;
  c.thickness = {film};
  assembly::Model model = tests::model_of(c, 0);
  model.foils[0]->law = law;
  model.chambers[0].gas = chamber::Regulated{0, pressure};
  return model;
}

analytical::CircularDisc exact_of(const material::MooneyRivlin& law) {
  return {radius, film, analytical::MooneyRivlin{law.c1, law.c2}};
}

// The state of a deflection, which grows with the pole's stretch.
analytical::InflatedCircle exact_at(const analytical::CircularDisc& disc, double deflection) {
  const double stretch = analytical::root_between(
      1 + 1e-6, 30, [&](double l) { return analytical::inflate_to(disc, l, 1000)->deflection - deflection; });
  return analytical::inflate_to(disc, stretch, 1000).value();
}

struct Blown {
  assembly::System system;
  path::Newton newton;
  assembly::Configuration at;
  path::PathResult path;
  std::vector<std::array<double, 2>> points; // deflection, pressure

  Blown(assembly::Model model, const path::PathControl& control)
      : system(std::move(model), 1), newton(system, {}), at(tests::start_of(system.model())) {
    path = path::follow_control(
        system, newton, at, control, {},
        [&](const path::Step&, const assembly::Configuration& c) {
          double highest = 0;
          for (const base::Vec3& x : c.positions) highest = std::max(highest, x.z());
          points.push_back({highest, c.pressures[0]});
        },
        tests::tell);
  }
  std::vector<double> limits() const {
    std::vector<double> pressures;
    for (const path::CriticalPoint& point : path.critical) {
      if (point.kind == path::CriticalPoint::Kind::limit) pressures.push_back(point.pressures[0]);
    }
    return pressures;
  }
  void tell(const char* name) const {
    std::printf("%-40s %d / %d / %d, %zu critical points, ends at %.4f m, %.2f Pa\n", name, path.steps,
                newton.work().iterations, newton.work().factorizations, path.critical.size(), points.back()[0],
                points.back()[1]);
  }
};

class RubberDisc : public testing::TestWithParam<ElementType> {
protected:
  static void SetUpTestSuite() { linear::prepare_blas(1); } // as the programs do
  bool quadratic() const { return geometry::is_quadratic(GetParam()); }
  std::array<int, 2> meshes() const { return quadratic() ? std::array{3, 6} : std::array{6, 12}; }
};
INSTANTIATE_TEST_SUITE_P(HardCases, RubberDisc, testing::Values(ElementType::T3, ElementType::T6),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(RubberDisc, NeoHookeanPassesItsLimitPressureByEveryControl) {
  const material::MooneyRivlin law{c1, 0};
  const std::vector<analytical::InflatedCircle> exact = analytical::limit_points(exact_of(law));
  ASSERT_EQ(exact.size(), 1u);
  const double most = exact[0].pressure, until = 2 * radius;
  const analytical::InflatedCircle end = exact_at(exact_of(law), until);
  std::array<double, 2> errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const int divisions = meshes()[i];
    path::ArcLengthPath arc;
    arc.displacement = until;
    const Blown a(disc_of(GetParam(), divisions, law, 1000), arc);
    const Blown v(disc_of(GetParam(), divisions, law, 1000), path::VolumePath{0, end.volume});
    const Blown d(disc_of(GetParam(), divisions, law, 1000), path::LargestDisplacementPath{0, until});
    a.tell("arc length");
    v.tell("volume");
    d.tell("largest displacement");
    for (const Blown* b : {&a, &v, &d}) {
      ASSERT_EQ(b->path.end, path::PathEnd::reached) << b->path.reason;
      ASSERT_EQ(b->limits().size(), 1u);
      EXPECT_NEAR(b->limits()[0], a.limits()[0], 1e-8 * most); // the mesh's limit point, whatever the control
    }
    EXPECT_NEAR(a.points.back()[1], d.points.back()[1], 1e-7 * most);
    errors[i] = std::abs(a.limits()[0] / most - 1);
    std::printf("%s %d: limit %.4f Pa (exact %.4f, pole stretch %.4f), error %.2e; at the end %.4f (%.4f)\n",
                name_of(GetParam()), divisions, a.limits()[0], most, exact[0].pole_stretch, errors[i],
                a.points.back()[1], end.pressure);
    if (i == 0) continue;
    // the few elements along the widest parallel err more than at the limit point; T6 with 12 divisions 2e-4
    EXPECT_NEAR(a.points.back()[1], end.pressure, (quadratic() ? 5e-3 : 2e-2) * end.pressure);
  }
  EXPECT_LT(errors[1], errors[0] / (quadratic() ? 6 : 3)); // near third and second order
  EXPECT_LT(errors[1], quadratic() ? 1e-3 : 1e-2);
}

TEST_P(RubberDisc, MooneyRivlinFallsAndRisesAgain) {
  const material::MooneyRivlin law{c1, 0.04 * c1};
  const std::vector<analytical::InflatedCircle> exact = analytical::limit_points(exact_of(law));
  ASSERT_EQ(exact.size(), 2u);
  const double most = exact[0].pressure, least = exact[1].pressure;
  path::ArcLengthPath arc;
  arc.pressure = 1.1 * most; // on the rising branch far out
  const Blown b(disc_of(GetParam(), meshes()[1], law, 1000), arc);
  b.tell("Mooney-Rivlin");
  ASSERT_EQ(b.path.end, path::PathEnd::reached) << b.path.reason;
  ASSERT_EQ(b.limits().size(), 2u);
  std::printf("%s: %.4f, %.4f Pa (exact %.4f, %.4f)\n", name_of(GetParam()), b.limits()[0], b.limits()[1], most, least);
  EXPECT_NEAR(b.limits()[0], most, (quadratic() ? 1e-3 : 1e-2) * most);
  EXPECT_NEAR(b.limits()[1], least, (quadratic() ? 1e-2 : 5e-2) * most);
}

TEST_P(RubberDisc, PressureControlStopsAtTheLimitPointAndNamesIt) {
  const material::MooneyRivlin law{c1, 0};
  const double exact = analytical::limit_points(exact_of(law)).at(0).pressure;
  const double error = quadratic() ? 1e-3 : 1e-2; // as above
  for (const int parts : {1, 20}) {
    assembly::System system(disc_of(GetParam(), meshes()[1], law, 2 * exact), 1);
    path::Newton newton(system, {});
    assembly::Configuration at = tests::start_of(system.model());
    path::LoadPathOptions options;
    options.parts = parts;
    const path::PathResult result = path::follow_load(system, newton, at, options, {}, tests::tell);
    std::printf("%s: %s (%d / %d / %d)\n", name_of(GetParam()), result.reason.c_str(), result.steps,
                newton.work().iterations, newton.work().factorizations);
    ASSERT_EQ(result.end, path::PathEnd::stuck);
    ASSERT_EQ(result.critical.size(), 1u);
    EXPECT_NEAR(result.critical[0].pressures[0], exact, error * exact);
    EXPECT_NE(result.reason.find("limit point at load factor 0.5"), std::string::npos) << result.reason;
    EXPECT_NEAR(result.load_factor, 0.5, 1e-3 + 0.5 * error);
    EXPECT_LE(result.load_factor, result.critical[0].load_factor + 1e-9);
  }
}

TEST_P(RubberDisc, WithoutALimitPointPressureControlBlowsItUpAllTheWay) {
  const material::MooneyRivlin law{c1, 0.1 * c1};
  ASSERT_TRUE(analytical::limit_points(exact_of(law)).empty());
  const analytical::InflatedCircle exact = exact_at(exact_of(law), 1.5 * radius);
  assembly::System system(disc_of(GetParam(), meshes()[1], law, exact.pressure), 1);
  path::Newton newton(system, {});
  assembly::Configuration at = tests::start_of(system.model());
  const path::PathResult result = path::follow_load(system, newton, at, {}, {}, tests::tell);
  ASSERT_EQ(result.end, path::PathEnd::reached) << result.reason;
  double highest = 0;
  for (const base::Vec3& x : at.positions) highest = std::max(highest, x.z());
  std::printf("%s: %.5f m (exact %.5f), %d / %d / %d\n", name_of(GetParam()), highest, exact.deflection, result.steps,
              newton.work().iterations, newton.work().factorizations);
  EXPECT_NEAR(highest, exact.deflection, (quadratic() ? 2e-3 : 5e-2) * exact.deflection); // a nearly level pressure
}

} // namespace
