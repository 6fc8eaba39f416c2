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
constexpr double thickness = 1e-3;                   // m
constexpr double tractions[] = {15e6, 52.5e6, 90e6}; // Pa, dead, on the edge y = 10 m
const char* const mesh = "200 Q4, 231 nodes";

// Load factor 1: 90 MPa.
assembly::Model rubber_sheet(const PerforatedSheet& sheet, const material::Law& law) {
  assembly::Model model = plane_model(mesh_of(sheet), law, thickness);
  pull_edge(model, nodes_at(model.mesh, 1, sheet.height), 1, tractions[2] * thickness);
  return model;
}

const material::MooneyRivlin rubber{25e6, 7e6};

TEST(PerforatedRubberSheet, NewtonsDisplacementsAreThoseOfTable43) {
  assembly::Model model = rubber_sheet(square, rubber);
  ASSERT_EQ(model.mesh.nodes.size(), 231u);
  ASSERT_EQ(model.mesh.element_count(model.mesh.blocks[0]), 200);
  assembly::System system(model, 1);
  assembly::Configuration at = start_of(model);
  // Columns of the two finest nets of PD-NURBS, first three iterations: later ones show the nets' own kinks. In the
  // second step 7.1e-1 is printed for the net of 70, first iteration: that of the third.
  const double finest[3][3] = {{1.14e1, 1.05, 2.14e-2}, {3.10e1, 7.94, 7.14e-1}, {4.77e1, 8.78, 2.63e-1}};
  const double next[3][3] = {{1.14e1, 1.05, 2.15e-2}, {3.10e1, 7.95, 7.10e-1}, {4.77e1, 8.79, 2.58e-1}};
  for (std::size_t i = 0; i < 3; ++i) {
    at.load_factor = tractions[i] / tractions[2];
    const PlainNewton newton = plain_newton(system, at, 1e-8, 20);
    ASSERT_TRUE(newton.converged);
    EXPECT_LE(newton.norms.size(), 6u);
    for (std::size_t k = 0; k < 3; ++k) {
      const double printed = finest[i][k];
      const double digit = 0.5 * std::pow(10, std::floor(std::log10(printed)) - 2) / printed;
      expect({"B4", fmt::format("displacement norm, step {}, iteration {}, m", i + 1, k + 1),
              fmt::format("{:.3g}", printed), "table 4.3, net of 100", printed, newton.norms[k],
              digit + std::abs(next[i][k] / printed - 1),
              "half of the last printed digit, and the difference of the nets of 70 and 100", mesh,
              static_cast<int>(newton.norms.size())});
    }
  }
}

} // namespace

} // namespace pneuma::tests
