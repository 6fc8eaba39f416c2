// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "tests/unit/solver/cushions.h"

namespace pneuma::tests {

// A pyramid of linear triangles over a square of 2 a, free of stress at height z0, one free node: the surface's
// counterpart of von Mises' truss. Strain across the base only, E22 = (z^2 - z0^2) / (2 (a^2 + z0^2)), and a pressure p
// pushes the apex with p 4 a^2 / 3. So
//   p(z) 4 a^2 / 3 = A0 h c z (z^2 - z0^2) / (2 (a^2 + z0^2)^2),  c = E / (1 - nu^2),  A0 = 4 a sqrt(a^2 + z0^2),
// with extremes at z = +- z0 / sqrt(3).
struct Pyramid {
  double a = 1, z0 = 0.1, h = 250e-6, E = 900e6, nu = 0.45;

  double pressure(double z) const {
    const double side = a * a + z0 * z0;
    return 4 * a * std::sqrt(side) * h * E / (1 - nu * nu) * z * (z * z - z0 * z0) / (2 * side * side) /
           (4 * a * a / 3);
  }
  double limit() const { return pressure(-z0 / std::numbers::sqrt3); }

  // load factor 1: the pressure `top` pushes down
  solver::assembly::Model model(double top) const {
    Cushion c;
    c.plan = geometry::Rectangle{2 * a, 2 * a};
    c.element = ElementType::T3;
    c.divisions = {2, 2};
    c.heights = {z0};
    c.base = true;
    c.thickness = {h};
    c.law = {E, nu};
    solver::assembly::Model model = model_of(c, 0);
    model.face_pressure = {{0, -top}, {0, 0}};
    return model;
  }
};

} // namespace pneuma::tests
