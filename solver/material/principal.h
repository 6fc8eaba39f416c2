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

// The logarithmic strain ln(C)/2 = (11, 22, 2 12) of a Green-Lagrange strain, and its derivatives by that.
struct LogStrain {
  Vec3 strain = Vec3::Zero();
  Mat3 slope = Mat3::Identity();

  PrincipalStrain green; // E
  PrincipalLogarithm logarithm;

  // sum_a stress_a d2 strain_a / dE2 of a conjugate stress (11, 22, 12), which need not have the axes of E.
  // By divided differences f[i, j, k] of f(E) = ln(1 + 2 E)/2 (Daleckii and Krein 1965),
  //   d2 (T : e) [H, H] = 2 sum_ij T_ij sum_k f[i, k, j] H_ik H_kj,
  // with C1 = m (1 + y), C2 = m (1 - y) and a = (atanh(y)/y - 1)/y^2, which is all that two close values need:
  //   m^2 f[1, 1, 2] = -1/(1 + y) - y a,   m^2 f[1, 2, 2] = -1/(1 - y) + y a.
  Mat3 curvature(const Vec3& stress) const noexcept {
    const double m = logarithm.c2 + green.difference;
    const double y = green.difference / m;
    constexpr double close = 0.25;
    double a = 0;
    if (y < close) {
      for (int k = 25; k > 1; k -= 2) a = a * y * y + 1.0 / k; // 1/3 + y^2/5 + ..: what is left is below 1e-16
    } else {
      a = (logarithm.quotient * m - 1) / (y * y);
    }
    const double f111 = -1 / (logarithm.c1 * logarithm.c1);
    const double f222 = -1 / (logarithm.c2 * logarithm.c2);
    const double f112 = -(m / logarithm.c1 + y * a) / (m * m);
    const double f122 = -(m / logarithm.c2 - y * a) / (m * m);
    const Vec3 twice(stress[0], stress[1], 2 * stress[2]);
    const double t1 = green.along1.dot(twice);
    const double t2 = green.along2.dot(twice);
    const double t12 = green.shear.dot(twice);
    const Vec3 by1 = 2 * (t1 * f111 * green.along1 + t12 * f112 * green.shear);
    const Vec3 by2 = 2 * (t2 * f222 * green.along2 + t12 * f122 * green.shear);
    const Vec3 turn = 2 * ((t1 * f112 + t2 * f122) * green.shear + t12 * (f112 * green.along1 + f122 * green.along2));
    return by1 * green.along1.transpose() + by2 * green.along2.transpose() + turn * green.shear.transpose();
  }
};

// False where C is not positive definite. Stretches from 0.1 to 10 in any directions: the digits are those of E.
inline bool log_strain(const Vec3& strain, LogStrain& log) noexcept {
  log.green = principal_strain(strain);
  log.logarithm = principal_logarithm(log.green);
  const PrincipalLogarithm& l = log.logarithm;
  if (!(l.c2 > 0) || !std::isfinite(l.c1)) return false;
  PrincipalFunction f;
  f.s2 = l.second;
  f.s1 = l.second + l.difference;
  f.d11 = 1 / l.c1;
  f.d22 = 1 / l.c2;
  f.quotient = l.quotient;
  in_frame(log.green, f, log.strain, log.slope);
  log.strain[2] *= 2;
  log.slope.row(2) *= 2;
  return true;
}

} // namespace pneuma::solver::material
