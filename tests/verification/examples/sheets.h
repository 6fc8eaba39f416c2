// SPDX-License-Identifier: GPL-3.0-or-later
// Flat sheets that stay in their plane, and how the examples pull them. SI units.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/unit/solver/cushions.h"

namespace pneuma::tests {

// A quarter of a rectangular sheet with a hole in the middle of it, which is the origin: `width` along x, `height`
// along y, Q4. Around the hole a square of side `width`, mapped from the hole's quarter circle to its sides
// (transfinite): `radial` elements outwards, twice `side` along the hole; above it `above` rows of `side` elements to
// the height.
struct PerforatedSheet {
  double width = 0, height = 0, radius = 0; // m
  int radial = 0, side = 0, above = 0;
};
geometry::Mesh mesh_of(const PerforatedSheet& sheet);

// A whole rectangle from the origin on, `across` x `along` Q4.
geometry::Mesh rectangle(double width, double height, int across, int along);

// The sheet with its symmetry lines x = 0 and y = 0 and its plane held; axis 1 of the material along x.
solver::assembly::Model plane_model(const geometry::Mesh& mesh, const solver::material::Law& law, double thickness);

// Nodes with this coordinate, in the order of the other.
std::vector<Index> nodes_at(const geometry::Mesh& mesh, int component, double value);

// A dead force per length of the undeformed edge at the nodes, N/m, along a component, from load factor 0 to 1.
void pull_edge(solver::assembly::Model& model, const std::vector<Index>& edge, int component, double force);

// Moves the nodes along a component, m, from load factor 0 to 1; the other components are as they were.
void move_edge(solver::assembly::Model& model, const std::vector<Index>& edge, int component, double displacement);

// Sum of the frame's forces on nodes, N.
double reaction(const solver::assembly::System& system, const std::vector<Index>& nodes, int component);

// Newton's method without any help at the configuration's load factor: the norms of its displacements, m, until one is
// below `enough` m or an element fails, `most` at most.
struct PlainNewton {
  bool converged = false;
  std::vector<double> norms;
};
PlainNewton plain_newton(solver::assembly::System& system, solver::assembly::Configuration& at, double enough,
                         int most);

// Moves a state in equilibrium to a load factor along its tangent.
void predict(solver::assembly::System& system, solver::assembly::Configuration& at, double load_factor);

} // namespace pneuma::tests
