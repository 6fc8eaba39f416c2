// SPDX-License-Identifier: GPL-3.0-or-later
// Example B8 as one table and four plots: PNEUMA_LONG=1 takes every case and fine meshes (minutes); PNEUMA_TABLES names
// the folder for circular_membrane.csv and the plots, which otherwise vanish with the test.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pipeline/drawing/chart.h"
#include "solver/analytical/small_slope.h"
#include "tests/unit/pipeline/drawing/well_formed.h"
#include "tests/unit/pipeline/state/temporary_folder.h"
#include "tests/verification/circular_disc.h"

namespace pneuma::tests {

namespace {

using namespace pipeline::drawing;
using geometry::is_quadratic;
using solver::analytical::Theory;

constexpr std::array elements = {ElementType::T3, ElementType::Q4, ElementType::T6, ElementType::Q9};
constexpr double kPa = 1e3, mm = 1e-3;

bool whole_table() {
  return std::getenv("PNEUMA_LONG") != nullptr;
}

struct Row {
  ElementType type;
  int divisions = 0;
  DiscCase disc;
  SolvedDisc solved;
  InflatedCircle exact;
  double deflection_error() const { return std::abs(solved.deflection / exact.deflection - 1); }
  double volume_error() const { return std::abs(solved.volume / exact.volume - 1); }
};

// Divisions of the quarter rim. The finest have 40960 T3, 20480 Q4, 10240 T6, 5120 Q9.
std::vector<int> meshes(ElementType type) {
  std::vector<int> divisions = {is_quadratic(type) ? 2 : 4};
  while (divisions.size() < (whole_table() ? 5u : 3u)) divisions.push_back(2 * divisions.back());
  return divisions;
}

std::vector<Row> rows_of(ElementType type, int divisions, double pretension) {
  const int steps = whole_table() ? 2000 : 1000; // of the exact solution
  std::vector<Row> rows;
  const auto add = [&](const DiscCase& c, const SolvedDisc& solved) {
    EXPECT_TRUE(solved.converged);
    rows.push_back({type, divisions, c, solved, exact_disc(c, steps)});
  };
  InflatedDisc inflated;
  for (const double pressure : {100 * kPa, 250 * kPa, closing_pressure}) {
    inflated = inflated_disc(type, divisions, pressure, pretension);
    add({pretension, pressure}, inflated.state);
  }
  for (const DiscCase& c : pressed_cases(pretension)) {
    if (whole_table() || c.outside == 300 * kPa) add(c, press(inflated, c));
  }
  return rows;
}

void write_csv(const std::vector<Row>& rows, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "element,divisions,unknowns,pretension N/m,inside Pa,outside Pa,kappa,ambient Pa,deflection m,exact m,error,"
          "volume m3,exact m3,error,iterations\n";
  for (const Row& r : rows) {
    file << fmt::format("{},{},{},{:g},{:g},{:g},{:g},{:g},{:.9g},{:.9g},{:.3e},{:.9g},{:.9g},{:.3e},{}\n",
                        geometry::name_of(r.type), r.divisions, r.solved.unknowns, r.disc.pretension, r.disc.inside,
                        r.disc.outside, r.disc.kappa, r.disc.ambient, r.solved.deflection, r.exact.deflection,
                        r.deflection_error(), r.solved.volume, r.exact.volume, r.volume_error(), r.solved.iterations);
  }
}

constexpr std::array marks = {Mark::circle, Mark::square, Mark::triangle, Mark::diamond};

// Inflated to 400 kPa without pretension.
Chart error_chart(const std::vector<Row>& rows, const char* quantity, double (Row::*error)() const) {
  Chart chart{fmt::format("B8, 400 kPa: error of {}", quantity),
              {"unknowns", Scale::logarithmic},
              {"relative error", Scale::logarithmic},
              {}};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    Curve curve{geometry::name_of(elements[i]), {}, Stroke::solid, marks[i], static_cast<int>(i) + 1};
    for (const Row& r : rows) {
      if (r.type == elements[i] && r.disc.pretension == 0 && r.disc.inside == closing_pressure && r.disc.outside == 0) {
        curve.points.emplace_back(r.solved.unknowns, (r.*error)());
      }
    }
    chart.curves.push_back(curve);
  }
  // below the last points of the two elements of an order; unknowns go with 1 / h^2
  for (const int order : {2, 4}) {
    const std::vector<Vec2>& a = chart.curves[order == 2 ? 0 : 2].points;
    const std::vector<Vec2>& b = chart.curves[order == 2 ? 1 : 3].points;
    const double first = a.front().x(), last = a.back().x();
    const double end = std::min(a.back().y(), b.back().y()) / 3;
    const Stroke stroke = order == 2 ? Stroke::dashed : Stroke::dotted;
    chart.curves.push_back({fmt::format("order {}", order),
                            {{first, end * std::pow(last / first, order / 2)}, {last, end}},
                            stroke,
                            Mark::none,
                            7});
  }
  return chart;
}

const Row& row(const std::vector<Row>& rows, ElementType type, int divisions, const DiscCase& c) {
  const auto same = [&](const Row& r) {
    return r.type == type && r.divisions == divisions && r.disc.pretension == c.pretension &&
           r.disc.inside == c.inside && r.disc.outside == c.outside && r.disc.kappa == c.kappa &&
           r.disc.ambient == c.ambient;
  };
  return *std::find_if(rows.begin(), rows.end(), same);
}

Chart inflation_chart(const std::vector<Row>& rows) {
  Chart chart{"B8: a flat disc inflated", {"pressure, kPa"}, {"deflection, mm"}, {}};
  for (const double pretension : {0.0, 10e3}) {
    const char* with = pretension == 0 ? "" : ", 10 kN/m";
    const Stroke stroke = pretension == 0 ? Stroke::solid : Stroke::dashed;
    Curve exact{fmt::format("exact{}", with), {}, stroke, Mark::none, 0};
    Curve plain{fmt::format("{}{}", pretension == 0 ? "Hencky" : "Campbell", with), {}, stroke, Mark::none, 2};
    Curve follows{
        fmt::format("{}{}", pretension == 0 ? "Fichter" : "modified Fichter", with), {}, stroke, Mark::none, 3};
    for (int i = 0; i <= 32; ++i) {
      const double pressure = i == 0 ? 1 : closing_pressure * std::pow(i / 32.0, 2); // dense at the steep start
      const CircularMembrane m = disc(pretension);
      exact.points.emplace_back(pressure / kPa, exact_disc({pretension, pressure}, 500).deflection / mm);
      plain.points.emplace_back(pressure / kPa, small_slope(Theory::campbell, m, pressure)->deflection / mm);
      follows.points.emplace_back(pressure / kPa, small_slope(Theory::modified_fichter, m, pressure)->deflection / mm);
    }
    for (Curve* curve : {&exact, &plain, &follows}) chart.curves.push_back(*curve);
  }
  Curve solved{"T6, 640 elements", {}, Stroke::none, Mark::circle, 1};
  for (const double pretension : {0.0, 10e3}) {
    for (const double pressure : {100 * kPa, 250 * kPa, closing_pressure}) {
      const Row& r = row(rows, ElementType::T6, 8, {pretension, pressure});
      solved.points.emplace_back(pressure / kPa, r.solved.deflection / mm);
    }
  }
  chart.curves.push_back(solved);
  return chart;
}

Chart pressed_chart(const std::vector<Row>& rows) {
  Chart chart{"B8: inflated to 400 kPa, then pressed from outside", {"outside pressure, kPa"}, {"deflection, mm"}, {}};
  struct Gas {
    const char* name;
    double kappa, ambient;
    Stroke stroke;
    int colour;
  };
  const Gas gases[] = {{"air held", 0, 0, Stroke::solid, 0},
                       {"shut in: kappa 1", 1, 0, Stroke::dashed, 2},
                       {"kappa 1, real air", 1, 101325, Stroke::solid, 2},
                       {"kappa 1.4", 1.4, 0, Stroke::dashed, 3},
                       {"kappa 1.4, real air", 1.4, 101325, Stroke::solid, 3}};
  Curve solved{"T6, 640 elements", {}, Stroke::none, Mark::circle, 1};
  for (const Gas& gas : gases) {
    Curve exact{gas.name, {}, gas.stroke, Mark::none, gas.colour};
    for (int i = 0; i <= 12; ++i) {
      const double outside = 25 * kPa * i;
      exact.points.emplace_back(
          outside / kPa, exact_disc({0, closing_pressure, outside, gas.kappa, gas.ambient}, 500).deflection / mm);
    }
    chart.curves.push_back(exact);
    for (const double outside : {150 * kPa, 300 * kPa}) {
      if (!whole_table() && outside < 200 * kPa) continue;
      const Row& r = row(rows, ElementType::T6, 8, {0, closing_pressure, outside, gas.kappa, gas.ambient});
      solved.points.emplace_back(outside / kPa, r.solved.deflection / mm);
    }
  }
  chart.curves.push_back(solved);
  return chart;
}

TEST(CircularMembraneTable, FallsWithEveryRefinementAndIsDrawn) {
  std::vector<Row> rows;
  const std::vector<double> pretensions = whole_table() ? std::vector{0.0, 1e3, 10e3} : std::vector{0.0, 10e3};
  for (const ElementType type : elements) {
    for (const double pretension : pretensions) {
      std::vector<Row> coarser;
      double least = 10, most = 0; // observed order of volume
      for (const int divisions : meshes(type)) {
        const std::vector<Row> finer = rows_of(type, divisions, pretension);
        for (std::size_t i = 0; i < coarser.size(); ++i) {
          const double order = std::log2(coarser[i].volume_error() / finer[i].volume_error());
          least = std::min(least, order);
          most = std::max(most, order);
          EXPECT_GT(order, is_quadratic(type) ? 3.5 : 1.9) << geometry::name_of(type) << ' ' << divisions;
        }
        rows.insert(rows.end(), finer.begin(), finer.end());
        coarser = finer;
      }
      std::printf("%s N0 %2.0f kN/m: order of volume %.2f to %.2f; finest mesh at 400 kPa: errors %.1e, %.1e with %d "
                  "unknowns\n",
                  geometry::name_of(type), pretension / 1e3, least, most, coarser[2].deflection_error(),
                  coarser[2].volume_error(), coarser[2].solved.unknowns);
    }
  }
  const TemporaryFolder temporary;
  const char* wanted = std::getenv("PNEUMA_TABLES");
  const std::filesystem::path folder = wanted != nullptr ? std::filesystem::path(wanted) : temporary.path();
  std::filesystem::create_directories(folder);
  write_csv(rows, folder / "circular_membrane.csv");
  write_chart(error_chart(rows, "apex deflection", &Row::deflection_error), folder / "error_deflection.svg");
  write_chart(error_chart(rows, "volume", &Row::volume_error), folder / "error_volume.svg");
  write_chart(inflation_chart(rows), folder / "inflation.svg");
  write_chart(pressed_chart(rows), folder / "pressed.svg");

  const std::string table = bytes_of(folder / "circular_membrane.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), rows.size() + 1);
  for (const char* plot : {"error_deflection.svg", "error_volume.svg", "inflation.svg", "pressed.svg"}) {
    EXPECT_TRUE(well_formed(bytes_of(folder / plot))) << plot;
  }
}

} // namespace

} // namespace pneuma::tests
