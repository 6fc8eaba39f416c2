// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <string>

namespace pneuma::pipeline::test_data {

// A point that a table is fitted to: Green-Lagrange strains, -; second Piola-Kirchhoff stresses, Pa.
struct Point {
  double strain_1 = 0, strain_2 = 0, stress_1 = 0, stress_2 = 0, weight = 1;
};

// How near points come to uniaxial stress along axis 1 and along axis 2: the least ratio of the smaller to the larger
// stress of those that are loaded along it, by a quarter of the largest stress at least; infinite without such a point.
// Of principal stresses, which have no axes, twice the same.
std::array<double, 2> least_stress_ratios(std::span<const Point> points, bool has_axes);

// What points leave open where no law fills it, and what to do about it; empty: nothing.
struct MissingTests {
  std::string message;
  bool useless = false; // a table of such points is none
};
MissingTests missing_tests(std::span<const Point> points, bool has_axes);

} // namespace pneuma::pipeline::test_data
