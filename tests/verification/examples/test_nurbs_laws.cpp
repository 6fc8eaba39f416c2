// SPDX-License-Identifier: GPL-3.0-or-later
// Examples B5 to B7 (Coelho 2012, sec. 4.5): PD-NURBS against the laws that its tables are fitted to.
#include <cmath>

#include <fmt/format.h>

#include "solver/material/nurbs_fit.h"
#include "tests/verification/examples/rubber_sheet.h"
#include "tests/verification/examples/strip.h"
#include "tests/verification/examples/table.h"

namespace pneuma::tests {

namespace {

using namespace solver;

constexpr double percent = 100;

material::PdFit fit(const material::Law& law, int net, int degree, material::StrainRange range) {
  material::NurbsOptions options;
  options.net = {net, net};
  options.degree = degree;
  options.range = range;
  return material::fit_pd_nurbs(law, options);
}

// Displacements (x, y), stresses and strains (11, 22, 12) of a flat sheet: all of one kind in a row.
struct Fields {
  std::array<std::vector<double>, 8> values;

  Fields(const assembly::System& system, const assembly::Configuration& at) {
    for (std::size_t i = 0; i < at.positions.size(); ++i) {
      const Vec3 u = at.positions[i] - system.model().mesh.nodes[i];
      values[0].push_back(u.x());
      values[1].push_back(u.y());
    }
    for (const element::PointState& p :
         element::point_states(system.foils()[0].membrane, at.positions, system.history(0))) {
      for (int c = 0; c < 3; ++c) {
        values[2 + static_cast<std::size_t>(c)].push_back(p.stress[c]);
        values[5 + static_cast<std::size_t>(c)].push_back(p.strain[c]);
      }
    }
  }
};

double largest(const std::vector<double>& values) {
  double all = 0;
  for (const double v : values) all = std::max(all, std::abs(v));
  return all;
}

// Largest difference over the largest value, %, of each field.
std::array<double, 8> differences(const Fields& a, const Fields& b) {
  std::array<double, 8> result{};
  for (std::size_t f = 0; f < 8; ++f) {
    double difference = 0;
    for (std::size_t i = 0; i < a.values[f].size(); ++i) {
      difference = std::max(difference, std::abs(a.values[f][i] - b.values[f][i]));
    }
    result[f] = percent * difference / largest(b.values[f]);
  }
  return result;
}

std::string list(const std::array<double, 8>& errors) {
  constexpr std::array names = {"ux", "uy", "sxx", "syy", "sxy", "exx", "eyy", "exy"};
  std::string text;
  for (std::size_t i = 0; i < 8; ++i) text += fmt::format("{}{} {:.2g}", i == 0 ? "" : ", ", names[i], errors[i]);
  return text;
}

TEST(PdNurbs, FollowsNeoHookeLikeTable42) {
  // A square clamped at its lower edge and pulled by dead forces on the upper one. 89.44 kN (a reading: the print's MN
  // would be 89 GPa) stretch the free part by about 1.5.
  constexpr double thickness = 1e-3;
  const double shear = 250e6 / (2 * (1 + 0.3));
  const material::MooneyRivlin law{shear / 2, 0};
  const auto model = [&](const material::Law& of) {
    assembly::Model m = plane_model(rectangle(1, 1, 10, 10), of, thickness);
    for (const Index node : nodes_at(m.mesh, 1, 0)) m.fixed[3 * static_cast<std::size_t>(node)] = 1;
    pull_edge(m, nodes_at(m.mesh, 1, 1), 1, 89.44e3);
    return m;
  };
  const Solved exact(model(law));
  const Solved net(model(material::PdNurbs{fit(law, 25, 3, {-0.46, 3}).table, false, 0.5}));
  ASSERT_TRUE(exact.converged() && net.converged()) << net.path.reason;
  const Fields a(net.system, net.at), b(exact.system, exact.at);
  const double longest = 1 + largest(b.values[5 + 1]); // sqrt(1 + 2 E) > 1.5 needs E > 0.625
  EXPECT_GT(longest, 1.625);
  const std::array<double, 8> errors = differences(a, b);
  const char* const mesh = "100 Q4, 121 nodes";
  const std::string remark = "errors in %: " + list(errors);
  expect({"B5", "largest error of displacement y, net of 25, %", "0.0165", "neo-Hooke", 0, errors[1], 0.0165,
          "the thesis' own", mesh, net.iterations(), remark + "; print: 89.44 MN and 143 nodes, which fit nothing"});
  expect({"B5", "largest error of stress y, net of 25, %", "0.15", "neo-Hooke", 0, errors[3], 0.15, "the thesis' own",
          mesh, net.iterations()});
}

TEST(PdNurbs, FollowsMooneyRivlinLikeTables43And44) {
  const Solved exact(rubber_sheet(rubber), 3);
  ASSERT_TRUE(exact.converged());
  const Fields b(exact.system, exact.at);
  struct Net {
    int size;
    const char* printed; // largest error of table 4.4, %
    double allowed;      // %
    const char* iterations;
  };
  for (const Net& net : {Net{15, "none: diverged", 5.558, "5, diverged"}, Net{20, "5.558 (sxx)", 5.558, "9, 13, 8"},
                         Net{40, "0.178 (sxx)", 0.178, "6, 8, 8"}, Net{70, "0.074 (syy)", 0.074, "5, 6, 7"},
                         Net{100, "0.011", 0.011, "5, 6, 5"}}) {
    const material::PdNurbs law{fit(rubber, net.size, 3, {-0.46, 14}).table, true, 0.5};
    const Solved s(rubber_sheet(law), 3);
    ASSERT_TRUE(s.converged()) << s.path.reason;
    const std::array<double, 8> errors = differences(Fields(s.system, s.at), b);
    expect({"B6", fmt::format("largest error of all fields, net of {}, %", net.size), net.printed, "Mooney-Rivlin", 0,
            *std::max_element(errors.begin(), errors.end()), net.allowed,
            net.size == 15 ? "the thesis' with 20" : "the thesis' own", rubber_mesh, s.iterations(),
            "errors in %: " + list(errors)});

    assembly::System system(rubber_sheet(law), 1);
    assembly::Configuration at = start_of(system.model());
    std::string norms;
    std::size_t most = 0;
    for (const double traction : rubber_tractions) {
      at.load_factor = traction / rubber_tractions.back();
      const PlainNewton newton = plain_newton(system, at, 1e-6, 20);
      ASSERT_TRUE(newton.converged);
      most = std::max(most, newton.norms.size());
      norms += norms.empty() ? "norms, m:" : " /";
      for (const double n : newton.norms) norms += fmt::format(" {:.2e}", n);
    }
    expect({"B6", fmt::format("most iterations of a step, net of {}", net.size), net.iterations, "Mooney-Rivlin itself",
            5, static_cast<double>(most), 0.001, "the table is twice continuously differentiable", rubber_mesh,
            static_cast<int>(most), norms});
  }
}

// Least and largest strain of all points, and a tenth more for what Newton passes through.
material::StrainRange range_of(const assembly::System& system, const assembly::Configuration& at) {
  material::StrainRange range;
  for (const element::PointState& p :
       element::point_states(system.foils()[0].membrane, at.positions, system.history(0))) {
    const material::PrincipalStrain e = material::principal_strain(p.strain);
    range.min = std::min(range.min, 1.1 * e.second);
    range.max = std::max(range.max, 1.1 * e.first);
  }
  return range;
}

// The strip at one displacement, by the net, by the deformation law that the net is a table of (J2 in a single step
// from the virgin state) and by flow theory in a hundred steps. The thesis does not name its displacement: its limits
// hold at the first yield of the net section, where all of it flows, and at the end of B1.
TEST(PdNurbs, FollowsTheDeformationLawOfPlasticityLikeTable46) {
  const material::J2 law{strip_elasticity, strip_flow()};
  const char* const mesh = "480 Q4, 531 nodes";
  // 70 spans of degree 2 over r = 1 to 50: stress to 1e-5 (test_nurbs_laws). Where it flows K = 0.2 GPa makes of that
  // strains of 1e-5 x 0.3 GPa / K = 1.5e-5, 0.02 % of 7 % and more.
  const char* const why = "the thesis' own, pointwise; the table's 1e-5 of stress are 0.02 % of the strain by K";
  constexpr double of_displacement = 0.032; // %, table 4.6
  constexpr double of_stress = 0.040;       // %
  for (const double displacement : {0.04e-3, 0.1e-3, 0.2e-3}) {
    const PulledStrip exact(perforated_strip, law, displacement, 1);
    const PulledStrip flow(perforated_strip, law, displacement, 100);
    ASSERT_TRUE(exact.reached() && flow.reached());
    ASSERT_EQ(exact.steps, 1); // else it is not the deformation law
    const material::PdFit table = fit(law, 70, 2, range_of(exact.system, exact.at));
    EXPECT_TRUE(table.report.monotone);
    const PulledStrip net(perforated_strip, material::PdNurbs{table.table, false, 0.5}, displacement, 1);
    ASSERT_TRUE(net.reached()) << net.path.reason;
    const Fields a(net.system, net.at), b(exact.system, exact.at), f(flow.system, flow.at);
    const std::array<double, 8> errors = differences(a, b);
    const std::string at = fmt::format("at {:.2f} mm", displacement / 1e-3);
    expect({"B7", "largest error of displacement y " + at + ", net against the exact deformation law, %", "0.032",
            "J2 in one step", 0, errors[1], of_displacement, why, mesh, net.iterations(),
            "errors in %: " + list(errors)});
    expect({"B7", "largest error of stress y " + at + ", net against the exact deformation law, %", "0.040",
            "J2 in one step", 0, errors[3], of_stress, why, mesh, net.iterations()});
    expect({"B7", "force " + at + ", net against the exact deformation law, kN", "", "J2 in one step",
            exact.points.back().force / 1e3, net.points.back().force / 1e3, 1e-5,
            "a mean over the net section of the table's 1e-5", mesh, net.iterations()});
    const std::array<double, 8> theory = differences(b, f);
    const char* const none = "none: two theories, no bound is known";
    expect({"B7", "largest difference of displacement y " + at + ", deformation law against flow theory, %", "",
            "J2 in 100 steps", 0, theory[1], unbounded, none, mesh, flow.iterations(),
            "differences in %: " + list(theory)});
    expect({"B7", "force " + at + ", deformation law against flow theory, kN", "", "J2 in 100 steps",
            flow.points.back().force / 1e3, exact.points.back().force / 1e3, unbounded, none, mesh, flow.iterations()});
  }
}

} // namespace

} // namespace pneuma::tests
