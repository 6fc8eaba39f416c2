// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/fabrication/fabrication.h"
#include "pipeline/drawing/drawing.h"
#include "pipeline/files/outputs.h"

namespace pneuma::stages::pattern {

// One flat strip and what flattening left in it. Seams have the same name in both strips they join; `mate` and
// `mate_length` of the sides are filled in here.
struct StripSheet {
  geometry::fabrication::FlatStrip flat;
  double distortion_max = 0; // largest principal strain from the flat strip to the form
};

struct RollSheet {
  double width = 1.55;
  double selvedge = 0.01; // not used along both its edges, m
  double gap = 0.01;      // between strips, m
  bool may_widen = false; // a roll as wide as the widest strip needs is taken where this one is too narrow
};

// Width: extent across the roll (y of the flat strip), length: along it (x).
struct StripFigures {
  std::string name;
  double width = 0, length = 0;         // of the net outline, m
  double cut_width = 0, cut_length = 0; // m
  double net_area = 0, cut_area = 0;    // m2
  double distortion_max = 0;
  double seam_mismatch_max = 0; // largest difference of length to a mating seam, m
};

// Left and right as seen along the seam.
struct SeamFigures {
  std::string name;
  std::string left, right;                  // strips
  double length_left = 0, length_right = 0; // m

  double length() const { return (length_left + length_right) / 2; }
  double mismatch() const { return length_left - length_right; }
};

struct Fabrication {
  std::vector<StripFigures> strips; // in the order given
  std::vector<SeamFigures> seams;   // in the order of their first strips
  geometry::fabrication::Nesting nesting;
  double roll_width = 0;              // m, that of the nesting
  double net_area = 0, cut_area = 0;  // m2
  double weld_length = 0;             // of all seams, m
  double seam_mismatch_max = 0;       // m
  double mismatch_per_length_max = 0; // m/m
  pipeline::drawing::Drawing drawing; // layers CUT, NET, NOTCH, TEXT, WARP, DIM; the strips where they lie on the roll
  std::string strips_table, seams_table; // CSV
};

// Cuts the strips of a foil out of a roll and draws what a manufacturer needs. Throws GeometryError with the strip's
// name (see cut_strip, nest).
Fabrication fabricate(const std::string& foil, std::span<const StripSheet> strips,
                      const geometry::fabrication::Allowances& allowances, const RollSheet& roll);

// Writes `<foil>.dxf`, `<foil>.svg`, `<foil>_strips.csv` and `<foil>_seams.csv`, each whole or not at all. Throws
// MachineError.
void write_sheets(const std::string& foil, const Fabrication& made, pipeline::files::Outputs& outputs);

} // namespace pneuma::stages::pattern
