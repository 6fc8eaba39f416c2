// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/drawing/drawing.h"

namespace pneuma::tests {

// A strip of 12 m with awkward coordinates, a line and two texts.
inline pipeline::drawing::Drawing example_drawing() {
  return {"foil \"upper\" <A&B>",
          {{"CUT", 7}, {"NET", 5}, {"TEXT", 3}},
          {{"CUT", true, {{-0.0301234567, 0}, {12.3456789012, -0.001}, {12, 1.5}, {0, 1.0 / 3}}},
           {"NET", false, {{0, 0}, {1.0 / 7, 0.5}}},
           {"NET", false, {{0, 0}, {1, 0}, {1, 1}}}},
          {{"TEXT", {0.5, 0.25}, 0.04, 0, "U1 <S1 & S2>"}, {"TEXT", {2, 0.5}, 0.02, 0.5, "12345.6"}}};
}

} // namespace pneuma::tests
