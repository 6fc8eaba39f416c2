// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/volume.h"
#include "solver/element/film.h"
#include "solver/element/membrane.h"
#include "solver/material/prestress.h"
#include "tests/unit/finite_differences.h"

namespace {

using namespace pneuma;
using namespace pneuma::geometry;
using namespace pneuma::solver;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tests::finite_difference_jacobian;
using tests::relative_difference;

// one element of about 1 m, plane, with straight sides, then moved about
std::vector<Vec3> plane_element(ElementType type) {
  std::vector<Vec3> x;
  if (corners_per_element(type) == 3) {
    x = {{0, 0, 0}, {1.1, 0.1, 0}, {0.2, 0.9, 0}};
  } else {
    x = {{0, 0, 0}, {1.1, 0.1, 0}, {1.2, 1.0, 0}, {-0.1, 0.9, 0}};
  }
  const std::size_t corners = x.size();
  if (is_quadratic(type)) {
    for (std::size_t c = 0; c < corners; ++c) x.push_back(0.5 * (x[c] + x[(c + 1) % corners]));
    if (corners == 4) x.push_back(0.25 * (x[0] + x[1] + x[2] + x[3]));
  }
  return x;
}

std::vector<Vec3> moved_about(std::vector<Vec3> x, double amount) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> d(-amount, amount);
  for (Vec3& v : x) v += Vec3(d(random), d(random), d(random));
  return x;
}

VectorXd flat(const std::vector<Vec3>& x) {
  VectorXd v(3 * static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) v.segment<3>(3 * static_cast<Eigen::Index>(i)) = x[i];
  return v;
}

std::vector<Vec3> nodes(const VectorXd& v) {
  std::vector<Vec3> x(static_cast<std::size_t>(v.size() / 3));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = v.segment<3>(3 * static_cast<Eigen::Index>(i));
  return x;
}

struct OneElement {
  std::vector<Index> connectivity;
  element::Membrane membrane;

  explicit OneElement(ElementType type, StressRule rule = StressRule::full, std::vector<double> predeformation = {}) {
    for (Index a = 0; a < nodes_per_element(type); ++a) connectivity.push_back(a);
    membrane.connectivity = connectivity;
    membrane.reference = element::make_reference(
        type, rule, element::corner_coordinates(connectivity, plane_element(type)), Vec3(1, 0.3, 0), predeformation);
    membrane.law = material::StVenantKirchhoff{900e6, 0.45};
    membrane.thickness = 250e-6;
  }

  struct Result {
    VectorXd force;
    MatrixXd tangent;
    double energy = 0;
  };
  Result evaluate(const VectorXd& x) const {
    Result r;
    const auto size = static_cast<Eigen::Index>(3 * connectivity.size());
    element::membrane_forces(membrane, nodes(x), {}, {}, 0, true, r.energy, [&](const element::ElementBatch& batch) {
      r.force = Eigen::Map<const VectorXd>(batch.force, size);
      r.tangent = Eigen::Map<const MatrixXd>(batch.tangent, size, size);
    });
    return r;
  }
};

class EveryElement : public testing::TestWithParam<ElementType> {};
INSTANTIATE_TEST_SUITE_P(Membrane, EveryElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& type) { return name_of(type.param); });

TEST_P(EveryElement, ForceIsTheDerivativeOfTheEnergyAndTangentOfTheForce) {
  const OneElement one(GetParam());
  const VectorXd x = flat(moved_about(plane_element(GetParam()), 0.1));
  const auto energy = [&](const VectorXd& y) { return VectorXd::Constant(1, one.evaluate(y).energy); };
  const auto force = [&](const VectorXd& y) { return one.evaluate(y).force; };
  const OneElement::Result at = one.evaluate(x);
  EXPECT_LT(relative_difference(finite_difference_jacobian(energy, x, 1e-3), at.force.transpose()), 1e-9);
  EXPECT_LT(relative_difference(finite_difference_jacobian(force, x, 1e-3), at.tangent), 1e-9);
  EXPECT_LT(relative_difference(at.tangent.transpose(), at.tangent), 1e-15);
}

TEST_P(EveryElement, RigidMotionGivesNoForce) {
  const OneElement one(GetParam());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> x = plane_element(GetParam());
  for (Vec3& v : x) v = turn * v + Vec3(5, -3, 2);
  // E h L = 2.25e5 N is what a strain of one would give
  EXPECT_LT(one.evaluate(flat(x)).force.cwiseAbs().maxCoeff(), 1e-14 * 2.25e5 * 10);
}

