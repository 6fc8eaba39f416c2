// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "solver/analytical/stretch_law.h"

namespace pneuma::solver::analytical {

// A flat circular membrane clamped at its rim under a pressure that follows it: St. Venant-Kirchhoff, exact kinematics,
// plane stress with the nominal thickness. What Hencky, Fichter and Campbell approximate.
struct CircularMembrane {
  double radius = 0;    // m, of the clamped rim
  double stiffness = 0; // E h, N/m
  double poissons_ratio = 0;
  double pretension = 0; // Cauchy force per length of the flat, clamped membrane, N/m
};

struct MeridianPoint {
  double reference_radius = 0;     // m, of the flat clamped membrane
  double radius = 0, height = 0;   // m, current; height above the rim
  double meridional = 0, hoop = 0; // Cauchy force per current length, N/m
};

struct InflatedCircle {
  double pressure = 0;                 // Pa, net
  double deflection = 0;               // m, of the apex
  double volume = 0;                   // m3, between membrane and the plane of its rim
  double apex_tension = 0;             // N/m, Cauchy force per current length
  double pole_stretch = 1;             // there, of the stress-free membrane
  std::vector<MeridianPoint> meridian; // pole to rim
};

// Solves the boundary value problem by shooting for the pole's stretch: unknowns y = r/R and eta = T_s cos(phi) over
// t = ln R, which is regular at the pole,
//   dy/dt = l_s cos(phi) - y,   d eta/dt = T_h - p r l_s sin(phi) - eta,   T_s sin(phi) = p r^2 / (2 R),
// T nominal forces, T_s = l_s S_s(l_s, l_h). Equations: axial and radial balance of a shell of revolution, e.g. Libai
// and Simmonds (1998), The Nonlinear Theory of Elastic Shells, ch. V. Fourth-order Runge-Kutta, `steps` over t;
// relative error below 1e-10 with the default. Pressure > 0. None if there is no solution up to a stretch of 3.
std::optional<InflatedCircle> inflate(const CircularMembrane& membrane, double pressure, int steps = 6000);

// The same of any law in two stretches: flat, clamped, free of stress.
struct CircularDisc {
  double radius = 0;    // m, of the clamped rim
  double thickness = 0; // m, nominal
  StretchLaw law;
};

// Equilibrium at a stretch of the pole > 1, on whichever branch it lies, past limit points too: rubber's pressure is
// not a growing function of the deflection, the pole's stretch tells the states apart (Adkins and Rivlin 1952, Phil.
// Trans. R. Soc. Lond. A 244, 505; Hart-Smith and Crisp 1967, Int. J. Eng. Sci. 5, 1). No shooting: a membrane under p
// of radius a is one under s p of radius a / s, so that the equations above are integrated from the pole under any
// pressure to where r = R, which is the rim. Relative error below 1e-9 with the default. None if the law has no such
// state.
std::optional<InflatedCircle> inflate_to(const CircularDisc& disc, double pole_stretch, int steps = 4000);

// Where the pressure has a maximum or, behind one, a minimum, in the order of the pole's stretch up to `last`; pressure
// to 1e-9. A maximum and a minimum that lie closer than 5 % in stretch go unseen.
std::vector<InflatedCircle> limit_points(const CircularDisc& disc, double last = 10);

// Closed air: the pressure after the chamber between the membrane and its rigid base, with volume `volume0` at absolute
// pressure `absolute0`, sees `external` Pa on the other side; p_abs V^kappa = const; ambient pressure `ambient`.
std::optional<InflatedCircle> inflate_closed(const CircularMembrane& membrane, double absolute0, double volume0,
                                             double kappa, double ambient, double external, int steps = 6000);

} // namespace pneuma::solver::analytical
