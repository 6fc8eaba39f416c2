// SPDX-License-Identifier: GPL-3.0-or-later
// The square sheet of Mooney-Rivlin rubber with a hole, examples B4 and B6 (Coelho 2012, sec. 3.3.4, 4.5.2; Gruttmann
// and Taylor 1992): a quarter of 20 m x 20 m with a hole of radius 3 m, pulled by dead forces on its edge y = 10 m.
#pragma once

#include "tests/verification/examples/sheets.h"

namespace pneuma::tests {

inline constexpr PerforatedSheet perforated_square{10, 10, 3, 10, 10, 0};
inline constexpr const char* rubber_mesh = "200 Q4, 231 nodes";
inline constexpr solver::material::MooneyRivlin rubber{25e6, 7e6};
inline constexpr std::array rubber_tractions = {15e6, 52.5e6, 90e6}; // Pa, the thesis' steps

// Load factor 1: the last traction.
inline solver::assembly::Model rubber_sheet(const solver::material::Law& law,
                                            const PerforatedSheet& sheet = perforated_square) {
  constexpr double thickness = 1e-3; // m
  solver::assembly::Model model = plane_model(mesh_of(sheet), law, thickness);
  pull_edge(model, nodes_at(model.mesh, 1, sheet.height), 1, rubber_tractions.back() * thickness);
  return model;
}

} // namespace pneuma::tests
