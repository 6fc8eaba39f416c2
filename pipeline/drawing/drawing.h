// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::pipeline::drawing {

using base::Vec2;

// A plane drawing on named layers, in m; written true to scale in mm.
struct Polyline {
  std::string layer;
  bool closed = false;
  std::vector<Vec2> points;
};
struct Text {
  std::string layer;
  Vec2 at;           // left end of the base line
  double height = 0; // m
  double angle = 0;  // rad
  std::string text;
};
struct Layer {
  std::string name; // upper case, as R12 wants it
  int colour = 7;   // AutoCAD colour index, used by both formats
};
struct Drawing {
  std::string title;
  std::vector<Layer> layers;
  std::vector<Polyline> lines;
  std::vector<Text> texts;
};

constexpr double letter_width = 0.85; // of a letter's height: wide enough for the fonts of both formats
double width(const Text& text);       // m

// Extent of all lines and texts, m; a point at the origin if there are none.
struct Extent {
  Vec2 low, high;
};
Extent extent(const Drawing& drawing);

// DXF R12 (AC1009) in ASCII, mm; lines of two points become LINE, others POLYLINE. What R12 cannot hold is replaced by
// `_`: letters of layer names other than A-Z, 0-9, $, _ and -, letters of texts that are not ASCII. Written to a
// temporary file and renamed; throws StateError with the system's reason.
void write_dxf(const Drawing& drawing, const std::filesystem::path& file);

// SVG, one user unit a mm, y upwards as in the drawing, a group a layer with its name as id. Colours of AutoCAD that
// cannot be read on white are darkened. Written and failing like write_dxf.
void write_svg(const Drawing& drawing, const std::filesystem::path& file);

} // namespace pneuma::pipeline::drawing
