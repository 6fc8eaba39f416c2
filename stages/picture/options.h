// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace pneuma::stages::picture {

enum class View : std::uint8_t { iso, top, side };

// What the command line asks for.
struct Options {
  std::filesystem::path state;
  std::filesystem::path out;
  std::string field; // "none": the mesh alone
  int width = 1400;  // pixels
  int height = 900;
  std::string title;
  std::optional<int> component;                   // none: the value, or the magnitude of several components
  std::optional<std::pair<double, double>> range; // of the colours, in the field's unit; none: smallest to largest
  double explode = 0;                             // m between neighbouring foils, added in z
  View view = View::iso;
  double warp = 1; // displacements are drawn this many times as large
};

// nullopt: help or version was asked for and is printed. Throws InputError with what is wrong and what is allowed.
std::optional<Options> parse(int argc, char** argv);

} // namespace pneuma::stages::picture
