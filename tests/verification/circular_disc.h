// SPDX-License-Identifier: GPL-3.0-or-later
// Example B8 (Coelho 2012, sec. 5.4; data of Bouzidi, Ravaut and Wielgosz 2003): a flat circular membrane, clamped at
// its rim over a rigid base, inflated and then pressed from outside; as a model and as exact axisymmetric solution.
#pragma once

#include <algorithm>
#include <map>
#include <tuple>

#include "geometry/meshing/plan_mesh.h"
#include "solver/analytical/circular_membrane.h"
#include "solver/linear/blas.h"
#include "solver/material/prestress.h"
#include "solver/path/load_path.h"

namespace pneuma::tests {

using base::Index;
using base::Vec3;
using base::VecX;
using geometry::ElementType;
using solver::analytical::CircularMembrane;
using solver::analytical::InflatedCircle;

constexpr double disc_radius = 0.1425;    // m
constexpr double disc_stiffness = 311488; // E h, N/m
constexpr double disc_poisson = 0.34;
constexpr double disc_thickness = 1e-3;    // m
constexpr double closing_pressure = 400e3; // Pa, gauge, at which the air is shut in

inline CircularMembrane disc(double pretension) {
  return {disc_radius, disc_stiffness, disc_poisson, pretension};
}

// What acts on the disc. SI units, pressures in Pa.
struct DiscCase {
  double pretension = 0;
  double inside = 0;  // gauge, to which it is inflated
  double outside = 0; // gauge, that presses on it then
  double kappa = 0;   // of the air shut in; 0: held at `inside`
  double ambient = 0; // 0: the thesis' gas law
};

// Every case of B8 with this pretension under outside pressure.
inline std::vector<DiscCase> pressed_cases(double pretension) {
  std::vector<DiscCase> cases;
  for (const double outside : {150e3, 300e3}) {
    cases.push_back({pretension, closing_pressure, outside, 0, 0});
    for (const double ambient : {0.0, 101325.0}) {
      for (const double kappa : {1.0, 1.4}) cases.push_back({pretension, closing_pressure, outside, kappa, ambient});
    }
  }
  return cases;
}

// The exact solution, solved once in a program; relative error below 1e-8 with 1000 steps, 1e-9 with 2000.
inline const InflatedCircle& exact_disc(const DiscCase& c, int steps = 1000) {
  static std::map<std::tuple<double, double, double, double, double, int>, InflatedCircle> solved;
  const std::tuple key(c.pretension, c.inside, c.outside, c.kappa, c.ambient, steps);
  const auto found = solved.find(key);
  if (found != solved.end()) return found->second;
  const CircularMembrane membrane = disc(c.pretension);
  if (c.kappa == 0) {
    return solved[key] = solver::analytical::inflate(membrane, c.inside - c.outside, steps).value();
  }
  const double volume = exact_disc({c.pretension, c.inside}, steps).volume;
  return solved[key] = solver::analytical::inflate_closed(membrane, c.inside + c.ambient, volume, c.kappa, c.ambient,
                                                          c.outside, steps)
                           .value();
}

inline solver::assembly::Model flat_disc(ElementType type, int divisions, double pressure, double pretension) {
  using namespace solver;
  assembly::Model model;
  const geometry::Mesh plan =
      geometry::meshing::mesh_plan(geometry::Circle{disc_radius}, {type, {}, std::array{divisions, divisions}});
  model.mesh =
      geometry::meshing::stack(plan, {{"membrane", geometry::BlockKind::foil}, {"base", geometry::BlockKind::base}});
  model.fixed.assign(3 * model.mesh.nodes.size(), 0);
  const auto hold = [&](Index node) {
    for (std::size_t c = 0; c < 3; ++c) model.fixed[3 * static_cast<std::size_t>(node) + c] = 1;
  };
  for (const Index node : model.mesh.edges[0].nodes) hold(node);
  for (const Index node : model.mesh.blocks[1].connectivity) hold(node);
  const std::vector<double> corners = element::corner_coordinates(model.mesh.blocks[0].connectivity, model.mesh.nodes);
  const material::StVenantKirchhoff law{disc_stiffness / disc_thickness, disc_poisson};
  const Vec3 g = material::predeformation(law, disc_thickness, Vec3(pretension, pretension, 0)).value();
  std::vector<double> predeformation;
  const std::size_t points =
      static_cast<std::size_t>(model.mesh.element_count(model.mesh.blocks[0])) * geometry::stress_rule(type).size();
  for (std::size_t i = 0; i < points; ++i) predeformation.insert(predeformation.end(), {g[0], g[1], g[2]});
  model.foils.push_back(
      assembly::Foil{element::make_reference(type, geometry::StressRule::full, corners, Vec3(1, 0, 0), predeformation),
                     law, disc_thickness});
  model.foils.emplace_back();
  model.chambers.push_back({"main", 0, 1, 0.0, chamber::Regulated{0, pressure}, 0.0});
  return model;
}

struct SolvedDisc {
  double deflection = 0, volume = 0; // m, m3
  double gauge = 0;                  // Pa, inside
  Index unknowns = 0;
  int iterations = 0, steps = 0;
  bool converged = false;
};

// Follows the load from where the disc is.
inline SolvedDisc solve_disc(const solver::assembly::Model& model, solver::assembly::Configuration& at) {
  using namespace solver;
  linear::prepare_blas(1); // as the programs do: small factors wait for threads longer than they work
  assembly::System system(model, 1);
  path::Newton newton(system, {});
  at.load_factor = 0;
  const path::PathResult result = path::follow_load(system, newton, at, {}, {});
  SolvedDisc s;
  s.converged = result.end == path::PathEnd::reached;
  for (const Vec3& x : at.positions) s.deflection = std::max(s.deflection, x.z());
  s.volume = system.chamber_volume(0);
  s.gauge = at.pressures[0];
  s.unknowns = system.unknowns();
  s.iterations = newton.work().iterations;
  s.steps = result.steps;
  return s;
}

// A disc at the pressure to which it was inflated from its flat state.
struct InflatedDisc {
  solver::assembly::Model model;
  solver::assembly::Configuration at;
  SolvedDisc state;
};

inline InflatedDisc inflated_disc(ElementType type, int divisions, double pressure, double pretension) {
  InflatedDisc disc{flat_disc(type, divisions, pressure, pretension), {}, {}};
  disc.at = {disc.model.mesh.nodes, VecX::Zero(1), 0};
  disc.state = solve_disc(disc.model, disc.at);
  return disc;
}

// What becomes of it under the outside pressure of `c`.
inline SolvedDisc press(const InflatedDisc& disc, const DiscCase& c) {
  using namespace solver;
  assembly::Model model = disc.model;
  assembly::Configuration at = disc.at;
  if (c.kappa == 0) {
    model.chambers[0].gas = chamber::Regulated{c.inside, c.inside};
  } else {
    chamber::Closed gas;
    gas.kappa = c.kappa;
    gas.absolute0 = c.inside + c.ambient;
    gas.volume0 = disc.state.volume;
    gas.ambient_from = gas.ambient_to = c.ambient;
    model.chambers[0].gas = gas;
  }
  model.face_pressure = {{0, -c.outside}, {0, 0}};
  return solve_disc(model, at);
}

} // namespace pneuma::tests
