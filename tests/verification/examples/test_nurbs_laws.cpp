// SPDX-License-Identifier: GPL-3.0-or-later
// Examples B5 to B7 (Coelho 2012, sec. 4.5): PD-NURBS against the laws that its tables are fitted to.
#include <cmath>

#include <fmt/format.h>

#include "solver/material/nurbs_fit.h"
#include "solver/material/test_piece.h"
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

double largest_of(const std::array<double, 8>& errors) {
  return *std::max_element(errors.begin(), errors.end());
}

// How much the constant of h^4 depends on where the few largest strains of a sheet lie within the spans of a net, where
// the error of a spline has zeros and peaks: over the thesis' nets of B6 by 1.9 = 0.43 / 0.23.
constexpr double phase = 1.9;

// The exponent of the spans, net - 3, that least squares find in the errors.
double order_in_spans(const std::vector<std::pair<int, double>>& errors) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [size, error] : errors) {
    const double a = -std::log(size - 3), b = std::log(error);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

// Largest error of the stretch, up to this one, of a piece of neo-Hooke that is pulled by a force: that of the nominal
// stress P = mu (l - l^-2) over dP/dl.
double largest_uniaxial_error(const material::Law& table, const material::MooneyRivlin& law, double stretch) {
  material::TestPiece a(table), b(law);
  double error = 0;
  for (int i = 1; i <= 100; ++i) {
    const double strain = (stretch - 1) * i / 100;
    EXPECT_TRUE(a.advance(material::uniaxial(), strain) && b.advance(material::uniaxial(), strain));
    const double slope = 2 * law.c1 * (1 + 2 * std::pow(1 + strain, -3));
    error = std::max(error, std::abs(a.state().nominal_stress()[0] - b.state().nominal_stress()[0]) / slope);
  }
  return error;
}

TEST(PdNurbs, FollowsNeoHookeLikeTable42) {
  // A square clamped at its lower edge and pulled by dead forces on the upper one. 89.44 kN (a reading: the print's MN
  // would be 89 GPa) stretch the free part by about 1.5.
  constexpr double thickness = 1e-3;
  const double shear = 250e6 / (2 * (1 + 0.3));
  const material::MooneyRivlin law{shear / 2, 0};
  const auto model = [&](const material::Law& of, double force) {
    assembly::Model m = plane_model(rectangle(1, 1, 10, 10), of, thickness);
    for (const Index node : nodes_at(m.mesh, 1, 0)) m.fixed[3 * static_cast<std::size_t>(node)] = 1;
    pull_edge(m, nodes_at(m.mesh, 1, 1), 1, force);
    return m;
  };
  const char* const mesh = "100 Q4, 121 nodes";
  const Solved exact(model(law, 89.44e3));
  ASSERT_TRUE(exact.converged());
  const Fields b(exact.system, exact.at);
  const double longest = 1 + largest(b.values[5 + 1]); // sqrt(1 + 2 E) > 1.5 needs E > 0.625
  EXPECT_GT(longest, 1.625);
  const auto errors_of = [&](int size, double force, const Fields& of, int& iterations) {
    const Solved net(model(material::PdNurbs{fit(law, size, 3, {-0.46, 3}).table, false, 0.5}, force));
    EXPECT_TRUE(net.converged()) << net.path.reason;
    iterations = net.iterations();
    return differences(Fields(net.system, net.at), of);
  };
  int iterations = 0;
  const std::array<double, 8> errors = errors_of(25, 89.44e3, b, iterations);
  expect({"B5", "largest error of displacement y, net of 25, %", "0.0165", "neo-Hooke", 0, errors[1], 0.0165,
          "the thesis' own", mesh, iterations,
          "errors in %: " + list(errors) + "; print: 89.44 MN and 143 nodes, which fit nothing"});
  expect({"B5", "largest error of stress y, net of 25, %", "0.15", "neo-Hooke", 0, errors[3], 0.15, "the thesis' own",
          mesh, iterations});
  // other loads: a column of pieces that are pulled, each off in its stretch by what its nominal stress is off over the
  // slope of that
  const material::PdNurbs table{fit(law, 25, 3, {-0.46, 3}).table, false, 0.5};
  for (const double force : {60e3, 67e3, 120e3}) {
    const Solved other(model(law, force));
    ASSERT_TRUE(other.converged());
    const Fields of(other.system, other.at);
    const double off = percent * largest_uniaxial_error(table, law, std::sqrt(1 + 2 * largest(of.values[5 + 1])));
    const std::array<double, 8> e = errors_of(25, force, of, iterations);
    const std::string name = fmt::format("net of 25, {:g} kN, %", force / 1e3);
    expect({"B5", "largest error of displacement y, " + name, "", "neo-Hooke", 0, e[1], off / largest(of.values[1]),
            "the largest error of a uniaxial stretch up to there, over the displacement", mesh, iterations,
            "errors in %: " + list(e) +
                (force == 60e3 ? "; first predicted: the thesis' 0.0165 at 89.44 kN, as the strains are smaller; but "
                                 "errors swing with their place within the spans"
                               : "")});
    expect({"B5", "largest error of stress y, " + name, "", "neo-Hooke", 0, e[3], 0.15,
            "the thesis' own at 89.44 kN: the spans are the same", mesh, iterations});
  }
  // other nets: cubic stresses, h^4
  std::vector<std::pair<int, double>> all = {{25, largest_of(errors)}};
  for (const int size : {18, 35, 50}) {
    const std::array<double, 8> other = errors_of(size, 89.44e3, b, iterations);
    all.emplace_back(size, largest_of(other));
    if (size == 18) continue;
    expect({"B5", fmt::format("largest error of all fields, net of {}, %", size), "", "neo-Hooke", 0, largest_of(other),
            all[0].second * std::pow(22.0 / (size - 3), 4) * phase,
            "h^4 from the net of 25; by the place of the strains within the spans 1.9 times that", mesh, iterations,
            "errors in %: " + list(other)});
  }
  expect({"B5", "order of the largest error in the span, nets of 18 to 50", "", "fourth: cubic stresses", 4,
          order_in_spans(all), std::log(phase) / std::log(47.0 / 15) / 4,
          "an error of 1.9 times at one end of the nets by the place of the strains within the spans", mesh,
          iterations});
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
    const char* why;
  };
  // c / spans^4, % : the largest c of the thesis' nets, that of 40
  const auto fourth = [](int size) { return 0.0227 * std::pow(37.0 / (size - 3), 4); };
  const char* const own = "the thesis' own";
  const char* const fresh = "h^4: that of the net of 40, whose constant is the largest of the thesis' nets";
  std::vector<std::pair<int, double>> all;
  for (const Net& net :
       {Net{15, "none: diverged", 5.558, "5, diverged", "the thesis' with 20: that it converges at all"},
        Net{20, "5.558 (sxx)", 5.558, "9, 13, 8", own}, Net{25, "", fourth(25), "", fresh},
        Net{30, "", fourth(30), "", fresh}, Net{40, "0.178 (sxx)", 0.178, "6, 8, 8", own},
        Net{50, "", fourth(50), "", fresh}, Net{70, "0.074 (syy)", 0.074, "5, 6, 7", own},
        Net{100, "0.011", 0.011, "5, 6, 5", own}}) {
    const material::PdNurbs law{fit(rubber, net.size, 3, {-0.46, 14}).table, true, 0.5};
    const Solved s(rubber_sheet(law), 3);
    ASSERT_TRUE(s.converged()) << s.path.reason;
    const std::array<double, 8> errors = differences(Fields(s.system, s.at), b);
    expect({"B6", fmt::format("largest error of all fields, net of {}, %", net.size), net.printed, "Mooney-Rivlin", 0,
            largest_of(errors), net.allowed, net.why, rubber_mesh, s.iterations(), "errors in %: " + list(errors)});
    all.emplace_back(net.size, largest_of(errors));

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
            5, static_cast<double>(most), 0, "its tangent is exact and continuous: quadratic like the law itself",
            rubber_mesh, static_cast<int>(most), norms});
  }
  expect({"B6", "order of the largest error in the span, nets of 15 to 100", "", "fourth: cubic stresses", 4,
          order_in_spans(all), std::log(phase) / std::log(97.0 / 12) / 4,
          "an error of 1.9 times at one end of the nets by the place of the strains within the spans", rubber_mesh, 0});
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
    const char* const none = "not asserted: a difference of two theories, not an error";
    expect({"B7", "largest difference of displacement y " + at + ", deformation law against flow theory, %", "",
            "J2 in 100 steps", 0, theory[1], unbounded, none, mesh, flow.iterations(),
            "differences in %: " + list(theory)});
    expect({"B7", "force " + at + ", deformation law against flow theory, kN", "", "J2 in 100 steps",
            flow.points.back().force / 1e3, exact.points.back().force / 1e3, unbounded, none, mesh, flow.iterations()});
  }
}

} // namespace

} // namespace pneuma::tests
