// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "geometry/base/quantities.h"

namespace pneuma::solver::chamber {

// The air of one chamber along a stage's path; every pair runs linearly with the load factor from 0 to 1.

// A fan holds the gauge pressure.
struct Regulated {
  double gauge_from = 0, gauge_to = 0; // Pa
};

// The air present at the start stays: (p_amb + p) / p_abs0 = (V0/V)^kappa T/T0, for absolute pressures.
struct Closed {
  double kappa = 1;
  double absolute0 = 0;                     // Pa, at the start
  double volume0 = 0;                       // m3, at the start
  double temperature0 = 1, temperature = 1; // K, at the start and at the end
  double ambient_from = 0, ambient_to = 0;  // Pa, absolute
};

// The volume is prescribed; the pressure follows. From 0 (a flat chamber) or more, to more than 0.
struct PrescribedVolume {
  double from = 0, to = 0; // m3
};

using Gas = std::variant<Regulated, Closed, PrescribedVolume>;

// The chamber's line of the bordered system, with q = dV/du: q . du + compliance dp + drive dlambda = -residual.
struct GasLine {
  bool pressure_is_unknown = false;
  double residual = 0;   // m3
  double compliance = 0; // -dV/dp of the gas alone, m3/Pa, >= 0
  double relative = 0;   // residual as a relative error of absolute pressure or volume, -
  double drive = 0;      // d residual / d load factor, m3
  bool possible = true;  // false: closed air without volume, pressure or temperature, or a volume of 0 is the goal
};

// At gauge pressure p, volume V and load factor. Closed air as ln p + kappa ln V = const, so that V -> 0 cannot
// overflow.
GasLine gas_line(const Gas& gas, double gauge_pressure, double volume, double load_factor);

// Gauge pressure that a regulated chamber has at a load factor; other laws keep `current`.
double prescribed_pressure(const Gas& gas, double current, double load_factor);

// Its derivative by the load factor, Pa; 0 of other laws.
double prescribed_rate(const Gas& gas);

// Ambient pressure at a load factor, as far as the law knows it.
double ambient_pressure(const Gas& gas, double otherwise, double load_factor);

} // namespace pneuma::solver::chamber
