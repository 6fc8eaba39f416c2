// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "geometry/meshing/plan_mesh.h"
#include "solver/element/membrane.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;

const Orthotropic fabric{1000e6, 300e6, 0.4, 50e6};

TEST(Orthotropic, PulledAlongAnAxisHasItsModulusAndNarrowsByItsRatio) {
  const Mat3 compliance = fabric.stiffness().inverse();
  for (const double stress : {1e3, 5e6}) {
    const Vec3 along1 = compliance * Vec3(stress, 0, 0);
    EXPECT_NEAR(along1[0], stress / 1000e6, 1e-15 * stress / 1000e6);
    EXPECT_NEAR(along1[1], -0.4 * along1[0], 1e-15 * along1[0]);
    const Vec3 along2 = compliance * Vec3(0, stress, 0);
    EXPECT_NEAR(along2[1], stress / 300e6, 1e-15 * stress / 300e6);
    EXPECT_NEAR(along2[0], -0.12 * along2[1], 1e-15 * along2[1]); // nu21 = 0.4 * 300 / 1000
    EXPECT_NEAR(compliance(2, 2), 1 / 50e6, 1e-15 / 50e6);
  }
}

TEST(Orthotropic, OfEqualModuliIsTheIsotropicLaw) {
  const StVenantKirchhoff isotropic{900e6, 0.45};
  const Orthotropic law{900e6, 900e6, 0.45, 900e6 / 2.9};
  for (const Vec3& strain : {Vec3(0.01, 0.02, -0.03), Vec3(0, 0, 0), Vec3(-0.2, 0.4, 0.1)}) {
    const Response one = answer(law, strain);
    const Response other = answer(isotropic, strain);
    EXPECT_LT(relative_difference(one.tangent, other.tangent), 1e-15);
    EXPECT_LT((one.stress - other.stress).norm(), 1e-15 * 900e6);
    EXPECT_NEAR(one.energy, other.energy, 1e-14 * other.energy);
    EXPECT_NEAR(law.thickness_stretch(strain, nullptr), isotropic.thickness_stretch(strain, nullptr), 1e-15);
  }
}

TEST(Orthotropic, GetsThinnerByItsOwnRatiosOrKeepsItsVolume) {
  const Mat3 compliance = fabric.stiffness().inverse();
  const Vec3 pulled1 = compliance * Vec3(1e6, 0, 0);
  const Vec3 pulled2 = compliance * Vec3(0, 1e6, 0);
  // as in the width: nu13 = 0.4, nu23 = nu21 = 0.12
  EXPECT_NEAR(fabric.thickness_stretch(pulled1, nullptr), std::sqrt(1 - 2 * 0.4 * 1e-3), 1e-15);
  EXPECT_NEAR(fabric.thickness_stretch(pulled2, nullptr), std::sqrt(1 - 2 * 0.12 * 1e6 / 300e6), 1e-15);
  Orthotropic solid = fabric;
  solid.poissons_ratio_13 = 1 - 0.4;
  solid.poissons_ratio_23 = 1 - 0.12;
  for (const Vec3& strain : {pulled1, pulled2, Vec3(2e-6, 1e-6, 3e-6)}) {
    const double e33 = 0.5 * (std::pow(solid.thickness_stretch(strain, nullptr), 2) - 1);
    EXPECT_NEAR(e33, -strain[0] - strain[1], 1e-15);
  }
}

TEST(Orthotropic, SaysWhereItsEnergyIsNotPositive) {
  EXPECT_TRUE(fabric.positive_definite());
  for (const Orthotropic& law : {fabric, Orthotropic{300e6, 1000e6, 0.54, 50e6}, Orthotropic{300e6, 1000e6, 0.55, 50e6},
                                 Orthotropic{300e6, 1000e6, -0.55, 50e6}, Orthotropic{-1e6, 1e6, 0.1, 1e6},
                                 Orthotropic{1e6, -1e6, 0.1, 1e6}, Orthotropic{1e6, 1e6, 0.1, -1e6}}) {
    const double least = Eigen::SelfAdjointEigenSolver<Mat3>(law.stiffness()).eigenvalues()[0];
    EXPECT_EQ(law.positive_definite(), least > 0) << law.youngs_modulus_1 << " " << law.poissons_ratio_12;
  }
  EXPECT_FALSE((Orthotropic{1e6, 1e6, std::nan(""), 1e6}).positive_definite());
}

