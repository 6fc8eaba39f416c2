// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "geometry/volume.h"
#include "solver/load/loads.h"
#include "solver/recovery/patch_recovery.h"
#include "solver/recovery/reactions.h"
#include "tests/unit/solver/cushions.h"

namespace {

using namespace pneuma;
using namespace pneuma::geometry;
using namespace pneuma::solver;
using assembly::at;
using base::VecX;

constexpr std::array all_elements = {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9};

Mesh dome(ElementType type, int divisions) {
  Mesh mesh = meshing::mesh_plan(Rectangle{2, 1}, {type, {}, std::array{2 * divisions, divisions}});
  for (Vec3& x : mesh.nodes) x.z() = 0.2 * (1 - x.x() * x.x()) * (1 - 4 * x.y() * x.y());
  return mesh;
}

Vec3 sum_of(const VecX& force) {
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index k = 0; k < force.size(); k += 3) sum += force.segment<3>(k);
  return sum;
}

TEST(Loads, SnowOnACurvedFoilWeighsWhatItsPlanCarries) {
  for (const ElementType type : all_elements) {
    const Mesh mesh = dome(type, 4);
    VecX force = VecX::Zero(static_cast<Eigen::Index>(3 * mesh.nodes.size()));
    load::add_plan_load(mesh, 0, mesh.nodes, region_quadrature(mesh, mesh.blocks[0], mesh.nodes, WholePlan{}),
                        Vec3(0, 0, -500), force);
    EXPECT_NEAR(sum_of(force).z(), -1000, 1e-10) << name_of(type);
  }
}

TEST(Loads, PatchActsAtItsMiddleWithItsWholeForceOnEveryMesh) {
  for (const ElementType type : all_elements) {
    for (const int divisions : {3, 4, 7}) {
      const Mesh mesh = dome(type, divisions);
      const RegionQuadrature region =
          region_quadrature(mesh, mesh.blocks[0], mesh.nodes, PlanRectangle{{0.07, -0.2}, {0.53, 0.3}});
      const Vec3 total(10, 0, -100);
      VecX force = VecX::Zero(static_cast<Eigen::Index>(3 * mesh.nodes.size()));
      load::add_plan_load(mesh, 0, mesh.nodes, region, total / plan_area(mesh, mesh.blocks[0], mesh.nodes, region),
                          force);
      EXPECT_LT((sum_of(force) - total).norm(), 1e-10) << name_of(type) << divisions;
      double moment = 0; // about the y axis, per unit of vertical force: the x of the patch's middle
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        moment += mesh.nodes[i].x() * force[static_cast<Eigen::Index>(3 * i + 2)];
      }
      EXPECT_NEAR(moment / -100, 0.3, 1e-10) << name_of(type) << divisions;
    }
  }
}

TEST(Loads, ZoneOverTheWholeFoilIsTheFacePressure) {
  const Mesh mesh = dome(ElementType::T6, 4);
  assembly::PressureZone zone =
      load::pressure_zone(mesh, 0, region_quadrature(mesh, mesh.blocks[0], mesh.nodes, WholePlan{}));
  zone.pressure = {0.0, 200.0};
  ASSERT_EQ(zone.offset.size(), static_cast<std::size_t>(mesh.element_count(mesh.blocks[0])) + 1);
  Vec3 resultant = Vec3::Zero();
  PressureElement<ElementType::T6> p;
  for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
    const auto begin = static_cast<std::size_t>(zone.offset[static_cast<std::size_t>(e)]);
    const auto end = static_cast<std::size_t>(zone.offset[static_cast<std::size_t>(e) + 1]);
    pressure_element<ElementType::T6>(gather<ElementType::T6>(mesh.element_nodes(mesh.blocks[0], e), mesh.nodes),
                                      std::span(zone.points).subspan(begin, end - begin), false, p);
    for (int a = 0; a < 6; ++a) resultant += at(zone.pressure, 0.5) * p.force.segment<3>(3 * a);
  }
  EXPECT_LT((resultant - Vec3(0, 0, 100.0 * 2)).norm(), 1e-10); // 100 Pa on 2 m2 of plan at half the path
}

