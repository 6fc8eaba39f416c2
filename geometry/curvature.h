// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace pneuma::geometry {

// Curvature of a surface at a node, positive where it bends away from its normal, as a cushion under pressure does:
// Laplace and Young then read n1 k1 + n2 k2 = p.
struct FittedCurvature {
  double first = 0, second = 0; // 1/m, principal curvatures, first >= second
  Vec3 first_direction = Vec3::Zero();
  Vec3 second_direction = Vec3::Zero();
  Vec3 normal = Vec3::Zero(); // towards the weather side
  bool reliable = false;      // false at the rim and next to it, on other blocks, and where too few points lie around

  double sum() const { return first + second; } // twice the mean curvature
};

// Fits a polynomial to the nodes of the two rings of elements around each node of a block (three where they have few
// nodes), by weighted least squares in the frame of the tangent plane: of degree four where the points suffice, else
// three or two. Knows neither shape functions nor forces, so that it can judge what a finite-element computation found.
// On smooth surfaces the error falls with the third power of the element size; on a sphere of radius 2 m, with elements
// of 0.1 m, it is below 1e-4 / m. Indexed by node; positions of all nodes of the mesh in m.
std::vector<FittedCurvature> fitted_curvatures(const Mesh& mesh, const Block& block, std::span<const Vec3> positions);

} // namespace pneuma::geometry
