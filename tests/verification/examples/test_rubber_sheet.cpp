// SPDX-License-Identifier: GPL-3.0-or-later
// Example B4 (Coelho 2012, sec. 3.3.4 and tables 4.3, 4.4; Gruttmann and Taylor 1992): a square sheet of Mooney-Rivlin
// rubber with a hole in its middle.
#include <cmath>

#include <fmt/format.h>

#include "tests/verification/examples/sheets.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

constexpr PerforatedSheet square{10, 10, 3, 10, 10, 0};
constexpr double thickness = 1e-3;               // m
constexpr double steps[] = {15e6, 52.5e6, 90e6}; // Pa, dead traction on the edge y = 10 m
const char* const mesh = "200 Q4, 231 nodes";

// Load factor 1: 90 MPa.
assembly::Model rubber_sheet(const material::Law& law) {
  assembly::Model model = plane_model(mesh_of(square), law, thickness);
  pull_edge(model, nodes_at(model.mesh, 1, square.height), 1, steps[2] * thickness);
  return model;
}

const material::MooneyRivlin rubber{25e6, 7e6};

TEST(PerforatedRubberSheet, NewtonsDisplacementsAreThoseOfTable43) {
  assembly::Model model = rubber_sheet(rubber);
  ASSERT_EQ(model.mesh.nodes.size(), 231u);
  ASSERT_EQ(model.mesh.element_count(model.mesh.blocks[0]), 200);
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model);
  // of the finest net, which the thesis says is the law's own; until 1e-5 m
  const std::vector<double> printed[] = {{1.14e1, 1.05, 2.14e-2, 1.55e-5, 4.44e-11},
                                         {3.10e1, 7.94, 7.14e-1, 2.13e-3, 1.03e-6},
                                         {4.77e1, 8.78, 2.63e-1, 2.02e-4, 1.81e-7}};
  for (std::size_t i = 0; i < 3; ++i) {
    at.load_factor = steps[i] / steps[2];
    const PlainNewton newton = plain_newton(system, at, 1e-5, 20);
    for (const double n : newton.norms) std::printf(" %.3e", n);
    std::printf("\n");
  }
}

} // namespace

} // namespace pneuma::tests
