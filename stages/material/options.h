// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pneuma::stages::material {

// How a test piece is pulled: by nominal stresses along its two axes, or by a shear stress alone.
struct Ratio {
  double a = 1, b = 0; // b = 0: uniaxial
  bool shear = false;  // then a and b are 0
};
inline constexpr Ratio pure_shear = {0, 0, true};
std::string name_of(const Ratio& ratio); // "uniaxial", "2:1", "shear"

inline constexpr double most_strain = 10; // of curves and tests

// What the command line asks for.
struct Options {
  std::filesystem::path materials;
  std::vector<std::string> names; // none: all in the file
  std::vector<Ratio> ratios = {{1, 0}, {1, 1}, {2, 1}};
  double strain = 0.1;               // to which the pieces are pulled, engineering or logarithmic
  int steps = 100;                   // of loading
  std::vector<double> rates;         // of that strain, 1/s
  std::optional<double> temperature; // K
  double angle = 0;                  // from the warp direction to axis 1, rad
  bool true_measures = false;        // logarithmic strain and Cauchy stress
  std::vector<std::filesystem::path> data;
  std::filesystem::path csv, svg;
  int branches = 0; // to be fitted; 0: none
  bool softening = false;
};

// nullopt: help or version was asked for and is printed. Throws InputError with what is wrong and what is allowed.
std::optional<Options> parse(int argc, char** argv);

} // namespace pneuma::stages::material
