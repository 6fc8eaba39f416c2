// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/schema/command_line.h"
#include "pipeline/schema/spelling.h"
#include "stages/common/law.h"
#include "stages/material/fit.h"
#include "stages/material/report.h"

namespace pneuma::stages::material {

namespace {

namespace workflow = pipeline::workflow;
using base::say;

constexpr double standard_rate = 1e-3; // 1/s, of quasi-static tests

workflow::MaterialsResult read_materials(const Options& options) {
  workflow::MaterialsResult result = workflow::read_materials(options.materials, options.names);
  std::vector<std::string> errors;
  for (const workflow::Problem& problem : result.problems) {
    if (problem.error) {
      errors.push_back(to_string(problem));
    } else {
      fmt::print(stderr, "{}\n", to_string(problem));
    }
  }
  for (const std::string& name : options.names) {
    if (std::find(result.names.begin(), result.names.end(), name) != result.names.end()) continue;
    errors.push_back(fmt::format("{}: there is no material `{}`{}; materials: {}", options.materials.generic_string(),
                                 name, pipeline::schema::suggestion(name, result.names),
                                 pipeline::schema::joined(result.names)));
  }
  if (!errors.empty()) throw base::InputError(fmt::format("{}", fmt::join(errors, "\n")));
  return result;
}

// The curve of a material as if a machine had measured it.
TestCurve as_test(const Curve& curve) {
  TestCurve test;
  test.name = curve.material;
  test.ratio = curve.ratio;
  for (const PieceState& state : curve.loading) {
    test.points.push_back({state.engineering_strain().head<2>(), state.nominal_stress().head<2>(), state.time, 1});
  }
  return test;
}

void say_misfit(const Misfit& misfit, const TestCurve& test) {
  if (misfit.points > 0) {
    say(fmt::format(
        "  against test {} ({}, {} points): rms {:.3g} MPa ({:.2g} %), max {:.3g} MPa ({:.2g} %) at a strain "
        "of {:.3g} %",
        test.name, name_of(test.ratio), misfit.points, misfit.rms / 1e6, 100 * misfit.rms / misfit.measured,
        misfit.max / 1e6, 100 * misfit.max / misfit.measured, 100 * misfit.at));
  }
  if (!misfit.end.empty()) say(fmt::format("  test {}: {}", test.name, misfit.end));
}

// The materials one after another, and what is written of all of them.
class Bench {
public:
  Bench(const Options& options, const std::map<std::string, workflow::Material>& materials,
        const std::vector<TestCurve>& tests)
      : options_(options), materials_(materials), tests_(tests), drawn_tests_(tests) {}

  void show(const workflow::Material& material) {
    std::map<std::string, workflow::Material> taut = materials_;
    taut.at(material.name).tension_field = false;
    say(fmt::format("{}{}", material.name, material.source.empty() ? "" : ": " + material.source));
    if (const auto range = workflow::temperatures_of(material); options_.temperature && !range) {
      say("  does not depend on the temperature");
    }
    if (material.tension_field) say("  without its tension field, which changes nothing in tension");
    const common::MaterialLaw made = common::law_of(taut, material.name, temperature());
    common::say_fit(material.name, made);
    show(material.name, made.law);
  }

  void show_fit(const workflow::Material& material) {
    const TestCurve test = uniaxial_test(material.name);
    if (tests_.empty()) drawn_tests_ = {test};
    first_drawn_ = curves_.size();
    // what a curve in tension does not tell
    double nu = 0.5;
    bool logarithmic = true;
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (requires { law.nu; }) nu = law.nu;
          if constexpr (requires { law.logarithmic; }) logarithmic = law.logarithmic;
        },
        workflow::law_at(material, temperature()));
    const FittedLaw fitted = fit(test, options_, nu, logarithmic);
    const std::size_t count = fitted.hardening.branches.size();
    const std::string name = fmt::format("{}_{}", material.name, count);
    say(fmt::format("{}: the {} hardening branch{} nearest to {}{}; nu and kind of strain as of {}", name, count,
                    count == 1 ? "" : "es", test.name,
                    static_cast<int>(count) < options_.branches ? ", more fit no better" : "", material.name));
    const solver::material::Law law = law_of(fitted);
    show(name, law);
    if (tests_.empty()) say_misfit(misfit(law, test, options_, std::nullopt), test);
    say(yaml_of(fitted, name, fmt::format("fitted to {} by pneuma material --fit", test.name)));
  }

