// SPDX-License-Identifier: GPL-3.0-or-later
// Example B4 (Coelho 2012, sec. 3.3.4 and table 4.3): the sheet of rubber with a hole.
#include <cmath>

#include <fmt/format.h>

#include "tests/verification/examples/rubber_sheet.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

TEST(PerforatedRubberSheet, NewtonsDisplacementsAreThoseOfTable43) {
  assembly::System system(rubber_sheet(rubber), 1);
  const geometry::Mesh& mesh = system.model().mesh;
  ASSERT_EQ(mesh.nodes.size(), 231u);
  ASSERT_EQ(mesh.element_count(mesh.blocks[0]), 200);
  assembly::Configuration at = start_of(system.model());
  // What is printed are nets of PD-NURBS, not the law: columns of 100 and 40 control points. An error that falls at
  // least as the span of the net leaves two thirds of their difference; table 4.4 leaves 0.074 % to the net of 70.
  // (The difference of 70 and 100 was expected to bound it and does not: 0.1 %, while the second iteration of the last
  // step is 0.47 % off.) In the second step 7.1e-1 is printed twice in the column of 70: its first iteration is lost.
  const double finest[3][3] = {{1.14e1, 1.05, 2.14e-2}, {3.10e1, 7.94, 7.14e-1}, {4.77e1, 8.78, 2.63e-1}};
  const double coarse[3][3] = {{1.14e1, 1.06, 1.94e-2}, {3.10e1, 7.82, 7.07e-1}, {4.84e1, 8.60, 2.34e-1}};
  for (std::size_t i = 0; i < 3; ++i) {
    at.load_factor = rubber_tractions[i] / rubber_tractions.back();
    const PlainNewton newton = plain_newton(system, at, 1e-6, 20);
    ASSERT_TRUE(newton.converged);
    EXPECT_LE(newton.norms.size(), 5u);
    for (std::size_t k = 0; k < 3; ++k) {
      const double printed = finest[i][k];
      const double digit = 0.5 * std::pow(10, std::floor(std::log10(printed)) - 2) / printed;
      const double tolerance = digit + 7.4e-4 + 2.0 / 3 * std::abs(coarse[i][k] / printed - 1);
      expect({"B4", fmt::format("displacement norm, step {}, iteration {}, m", i + 1, k + 1),
              fmt::format("{:.3g}", printed), "table 4.3, net of 100", printed, newton.norms[k], tolerance,
              "the last printed digit and the net's error", rubber_mesh, static_cast<int>(newton.norms.size())});
    }
  }
}

TEST(PerforatedRubberSheet, DisplacementsAreThoseOfAFinerMesh) {
  // Gruttmann and Taylor show curves of the nodes at the ends of the hole and of the edge; their numbers are in a
  // figure.
  PerforatedSheet finer = perforated_square;
  finer.radial *= 4;
  finer.side *= 4;
  const Solved s(rubber_sheet(rubber), 3);
  const Solved fine(rubber_sheet(rubber, finer), 3);
  ASSERT_TRUE(s.converged() && fine.converged());
  struct Place {
    const char* name;
    Vec3 at;
    int component;
  };
  for (const Place& p : {Place{"x of the hole's side", {3, 0, 0}, 0}, Place{"y of the hole's top", {0, 3, 0}, 1},
                         Place{"y of the edge's middle", {0, 10, 0}, 1}, Place{"x of the corner", {10, 10, 0}, 0},
                         Place{"y of the corner", {10, 10, 0}, 1}}) {
    const auto displacement = [&](const Solved& of) {
      const geometry::Mesh& mesh = of.system.model().mesh;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        if ((mesh.nodes[i] - p.at).norm() < 1e-9) return of.at.positions[i][p.component] - p.at[p.component];
      }
      return 0.0;
    };
    expect({"B4", fmt::format("displacement {}, 90 MPa, m", p.name), "figure 3.9", "16 times the elements",
            displacement(fine), displacement(s), 0.02, "Q4: h^2, with ten elements over a field that changes by 4",
            rubber_mesh, s.iterations()});
  }
}

} // namespace

} // namespace pneuma::tests