class EveryElementAndAngle : public testing::TestWithParam<std::tuple<geometry::ElementType, double>> {};
INSTANTIATE_TEST_SUITE_P(Orthotropic, EveryElementAndAngle,
                         testing::Combine(testing::Values(geometry::ElementType::T3, geometry::ElementType::T6,
                                                          geometry::ElementType::Q4, geometry::ElementType::Q9),
                                          testing::Values(0.0, 0.5, 2.1)),
                         [](const auto& point) {
                           return fmt::format("{}Warp{:.0f}", name_of(std::get<0>(point.param)),
                                              10 * std::get<1>(point.param));
                         });

// A disc of elements of all shapes, its warp in any direction, stretched and sheared alike everywhere, then turned in
// space: one stress, that of the law in the turned frame, and no force on any inner node.
TEST_P(EveryElementAndAngle, PassesThePatchTest) {
  using namespace solver;
  const auto [type, angle] = GetParam();
  const geometry::Mesh plan = geometry::meshing::mesh_plan(geometry::Circle{0.5}, {type, {}, std::array{3, 3}});
  element::Membrane foil;
  foil.connectivity = plan.blocks[0].connectivity;
  foil.reference = element::make_reference(type, geometry::StressRule::full,
                                           element::corner_coordinates(foil.connectivity, plan.nodes),
                                           Vec3(std::cos(angle), std::sin(angle), 0));
  foil.law = fabric;
  foil.thickness = 250e-6;
  Mat2 stretch; // in the plane of the disc
  stretch << 1.03, 0.02, -0.01, 0.98;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> moved;
  for (const Vec3& x : plan.nodes) {
    const base::Vec2 y = stretch * x.head<2>();
    moved.push_back(turn * Vec3(y[0], y[1], 0));
  }

  // E in the frame of warp and weft
  Mat2 frame;
  frame << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const Mat2 e = frame.transpose() * (0.5 * (stretch.transpose() * stretch - Mat2::Identity())) * frame;
  const double c = 1 / (1 - 0.4 * 0.12);
  const Vec3 expected(c * 1000e6 * (e(0, 0) + 0.12 * e(1, 1)), c * 300e6 * (e(1, 1) + 0.4 * e(0, 0)),
                      50e6 * 2 * e(0, 1));
  const double modulus = 1000e6;
  for (const element::PointState& p : element::point_states(foil, moved, {})) {
    EXPECT_LT((p.stress - expected).cwiseAbs().maxCoeff(), 1e-14 * modulus);
  }
  std::vector<Vec3> force(plan.nodes.size(), Vec3::Zero());
  double energy = 0;
  const auto nodes = static_cast<std::size_t>(nodes_per_element(type));
  const auto failed =
      element::membrane_forces(foil, moved, {}, {}, 0, true, energy, [&](const element::ElementBatch& batch) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(batch.count) * nodes; ++k) {
          const auto node =
              static_cast<std::size_t>(foil.connectivity[static_cast<std::size_t>(batch.first) * nodes + k]);
          force[node] += Eigen::Map<const Vec3>(batch.force + 3 * k);
        }
      });
  EXPECT_FALSE(failed);
  int inner = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (plan.nodes[i].norm() > 0.5 * (1 - 1e-9)) continue;
    EXPECT_LT(force[i].norm(), 1e-14 * modulus * foil.thickness) << i; // N per m of 1
    ++inner;
  }
  EXPECT_GT(inner, 0);
}

} // namespace
} // namespace pneuma::tests
