// SPDX-License-Identifier: GPL-3.0-or-later
// What a law costs in assembly, as the ratio to the elastic one in the same run: residual and tangent of a foil.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "solver/assembly/system.h"
#include "solver/material/nurbs_fit.h"
#include "tests/unit/solver/cushions.h"

namespace pneuma::tests {
namespace {

using namespace solver;

const material::StVenantKirchhoff elastic{900e6, 0.45};

struct Assembled {
  double seconds = std::numeric_limits<double>::infinity(); // of the quickest of several
  VecX forces;                                              // of the frame, N
};

std::vector<Assembled> assemble(ElementType element, const std::vector<material::Law>& laws) {
  Cushion cushion;
  cushion.element = element;
  cushion.divisions = geometry::is_quadratic(element) ? std::array{24, 12} : std::array{48, 24};
  cushion.heights = {0.1};
  cushion.base = true;
  std::vector<Assembled> results;
  std::vector<assembly::System> systems;
  std::vector<assembly::Configuration> configurations;
  for (const material::Law& law : laws) {
    assembly::Model model = model_of(cushion, 300);
    model.foils[0]->law = law;
    systems.emplace_back(std::move(model), 1);
    assembly::Configuration at = start_of(systems.back().model());
    for (Vec3& x : at.positions) x += Vec3(1e-2 * x.x(), 5e-3 * x.y(), 2e-2 * x.z()); // strains of 1 to 3 %
    configurations.push_back(std::move(at));
    results.emplace_back();
  }
  for (int repeat = 0; repeat < 7; ++repeat) { // by turns: what else the machine does meets all of them
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      systems[i].evaluate(configurations[i], true);
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
      results[i].seconds = std::min(results[i].seconds, time.count());
      results[i].forces = systems[i].support_forces();
    }
  }
  return results;
}

TEST(MaterialCost, TablesOfElasticityCarryItsForces) {
  material::NurbsOptions options;
  options.range = material::StrainRange{-0.05, 0.2};
  const material::PdNurbs pd{material::fit_pd_nurbs(material::Law(elastic), options).table};
  const material::LeNurbs le{material::fit_le_nurbs(material::Law(elastic), options).table};
  options.degree = 5;
  const material::PdNurbs of_degree_five{material::fit_pd_nurbs(material::Law(elastic), options).table};
  const std::vector<material::Law> laws = {elastic, pd, le, of_degree_five};
  for (const ElementType element : {ElementType::T3, ElementType::Q4, ElementType::T6, ElementType::Q9}) {
    const std::vector<Assembled> results = assemble(element, laws);
    const double scale = results[0].forces.cwiseAbs().maxCoeff();
    for (std::size_t i = 1; i < laws.size(); ++i) {
      EXPECT_LT((results[i].forces - results[0].forces).cwiseAbs().maxCoeff(), 1e-9 * scale);
    }
    const double once = results[0].seconds;
    std::printf(
        "%s: assembly %.2f ms; PD-NURBS of degree 3 %.2f, of degree 5 %.2f, LE-NURBS of degree 3 %.2f times it\n",
        geometry::name_of(element), 1e3 * once, results[1].seconds / once, results[3].seconds / once,
        results[2].seconds / once);
  }
}

} // namespace
} // namespace pneuma::tests
