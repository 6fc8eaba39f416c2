// SPDX-License-Identifier: GPL-3.0-or-later
// Example B8 (Coelho 2012, sec. 5.4; data of Bouzidi, Ravaut and Wielgosz 2003): a flat circular membrane, clamped at
// its rim, against the exact axisymmetric solution.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "geometry/volume.h"
#include "solver/analytical/circular_membrane.h"
#include "solver/path/load_path.h"

namespace {

using namespace pneuma;
using namespace pneuma::geometry;
using namespace pneuma::solver;
using base::VecX;

constexpr double radius = 0.1425;
constexpr double stiffness = 311488; // E h, N/m
constexpr double poisson = 0.34;
constexpr double thickness = 1e-3;

assembly::Model flat_disc(ElementType type, int divisions, double pressure) {
  assembly::Model model;
  const Mesh plan = meshing::mesh_plan(Circle{radius}, {type, {}, std::array{divisions, divisions}});
  model.mesh = meshing::stack(plan, {{"membrane", BlockKind::foil}, {"base", BlockKind::base}});
  model.fixed.assign(3 * model.mesh.nodes.size(), 0);
  const auto hold = [&](Index node) {
    for (std::size_t c = 0; c < 3; ++c) model.fixed[3 * static_cast<std::size_t>(node) + c] = 1;
  };
  for (const Index node : model.mesh.edges[0].nodes) hold(node);
  for (const Index node : model.mesh.blocks[1].connectivity) hold(node);
  const std::vector<double> corners = element::corner_coordinates(model.mesh.blocks[0].connectivity, model.mesh.nodes);
  model.foils.push_back(assembly::Foil{element::make_reference(type, StressRule::full, corners, Vec3(1, 0, 0)),
                                       material::StVenantKirchhoff{stiffness / thickness, poisson}, thickness});
  model.foils.emplace_back();
  model.chambers.push_back({"main", 0, 1, 0.0, chamber::Regulated{0, pressure}, 0.0});
  return model;
}

struct Solved {
  double deflection = 0, volume = 0;
  int iterations = 0, steps = 0;
  bool converged = false;
};

Solved inflate(ElementType type, int divisions, double pressure) {
  assembly::System system(flat_disc(type, divisions, pressure), 1);
  path::Newton newton(system, {});
  assembly::Configuration c{system.model().mesh.nodes, VecX::Zero(1), 0};
  const path::PathResult result = path::follow_load(system, newton, c, {}, {}, [](int step, const path::Iteration& i) {
    if (std::getenv("VERBOSE")) {
      std::printf("  step %d it %d lambda %.4f residual %.3e length %.3g shift %.3g\n", step, i.number, i.load_factor,
                  i.residual, i.step_length, i.shift);
    }
  });
  Solved s;
  s.converged = result.end == path::PathEnd::reached;
  for (const Vec3& x : c.positions) s.deflection = std::max(s.deflection, x.z());
  s.volume = system.chamber_volume(0);
  s.iterations = newton.work().iterations;
  s.steps = result.steps;
  return s;
}

TEST(CircularMembrane, ExactSolutionConvergesAndBalances) {
  const analytical::CircularMembrane membrane{radius, stiffness, poisson, 0};
  for (const double pressure : {100e3, 250e3, 400e3}) {
    const auto fine = analytical::inflate(membrane, pressure, 12000);
    const auto coarse = analytical::inflate(membrane, pressure, 6000);
    ASSERT_TRUE(fine && coarse);
    EXPECT_NEAR(coarse->deflection, fine->deflection, 1e-10 * fine->deflection);
    EXPECT_NEAR(coarse->volume, fine->volume, 1e-10 * fine->volume);
    // Laplace at the apex: p = 2 T / R from three points of the meridian is an independent check
    const auto& m = fine->meridian;
    const analytical::MeridianPoint& point = m[m.size() - 1600];
    const double curvature = 2 * (fine->deflection - point.height) /
                             (point.radius * point.radius + std::pow(fine->deflection - point.height, 2));
    EXPECT_NEAR(2 * fine->apex_tension * curvature, pressure, 0.01 * pressure);
    std::printf("exact: p %.0f kPa deflection %.8f m volume %.8f m3 tension %.2f N/m\n", pressure / 1e3,
                fine->deflection, fine->volume, fine->apex_tension);
  }
}

class EveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(CircularMembrane, EveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(EveryElement, InflatesFromFlatToTheExactSolutionWithItsOrder) {
  const analytical::CircularMembrane membrane{radius, stiffness, poisson, 0};
  for (const double pressure : {100e3, 400e3}) {
    const auto exact = analytical::inflate(membrane, pressure);
    std::array<double, 3> deflection_error{}, volume_error{};
    const int first = is_quadratic(GetParam()) ? 2 : 8;
    for (std::size_t k = 0; k < 3; ++k) {
      const Solved s = inflate(GetParam(), first << k, pressure);
      ASSERT_TRUE(s.converged);
      deflection_error[k] = std::abs(s.deflection / exact->deflection - 1);
      volume_error[k] = std::abs(s.volume / exact->volume - 1);
      std::printf("%s divisions %d p %.0f: deflection error %.3e volume error %.3e (%d iterations, %d steps)\n",
                  name_of(GetParam()), first << k, pressure, deflection_error[k], volume_error[k], s.iterations,
                  s.steps);
    }
    const double wanted = is_quadratic(GetParam()) ? 3.5 : 1.9;
    EXPECT_GT(std::log2(deflection_error[1] / deflection_error[2]), wanted);
    EXPECT_GT(std::log2(volume_error[1] / volume_error[2]), wanted);
  }
}

} // namespace
