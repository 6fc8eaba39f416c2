// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::pipeline::drawing {

using base::Vec2;

enum class Scale : std::uint8_t { linear, logarithmic };
enum class Stroke : std::uint8_t { solid, dashed, dotted, none };
enum class Mark : std::uint8_t { none, circle, square, triangle, diamond };

// The quantity with its unit, as it shall be read: "pressure, kPa". Values are in that unit.
struct Axis {
  std::string label;
  Scale scale = Scale::linear;
  std::optional<std::array<double, 2>> range =
      {}; // what is shown; without it all points, and linear axes from tick to tick
};

struct Curve {
  std::string name; // in the legend; without one it stands there not
  std::vector<Vec2> points;
  Stroke stroke = Stroke::solid;
  Mark mark = Mark::none;
  int colour = 0; // 0 black, 1 to 6 told apart by the colour-blind, 7 grey; others start over from 1
};

// Curves over two axes.
struct Chart {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves; // later ones lie above
};

// SVG of 720 x 450 px, the legend on the right of the axes, so that it hides nothing. The same chart gives the same
// bytes. Written to a temporary file and renamed; throws StateError with the system's reason, std::invalid_argument
// (it is the caller's mistake) if there is no point to show, one is not finite or has no logarithm, or a range is
// empty.
void write_chart(const Chart& chart, const std::filesystem::path& file);

} // namespace pneuma::pipeline::drawing
