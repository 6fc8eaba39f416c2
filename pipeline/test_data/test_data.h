// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::test_data {

// How strains and stresses of a test are meant.
enum class Measure : std::uint8_t {
  engineering,    // change of length over length, force per undeformed area: what test machines give
  green_lagrange, // with second Piola-Kirchhoff stress
};

inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

// One row of a test, SI. 1 and 2 are perpendicular and without shear between them: principal, or along the axes.
struct Row {
  double strain_1 = not_measured, strain_2 = not_measured;         // -
  double stress_1 = not_measured, stress_2 = not_measured;         // Pa
  double shear_strain = not_measured, shear_stress = not_measured; // 2 E12, -; S12, Pa
  double time = not_measured;                                      // s
  double temperature = not_measured;                               // K
  double weight = 1;
  int line = 0; // in the file
};

// Reads the text of a CSV file (README.md says what it holds); `name` stands for the file in the marks. `needed`:
// columns without which it is of no use. Every fault is a problem at its line and column; rows that have one are left
// out. What is implausible (units, stress that falls, strains that come again) is a warning there, once for each kind.
std::vector<Row> parse(const std::string& text, const std::string& name, Measure measure,
                       const std::vector<std::string>& needed, std::vector<yaml::Problem>& problems);

// Strains and stresses of a row in the other measure: stretch l = 1 + e = sqrt(1 + 2 E), nominal stress = l S (no shear
// between 1 and 2). Shear stays as it is.
Row converted(const Row& row, Measure from, Measure to);

// The rows of several files, one after the other, as Green-Lagrange strains and second Piola-Kirchhoff stresses.
struct Tests {
  std::vector<Row> rows;
  std::vector<yaml::Mark> marks;                     // where each stands
  std::optional<std::array<double, 2>> temperatures; // least and most, K
};

// Reads files that lie beside the one that names them, at `named`.
Tests read_tests(const std::vector<std::string>& files, const yaml::Mark& named, Measure measure,
                 const std::vector<std::string>& needed, std::vector<yaml::Problem>& problems);

} // namespace pneuma::pipeline::test_data