TEST(Recovery, ReproducesFieldsOfItsDegreeExactlyAndOthersWithItsOrder) {
  const auto linear = [](const Vec3& x) { return 3 + 2 * x.x() - x.y(); };
  const auto quadratic = [](const Vec3& x) { return x.x() * x.x() - 3 * x.x() * x.y() + 0.5 * x.y(); };
  const auto wavy = [](const Vec3& x) { return std::sin(2 * x.x() + 0.3) * std::cos(3 * x.y() + 0.2); };
  for (const ElementType type : all_elements) {
    const auto largest_error = [&](int divisions, const auto& field) {
      const Mesh mesh = meshing::mesh_plan(Rectangle{2, 1}, {type, {}, std::array{2 * divisions, divisions}});
      std::vector<double> values;
      dispatch(type, [&]<ElementType E>() {
        for (Index e = 0; e < mesh.element_count(mesh.blocks[0]); ++e) {
          const ElementPositions<E> x = gather<E>(mesh.element_nodes(mesh.blocks[0], e), mesh.nodes);
          for (const QuadraturePoint& q : stress_rule(E)) {
            values.push_back(field(Vec3(x * shape_functions<E>(q.xi, q.eta).value)));
          }
        }
      });
      const std::vector<double> nodal =
          recovery::recover_at_nodes(mesh, mesh.blocks[0], StressRule::full, mesh.nodes, values, 1);
      double error = 0;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        error = std::max(error, std::abs(nodal[i] - field(mesh.nodes[i])));
      return error;
    };
    EXPECT_LT(largest_error(4, linear), 1e-12) << name_of(type);
    if (is_quadratic(type)) {
      EXPECT_LT(largest_error(4, quadratic), 1e-12) << name_of(type);
    }
    const double order = std::log2(largest_error(16, wavy) / largest_error(32, wavy));
    EXPECT_GT(order, is_quadratic(type) ? 2.7 : 1.7) << name_of(type); // one above the field's own degree
  }
}

TEST(Recovery, LineLoadOfAUniformTractionIsThatTraction) {
  for (const ElementType type : all_elements) {
    const Mesh mesh = meshing::mesh_plan(Circle{1}, {type, {}, std::array{8, 8}});
    // consistent forces of a radial traction of 70 N/m along the rim
    std::vector<double> force(3 * mesh.nodes.size(), 0.0);
    const std::vector<Index>& rim = mesh.edges[0].nodes;
    const std::size_t step = is_quadratic(type) ? 2 : 1;
    for (std::size_t k = 0; k < rim.size(); k += step) {
      const std::array<std::size_t, 3> i = {k, k + 1, (k + step) % rim.size()};
      const double length = 2 * std::numbers::pi * static_cast<double>(step) / static_cast<double>(rim.size());
      const std::array<double, 3> weight =
          is_quadratic(type) ? std::array{1.0 / 6, 4.0 / 6, 1.0 / 6} : std::array{0.5, 0.0, 0.5};
      for (std::size_t a = 0; a < 3; ++a) {
        const auto node = static_cast<std::size_t>(rim[i[a] % rim.size()]);
        for (std::size_t c = 0; c < 2; ++c) {
          force[3 * node + c] += 70 * length * weight[a] * mesh.nodes[node][static_cast<Eigen::Index>(c)];
        }
      }
    }
    for (const Vec3& q : recovery::line_load(mesh, mesh.nodes, force).load) {
      EXPECT_NEAR(q.norm(), 70, 0.02 * 70) << name_of(type); // chords instead of the circle
    }
  }
}

TEST(Recovery, LineLoadOfASquaresEdgesDoesNotOvershootAtItsCorners) {
  for (const ElementType type : all_elements) {
    const Mesh mesh = meshing::mesh_plan(Rectangle{1, 1}, {type, {}, std::array{6, 6}});
    // 70 N/m outwards on every edge
    std::vector<double> force(3 * mesh.nodes.size(), 0.0);
    const std::size_t step = is_quadratic(type) ? 2 : 1;
    for (const Edge& edge : mesh.edges) {
      for (std::size_t k = 0; k + step < edge.nodes.size(); k += step) {
        const std::array<std::size_t, 3> i = {k, k + 1, k + step};
        const std::array<double, 3> weight =
            is_quadratic(type) ? std::array{1.0 / 6, 4.0 / 6, 1.0 / 6} : std::array{0.5, 0.0, 0.5};
        const Vec3 middle = mesh.nodes[static_cast<std::size_t>(edge.nodes[edge.nodes.size() / 2])];
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t c = 0; c < 2; ++c) {
            force[3 * static_cast<std::size_t>(edge.nodes[i[a]]) + c] +=
                70.0 / 6 * weight[a] * middle.normalized()[static_cast<Eigen::Index>(c)];
          }
        }
      }
    }
    for (const Vec3& q : recovery::line_load(mesh, mesh.nodes, force).load)
      EXPECT_NEAR(q.norm(), 70, 1e-9) << name_of(type);
  }
}

} // namespace
