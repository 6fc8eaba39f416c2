// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/materials.h"
#include "stages/common/law.h"
#include "stages/common/law_at.h"
#include "stages/material/fit.h"
#include "stages/material/report.h"

namespace pneuma::stages::material {

namespace {

namespace workflow = pipeline::workflow;
using base::say;
using solver::material::Law;

constexpr double same_temperature = 2; // K, of rooms
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
    if (result.names.empty() || std::find(result.names.begin(), result.names.end(), name) != result.names.end())
      continue;
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
    test.points.push_back({state.engineering_strain(), state.nominal_stress(), state.time, 1});
  }
  return test;
}

void say_misfit(const Misfit& misfit, const TestCurve& test) {
  const std::string at = test.temperature ? fmt::format(", taken at {:.4g} degC", celsius(*test.temperature)) : "";
  if (misfit.points > 0) {
    say(fmt::format(
        "  against test {} ({}, {} points{}): rms {:.3g} MPa ({:.2g} %), max {:.3g} MPa ({:.2g} %) at a strain "
        "of {:.3g} %",
        test.name, name_of(test.ratio), misfit.points, at, misfit.rms / 1e6, 100 * misfit.rms / misfit.measured,
        misfit.max / 1e6, 100 * misfit.max / misfit.measured, 100 * misfit.at));
  }
  if (!misfit.end.empty()) say(fmt::format("  test {}: {}", test.name, misfit.end));
}

// The materials one after another, and what is written of all of them.
class Bench {
public:
  Bench(const Options& options, const std::map<std::string, workflow::Material>& materials,
        const std::vector<TestCurve>& tests)
      : options_(options), materials_(materials), tests_(tests), test_temperature_(common_temperature(tests)),
        drawn_tests_(tests) {}

  // What is wrong with the laws of these materials, and of what they are fitted to, before any is shown.
  void check(const std::vector<workflow::Material>& materials) const {
    std::vector<workflow::Problem> problems;
    for (const workflow::Material& material : materials) {
      for (const std::string& name : workflow::with_fits(materials_, {material.name})) {
        for (workflow::Problem& problem : common::problems_of_law(materials_.at(name), temperature_for(material))) {
          problems.push_back(std::move(problem));
        }
      }
    }
    common::tell(std::move(problems));
  }

  void show(const workflow::Material& material) {
    std::map<std::string, workflow::Material> taut = materials_;
    taut.at(material.name).tension_field = false;
    say(fmt::format("{}{}", material.name, material.source ? ": " + *material.source : ""));
    if (!temperatures_of(material) && (options_.temperature || is_measured_elsewhere())) {
      say("  does not depend on the temperature");
    }
    if (material.tension_field) say("  without its tension field, which changes nothing in tension");
    const double temperature = temperature_for(material);
    if (temperature != temperature_without_tests())
      say(fmt::format("  at {:.4g} degC, as the tests", celsius(temperature)));
    const common::MaterialLaw made = common::law_of(taut, material.name, temperature);
    common::say_fit(material.name, made);
    show(material.name, made.law, [&](const TestCurve& test) -> std::optional<Law> {
      if (!temperatures_of(material) || options_.temperature || !test.temperature) return made.law;
      if (!has_values(material, *test.temperature)) return std::nullopt;
      return common::law_of(taut, material.name, *test.temperature).law;
    });
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
        common::law_at(material, temperature_for(material)));
    const FittedLaw fitted = fit(test, options_, nu, logarithmic);
    const std::size_t count = fitted.hardening.branches.size();
    const std::string name = fmt::format("{}_{}", material.name, count);
    say(fmt::format("{}: the {} hardening branch{} nearest to {}{}; nu and kind of strain as of {}", name, count,
                    count == 1 ? "" : "es", test.name,
                    static_cast<int>(count) < options_.branches ? ", a branch more would fit noise" : "",
                    material.name));
    const Law law = law_of(fitted);
    show(name, law, [&](const TestCurve&) { return law; });
    if (tests_.empty()) say_misfit(misfit(law, test, options_, std::nullopt), test);
    const std::string at = test.temperature ? fmt::format(" at {:.4g} degC", celsius(*test.temperature)) : "";
    say(yaml_of(fitted, name, fmt::format("fitted to {}{} by pneuma material --fit", test.name, at)));
  }

  void write() const {
    if (!options_.csv.empty()) write_csv(curves_, options_);
    if (options_.svg.empty()) return;
    write_svg(std::span<const Curve>(curves_).subspan(first_drawn_), drawn_tests_, options_);
  }

