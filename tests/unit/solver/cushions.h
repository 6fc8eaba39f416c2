// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "solver/material/prestress.h"
#include "solver/path/load_path.h"

namespace pneuma::tests {

using base::Index;
using base::Vec3;
using base::VecX;
using geometry::ElementType;

// A cushion for tests: foils over one plan, each at height x shape above it; the shape is zero on the edge. SI units.
struct Cushion {
  geometry::Plan plan = geometry::Rectangle{2, 1};
  ElementType element = ElementType::T6;
  geometry::StressRule rule = geometry::StressRule::full;
  std::array<int, 2> divisions{4, 2};
  std::vector<double> heights{0.12, -0.12}; // m, one a foil, weather side first
  bool base = false;                        // a rigid base in the plane, below the foils
  double prestress = 0;                     // N/m at the given shape (predeformation); 0: free of stress there
  std::vector<double> thickness{250e-6};    // m, one for all or one a foil
  solver::material::StVenantKirchhoff law{900e6, 0.45};
  bool tension_field = false;
  Vec3 place = Vec3::Zero();               // m, of the plan's centre
  std::function<void(Vec3&)> distort = {}; // moves the plan's nodes before anything else; edges onto themselves
};

// 1 in the middle of the plan, 0 on its edge
inline double shape_over(const geometry::Plan& plan, const Vec3& x) {
  if (const auto* r = std::get_if<geometry::Rectangle>(&plan)) {
    const double u = 2 * x.x() / r->length;
    const double v = 2 * x.y() / r->width;
    return (1 - u * u) * (1 - v * v);
  }
  const double radius = std::get<geometry::Circle>(plan).radius;
  return 1 - (x.x() * x.x() + x.y() * x.y()) / (radius * radius);
}

// Foils with references and held edges; one chamber between each pair of neighbours, regulated at `pressure` Pa.
inline solver::assembly::Model model_of(const Cushion& cushion, double pressure) {
  using namespace solver;
  assembly::Model model;
  geometry::Mesh plan = geometry::meshing::mesh_plan(cushion.plan, {cushion.element, {}, cushion.divisions});
  if (cushion.distort) {
    for (Vec3& x : plan.nodes) cushion.distort(x);
  }
  std::vector<geometry::meshing::Layer> layers;
  for (std::size_t b = 0; b < cushion.heights.size(); ++b) layers.push_back({"foil " + std::to_string(b + 1)});
  if (cushion.base) layers.push_back({"base", geometry::BlockKind::base});
  model.mesh = geometry::meshing::stack(plan, layers);
  geometry::Mesh& mesh = model.mesh;
  model.fixed.assign(3 * mesh.nodes.size(), 0);
  const auto hold = [&](Index node) {
    for (std::size_t c = 0; c < 3; ++c) model.fixed[3 * static_cast<std::size_t>(node) + c] = 1;
  };
  for (const geometry::Edge& edge : mesh.edges) {
    for (const Index node : edge.nodes) hold(node);
  }
  if (cushion.base) {
    for (const Index node : mesh.blocks.back().connectivity) hold(node);
  }
  for (std::size_t b = 0; b < cushion.heights.size(); ++b) {
    for (const Index node : mesh.blocks[b].connectivity) {
      Vec3& x = mesh.nodes[static_cast<std::size_t>(node)];
      if (model.fixed[3 * static_cast<std::size_t>(node)] == 0)
        x.z() = cushion.heights[b] * shape_over(cushion.plan, x);
    }
  }
  for (Vec3& x : mesh.nodes) x += cushion.place;
  const material::Law law = cushion.tension_field
                                ? material::Law(material::TensionField<material::StVenantKirchhoff>{cushion.law})
                                : material::Law(cushion.law);
  for (std::size_t b = 0; b < cushion.heights.size(); ++b) {
    const double thickness = cushion.thickness.size() > 1 ? cushion.thickness[b] : cushion.thickness[0];
    std::vector<double> predeformation;
    if (cushion.prestress != 0) {
      const auto g = material::predeformation(law, thickness, Vec3(cushion.prestress, cushion.prestress, 0)).value();
      const std::size_t points = static_cast<std::size_t>(mesh.element_count(mesh.blocks[b])) *
                                 geometry::stress_rule(cushion.element, cushion.rule).size();
      for (std::size_t i = 0; i < points; ++i) predeformation.insert(predeformation.end(), {g[0], g[1], g[2]});
    }
    const std::vector<double> corners = element::corner_coordinates(mesh.blocks[b].connectivity, mesh.nodes);
    model.foils.push_back(
        assembly::Foil{element::make_reference(cushion.element, cushion.rule, corners, Vec3(1, 0, 0), predeformation),
                       law, thickness});
  }
  if (cushion.base) model.foils.emplace_back();
  for (std::size_t c = 0; c + 1 < mesh.blocks.size(); ++c) {
    model.chambers.push_back({"chamber " + std::to_string(c + 1), static_cast<Index>(c), static_cast<Index>(c + 1), 0.0,
                              solver::chamber::Regulated{pressure, pressure}, 0.0});
  }
  return model;
}

inline solver::assembly::Configuration start_of(const solver::assembly::Model& model, double load_factor = 0) {
  return {model.mesh.nodes, VecX::Zero(static_cast<Eigen::Index>(model.chambers.size())), load_factor};
}

// Moves every free coordinate by up to `amount` m at random, the same each time.
inline void shake(const solver::assembly::Model& model, std::vector<Vec3>& positions, double amount) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> d(-amount, amount);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (model.fixed[3 * i + c] == 0) positions[i][static_cast<Eigen::Index>(c)] += d(random);
    }
  }
}

