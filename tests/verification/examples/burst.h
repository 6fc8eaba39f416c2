// SPDX-License-Identifier: GPL-3.0-or-later
// The burst test of specimen V28 (Schiemann 2007), example B11 (Coelho 2012, sec. 6.4): a flat disc, clamped, of 53 cm
// diameter (a reading: the print says radius, which gives half the pressure), blown up; a quarter of it.
#pragma once

#include "solver/path/controlled_path.h"
#include "tests/unit/solver/cushions.h"

namespace pneuma::tests {

inline constexpr double burst_radius = 0.265;     // m
inline constexpr double burst_thickness = 200e-6; // m
inline constexpr double burst_load = 40e3;        // Pa, gauge, at load factor 1
inline constexpr solver::material::Elasticity burst_elasticity{417e6, 0.45};

// sigma_y = 14 MPa + 120 MPa alpha, from 32 MPa on 30 MPa (table 6.3). `tangent`: the moduli are those of the uniaxial
// curve, elastic strain included, 1/K = 1/H + 1/E.
solver::material::Flow burst_flow(bool tangent = false);

// T3 or T6, 2 divisions^2 elements (20: the thesis' 441 or 1681 nodes), on rings about the centre.
solver::assembly::Model burst_disc(ElementType element, int divisions, const solver::material::Law& law);

struct BurstPoint {
  double deflection = 0, pressure = 0, volume = 0; // m, Pa, m3 of the quarter
};

struct Burst {
  solver::assembly::System system;
  solver::path::Newton newton;
  solver::assembly::Configuration at;
  solver::path::PathResult path;
  std::vector<BurstPoint> points; // every step
  std::optional<BurstPoint> peak; // the first limit point

  Burst(solver::assembly::Model model, const solver::path::PathControl& control,
        const solver::path::ControlledPathOptions& options = {});
  bool reached() const { return path.end == solver::path::PathEnd::reached; }
  int iterations() const { return newton.work().iterations; }
};

} // namespace pneuma::tests