  void write() const {
    if (!options_.csv.empty()) write_csv(curves_, options_);
    if (options_.svg.empty()) return;
    write_svg(std::span<const Curve>(curves_).subspan(first_drawn_), drawn_tests_, options_);
  }

private:
  void show(const std::string& name, const solver::material::Law& law) {
    std::vector<std::optional<double>> rates = {std::nullopt};
    if (solver::material::is_rate_dependent(law)) {
      rates.assign(options_.rates.begin(), options_.rates.end());
      if (rates.empty()) rates = {standard_rate};
    } else if (!options_.rates.empty()) {
      say("  does not depend on the rate");
    }
    const std::size_t first = curves_.size();
    for (const std::optional<double>& rate : rates) {
      for (const Ratio& ratio : options_.ratios) {
        curves_.push_back(follow(law, ratio, options_, rate));
        curves_.back().material = name;
      }
    }
    const auto mine = std::span<const Curve>(curves_).subspan(first);
    say(table(mine, options_));
    for (const Curve& curve : mine) {
      if (!curve.end.empty()) say(fmt::format("  {} {}", name_of(curve.ratio), curve.end));
    }
    for (const TestCurve& test : tests_) {
      for (const std::optional<double>& rate : rates) say_misfit(misfit(law, test, options_, rate), test);
    }
  }

  double temperature() const { return options_.temperature.value_or(workflow::Site().temperature); }

  // What is to be fitted: the uniaxial test, or the material's own curve.
  TestCurve uniaxial_test(const std::string& name) const {
    const auto is_uniaxial = [](const auto& one) { return one.ratio.a == 0 || one.ratio.b == 0; };
    if (const auto test = std::find_if(tests_.begin(), tests_.end(), is_uniaxial); test != tests_.end()) return *test;
    if (!tests_.empty()) throw base::InputError("--fit: none of the tests is uniaxial");
    const auto curve = std::find_if(curves_.begin(), curves_.end(), is_uniaxial);
    if (curve == curves_.end()) {
      throw base::InputError(
          fmt::format("--fit: give a uniaxial test by --data, or 1:0 among --ratios for the curve of "
                      "`{}`",
                      name));
    }
    return as_test(*curve);
  }

  const Options& options_;
  const std::map<std::string, workflow::Material>& materials_;
  const std::vector<TestCurve>& tests_;
  std::vector<Curve> curves_;
  std::vector<TestCurve> drawn_tests_;
  std::size_t first_drawn_ = 0; // a picture of a fit shows it and what it was fitted to
};

int run(int argc, char** argv) {
  if (pipeline::schema::asks_for_help(argc, argv)) {
    std::puts(usage());
    return 0;
  }
  const Options options = parse(argc, argv);
  const workflow::MaterialsResult read = read_materials(options);
  const std::vector<workflow::Material>& materials = read.materials;
  std::vector<TestCurve> tests;
  for (const std::filesystem::path& file : options.data) tests.push_back(read_test(file));
  if (options.branches > 0 && materials.size() != 1) {
    throw base::InputError(fmt::format("--fit fits one material; name one of the {}", materials.size()));
  }
  Bench bench(options, read.known, tests);
  for (const workflow::Material& material : materials) bench.show(material);
  if (options.branches > 0) bench.show_fit(materials.front());
  bench.write();
  return 0;
}

} // namespace

} // namespace pneuma::stages::material

int main(int argc, char** argv) {
  return pneuma::base::guarded_main("pneuma-material", pneuma::stages::material::run, argc, argv);
}