// The tangent of one foil as a dense matrix, of the last evaluation.
inline base::MatX dense_tangent(const solver::assembly::System& system, std::size_t foil) {
  const solver::assembly::FoilEquations& equations = system.foils()[foil];
  const Index size = equations.pattern.size;
  base::MatX dense(size, size);
  for (Index j = 0; j < size; ++j) {
    dense.col(j) = solver::linear::multiply(equations.pattern, equations.tangent, VecX::Unit(size, j));
  }
  return dense;
}

// Prints each iteration if VERBOSE stands in the environment.
inline void tell(int step, const solver::path::Iteration& i) {
  if (std::getenv("VERBOSE") == nullptr) return;
  std::printf("  step %d it %d lambda %.4f residual %.3e gas %.3e length %.3g shift %.3g\n", step, i.number,
              i.load_factor, i.residual, i.gas, i.step_length, i.shift);
}

// A model and its solution at load factor 1.
// What happens where the cushion loses its shape.
enum class AtLimit : std::uint8_t { stop, snap };

struct Solved {
  solver::assembly::System system;
  solver::path::Newton newton;
  solver::assembly::Configuration at;
  solver::path::PathResult path;

  explicit Solved(solver::assembly::Model model, int parts = 1, int threads = 1)
      : system(std::move(model), threads), newton(system, {}), at(start_of(system.model())) {
    run(parts, AtLimit::stop);
  }
  Solved(solver::assembly::Model model, AtLimit at_limit)
      : system(std::move(model), 1), newton(system, {}), at(start_of(system.model())) {
    run(1, at_limit);
  }
  Solved(solver::assembly::Model model, solver::assembly::Configuration from, int parts = 1,
         AtLimit at_limit = AtLimit::stop)
      : system(std::move(model), 1), newton(system, {}), at(std::move(from)) {
    at.load_factor = 0;
    run(parts, at_limit);
  }
  // By Newton alone, from there with the whole load: foils may fold over on the way.
  Solved(solver::assembly::Model model, solver::assembly::Configuration from,
         const solver::path::NewtonOptions& options)
      : system(std::move(model), 1), newton(system, options), at(std::move(from)) {
    at.load_factor = 1;
    const solver::path::Newton::Outcome outcome =
        newton.solve(at, [](const solver::path::Iteration& i) { tell(1, i); });
    path.end = outcome.converged ? solver::path::PathEnd::reached : solver::path::PathEnd::stuck;
    path.reason = outcome.reason;
  }
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;

  bool converged() const { return path.end == solver::path::PathEnd::reached; }
  int iterations() const { return newton.work().iterations; }
  // of a block's nodes, m
  double highest(std::size_t block = 0) const {
    double z = -1e300;
    for (const Index node : system.model().mesh.blocks[block].connectivity) {
      z = std::max(z, at.positions[static_cast<std::size_t>(node)].z());
    }
    return z;
  }
  double lowest(std::size_t block) const {
    double z = 1e300;
    for (const Index node : system.model().mesh.blocks[block].connectivity) {
      z = std::min(z, at.positions[static_cast<std::size_t>(node)].z());
    }
    return z;
  }

private:
  void run(int parts, AtLimit at_limit) {
    solver::path::LoadPathOptions options;
    options.parts = parts;
    options.snaps = at_limit == AtLimit::snap;
    path = solver::path::follow_load(system, newton, at, options, {}, tell);
  }
};

// Air that is in the chamber now stays there.
inline solver::chamber::Closed closed_now(const Solved& from, Index chamber, double ambient, double kappa = 1) {
  solver::chamber::Closed gas;
  gas.kappa = kappa;
  gas.ambient_from = gas.ambient_to = ambient;
  gas.absolute0 = from.at.pressures[chamber] + ambient;
  gas.volume0 = from.system.chamber_volume(chamber);
  return gas;
}

inline const auto every_element = testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9);
inline std::string element_name(const testing::TestParamInfo<ElementType>& type) {
  return geometry::name_of(type.param);
}

} // namespace pneuma::tests
