// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the thesis' material examples (Coelho 2012): what it prints, what the literature says, what this code
// finds. Every row with a tolerance is an assertion too.
#pragma once

#include <array>
#include <limits>
#include <string>

namespace pneuma::tests {

// Tolerance of what is reported and not asserted.
inline constexpr double unbounded = std::numeric_limits<double>::infinity();

struct Row {
  std::string example;        // B1 to B11
  std::string quantity;       // with its unit
  std::string thesis;         // as printed; "figure" where only a picture shows it
  std::string reference_name; // what `reference` is: a closed form, the literature, another law of ours
  double reference = 0;
  double ours = 0;
  double tolerance = 0; // of |ours / reference - 1|; where the reference is 0, of |ours|
  std::string why;      // this tolerance
  std::string mesh;
  int iterations = 0; // of Newton, of the whole path; 0: none to tell
  std::string remark = {};

  double error() const;
};

// Order p of convergence of values on three meshes or in three numbers of steps n0 < n1 < n2:
//   (v0 - v1) / (v1 - v2) = (n0^-p - n1^-p) / (n1^-p - n2^-p),
// 0 where they do not converge, 12 at most.
double observed_order(const std::array<double, 3>& n, const std::array<double, 3>& values);

// Asserts the row, prints it and keeps it for the table. Where PNEUMA_TABLES names a folder, the program writes all of
// its rows there at its end, as material_examples.csv and .md.
void expect(const Row& row);

} // namespace pneuma::tests
