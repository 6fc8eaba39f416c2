// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/quadrature.h"

namespace pneuma::solver::flattening {

using base::Index;
using base::Mat3;
using base::Vec2;
using base::Vec3;
using geometry::ElementType;

// The nodes of the flat strips of one foil: a node on a seam is one node in each of its strips.
struct FlatNodes {
  std::vector<Index> connectivity; // [element][node], numbers of flat nodes
  std::vector<Index> node;         // [flat node], of the mesh
  std::vector<Index> strip;        // [flat node]
};

// Flat nodes in the order in which the elements meet them, strip by strip.
FlatNodes flat_nodes(ElementType element, std::span<const Index> connectivity, std::span<const Index> strip_of_element,
                     Index strips);

// A condition on lengths in the plane: of the side from a[0] to a[1], less that of the side from b[0] to b[1] (none:
// b[0] < 0), is `value`. Two mating sides of a seam have value 0.
struct LengthTie {
  Index a[2];
  Index b[2] = {-1, -1};
  double value = 0; // m
};

struct Problem {
  ElementType element = ElementType::T3;
  geometry::StressRule rule = geometry::StressRule::full;
  const FlatNodes* nodes = nullptr;
  std::vector<Vec3> form; // [flat node], m: where it lies on the form
  // Wanted stretch from the flat strip to the form [element][point][3] = (G11, G22, G12), symmetric, in the frame of
  // the plane (x: roll direction); empty: identity (no compensation)
  std::vector<double> stretch;
  // Weight of the deviation strain (e11, e22, 2 e12): D^T diag(1, 1, 2) D for the square of the stress that the law D
  // answers with
  Mat3 weight = Mat3::Identity();
  std::vector<LengthTie> ties;
};

struct Options {
  double tolerance = 1e-13; // largest move of the last step, relative to the extent
  int max_iterations = 60;
};

struct Iteration {
  int number = 0;
  double deviation = 0; // root mean square of the deviation strain's weighted norm
  double move = 0;      // m, largest
  double tie = 0;       // m, largest violation
};

struct Flat {
  bool converged = false;
  int iterations = 0;
  int factorizations = 0;
  std::vector<Vec2> points; // [flat node], m
};

// The flat strips whose stretch to the form is nearest to the wanted one, all strips of a foil in one system: least
//   1/2 int e : weight : e dA over the form,   e = (I - G f f^T G) / 2,   f = d plane / d form,
// under the ties. f f^T = C^-1 is quadratic in the coordinates, e the strain by which the wanted stress is missed
// (first order), in the frame of the plane, so that orthotropy and compensation by directions keep to the roll. Related
// to the least squares of Linhard (2009) with the flat shape as unknown. Gauss-Newton with a line search that keeps all
// stress points unfolded (the exact Hessian is not always positive and took 7 instead of 4 factorisations a foil of 1e5
// triangles); ties by augmented Lagrangian. Every strip keeps the place and direction of `start`: three
// coordinates of two far nodes stay. Elements of `start` must not be turned over.
Flat flatten(const Problem& problem, std::vector<Vec2> start, const Options& options = {},
             const std::function<void(const Iteration&)>& report = {});

// Value, gradient [2 flat node + component] and Gauss-Newton matrix (dense; for tests) of the function above with given
// multipliers and a penalty on the ties.
struct Value {
  double value = 0;
  base::VecX gradient;
  base::MatX matrix;
};
Value evaluate(const Problem& problem, std::span<const Vec2> points, std::span<const double> multipliers,
               double penalty);

// Stretch from plane to form at one stress point.
struct PointStretch {
  base::Mat2 inverse_metric; // C^-1 = f f^T in the frame of the plane
  double larger = 1;         // principal stretches relative to the wanted ones
  double smaller = 1;
  double area = 0; // on the form, m2
};
std::vector<PointStretch> stretches(const Problem& problem, std::span<const Vec2> points); // [element][point]

} // namespace pneuma::solver::flattening
