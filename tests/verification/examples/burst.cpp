// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/verification/examples/burst.h"

#include <map>
#include <numbers>

#include "solver/linear/blas.h"

namespace pneuma::tests {

using namespace solver;

material::Flow burst_flow(bool tangent) {
  const auto plastic = [&](double modulus) {
    return tangent ? modulus / (1 - modulus / burst_elasticity.youngs_modulus) : modulus;
  };
  const material::HardeningBranch branches[] = {{14e6, plastic(120e6)}, {32e6, plastic(30e6)}};
  return {material::piecewise_linear(branches).value(), {}};
}

assembly::Model burst_disc(ElementType element, int divisions, const material::Law& law) {
  assembly::Model model;
  geometry::Mesh& mesh = model.mesh;
  mesh.element = element;
  mesh.blocks.push_back({"foil", geometry::BlockKind::foil, {}});
  mesh.blocks.push_back({"nothing", geometry::BlockKind::base, {}}); // the planes are the other walls
  // a square of divisions^2 onto the quarter: its rings max(i, j) become circles (Shirley and Chiu 1997)
  const int per_side = divisions + 1;
  for (int j = 0; j < per_side; ++j) {
    for (int i = 0; i < per_side; ++i) {
      const int ring = std::max(i, j);
      const double part = ring == 0 ? 0 : static_cast<double>(std::min(i, j)) / ring;
      const double angle = j <= i ? part * std::numbers::pi / 4 : (2 - part) * std::numbers::pi / 4;
      Vec3 x = burst_radius * ring / divisions * Vec3(std::cos(angle), std::sin(angle), 0);
      if (i == 0) x.x() = 0; // not the cosine's rounding
      mesh.nodes.push_back(x);
    }
  }
  const auto is_rim = [&](Index a, Index b) {
    const auto on_rim = [&](Index n) { return n % per_side == divisions || n / per_side == divisions; };
    return on_rim(a) && on_rim(b);
  };
  std::map<std::uint64_t, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [found, is_new] = middles.try_emplace(geometry::side_key(a, b), static_cast<Index>(mesh.nodes.size()));
    if (is_new) {
      Vec3 x = 0.5 * (mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)]);
      if (is_rim(a, b)) x = burst_radius * x.normalized();
      mesh.nodes.push_back(x);
    }
    return found->second;
  };
  const auto add = [&](Index a, Index b, Index c) {
    std::vector<Index>& nodes = mesh.blocks[0].connectivity;
    nodes.insert(nodes.end(), {a, b, c});
    if (element == ElementType::T6) nodes.insert(nodes.end(), {middle(a, b), middle(b, c), middle(c, a)});
  };
  for (int j = 0; j < divisions; ++j) {
    for (int i = 0; i < divisions;
         ++i) { // the diagonal leads outwards: at 45 degrees a quadrangle has a straight angle
      const Index a = j * per_side + i;
      add(a, a + 1, a + per_side + 1);
      add(a, a + per_side + 1, a + per_side);
    }
  }
  for (const Vec3& x : mesh.nodes) {
    const bool rim = x.norm() > burst_radius * (1 - 1e-9);
    for (int c = 0; c < 3; ++c) model.fixed.push_back(rim || (c < 2 && x[c] == 0) ? 1 : 0);
  }
  model.foils.push_back(assembly::Foil{
      element::make_reference(element, geometry::StressRule::full,
                              element::corner_coordinates(mesh.blocks[0].connectivity, mesh.nodes), Vec3(1, 0, 0)),
      law, burst_thickness});
  model.foils.emplace_back();
  model.chambers.push_back({"inside", 0, 1, 0.0, chamber::Regulated{0, burst_load}, 0.0});
  model.origin = Vec3::Zero();
  return model;
}

Burst::Burst(assembly::Model model, const path::PathControl& control, const path::ControlledPathOptions& options)
    : system(std::move(model), 1), newton(system, {}), at(start_of(system.model())) {
  linear::prepare_blas(1); // as the programs do
  std::vector<int> steps;
  path = path::follow_control(
      system, newton, at, control, options,
      [&](const path::Step& step, const assembly::Configuration& c) {
        points.push_back({c.positions[0].z(), c.pressures[0], system.chamber_volume(0)});
        steps.push_back(step.number);
      },
      tell);
  for (const path::CriticalPoint& point : path.critical) {
    if (point.kind != path::CriticalPoint::Kind::limit) continue;
    peak = points[static_cast<std::size_t>(point.step - 1)];
    break;
  }
}

} // namespace pneuma::tests
