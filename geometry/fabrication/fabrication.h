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
  double mate_length = 0;   // of the seam in the mating strip, m: flattening leaves both a little different
  std::vector<Vec2> points; // along the net outline, counterclockwise, both ends included
};

double length(const Side& side); // m

// A strip as it lies flat, its length (roll direction) along x: the net outline is where welds and clamps hold.
struct FlatStrip {
  std::string name;
  std::vector<Side> sides; // counterclockwise, each ends where the next begins
};

struct Allowances {
  double seam = 0;          // beyond the net line of a seam, m (half the weld's width: the net line is its middle)
  double clamp = 0;         // beyond the net line of a clamped edge, m
  double notch_spacing = 0; // largest along seams, m; 0: no notches
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

// Wedges are cut off square where the mitre would reach farther from the net corner than this times the allowance.
constexpr double mitre_limit = 2;

// The cut outline with its allowances and notches. At a corner the lines parallel to both sides are prolonged until
// they meet; where one of them would then cut into the other side's allowance (a blunt corner between a seam and a
// clamped edge), the outline steps from one to the other. Notches of a seam stand at the same fractions of its length
// in both strips, so that they meet when welded; they are numbered in the seam's direction. Throws GeometryError with
// the strip's name and the place where the net outline is open or crosses itself, or the offset crosses itself (loops
// of the allowance's size, in hollows, are cut off instead).
CutStrip cut_strip(const FlatStrip& strip, const Allowances& allowances);

// Where a strip lies on the roll: turned by half a turn or not (never mirrored, never across the roll), then moved.
struct Placement {
  Index strip = 0;
  bool turned = false;
  Vec2 move; // x along the roll, y across it from its edge

  Vec2 operator()(const Vec2& point) const { return (turned ? -1 : 1) * point + move; }
};
struct Nesting {
  std::vector<Placement> placements;
  double length = 0;         // of roll used, m
  double waste_fraction = 0; // 1 - area of the cuts / (length x full roll width)
};

double roll_width_for(const std::vector<CutStrip>& strips, double selvedge); // that takes the widest of them, m

// Puts strips on a roll, longest first, side by side where the width allows, with `gap` between them: simple shelves.
// `width`: of the roll, m; `selvedge`: not used along both its edges, m. Throws GeometryError naming the strips that
// are wider than the roll allows, their widths, and the roll that would do.
Nesting nest(const std::vector<CutStrip>& strips, const std::vector<std::string>& names, double width, double selvedge,
             double gap);

} // namespace pneuma::geometry::fabrication
