// SPDX-License-Identifier: GPL-3.0-or-later
// What a law costs in the elements: internal forces and tangent of a stretched sheet, each law over St.
// Venant-Kirchhoff in the same run. Ratios are reported, not asserted.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "solver/element/membrane.h"
#include "solver/material/nurbs_fit.h"

namespace pneuma::tests {
namespace {

using namespace solver;
using base::Vec3;
using geometry::ElementType;

constexpr material::Elasticity elasticity{1100e6, 0.43};

material::Flow flow(std::vector<material::HardeningBranch> branches, material::Viscosity viscosity = {}) {
  return {material::piecewise_linear(branches).value(), viscosity};
}

class LawCost : public testing::TestWithParam<ElementType> {};

TEST_P(LawCost, IsReportedAsRatiosToTheElasticLaw) {
  const ElementType type = GetParam();
  const bool quadratic = geometry::is_quadratic(type);
  const std::array<int, 2> divisions = quadratic ? std::array{40, 20} : std::array{80, 40};
  const geometry::Mesh mesh = geometry::meshing::mesh_plan(geometry::Rectangle{2, 1}, {type, {}, divisions});
  const std::vector<base::Index>& connectivity = mesh.blocks.front().connectivity;
  element::Membrane membrane;
  membrane.connectivity = connectivity;
  membrane.reference = element::make_reference(type, geometry::StressRule::full,
                                               element::corner_coordinates(connectivity, mesh.nodes), Vec3::UnitX());
  membrane.thickness = 250e-6;
  // every point strained otherwise, mean strain `size`
  const auto stretched = [&](double size) {
    std::vector<Vec3> x = mesh.nodes;
    for (Vec3& p : x) {
      const double wave = 0.1 * size * std::sin(7 * p.x() + 5 * p.y());
      p = Vec3((1 + size) * p.x() + wave, (1 + 0.4 * size) * p.y() + wave, wave);
    }
    return x;
  };

  struct Measured {
    material::Law law;
    std::vector<Vec3> positions;
    std::vector<double> old_history, new_history;
    double best = 1e9; // s
  };
  const material::StVenantKirchhoff elastic{1100e6, 0.43};
  const material::Flow never = flow({{1e9, 0}});
  const material::Flow etfe = flow({{16e6, 160e6}, {27e6, 80e6}});
  const material::Viscosity creep{material::Overstress::perzyna, 1e4, 0.3, 1.5e6};
  const material::Flow creeping = flow({{16e6, 160e6}, {27e6, 80e6}}, creep);
  const material::Ogden treloar{3, {{{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}}}};
  material::NurbsOptions options;
  options.range = material::StrainRange{-0.05, 0.2};
  const material::Law tabled(elastic);
  const std::vector<Vec3> small = stretched(0.01);
  const std::vector<Vec3> large = stretched(0.2);
  std::vector<std::pair<std::string, Measured>> laws;
  const auto add = [&](const char* name, const material::Law& law, const std::vector<Vec3>& positions) {
    const auto size = static_cast<std::size_t>(material::history_components(law)) * membrane.reference.area.size();
    laws.push_back({name, {law, positions, std::vector<double>(size), std::vector<double>(size)}});
  };
  add("St. Venant-Kirchhoff", elastic, small);
  add("tension field of it", material::TensionField<material::StVenantKirchhoff>{elastic}, small);
  add("rubber", material::MooneyRivlin{0.2e6, 0.05e6}, large);
  add("Ogden, three terms", treloar, large);
  add("orthotropic", material::Orthotropic{1000e6, 300e6, 0.4, 50e6}, small);
  add("PD-NURBS, degree 3", material::PdNurbs{material::fit_pd_nurbs(tabled, options).table}, small);
  add("LE-NURBS, degree 3", material::LeNurbs{material::fit_le_nurbs(tabled, options).table}, small);
  options.degree = 5;
  add("PD-NURBS, degree 5", material::PdNurbs{material::fit_pd_nurbs(tabled, options).table}, small);
  options.degree = 3;
  const material::Law yielding(material::Logarithmic{elasticity, etfe});
  options.range = material::StrainRange{-0.3, 1};
  const material::StressPoint test{0.1, 0.1, 30e6, 30e6};
  add("PD-NURBS of a law that yields", material::PdNurbs{material::fit_pd_nurbs(yielding, options).table}, large);
  add("  and of a test", material::PdNurbs{material::fit_pd_nurbs(yielding, options, 0, {&test, 1}).table}, large);
  add("J2, elastic", material::J2{elasticity, never}, small);
  add("J2, flows", material::J2{elasticity, etfe}, large);
  add("J2, creeps", material::J2{elasticity, creeping}, large);
  add("logarithmic, elastic", material::Logarithmic{elasticity, never}, small);
  add("logarithmic, flows", material::Logarithmic{elasticity, etfe}, large);
  add("logarithmic, creeps", material::Logarithmic{elasticity, creeping}, large);
  add("tension field of it, flows", material::TensionField<material::Logarithmic>{{elasticity, etfe}}, large);

  double sum = 0;
  const auto run = [&](Measured& m) {
    membrane.law = m.law;
    double energy = 0;
    const auto begin = std::chrono::steady_clock::now();
    const auto failed = element::membrane_forces(membrane, m.positions, m.old_history, m.new_history, 10, true, energy,
                                                 [&](const element::ElementBatch& b) { sum += b.tangent[0]; });
    m.best = std::min(m.best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    EXPECT_FALSE(failed);
  };
  // second steps flow from a history that is not zero; laws take turns, the best of many counts
  for (auto& [name, m] : laws) {
    run(m);
    for (const double h : m.new_history) EXPECT_TRUE(std::isfinite(h));
    const std::vector<Vec3>& first = m.positions;
    m.old_history = m.new_history;
    std::vector<Vec3> further(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) further[i] = mesh.nodes[i] + 1.1 * (first[i] - mesh.nodes[i]);
    m.positions = further;
    m.best = 1e9;
  }
  for (int i = 0; i < 7; ++i) {
    for (auto& [name, m] : laws) run(m);
  }
  EXPECT_TRUE(std::isfinite(sum));
  const auto points = static_cast<double>(membrane.reference.area.size());
  std::printf("%d points an element\n", static_cast<int>(membrane.reference.points));
  for (const auto& [name, m] : laws) {
    std::printf("| %-30s | %5.0f ns a point | %4.2f |\n", name.c_str(), m.best / points * 1e9,
                m.best / laws.front().second.best);
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, LawCost,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& element) { return std::string(geometry::name_of(element.param)); });

} // namespace
} // namespace pneuma::tests