TEST_P(EveryElement, HomogeneousStretchGivesTheClosedFormStressAtEveryPoint) {
  const OneElement one(GetParam());
  std::vector<Vec3> x = plane_element(GetParam());
  for (Vec3& v : x) v *= 1.02;
  const double strain = 0.5 * (1.02 * 1.02 - 1);
  const double stress = 900e6 / (1 - 0.45) * strain;
  const double thickness = std::sqrt(1 - 2 * 0.45 / 0.55 * 2 * strain);
  for (const element::PointState& p : element::point_states(one.membrane, x, {})) {
    EXPECT_NEAR(p.stress[0], stress, 1e-9 * stress);
    EXPECT_NEAR(p.stress[1], stress, 1e-9 * stress);
    EXPECT_NEAR(p.stress[2], 0, 1e-9 * stress);
    EXPECT_NEAR(p.thickness_ratio, thickness, 1e-12);
    EXPECT_NEAR(p.cauchy(0, 0), stress / thickness, 1e-9 * stress); // F S F^T / (1.02^2 thickness)
  }
}

TEST_P(EveryElement, PredeformationCarriesThePrestressAtTheUnmovedShape) {
  const material::Law law = material::StVenantKirchhoff{900e6, 0.45};
  const Vec3 wanted(890, 650, 40); // N/m
  const auto g = material::predeformation(law, 250e-6, wanted);
  ASSERT_TRUE(g);
  const std::size_t points = stress_rule(GetParam()).size();
  std::vector<double> all;
  for (std::size_t i = 0; i < points; ++i) all.insert(all.end(), {(*g)[0], (*g)[1], (*g)[2]});
  const OneElement one(GetParam(), StressRule::full, all);
  for (const element::PointState& p : element::point_states(one.membrane, plane_element(GetParam()), {})) {
    // Cauchy force per current length = cauchy x current thickness; axes turned from the first material axis
    const base::Mat2 force = p.cauchy * 250e-6 * p.thickness_ratio;
    EXPECT_NEAR(force.trace(), 890 + 650, 1e-8);
    EXPECT_NEAR(force.determinant(), 890.0 * 650 - 40 * 40, 1e-5);
  }
}

TEST_P(EveryElement, ForcesOfAStretchedElementAreInBalance) {
  const OneElement one(GetParam());
  std::vector<Vec3> x = plane_element(GetParam());
  for (Vec3& v : x) v *= 1.01;
  const VectorXd f = one.evaluate(flat(x)).force;
  Vec3 sum = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3 fa = f.segment<3>(3 * static_cast<Eigen::Index>(a));
    sum += fa;
    moment += x[a].cross(fa);
  }
  EXPECT_LT(sum.norm(), 1e-10 * f.norm());
  EXPECT_LT(moment.norm(), 1e-10 * f.norm());
}

TEST_P(EveryElement, FilmForceIsTheDerivativeOfItsAreaAndTangentOfItsForce) {
  std::vector<Index> connectivity;
  for (Index a = 0; a < nodes_per_element(GetParam()); ++a) connectivity.push_back(a);
  const element::Film film{GetParam(), StressRule::full, connectivity, 890.0};
  const VectorXd x = flat(moved_about(plane_element(GetParam()), 0.1));
  const auto evaluate = [&](const VectorXd& y, double current) {
    OneElement::Result r;
    element::film_forces(film, nodes(y), current, r.energy, [&](const element::ElementBatch& batch) {
      r.force = Eigen::Map<const VectorXd>(batch.force, y.size());
      r.tangent = Eigen::Map<const MatrixXd>(batch.tangent, y.size(), y.size());
    });
    return r;
  };
  const auto energy = [&](const VectorXd& y) { return VectorXd::Constant(1, 890.0 * evaluate(y, 1).energy); };
  const auto force = [&](const VectorXd& y) { return evaluate(y, 1).force; };
  const OneElement::Result at = evaluate(x, 1);
  EXPECT_LT(relative_difference(finite_difference_jacobian(energy, x, 1e-3), at.force.transpose()), 1e-9);
  EXPECT_LT(relative_difference(finite_difference_jacobian(force, x, 1e-3), at.tangent), 1e-8);
  EXPECT_EQ(evaluate(x, 0).force, at.force); // the homotopy changes the tangent, never the force
}

TEST_P(EveryElement, PressureForceDerivativeMatchesDifferences) {
  const VectorXd x = flat(moved_about(plane_element(GetParam()), 0.1));
  dispatch(GetParam(), [&]<ElementType E>() {
    const auto evaluate = [](const VectorXd& y) {
      PressureElement<E> p;
      pressure_element<E>(Eigen::Map<const ElementPositions<E>>(y.data()), pressure_rule(E), true, p);
      return p;
    };
    const auto force = [&](const VectorXd& y) { return VectorXd(evaluate(y).force); };
    EXPECT_LT(relative_difference(finite_difference_jacobian(force, x, 1e-3), evaluate(x).derivative), 1e-10);
  });
}

} // namespace
