// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/test_piece.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "solver/material/hardening_fit.h"
#include "solver/material/nurbs_fit.h"

namespace pneuma::tests {
namespace {

using base::Mat3;
using base::Vec3;
using namespace solver::material;

const StVenantKirchhoff foil{900e6, 0.45};
const MooneyRivlin rubber{0.4e6, 0.1e6};

// Newton stops at 1e-13 of the strain and converges quadratically; the rest is rounding.
constexpr double sharp = 1e-12;

TEST(TestPiece, UniaxialElasticFoilFollowsItsClosedForm) {
  // S = E E11 with E22 = -nu E11; n = (1 + e) S
  for (const double e : {1e-9, 0.01, 0.3, -0.2}) {
    TestPiece piece(foil);
    ASSERT_TRUE(piece.advance(uniaxial(), e)) << e;
    const double green = e + 0.5 * e * e;
    EXPECT_NEAR(piece.state().nominal_stress()[0] / ((1 + e) * foil.youngs_modulus * green), 1, sharp) << e;
    EXPECT_NEAR(piece.state().strain[1] / (-foil.poissons_ratio * green), 1, sharp) << e;
    EXPECT_NEAR(piece.state().engineering_strain()[0], e, sharp * std::abs(e));
    EXPECT_NEAR(piece.driven(uniaxial()), e, sharp * std::abs(e));
    EXPECT_NEAR(piece.state().energy / (0.5 * foil.youngs_modulus * green * green), 1, sharp) << e;
  }
}

TEST(TestPiece, RatioOfTheNominalStressesIsHeld) {
  // a force twice as large along 1: from a chosen pair of S the strains, and from them the ratio of the forces
  for (const auto& [s1, s2] : {std::pair{20e6, 10e6}, {12e6, 12e6}, {5e6, 30e6}, {10e6, -10e6}}) {
    const Vec3 strain = foil.stiffness().inverse() * Vec3(s1, s2, 0);
    const Vec3 nominal(s1 * std::sqrt(1 + 2 * strain[0]), s2 * std::sqrt(1 + 2 * strain[1]), 0);
    const Control control = biaxial(nominal[0], nominal[1]);
    const double larger = strain[std::abs(nominal[1]) > std::abs(nominal[0]) ? 1 : 0];
    TestPiece by_strain(foil);
    ASSERT_TRUE(by_strain.advance(control, std::sqrt(1 + 2 * larger) - 1));
    EXPECT_LT((by_strain.state().strain - strain).norm(), sharp * strain.norm());
    TestPiece by_force(foil);
    ASSERT_TRUE(by_force.advance(stresses(nominal), 1));
    EXPECT_LT((by_force.state().strain - strain).norm(), sharp * strain.norm());
  }
}

TEST(TestPiece, RubberFollowsTreloarsClosedForms) {
  const auto [c1, c2] = rubber;
  for (const double a : {0.4, 0.9, 1.2, 2.0, 6.0}) {
    const double scale = c1 * std::pow(std::max(a, 1 / a), 5); // of the largest term
    TestPiece tension(rubber), wide(rubber), equal(rubber);
    ASSERT_TRUE(tension.advance(uniaxial(), a - 1)) << a; // in one step
    EXPECT_NEAR(tension.state().nominal_stress()[0], 2 * (a - 1 / (a * a)) * (c1 + c2 / a), sharp * scale) << a;
    EXPECT_NEAR(tension.state().true_stress()[0], a * tension.state().nominal_stress()[0], sharp * scale * a);
    EXPECT_NEAR(tension.state().thickness_stretch, 1 / std::sqrt(a), sharp);
    EXPECT_NEAR(tension.state().logarithmic_strain()[1], -0.5 * std::log(a), sharp);
    ASSERT_TRUE(wide.advance(wide_strip(), a - 1)) << a;
    EXPECT_NEAR(wide.state().nominal_stress()[0], 2 * (a - 1 / (a * a * a)) * (c1 + c2), sharp * scale) << a;
    ASSERT_TRUE(equal.advance(strains({1, 1, 0}), a - 1)) << a;
    EXPECT_NEAR(equal.state().nominal_stress()[0], 2 * (a - std::pow(a, -5)) * (c1 + c2 * a * a), sharp * scale) << a;
  }
}

TEST(TestPiece, ShearIsFreeOfStressAlongTheAxes) {
  TestPiece piece(foil);
  ASSERT_TRUE(piece.advance(shear(), 0.2));
  const double G = foil.youngs_modulus / (2 * (1 + foil.poissons_ratio));
  EXPECT_NEAR(piece.state().stress[2] / (0.2 * G), 1, sharp);
  EXPECT_LT(std::abs(piece.state().stress[0]), sharp * G);
}

TEST(TestPiece, IsotropicLawsKnowNoAngle) {
  for (const double angle : {0.3, std::numbers::pi / 2, 2.0}) {
    TestPiece straight(rubber), turned(rubber, angle);
    ASSERT_TRUE(straight.advance(biaxial(2, 1), 0.8));
    ASSERT_TRUE(turned.advance(biaxial(2, 1), 0.8));
    EXPECT_LT((straight.state().stress - turned.state().stress).norm(), sharp * straight.state().stress.norm());
    EXPECT_LT((straight.state().tangent - turned.state().tangent).norm(), sharp * straight.state().tangent.norm());
  }
}

TEST(TestPiece, OneControlFollowsAnother) {
  TestPiece piece(rubber);
  ASSERT_TRUE(piece.advance(uniaxial(), 1.0, 2));
  const PieceState loaded = piece.state();
  // an elastic law neither creeps nor relaxes
  const Control creep = stresses({1, 0, 0});
  ASSERT_TRUE(piece.advance(creep, piece.driven(creep), 1e6));
  EXPECT_LT((piece.state().strain - loaded.strain).norm(), sharp);
  EXPECT_DOUBLE_EQ(piece.state().time, 2 + 1e6);
  // to biaxial tension from there, and back to nothing
  ASSERT_TRUE(piece.advance(biaxial(1, 1), 0.5));
  EXPECT_NEAR(piece.state().nominal_stress()[0], piece.state().nominal_stress()[1], sharp * rubber.c1);
  ASSERT_TRUE(piece.advance(stresses({1, 1, 0}), 0));
  EXPECT_LT(piece.state().strain.norm(), sharp);
}

// thesis table 6.1
const std::vector<HardeningBranch> etfe_branches = {{16e6, 160e6}, {27e6, 80e6}};
const Elasticity etfe_elasticity{1100e6, 0.43};
const Flow etfe_flow{*piecewise_linear(etfe_branches), {}};

TEST(TestPiece, UniaxialPlasticFoilFollowsThePolygonOfItsBranches) {
  const HardeningFit polygon{etfe_elasticity.youngs_modulus, etfe_branches, 0};
  TestPiece small(J2{etfe_elasticity, etfe_flow}), large(Logarithmic{etfe_elasticity, etfe_flow});
  for (int i = 1; i <= 60; ++i) {
    const double stretch = 1 + 0.005 * i;
    ASSERT_TRUE(small.advance(uniaxial(), stretch - 1));
    ASSERT_TRUE(large.advance(uniaxial(), stretch - 1));
    const double S = polygon.stress_at(0.5 * (stretch * stretch - 1));
    const double kirchhoff = polygon.stress_at(std::log(stretch));
    EXPECT_NEAR(small.state().nominal_stress()[0] / (stretch * S), 1, sharp) << i;
    EXPECT_NEAR(large.state().nominal_stress()[0] / (kirchhoff / stretch), 1, sharp) << i;
  }
  // unloaded, the elastic strain is gone
  const double plastic = large.state().logarithmic_strain()[0] - polygon.stress_at(std::log(1.3)) / 1100e6;
  ASSERT_TRUE(large.advance(stresses({1, 0, 0}), 0));
  EXPECT_NEAR(large.state().logarithmic_strain()[0], plastic, sharp);
}

TEST(TestPiece, AHeldStressCreepsAndAHeldStrainRelaxes) {
  // Perzyna, epsilon 1, threshold 5 MPa: sigma = 5 MPa + K alpha + sigma_y mu dalpha/dt with K = 160 MPa; in the end
  // creep comes to rest at alpha = (sigma - 5 MPa) / K, relaxation at sigma = 5 MPa + K alpha
  const Flow flow{etfe_flow.hardening, {Overstress::perzyna, 100, 1, 5e6}};
  const J2 law{etfe_elasticity, flow};
  TestPiece creep(law), relaxation(law);
  const Control tension = stresses({1, 0, 0});
  ASSERT_TRUE(creep.advance(tension, 10e6));
  const double elastic = creep.state().engineering_strain()[0];
  ASSERT_TRUE(relaxation.advance(uniaxial(), elastic));
  for (int i = 0; i < 200; ++i) {
    const double before = creep.state().strain[0];
    ASSERT_TRUE(creep.advance(tension, 10e6, 100));
    ASSERT_TRUE(relaxation.advance(uniaxial(), elastic, 100));
    EXPECT_GE(creep.state().strain[0], before);
    EXPECT_NEAR(creep.state().nominal_stress()[0] / 10e6, 1, sharp);
  }
  const double alpha = creep.state().history[3];
  EXPECT_NEAR(alpha, (creep.state().stress[0] - 5e6) / 160e6, 1e-9);
  EXPECT_NEAR(relaxation.state().stress[0] / (5e6 + 160e6 * relaxation.state().history[3]), 1, 1e-9);
  EXPECT_LT(relaxation.state().stress[0], 10e6);
  EXPECT_DOUBLE_EQ(creep.state().time, 200 * 100);
}

TEST(TestPiece, ATensionFieldInTensionIsItsLaw) {
  TestPiece plain(rubber), field(TensionField<MooneyRivlin>{rubber});
  for (const double e : {0.5, 1.5}) {
    ASSERT_TRUE(plain.advance(uniaxial(), e));
    ASSERT_TRUE(field.advance(uniaxial(), e));
    EXPECT_NEAR(field.state().nominal_stress()[0], plain.state().nominal_stress()[0], sharp * rubber.c1);
  }
}

TEST(TestPiece, ATableRestsWithoutStrainThoughItsStressIsZeroToRoundingOnly) {
  // uniaxial and equal tests of the elastic foil, as a machine gives them: the first row is zero
  std::vector<StressPoint> points;
  for (int i = 0; i <= 20; ++i) {
    const double s = 1e6 * i;
    points.push_back({s / foil.youngs_modulus, -foil.poissons_ratio * s / foil.youngs_modulus, s, 0, 1});
    points.push_back({0.55 * s / foil.youngs_modulus, 0.55 * s / foil.youngs_modulus, s, s, 1});
  }
  const PdNurbs table{fit_pd_nurbs(points, {}).table};
  for (const Control& control : {uniaxial(), biaxial(1, 1), biaxial(2, 1)}) {
    TestPiece piece(table);
    EXPECT_TRUE(piece.advance(control, 0));
    EXPECT_TRUE(piece.advance(control, 0.01));
    EXPECT_TRUE(piece.advance(control, 0));
    EXPECT_LT(piece.state().strain.norm(), 1e-15); // stress left over 1 GPa
  }
}

TEST(TestPiece, WhatCannotBeReachedIsSaidAndTheLastStateKept) {
  // no piece is shorter than nothing
  TestPiece piece(rubber);
  ASSERT_TRUE(piece.advance(uniaxial(), 0.5));
  EXPECT_FALSE(piece.advance(uniaxial(), -1.5));
  EXPECT_GT(piece.state().engineering_strain()[0], -1);
  EXPECT_LT(std::abs(piece.state().nominal_stress()[1]), 1e-9 * std::abs(piece.state().nominal_stress()[0]));
  // St. Venant-Kirchhoff in compression: n = E (1 + e)(e + e^2/2) is least at 1 + e = 1/sqrt(3)
  TestPiece svk(foil);
  EXPECT_FALSE(svk.advance(stresses({1, 0, 0}), -0.2 * foil.youngs_modulus));
  EXPECT_NEAR(svk.state().engineering_strain()[0], 1 / std::numbers::sqrt3 - 1, 2e-3); // of the smallest cut
  EXPECT_GT(svk.state().nominal_stress()[0], -foil.youngs_modulus / (3 * std::numbers::sqrt3) * (1 + 1e-9));
}

} // namespace
} // namespace pneuma::tests
