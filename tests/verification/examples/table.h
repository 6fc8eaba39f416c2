// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the thesis' material examples (Coelho 2012): what it prints, what the literature says, what this code
// finds. Every row with a tolerance is an assertion too.
#pragma once

#include <limits>
#include <optional>
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
  int iterations = 0; // of Newton, of the whole path
  std::string remark = {};

  double error() const;
};

// Asserts the row, prints it and keeps it for the table. Where PNEUMA_TABLES names a folder, the program writes all of
// its rows there at its end, as material_examples.csv and .md.
void expect(const Row& row);

} // namespace pneuma::tests
