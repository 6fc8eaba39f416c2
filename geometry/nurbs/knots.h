// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry::nurbs {

constexpr int max_degree = 7; // bounds the arrays below

// Degree and knot vector of clamped B-splines: both ends have degree + 1 equal knots, inner ones at most `degree`.
struct Knots {
  int degree = 0;
  std::vector<double> values;

  int functions() const { return static_cast<int>(values.size()) - degree - 1; } // as many as control points
  double first() const { return values.front(); }
  double last() const { return values.back(); }
};

// Throws std::invalid_argument with what is wrong, if anything is.
void check(const Knots& knots);

// Knots with a simple knot at each of the strictly rising `breaks`, two at least: breaks + degree - 1 functions.
Knots from_breaks(int degree, std::span<const double> breaks);

// Equal spans between `first` and `last`; `functions` > degree.
Knots uniform(int degree, int functions, double first, double last);

// Knots for fitting rising `parameters` with `functions` <= parameters: every span holds a parameter at least, so that
// least squares without smoothing are determined (Piegl and Tiller 1997, The NURBS Book, eq. 9.68 and 9.69); with as
// many functions as parameters, for interpolation, the averages of eq. 9.8.
Knots averaged(int degree, int functions, std::span<const double> parameters);

// Distinct knots: the borders of the spans.
std::vector<double> breaks(const Knots& knots);

// Greville abscissae, the mean of `degree` knots a function: with them as control points a spline is the identity.
std::vector<double> greville(const Knots& knots);

// Number i of the span with values[i] <= u < values[i + 1]; the last one not empty at the end; the end spans beyond.
int find_span(const Knots& knots, double u);

// The degree + 1 basis functions that are not zero at a parameter, with derivatives.
struct Basis {
  int first = 0;                                               // number of the first of them
  std::array<std::array<double, max_degree + 1>, 4> functions; // [k][j]: k-th derivative of function first + j
};

// Basis functions and their derivatives up to `order` <= 3 (Piegl and Tiller 1997, algorithm A2.3 in the form of
// eq. 2.9 applied to lower degrees). Beyond the ends each function goes on as the parabola with its value and
// derivatives there: what a first derivative stands for is continued linearly.
void evaluate_basis(const Knots& knots, double u, int order, Basis& basis) noexcept;

} // namespace pneuma::geometry::nurbs
