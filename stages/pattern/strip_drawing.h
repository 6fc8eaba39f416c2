// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/fabrication/fabrication.h"
#include "pipeline/drawing/drawing.h"

namespace pneuma::stages::pattern {

// CUT, NET, NOTCH, TEXT, WARP, DIM with their colours.
std::vector<pipeline::drawing::Layer> strip_layers();

// Adds a strip where it lies on the roll: its outlines, its notches as lines of `notch_length` (m) from the cut
// inwards, the roll direction, its overall dimensions, and its name, those of the notches and along each side that of
// the seam and the mating strip: inside the strip, readable from below, clear of each other, smaller where room is
// short.
void draw_strip(const geometry::fabrication::FlatStrip& flat, const geometry::fabrication::CutStrip& cut,
                const geometry::fabrication::Placement& placement, double notch_length,
                pipeline::drawing::Drawing& drawing);

// Adds the part of the roll that is used, with its selvedges and its size; m.
void draw_roll(double length, double width, double selvedge, pipeline::drawing::Drawing& drawing);

// Says above a roll of this width where in the user's coordinates the plan has its centre, m.
void draw_plan_centre(const base::Vec2& centre, double width, pipeline::drawing::Drawing& drawing);

} // namespace pneuma::stages::pattern
