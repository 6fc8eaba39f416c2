// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/nurbs/surface.h"

namespace pneuma::geometry::nurbs {

// What a function of u, or one of its derivatives, should be somewhere.
struct CurveObservation {
  double u = 0;
  int order = 0; // of the derivative, <= 3
  double value = 0;
  double weight = 1; // of the squared residual, >= 0
};

struct SurfaceObservation {
  double u = 0, v = 0;
  int order_u = 0, order_v = 0; // of the derivative, <= 3
  double value = 0;
  double weight = 1; // of the squared residual, >= 0
};

struct FitSettings {
  // Weight of a penalty on all derivatives of order `penalized` (1 to 3), each times the size of its span to that
  // power, against observations of one per span: 1e-7 moves a fitted curve by 1e-7 of what it bends over a span, and
  // lets spans without observations continue their neighbours as the polynomial of the order below. 0: none.
  double smoothing = 1e-7;
  int penalized = 2;
  // The observations are first derivatives: the penalty, too, is on derivatives of these, of one order less, with as
  // many powers of the size.
  bool of_gradient = false;
  bool symmetric = false; // surfaces: f(u, v) = f(v, u), with equal knots
  // Surfaces that are not symmetric: f and its derivatives by u of an order below this one are zero at the first u.
  int flat_start = 0;
};

// Residuals r = fitted - observed of a fit, in the unit of the observations.
struct Residuals {
  double rms = 0;           // sqrt(sum w r^2 / sum w)
  double max = 0;           // largest |r| among those with a weight
  std::size_t where = 0;    // number of the observation with it
  std::vector<double> each; // [observation]
  double uncovered = 0;     // part of the spans, or cells of a surface, without an observation
};

struct CurveFit {
  Curve<1> curve;
  Residuals residuals;
};

struct SurfaceFit {
  Surface<1> surface;
  Residuals residuals;
};

// Least squares for the control values of a function on given knots: minimum of
//   (spans / sum w) sum w r^2 + smoothing sum over spans of the mean of (size^k d^k f)^2,  k = penalized
// (Eilers and Marx 1996, Stat. Sci. 11, with derivatives in place of differences). Normal equations, sparse LDLt, one
// refinement. Throws std::invalid_argument where the observations do not determine the fit: with smoothing, where they
// leave a polynomial of the order below `penalized` free; without, where control values are free.
CurveFit fit(const Knots& knots, std::span<const CurveObservation> observations, const FitSettings& settings);
SurfaceFit fit(const Knots& u, const Knots& v, std::span<const SurfaceObservation> observations,
               const FitSettings& settings);

// The least derivative by u (order 1 of a rising curve: positive), looked for at `points` places of each span, ends
// included; a function rises all along where it is not negative.
struct Slope {
  double least = 0;
  double u = 0; // where
};
Slope least_slope(const Curve<1>& curve, int points = 8);

} // namespace pneuma::geometry::nurbs
