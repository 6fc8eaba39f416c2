// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "geometry/nurbs/surface.h"
#include "solver/material/plane_stress_return.h"
#include "solver/material/principal.h"

namespace pneuma::solver::material {

// Potential over the principal strains of an isotropic law that is linearly elastic until its von Mises stress reaches
// `yield`. In
//   x = (t1 + t2) / 2 / yield,   y = sqrt(3)/2 (t1 - t2) / yield   of the elastic stresses t
// the curve of yield is the circle r = 1: no knots of a surface over the strains themselves follow it, and one that
// swings about the corner of the stresses there does not rise with the strain. So, over r and v = x / r (an isotropic
// law knows the sign of y by nothing), with W1(v) the elastic potential on the curve:
//   W = r^2 W1(v) up to the curve,   W = (2 r - 1) W1(v) + beyond(r, v) past it,
//   beyond(1, v) = d beyond / dr (1, v) = 0.
// Stresses and, along the curve, tangents are continuous.
struct YieldTable {
  Elasticity elasticity;
  double yield = 0; // Pa
  // Strains are ln(C)/2 and stresses Kirchhoff's; otherwise Green-Lagrange's and second Piola-Kirchhoff.
  bool logarithmic = false;
  geometry::nurbs::Surface<1> beyond; // J/m3, over (r, v), 1 <= r, -1 <= v <= 1

  // x and y by the sum and the difference of the strains.
  double of_sum() const noexcept { return 0.5 * elasticity.sum_modulus() / yield; }
  double of_difference() const noexcept { return std::sqrt(3.0) * elasticity.shear_modulus() / yield; }

  // W1 = of_x v^2 + of_y (1 - v^2) and its first derivative.
  double on_curve(double v) const noexcept { return of_y() + (of_x() - of_y()) * v * v; }
  double slope_on_curve(double v) const noexcept { return 2 * (of_x() - of_y()) * v; }

  // Stresses at strains of this sum and difference >= 0, and the potential, J/m3.
  PrincipalKirchhoff evaluate(double sum, double difference, double& potential) const noexcept {
    const double kx = of_sum();
    const double ky = of_difference();
    const double x = kx * sum;
    const double y = ky * difference;
    const double r = std::sqrt(x * x + y * y);
    double by_sum = 0;             // d W / d sum = (t1 + t2) / 2
    double quotient = 0;           // d W / d difference / difference = (t1 - t2) / 2 / difference
    double xx = 0, xy = 0, yy = 0; // second derivatives of W by sum and difference
    if (r <= 1) {
      potential = of_x() * x * x + of_y() * y * y;
      xx = 0.5 * elasticity.sum_modulus();
      yy = elasticity.shear_modulus();
      by_sum = xx * sum;
      quotient = yy;
    } else {
      const double c = x / r;
      const double s = y / r;
      const double w1 = on_curve(c);
      const double w1_v = slope_on_curve(c);
      geometry::nurbs::SurfaceJet<1> w = geometry::nurbs::evaluate(beyond, r, c);
      potential = w.value[0] + (2 * r - 1) * w1;
      const double i = 1 / r;
      const double wr = w.u[0] + 2 * w1;
      const double wv = i * (w.v[0] + (2 * r - 1) * w1_v);
      const double wrr = w.uu[0];
      const double wrv = i * (w.uv[0] + 2 * w1_v);
      const double wvv = i * i * (w.vv[0] + 2 * (2 * r - 1) * (of_x() - of_y()));
      by_sum = kx * (c * wr + s * s * wv);
      quotient = ky * ky * i * (wr - c * wv);
      xx = kx * kx * (c * c * wrr + s * s * (2 * c * wrv + s * s * wvv + i * (wr - 3 * c * wv)));
      xy = kx * ky * s * (c * wrr + (s * s - c * c) * wrv - c * s * s * wvv - i * (c * wr - (2 * c * c - s * s) * wv));
      yy = ky * ky * (s * s * (wrr - 2 * c * wrv + c * c * wvv) + c * i * (c * wr - (c * c - 2 * s * s) * wv));
    }
    PrincipalKirchhoff t;
    t.t1 = by_sum + quotient * difference;
    t.t2 = by_sum - quotient * difference;
    t.d11 = xx + 2 * xy + yy;
    t.d12 = xx - yy;
    t.d22 = xx - 2 * xy + yy;
    t.quotient = 2 * quotient;
    return t;
  }

  // The stress function of Green-Lagrange strains; not finite where there is no state.
  PrincipalFunction stress(const PrincipalStrain& e, double& potential) const noexcept {
    if (logarithmic) {
      const PrincipalLogarithm log = principal_logarithm(e);
      return of_logarithm(log, evaluate(2 * log.second + log.difference, log.difference, potential));
    }
    const PrincipalKirchhoff t = evaluate(e.first + e.second, e.difference, potential);
    return {t.t1, t.t2, t.d11, t.d12, t.d12, t.d22, t.quotient};
  }

private:
  double of_x() const noexcept { return yield * yield / elasticity.sum_modulus(); }
  double of_y() const noexcept { return yield * yield / (6 * elasticity.shear_modulus()); }
};

} // namespace pneuma::solver::material
