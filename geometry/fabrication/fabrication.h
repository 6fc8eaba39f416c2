// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry::fabrication {

using base::Index;
using base::Vec2;

// A side of a flat strip: a seam to another strip, or a clamped edge.
struct Side {
  std::string name; // of the seam ("S2") or of the plan's edge ("south")
  bool seam = false;
  std::string mate;         // name of the strip on the other side of a seam
  bool reversed = false;    // runs against the seam's direction: the mating strip sees it the other way round
  std::vector<Vec2> points; // along the net outline, counterclockwise, both ends included
};

// A strip as it lies flat, its length (roll direction) along x: the net outline is where welds and clamps hold.
struct FlatStrip {
  std::string name;
  std::vector<Side> sides; // counterclockwise, each ends where the next begins
};

struct Allowances {
  double seam = 0;          // beyond the net line of a seam, m (half the weld's width: the net line is its middle)
  double clamp = 0;         // beyond the net line of a clamped edge, m
  double notch_spacing = 0; // along seams, m
};

struct Notch {
  Vec2 at;          // on the cut outline, m
  Vec2 inwards;     // unit vector
  std::string name; // the same on both mating strips: "S2-3"
};

struct CutStrip {
  std::vector<Vec2> net;     // closed ring, counterclockwise
  std::vector<Vec2> outline; // closed ring of the cut, counterclockwise: true offset, mitred corners
  std::vector<Notch> notches;
  double area = 0, net_area = 0; // m2
  Vec2 low, high;                // bounding box of the cut
};

// The cut outline with its allowances and notches. Notches of a seam stand at the same fractions of its length in both
// strips, so that they meet when welded. Throws GeometryError with the strip's name and the place where the offset
// crosses itself.
CutStrip cut_strip(const FlatStrip& strip, const Allowances& allowances);

// Where a strip lies on the roll: turned by half a turn or not (never mirrored, never across the roll), then moved.
struct Placement {
  Index strip = 0;
  bool turned = false;
  Vec2 move; // x along the roll
};
struct Nesting {
  std::vector<Placement> placements;
  double length = 0;         // of roll used, m
  double waste_fraction = 0; // 1 - area of the cuts / (length x full roll width)
};

// Puts strips on a roll, longest first, side by side where the width allows, with `gap` between them: simple shelves.
// `width`: of the roll, m; `selvedge`: not used along both its edges, m. Throws GeometryError naming the strips that
// are wider than the roll allows, their widths, and the roll that would do.
Nesting nest(const std::vector<CutStrip>& strips, const std::vector<std::string>& names, double width, double selvedge,
             double gap);

} // namespace pneuma::geometry::fabrication
