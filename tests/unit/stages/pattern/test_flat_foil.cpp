// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/flat_foil.h"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/meshing/plan_mesh.h"
#include "geometry/strips/lines.h"
#include "tests/unit/geometry/domes.h"

namespace pneuma::tests {
namespace {

using namespace stages::pattern;
using geometry::ElementType;

// A dome of 4 x 3 m over its plan, or the flat plan where `sag` is zero, cut along y = 0.
struct Cut {
  geometry::strips::CutMesh cut;

  Cut(ElementType element, double sag) {
    const geometry::Plan plan = geometry::Rectangle{4, 3};
    geometry::Mesh mesh =
        geometry::meshing::mesh_plan(plan, {element, 0.4, std::nullopt, geometry::meshing::Pattern::structured});
    for (Vec3& x : mesh.nodes) x.z() = domes::height(plan, x.head<2>(), sag);
    const geometry::strips::Surface surface = geometry::strips::prepare(plan, mesh, mesh.blocks[0], mesh.nodes);
    const geometry::strips::Cut lines{&surface,
                                      {geometry::strips::straight_line(surface, geometry::rim_position(plan, {-2, 0}),
                                                                       geometry::rim_position(plan, {2, 0}))}};
    cut = geometry::strips::cut(plan, mesh, {&lines, 1}, 0.4);
  }
  FlatFoil flat(const Wanted& wanted) const {
    return flatten_foil(cut.mesh, 0, geometry::StressRule::full, cut.foils[0], wanted);
  }
};

// Length of a side in the plane over that on the form, calls visit(side, ratio).
template <class Visit>
void each_side(const Cut& cut, const FlatFoil& foil, const Visit& visit) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  for (std::size_t s = 0; s < foil.sides.size(); ++s) {
    for (std::size_t k = 0; k < foil.sides[s].size(); ++k) {
      const auto& nodes = foil.sides[s][k].nodes;
      const auto& flat = foil.flat_sides[s][k];
      double form = 0;
      double plane = 0;
      for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        form += (cut.cut.mesh.nodes[at(nodes[i + 1])] - cut.cut.mesh.nodes[at(nodes[i])]).norm();
        plane += (foil.flat.points[at(flat[i + 1])] - foil.flat.points[at(flat[i])]).norm();
      }
      visit(foil.sides[s][k], plane / form);
    }
  }
}

TEST(FlatFoil, OfAFlatFoilIsSmallerByTheWantedStretch) {
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    const Cut cut(element, 0);
    Wanted wanted;
    wanted.stretch = {1 / (1 - 0.004), 1 / (1 - 0.001), 0};
    const FlatFoil foil = cut.flat(wanted);
    ASSERT_TRUE(foil.flat.converged);
    each_side(cut, foil, [&](const geometry::strips::StripSide& side, double ratio) {
      const bool along_roll = side.seam >= 0 ||
                              cut.cut.mesh.edges[static_cast<std::size_t>(side.edge)].name == "north" ||
                              cut.cut.mesh.edges[static_cast<std::size_t>(side.edge)].name == "south";
      EXPECT_NEAR(ratio, along_roll ? 0.996 : 0.999, 1e-8) << name_of(element);
    });
    // the roll across the plan's length: warp and weft change places
    wanted.direction = std::acos(-1.0) / 2;
    each_side(cut, cut.flat(wanted), [&](const geometry::strips::StripSide& side, double ratio) {
      if (side.seam >= 0) {
        EXPECT_NEAR(ratio, 0.999, 1e-8) << name_of(element);
      }
    });
  }
}

TEST(FlatFoil, DecompensatedKeepsItsClampedEdgesAndShrinksInside) {
  for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    for (const double sag : {0.0, 0.4}) {
      const Cut cut(element, sag);
      Wanted wanted;
      wanted.stretch = {1.005, 1.005, 0};
      wanted.decompensation = 0.5;
      const FlatFoil foil = cut.flat(wanted);
      ASSERT_TRUE(foil.flat.converged);
      each_side(cut, foil, [&](const geometry::strips::StripSide& side, double ratio) {
        if (side.edge >= 0) {
          EXPECT_NEAR(ratio, 1, 1e-9) << name_of(element) << sag;
        } else if (sag == 0) {
          EXPECT_LT(ratio, 0.998) << name_of(element);
        }
      });
      std::vector<double> seam; // its length in both strips
      for (const auto& strip : outlines(foil, cut.cut.mesh, 0)) {
        for (const geometry::fabrication::Side& side : strip.sides) {
          if (side.seam) seam.push_back(length(side));
        }
      }
      ASSERT_EQ(seam.size(), 2u);
      EXPECT_NEAR(seam[0], seam[1], 1e-9);
    }
  }
}

TEST(FlatFoil, ElasticStretchIsThatOfThePrestress) {
  // equal stretches: n = h E / (1 - nu) (g^2 - 1) / 2 per length of the strip as it lies flat
  const auto elastic = elastic_stretch(solver::material::StVenantKirchhoff{900e6, 0.45}, 200e-6, 890);
  ASSERT_TRUE(elastic.has_value());
  const double g = elastic->stretch[0];
  EXPECT_NEAR(g, elastic->stretch[1], 1e-15);
  EXPECT_NEAR(elastic->stretch[2], 0, 1e-15);
  EXPECT_NEAR(200e-6 * 900e6 / 0.55 * (g * g - 1) / 2, 890, 1e-6);
  EXPECT_LT((elastic->weight - elastic->weight.transpose()).norm(), 1e-9 * elastic->weight.norm());
  EXPECT_FALSE(elastic_stretch(solver::material::StVenantKirchhoff{900e6, 0.45}, 200e-6, -1e6).has_value());
}

} // namespace
} // namespace pneuma::tests
