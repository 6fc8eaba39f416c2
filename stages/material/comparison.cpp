// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/comparison.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/test_data/test_data.h"
#include "pipeline/yaml/text.h"

namespace pneuma::stages::material {

namespace law = solver::material;

namespace {

// From the axis of the larger stress: the smaller one over it.
Ratio ratio_of(const std::vector<TestPoint>& points) {
  base::Mat2 products = base::Mat2::Zero();
  for (const TestPoint& point : points) {
    products += point.weight * point.stress.head<2>() * point.stress.head<2>().transpose();
  }
  const int larger = products(1, 1) > products(0, 0) ? 1 : 0;
  constexpr double none = 0.01;
  double smaller = products(0, 1) / products(larger, larger);
  if (!(std::abs(smaller) > none)) smaller = 0;
  return larger == 0 ? Ratio{1, smaller} : Ratio{smaller, 1};
}

// How far the stresses are from their ratio, as a part of the largest one.
double scatter_of(const TestCurve& test) {
  const Vec3 direction(test.ratio.a, test.ratio.b, 0);
  double largest = 0;
  double off = 0;
  for (const TestPoint& point : test.points) {
    const Vec3 rest = point.stress - direction * direction.dot(point.stress) / direction.squaredNorm();
    off = std::max(off, rest.norm());
    largest = std::max(largest, point.stress.norm());
  }
  return off / largest;
}

// Mean temperature of a test; none: not measured.
std::optional<double> temperature_of(const std::vector<pipeline::test_data::Row>& rows, const std::string& name) {
  double sum = 0;
  double least = rows.front().temperature;
  double most = least;
  for (const auto& row : rows) {
    sum += row.temperature;
    least = std::min(least, row.temperature);
    most = std::max(most, row.temperature);
  }
  if (std::isnan(sum)) return std::nullopt;
  const double mean = sum / static_cast<double>(rows.size());
  constexpr double steady = 5; // K, from the least to the most
  if (most - least > steady) {
    base::warn(fmt::format("{}: the temperature runs from {:.4g} to {:.4g} degC; the test is taken to be at the mean, "
                           "{:.4g} degC",
                           name, celsius(least), celsius(most), celsius(mean)));
  }
  return mean;
}

} // namespace

TestCurve read_test(const std::filesystem::path& file) {
  namespace test_data = pipeline::test_data;
  std::vector<pipeline::yaml::Problem> problems;
  const std::string name = file.generic_string();
  const std::string text = pipeline::yaml::read_text(file, {"--data", 0, 0}, problems);
  if (!problems.empty()) {
    throw base::InputError(fmt::format("--data: {}", pipeline::yaml::printable(problems.front().message)));
  }
  const bool has_shear = text.find("shear_strain") != std::string::npos;
  const bool is_shear = has_shear && text.find("strain_1") == std::string::npos;
  const std::vector<std::string> needed = is_shear ? std::vector<std::string>{"shear_strain", "shear_stress"}
                                                   : std::vector<std::string>{"strain_1", "stress_1"};
  const auto rows = test_data::parse(text, name, test_data::Measure::engineering, needed, problems);
  for (const test_data::Row& row : rows) {
    double strain = 0;
    for (const double one : {row.strain_1, row.strain_2, row.shear_strain}) {
      if (std::abs(one) > std::abs(strain)) strain = one;
    }
    if (std::abs(strain) <= most_strain) continue;
    pipeline::yaml::Problem problem;
    problem.mark = {name, row.line, 1};
    problem.message = fmt::format("a strain of {:.4g} %: tests are compared up to {:g} %; is its unit right?",
                                  100 * strain, 100 * most_strain);
    problems.push_back(std::move(problem));
    break; // the unit is that of all rows
  }
  std::vector<std::string> errors;
  for (const auto& problem : problems) {
    if (problem.error) {
      errors.push_back(to_string(problem));
    } else {
      fmt::print(stderr, "{}\n", to_string(problem));
    }
  }
  if (!errors.empty()) throw base::InputError(fmt::format("{}", fmt::join(errors, "\n")));
  if (has_shear && !is_shear) {
    base::warn(fmt::format(
        "{}: shear beside other strains is not compared; a file without `strain_1` is a test in shear", name));
  }
  const auto measured = [](double value) { return std::isnan(value) ? 0 : value; };
  TestCurve test;
  test.name = file.stem().string();
  for (const test_data::Row& row : rows) {
    TestPoint point;
    if (is_shear) {
      point.strain = Vec3(0, 0, row.shear_strain);
      point.stress = Vec3(0, 0, row.shear_stress);
    } else {
      point.strain = Vec3(row.strain_1, measured(row.strain_2), 0);
      point.stress = Vec3(row.stress_1, measured(row.stress_2), 0);
    }
    if (!std::isnan(row.time)) point.time = row.time - rows.front().time;
    point.weight = row.weight;
    test.points.push_back(point);
  }
  test.temperature = temperature_of(rows, name);
  if (is_shear) {
    test.ratio = pure_shear;
    return test;
  }
  const auto is_unloaded = [](const TestPoint& point) { return point.weight == 0 || point.stress.isZero(0); };
  if (std::all_of(test.points.begin(), test.points.end(), is_unloaded)) {
    throw base::InputError(fmt::format("{}: no row with a weight has a stress", name));
  }
  test.ratio = ratio_of(test.points);
  if (driven_axis(test.ratio) == 1 && std::isnan(rows.front().strain_2)) {
    throw base::InputError(fmt::format("{}:{}:1: the larger stress is `stress_2`: the column `strain_2` is needed",
                                       name, rows.front().line));
  }
  constexpr double most = 0.1;
  if (const double scatter = scatter_of(test); !(scatter < most)) {
    throw base::InputError(
        fmt::format("{}: the two stresses have no common ratio (up to {:.0f} % of the largest is off "
                    "the best one); write each test to a file of its own",
                    name, 100 * scatter));
  }
  return test;
}

Misfit misfit(const law::Law& material, const TestCurve& test, const Options& options, std::optional<double> rate) {
  Misfit result;
  law::TestPiece piece(material, options.angle);
  const law::Control control = control_of(test.ratio);
  const int axis = driven_axis(test.ratio);
  const bool both = test.ratio.a != 0 && test.ratio.b != 0;
  double squares = 0;
  double weights = 0;
  for (const TestPoint& point : test.points) {
    result.measured = std::max(result.measured, point.stress.cwiseAbs().maxCoeff());
  }
  for (const TestPoint& point : test.points) {
    // steps as short as those of the curves
    const double from = piece.driven(control);
    const double way = point.strain[axis] - from;
    double duration = 0;
    if (point.time) {
      duration = std::max(*point.time - piece.state().time, 0.0);
    } else if (rate) {
      duration = std::abs(way) / *rate;
    }
    constexpr double rounding = 1e-9;
    constexpr double most = 10000; // from row to row, where the curves are short
    const double of_curve = std::min(std::ceil(std::abs(way) * options.steps / options.strain - rounding), most);
    const int steps = std::max(1, static_cast<int>(of_curve)) * (duration > 0 ? steps_in_time : 1);
    for (int i = 1; i <= steps && result.end.empty(); ++i) {
      if (piece.advance(control, from + way * i / steps, duration / steps)) continue;
      const char* why = piece.status() == law::Status::outside_data ? "its data end before" : "it knows no such state";
      result.end = fmt::format("not compared from a strain of {:.3g} % on: {}", 100 * point.strain[axis], why);
    }
    if (!result.end.empty()) break;
    const Vec3 difference = piece.state().nominal_stress() - point.stress;
    for (int i = 0; i < 3; ++i) {
      if (i != axis && !(both && i < 2)) continue;
      squares += point.weight * difference[i] * difference[i];
      weights += point.weight;
      if (!(std::abs(difference[i]) > result.max)) continue;
      result.max = std::abs(difference[i]);
      result.at = point.strain[axis];
    }
    ++result.points;
  }
  if (weights > 0) result.rms = std::sqrt(squares / weights);
  return result;
}

} // namespace pneuma::stages::material
