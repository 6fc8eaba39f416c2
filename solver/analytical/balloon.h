// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "solver/analytical/stretch_law.h"

namespace pneuma::solver::analytical {

// A sphere, or a piece far from the ends of a long tube: its ends held apart at their nominal distance, or closed by
// caps that the pressure pushes apart.
enum class BalloonShape : std::uint8_t { sphere, held_tube, capped_tube };

struct Balloon {
  BalloonShape shape = BalloonShape::sphere;
  double radius = 0;    // m, nominal, of the middle of a thin wall
  double thickness = 0; // m, nominal
  StretchLaw law;
};

struct InflatedBalloon {
  double stretch = 1;           // current / nominal radius
  double axial_stretch = 1;     // of a tube; of a sphere the other direction in its wall
  double thickness_stretch = 1; // NaN where St. Venant-Kirchhoff's law has no such thickness
  double pressure = 0;          // Pa, inside less outside
  double slope = 0;             // d pressure / d stretch, Pa
  double volume = 0;            // m3; of tubes m3 per nominal length
  double energy = 0;            // J; of tubes J per nominal length
  double hoop = 0, axial = 0;   // Cauchy stress, Pa
};

// Equilibrium of a thin wall at a stretch of its radius, by energy: p = dU/dV.
//   sphere       p = 2 h W1 / (R l^2)
//   held tube    p = h W1 / (R l), axial stretch 1
//   capped tube  p = h W1 / (R l lz), and 2 lz W2 = l W1 gives lz: half of the hoop force per length (Newton)
// with W1, W2 the derivatives of the energy by hoop and axial stretch: e.g. Holzapfel (2000), Nonlinear Solid
// Mechanics, sec. 6.5 (sphere); Ogden (1997), Non-linear Elastic Deformations, sec. 5.3 (thick tubes, whose limit this
// is). Nominal thickness carries the stress, so that St. Venant-Kirchhoff's is the solver's. `stretch` >= 1; none if it
// is less, or if the law has no axial balance.
std::optional<InflatedBalloon> inflate(const Balloon& balloon, double stretch);

// Where the pressure has a maximum or, behind one, a minimum, in the order of the stretch up to 20, to rounding: the
// limit points of an inflation. A maximum and a minimum that lie closer than 0.005 in stretch go unseen.
std::vector<InflatedBalloon> limit_points(const Balloon& balloon);

} // namespace pneuma::solver::analytical
