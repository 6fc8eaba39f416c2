// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "stages/common/foil_results.h"

namespace pneuma::tests {
namespace {

using namespace stages::common;
using geometry::ElementType;

constexpr double modulus = 900e6; // Pa
constexpr double ratio = 0.45;

// A flat foil of 4 x 2 m, cut along y = 0 into two strips that are stretched alike in both directions, each by its own.
struct Welded {
  geometry::Mesh mesh;
  std::vector<Index> strip_of_element;
  solver::element::Membrane membrane;

  Welded(ElementType element, const std::array<double, 2>& strain,
         const solver::material::Law& law = solver::material::StVenantKirchhoff{modulus, ratio})
      : mesh(geometry::meshing::mesh_plan(geometry::Rectangle{4, 2},
                                          {element, {}, std::array{8, 4}, geometry::meshing::Pattern::structured})) {
    const geometry::Block& block = mesh.blocks[0];
    std::vector<double> flat = solver::element::corner_coordinates(block.connectivity, mesh.nodes);
    const auto n = static_cast<std::size_t>(geometry::nodes_per_element(element));
    for (std::size_t e = 0; e < static_cast<std::size_t>(mesh.element_count(block)); ++e) {
      double y = 0;
      for (std::size_t a = 0; a < n; ++a) y += flat[3 * (e * n + a) + 1];
      const std::size_t strip = y > 0 ? 0 : 1;
      strip_of_element.push_back(static_cast<Index>(strip));
      for (std::size_t k = 3 * e * n; k < 3 * (e + 1) * n; ++k) flat[k] /= 1 + strain[strip];
    }
    membrane = {block.connectivity,
                solver::element::make_reference(element, geometry::StressRule::full, flat, Vec3::UnitX()), law, 200e-6};
  }
  Welded(const Welded&) = delete;

  FoilResults results(std::span<const Index> strips) const {
    return foil_results(mesh, 0, membrane, strips, mesh.nodes, mesh.nodes, {});
  }
};

// Cauchy stress of equal stretches: S = E / (1 - nu) (stretch^2 - 1) / 2 and no change of thickness in the law.
double stress(double strain) {
  const double stretch = 1 + strain;
  return modulus / (1 - ratio) * (stretch * stretch - 1) / 2;
}

TEST(FoilResults, OfStripsWithDifferentConstantStressHaveTheLargerOneNotTheirMean) {
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Welded foil(element, {0.004, 0.002});
    const FoilResults r = foil.results(foil.strip_of_element);
    const double larger = r.von_mises.max_gauss;
    EXPECT_NEAR(larger, stress(0.004), 0.01 * larger); // Cauchy: by thickness and stretch, 1 % at this strain
    EXPECT_NEAR(r.von_mises.max, larger, 1e-9 * larger) << name_of(element);
    EXPECT_NEAR(r.stress1.max, larger, 1e-9 * larger) << name_of(element);
    EXPECT_NEAR(r.von_mises.min, stress(0.002), 0.01 * larger) << name_of(element);
    EXPECT_NEAR(r.strain1.max, 0.004, 1e-12) << name_of(element);
    EXPECT_NEAR(r.strain2.min, 0.002, 1e-12) << name_of(element);
    for (std::size_t i = 0; i < foil.mesh.nodes.size(); ++i) {
      // the seam carries the larger one of both
      const double expected = foil.mesh.nodes[i].y() > -1e-9 ? r.von_mises.max : r.von_mises.min;
      EXPECT_NEAR(r.nodal_von_mises[i], expected, 1e-9 * larger) << name_of(element);
    }
  }
}

TEST(FoilResults, WithoutStripsSmearTheJump) {
  const Welded foil(ElementType::T6, {0.004, 0.002});
  const FoilResults whole = foil.results({});
  double seam = 0;
  for (std::size_t i = 0; i < foil.mesh.nodes.size(); ++i) {
    if (foil.mesh.nodes[i].norm() < 1e-9) seam = whole.nodal_von_mises[i];
  }
  EXPECT_GT(seam, stress(0.0022));
  EXPECT_LT(seam, stress(0.0038));
}

TEST(FoilResults, OfOneStripAreThoseOfTheWhole) {
  const Welded foil(ElementType::Q9, {0.003, 0.003});
  const std::vector<Index> one(foil.strip_of_element.size(), 0);
  const FoilResults whole = foil.results({}), single = foil.results(one);
  EXPECT_EQ(whole.von_mises.max, single.von_mises.max);
  EXPECT_EQ(whole.nodal_stress2, single.nodal_stress2);
}

TEST(FoilResults, OfSlackAreasHoldNeitherSagNorDeflectionNorStrain) {
  const solver::material::Law field =
      solver::material::TensionField<solver::material::StVenantKirchhoff>{{modulus, ratio}};
  const std::vector<Index>& none = {};
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Welded foil(element, {0.004, -0.002}, field); // the half at y < 0 is slack
    std::vector<Vec3> start = foil.mesh.nodes;
    for (Vec3& x : start) {
      if (x.y() > -1e-9) x.x() -= 0.01; // has moved by 0.01 m since
      if (x.y() < -0.1) x.z() += 0.3;   // slack: anywhere
    }
    const FoilResults r = foil_results(foil.mesh, 0, foil.membrane, none, start, foil.mesh.nodes, {});
    EXPECT_NEAR(r.slack_area, 1.004 * 1.004 / (1.004 * 1.004 + 0.998 * 0.998), 1e-12) << name_of(element);
    EXPECT_EQ(r.wrinkled_area, 0);
    EXPECT_NEAR(r.max_deflection, 0.01, 1e-12) << name_of(element);
    EXPECT_NEAR(r.strain2.max_gauss, 0.004, 1e-12);
    EXPECT_GE(r.stress2.min, 0); // recovered across the jump
    EXPECT_EQ(r.compressed_area, 0);
    const Welded slack(element, {-0.004, -0.002}, field);
    EXPECT_TRUE(std::isnan(slack.results({}).max_deflection));
    EXPECT_TRUE(std::isnan(slack.results({}).sag));
    EXPECT_EQ(slack.results({}).slack_area, 1);
  }
}

TEST(FoilResults, ShowTheSurfaceStateOfFoilsWithATensionFieldOnly) {
  for (const bool with : {false, true}) {
    const solver::material::StVenantKirchhoff law{modulus, ratio};
    const Welded foil(
        ElementType::T6, {0.004, -0.002},
        with ? solver::material::Law(solver::material::TensionField<solver::material::StVenantKirchhoff>{law})
             : solver::material::Law(law));
    State state;
    state.mesh = foil.mesh;
    add_fields({foil.results({})}, foil.mesh.nodes, state);
    const auto field = std::find_if(state.fields.begin(), state.fields.end(),
                                    [](const auto& f) { return f.name == "surface_state.plan"; });
    ASSERT_EQ(field != state.fields.end(), with);
    if (!with) continue;
    for (std::size_t e = 0; e < foil.strip_of_element.size(); ++e) {
      EXPECT_EQ(field->values[e], foil.strip_of_element[e] == 0 ? 0 : 2);
    }
  }
}

} // namespace
} // namespace pneuma::tests
