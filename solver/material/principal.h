// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/base/types.h"

namespace pneuma::solver::material {

using base::Mat3;
using base::Vec3;

// Principal values first >= second of a strain (E11, E22, 2 E12), and its axes n1, n2 as tensors (11, 22, 12). Such a
// tensor times a strain is the strain's component along n1, n2, or between them.
struct PrincipalStrain {
  double first = 0, second = 0;
  double difference = 0;      // first - second, without loss of digits
  Vec3 along1, along2, shear; // n1 n1, n2 n2, sym(n1 n2)
};

// In closed form by the double angle (Mohr's circle). The principal values are written from the larger and the smaller
// diagonal term, so that axes along the frame lose no digits. Equal values: the axes are the frame's.
inline PrincipalStrain principal_strain(const Vec3& strain) noexcept {
  const double half = 0.5 * (strain[0] - strain[1]);
  const double shear = 0.5 * strain[2];
  const double radius = std::sqrt(half * half + shear * shear);
  PrincipalStrain p;
  double c = 1;
  double s = 0;
  constexpr double equal = 1e-140; // squares of less lose digits to underflow
  p.first = std::max(strain[0], strain[1]);
  p.second = std::min(strain[0], strain[1]);
  if (radius > equal) {
    c = half / radius;
    s = shear / radius;
    const double beyond = shear * shear / (radius + std::abs(half));
    p.first += beyond;
    p.second -= beyond;
    p.difference = 2 * radius;
  }
  p.along1 = 0.5 * Vec3(1 + c, 1 - c, s);
  p.along2 = 0.5 * Vec3(1 - c, 1 + c, -s);
  p.shear = 0.5 * Vec3(-s, s, c);
  return p;
}

// An isotropic function S(E) by its principal values s_i(E1, E2): where E has its axes, S has them too.
struct PrincipalFunction {
  double s1 = 0, s2 = 0;
  double d11 = 0, d12 = 0, d21 = 0, d22 = 0; // d s_i / d E_j
  // (s1 - s2) / (E1 - E2), at equal strains d11 - d12: whoever knows s writes it so that close strains lose no digits
  double quotient = 0;
};

// Its components (S11, S22, S12) and their derivatives by (E11, E22, 2 E12):
//   S = s1 n1 n1 + s2 n2 n2,   dS = sum d_ij (n_i n_i)(n_j n_j) : dE + (s1 - s2) d(n1 n1),
//   d(n1 n1) = 2 sym(n1 n2) n1 dE n2 / (E1 - E2)
// (Ogden 1997, Non-linear Elastic Deformations, sec. 6.1.4; de Souza Neto, Peric and Owen 2008, app. A). No division:
// equal strains are nothing special.
inline void in_frame(const PrincipalStrain& e, const PrincipalFunction& f, Vec3& stress, Mat3& tangent) noexcept {
  stress = f.s1 * e.along1 + f.s2 * e.along2;
  const Vec3 by1 = f.d11 * e.along1 + f.d21 * e.along2;
  const Vec3 by2 = f.d12 * e.along1 + f.d22 * e.along2;
  const Vec3 turn = 2 * f.quotient * e.shear;
  for (int j = 0; j < 3; ++j) tangent.col(j) = e.along1[j] * by1 + e.along2[j] * by2 + e.shear[j] * turn;
}

// Principal values of C = I + 2 E and of ln(C)/2.
struct PrincipalLogarithm {
  double c1 = 1, c2 = 1;
  double second = 0;     // of ln(C)/2
  double difference = 0; // first - second
  double quotient = 1;   // difference / (E1 - E2), the derivative where they are equal
};

// Small strains and close ones lose no digits. Not finite where C is not positive definite.
inline PrincipalLogarithm principal_logarithm(const PrincipalStrain& e) noexcept {
  PrincipalLogarithm l;
  l.c2 = 1 + 2 * e.second;
  l.c1 = 1 + 2 * e.first;
  l.second = 0.5 * std::log1p(2 * e.second);
  l.difference = 0.5 * std::log1p(2 * e.difference / l.c2);
  l.quotient = e.difference > 0 ? l.difference / e.difference : 1 / l.c2;
  return l;
}

// Principal values of a Kirchhoff stress T that has the axes of ln(C)/2, and their derivatives by that strain.
struct PrincipalKirchhoff {
  double t1 = 0, t2 = 0;
  double d11 = 0, d12 = 0, d22 = 0; // d t_i / d e_j, symmetric
  double quotient = 0;              // (t1 - t2) / (e1 - e2), at equal strains d11 - d12
};

// Its S as a function of E:
//   s_i = t_i / c_i,   ds_i/dE_j = d_ij / (c_i c_j) - 2 delta_ij t_i / c_i^2,
//   (s1 - s2) / (E1 - E2) from the quotients of T and of the logarithms, so that equal stretches lose no digits.
inline PrincipalFunction of_logarithm(const PrincipalLogarithm& log, const PrincipalKirchhoff& t) noexcept {
  const double i1 = 1 / log.c1;
  const double i2 = 1 / log.c2;
  PrincipalFunction s;
  s.s1 = t.t1 * i1;
  s.s2 = t.t2 * i2;
  s.d11 = (t.d11 - 2 * t.t1) * i1 * i1;
  s.d22 = (t.d22 - 2 * t.t2) * i2 * i2;
  s.d12 = s.d21 = t.d12 * i1 * i2;
  s.quotient = (t.quotient * log.quotient - 2 * s.s2) * i1;
  return s;
}

} // namespace pneuma::solver::material
