// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the pattern stage against the formfind stage on the same mesh, over the number of elements. Times are
// reported; only PNEUMA_LONG=1, which goes up to 1e5 triangles a foil, holds their ratio and growth against what was
// promised.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {

namespace {

class PatternScale : public InFolder {
protected:
  struct Cost {
    double triangles = 0;        // a foil
    double form = 0, strips = 0; // s of wall time
    double memory = 0;           // bytes, of the pattern stage
    int iterations = 0;          // of the flattening
  };

  Cost run(int across) const {
    write(R"(pneuma: 1
name: Scale
materials: {foil: {law: elastic, E: 900 MPa, nu: 0.45}}
site: {gravity: off}
cushion:
  plan: {shape: rectangle, length: 6 m, width: 3 m}
  foils:
    - {name: upper, material: foil, thickness: 200 um}
    - {name: lower, material: foil, thickness: 200 um}
  chambers: [{name: main, between: [upper, lower]}]
mesh: {element: T3, divisions: [)" +
          std::to_string(2 * across) + ", " + std::to_string(across) + R"(]}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {main: 400 Pa}, prestress: {all: 0.89 kN/m}}
  strips: {run: pattern, from: form, strips_per_foil: 6, direction: 0 deg, compensation: elastic}
)");
    const Outcome outcome = pneuma("run w.yaml");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    const json form = summary("form");
    const json strips = summary("strips");
    const Cost cost{form["mesh"]["elements"].get<double>() / 2, form["timing"]["total"], strips["timing"]["total"],
                    strips["memory_peak"], strips["iterations"]};
    std::printf("| %6.0f | %6.2f | %6.2f | %4.2f | %5.0f | %d |\n", cost.triangles, cost.form, cost.strips,
                cost.strips / cost.form, cost.memory / 1e6, cost.iterations);
    return cost;
  }
};

TEST_F(PatternScale, WorkDoesNotGrowWithTheMeshAndTimeHardlyMore) {
  const bool all = std::getenv("PNEUMA_LONG") != nullptr;
  std::printf("triangles a foil | formfind, s | pattern, s | ratio | MB | iterations of the flattening\n");
  std::vector<Cost> costs;
  for (const int across : all ? std::vector<int>{50, 158} : std::vector<int>{26, 50}) costs.push_back(run(across));
  EXPECT_LE(costs.back().iterations, costs.front().iterations + 2);
  const double growth =
      std::log(costs.back().strips / costs.front().strips) / std::log(costs.back().triangles / costs.front().triangles);
  std::printf("growth exponent of the pattern stage: %.2f\n", growth);
  if (!all) return;
  EXPECT_LE(costs.back().strips, 3 * costs.back().form);
  EXPECT_LE(growth, 1.2);
}

} // namespace

} // namespace pneuma::tests