private:
  // `law_at`: the law at the temperature of a test; none: it has no values there.
  void show(const std::string& name, const Law& law,
            const std::function<std::optional<Law>(const TestCurve&)>& law_at) {
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
      const std::optional<Law> of_test = law_at(test);
      if (!of_test) {
        say(fmt::format("  test {}: not compared, {:.4g} degC is outside the temperatures of the material", test.name,
                        celsius(*test.temperature)));
        continue;
      }
      for (const std::optional<double>& rate : rates) say_misfit(misfit(*of_test, test, options_, rate), test);
    }
  }

  double temperature_without_tests() const {
    return options_.temperature.value_or(pipeline::schema::defaults<workflow::Site>().temperature);
  }

  // Of the curves: what is asked for, or that of the tests where the material has values there.
  double temperature_for(const workflow::Material& material) const {
    const bool as_tests = !options_.temperature && test_temperature_ && has_values(material, *test_temperature_);
    return as_tests ? *test_temperature_ : temperature_without_tests();
  }

  bool has_values(const workflow::Material& material, double temperature) const {
    const auto range = temperatures_of(material);
    return range && temperature >= (*range)[0] && temperature <= (*range)[1];
  }

  // Where a material has values: between its own temperatures, or those of what its table is fitted to.
  std::optional<std::array<double, 2>> temperatures_of(const workflow::Material& material) const {
    const auto* table = std::get_if<workflow::TableLaw>(&material.law);
    if (table != nullptr && table->fit_to) return temperatures_of(materials_.at(*table->fit_to));
    return common::temperatures_of(material);
  }

  bool is_measured_elsewhere() const {
    return std::any_of(tests_.begin(), tests_.end(), [](const TestCurve& test) {
      return test.temperature &&
             std::abs(*test.temperature - pipeline::schema::defaults<workflow::Site>().temperature) > same_temperature;
    });
  }

  // That of all tests which name one.
  static std::optional<double> common_temperature(const std::vector<TestCurve>& tests) {
    std::optional<double> common;
    for (const TestCurve& test : tests) {
      if (!test.temperature) continue;
      if (common && std::abs(*common - *test.temperature) > same_temperature) return std::nullopt;
      if (!common) common = test.temperature;
    }
    return common;
  }

  // What is to be fitted: the uniaxial test, or the material's own curve.
  TestCurve uniaxial_test(const std::string& name) const {
    const auto is_uniaxial = [](const auto& one) { return !one.ratio.shear && (one.ratio.a == 0 || one.ratio.b == 0); };
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
  std::optional<double> test_temperature_; // K; none: tests name none, or several
  std::vector<Curve> curves_;
  std::vector<TestCurve> drawn_tests_;
  std::size_t first_drawn_ = 0; // a picture of a fit shows it and what it was fitted to
};

int run(int argc, char** argv) {
  std::optional<Options> asked = parse(argc, argv);
  if (!asked) return 0;
  Options& options = *asked;
  const workflow::MaterialsResult read = read_materials(options);
  const std::vector<workflow::Material>& materials = read.materials;
  std::vector<TestCurve> tests;
  for (const std::filesystem::path& file : options.data) tests.push_back(read_test(file));
  const auto is_shear = [](const auto& ratio) { return ratio.shear; };
  if (std::any_of(tests.begin(), tests.end(), [&](const TestCurve& test) { return is_shear(test.ratio); }) &&
      std::none_of(options.ratios.begin(), options.ratios.end(), is_shear)) {
    options.ratios.push_back(pure_shear); // drawn under the test
  }
  if (options.branches > 0 && materials.size() != 1) {
    throw base::InputError(fmt::format("--fit fits one material; name one of the {}", materials.size()));
  }
  Bench bench(options, read.known, tests);
  bench.check(materials);
  for (const workflow::Material& material : materials) bench.show(material);
  if (options.branches > 0) bench.show_fit(materials.front());
  bench.write();
  return 0;
}

} // namespace

} // namespace pneuma::stages::material

int main(int argc, char** argv) {
  return pneuma::base::guarded_main("pneuma-material", [&] { return pneuma::stages::material::run(argc, argv); });
}
