// SPDX-License-Identifier: GPL-3.0-or-later
// Foils that cannot carry compression. PNEUMA_LONG=1 refines the airbag further.
#include <cmath>

#include <fmt/format.h>

#include "tests/unit/solver/cushions.h"

namespace pneuma::tests {

namespace {

using namespace solver;
using material::Surface;

// Parts of the stress-free area in each state.
struct Areas {
  double taut = 0, wrinkled = 0, slack = 0;
};

std::vector<element::PointState> states_of(const Solved& s, std::size_t foil) {
  return element::point_states(s.system.foils()[foil].membrane, s.at.positions, {});
}

Areas areas_of(const Solved& s, std::size_t foil) {
  const std::vector<element::PointState> points = states_of(s, foil);
  const std::vector<double>& area = s.system.foils()[foil].membrane.reference.area;
  Areas sum;
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    (points[i].surface == Surface::taut       ? sum.taut
     : points[i].surface == Surface::wrinkled ? sum.wrinkled
                                              : sum.slack) += area[i];
    total += area[i];
  }
  return {sum.taut / total, sum.wrinkled / total, sum.slack / total};
}

// One quarter of one foil of the square airbag of Contri and Schrefler (1988): diagonal 1.2 m, 0.6 mm, E 588 MPa,
// nu 0.4, flat and without stress at the start; the edge is held in z only, the lines of symmetry across themselves.
assembly::Model airbag(ElementType element, int divisions, double pressure) {
  const double half = 0.6 / std::sqrt(2.0);
  assembly::Model model;
  model.mesh = geometry::meshing::stack(
      geometry::meshing::mesh_plan(geometry::Rectangle{half, half}, {element, {}, std::array{divisions, divisions}}),
      {{"quarter"}});
  for (Vec3& x : model.mesh.nodes) x += Vec3(half / 2, half / 2, 0);
  for (const Vec3& x : model.mesh.nodes) {
    const auto is = [half](double a, double b) { return std::abs(a - b) < 1e-9 * half; };
    model.fixed.push_back(is(x.x(), 0) ? 1 : 0);
    model.fixed.push_back(is(x.y(), 0) ? 1 : 0);
    model.fixed.push_back(is(x.x(), half) || is(x.y(), half) ? 1 : 0);
  }
  const std::vector<double> corners = element::corner_coordinates(model.mesh.blocks[0].connectivity, model.mesh.nodes);
  model.foils.push_back(
      assembly::Foil{element::make_reference(element, geometry::StressRule::full, corners, Vec3(1, 0, 0)),
                     material::TensionField<material::StVenantKirchhoff>{{588e6, 0.4}}, 0.6e-3});
  model.face_pressure = {{0, pressure}};
  return model;
}

TEST(TensionField, SquareAirbagRisesAsInTheLiterature) {
  for (const auto& [element, divisions] :
       {std::pair{ElementType::T6, 8}, {ElementType::Q4, 16}, {ElementType::Q9, 8}, {ElementType::T3, 16}}) {
    Solved s(airbag(element, divisions, 5000));
    const Areas areas = areas_of(s, 0);
    double stress = 0;
    double nearest = 1e9;
    const std::vector<element::PointState> points = states_of(s, 0);
    double rise = 0;
    for (std::size_t k = 0; k < s.at.positions.size(); ++k) {
      if (s.system.model().mesh.nodes[k].norm() < 1e-9) rise = s.at.positions[k].z();
    }
    (void)nearest;
    (void)points;
    (void)stress;
    std::printf("| %s | %d | %.5f | %.3f | %.3f | %.3f | %d | %d | %d |%s\n", geometry::name_of(element), divisions,
                rise, areas.taut, areas.wrinkled, areas.slack, s.path.steps, s.iterations(),
                s.newton.work().factorizations, s.path.reason.c_str());
    EXPECT_TRUE(s.converged());
  }
}

TEST(TensionField, LowerFoilGoesSlack) {
  for (const bool field : {false, true}) {
    for (const ElementType element : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
      for (const int fine : {1, 2}) {
        Cushion c;
        c.plan = geometry::Rectangle{6, 3};
        c.element = element;
        c.divisions = geometry::is_quadratic(element) ? std::array{8, 4} : std::array{16, 8};
        c.divisions[0] *= fine;
        c.divisions[1] *= fine;
        c.heights = {0.4, -0.4};
        c.tension_field = field;
        assembly::Model model = model_of(c, 0);
        model.chambers[0].gas = chamber::Regulated{0, 300};
        Solved from(model);
        model.chambers[0].gas = closed_now(from, 0, 101325);
        model.face_pressure = {{0, 1500}, {0, 0}};
        Solved s(model, from.at);
        const Areas a0 = areas_of(s, 0);
        const Areas a1 = areas_of(s, 1);
        std::printf("| %d %s | %d | %d %d | gauge %.5f | %.3f %.3f %.3f | %.3f %.3f %.3f | %d | %d | %d |%s\n", field,
                    geometry::name_of(element), fine, from.iterations(), from.newton.work().factorizations,
                    s.at.pressures[0], a0.taut, a0.wrinkled, a0.slack, a1.taut, a1.wrinkled, a1.slack, s.path.steps,
                    s.iterations(), s.newton.work().factorizations, s.path.reason.c_str());
      }
    }
  }
}

} // namespace

} // namespace pneuma::tests
