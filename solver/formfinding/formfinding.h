// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/quadrature.h"

namespace pneuma::solver::formfinding {

using base::Index;
using base::Vec3;

// A foil whose form is sought: isotropic prestress and the pressure that it carries.
struct Target {
  Index block = 0;
  double tension = 0;  // force per current length, N/m, > 0
  double pressure = 0; // net, along the block's normal, Pa
};

struct Options {
  double tolerance = 1e-11; // force across the surface, relative to tension x sqrt(area)
  int max_updates = 200;    // of the reference
  geometry::StressRule rule = geometry::StressRule::full;
};

// How the search ended.
enum class Verdict : std::uint8_t {
  converged,
  swimming,       // still moving when the updates ran out
  no_equilibrium, // the form lost its stiffness or collapsed on the way: none exists near here
};

struct Update {
  int number = 0;
  double residual = 0; // across the surface, relative
  double move = 0;     // largest displacement, m
  double current = 0;  // share of the current-surface stress in the tangent (homotopy)
};

struct Form {
  Verdict verdict = Verdict::swimming;
  std::string reason;
  int updates = 0;
  int factorizations = 0;
  double residual = 0;         // across the surface, relative to the film's forces
  double residual_along = 0;   // along it: what the mesh leaves, falls with refinement
  double area = 0;             // m2
  bool stable = false;         // the film's second variation is positive at the end
  std::vector<Vec3> positions; // all nodes of the mesh; only this block's free ones moved
};

// Finds the film in equilibrium, tension n and pressure p on every point: p = n (k1 + k2), by the updated reference
// strategy (Bletzinger and Ramm 1999; homotopy between the stress on the reference and on the current surface). First
// updates take the reference stress alone: always stiff, they move the nodes along the surface too and keep the mesh
// even. Near the form the current stress alone is taken and the nodes move across the surface only: Newton's method for
// tension x area - pressure x volume, quadratic, without the film's freedom to flow along itself.
// `fixed` [node][3]; a node is held if any of its coordinates is.
Form find_form(const geometry::Mesh& mesh, const std::vector<std::uint8_t>& fixed, std::vector<Vec3> positions,
               const Target& target, const Options& options, const std::function<void(const Update&)>& report = {});

// What to tell the user where find_form found no equilibrium under pressure: the largest pressure that this edge and
// tension have a film for, by bisection to 1 %, and the tension that would carry the wanted pressure (films with equal
// p/n have equal forms). None if not even a hundredth of the pressure has a film.
struct Limit {
  double largest_pressure = 0; // Pa, at the given tension
  double needed_tension = 0;   // N/m, at the given pressure
};
std::optional<Limit> find_limit(const geometry::Mesh& mesh, const std::vector<std::uint8_t>& fixed,
                                const std::vector<Vec3>& positions, const Target& target, const Options& options);

} // namespace pneuma::solver::formfinding
