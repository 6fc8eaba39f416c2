// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/schema/quantity.h"
#include "solver/material/judgement.h"
#include "stages/common/law_at.h"
#include "stages/common/summary.h"

namespace pneuma::stages::common {

namespace {

namespace workflow = pipeline::workflow;
namespace test_data = pipeline::test_data;
namespace material = solver::material;
using pipeline::schema::celsius;
using workflow::Mark;
using workflow::Problem;

constexpr double megapascal = 1e6;

// The place in the user's file of a parameter (as `material::Fault` names it; of a list where it begins) of the law
// that a material has at a temperature: where its table has an own value, that, otherwise the law's, or the material's.
Mark place_of(const workflow::Material& m, const std::string& parameter = "", double temperature = 0) {
  if (m.places.empty()) return {};
  const Mark& whole = m.places.begin()->second; // "" comes first
  if (parameter.empty()) return whole;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < m.other.size(); ++i) {
    if (m.other[i].at == temperature) paths.push_back(fmt::format("temperature.{}.{}", i, parameter));
  }
  paths.push_back(parameter);
  const auto position = [](const Mark& mark) { return std::pair(mark.line, mark.column); };
  for (const std::string& path : paths) {
    const Mark* first = nullptr;
    for (const auto& [key, mark] : m.places) {
      const bool is_of_it = key == path || key.starts_with(path + ".");
      if (!is_of_it || mark.file != whole.file) continue; // what is not given stage.yaml has filled in
      if (first == nullptr || position(mark) < position(*first)) first = &mark;
    }
    if (first != nullptr) return *first;
  }
  return whole;
}

Problem problem_of(const Mark& place, const workflow::Material& m, const std::string& what, bool error = true) {
  return {place, fmt::format("material `{}`: {}", m.name, what), error};
}

[[noreturn]] void refuse(const workflow::Material& m, const std::string& what) {
  throw base::InputError(to_string(problem_of(place_of(m), m, what)));
}

// Laws as the solver judges them.
material::StVenantKirchhoff stated(const workflow::ElasticLaw& law) {
  return {law.E, law.nu};
}

material::Orthotropic stated(const workflow::OrthotropicLaw& law) {
  return {law.E1, law.E2, law.nu12, law.G12};
}

material::MooneyRivlin stated(const workflow::MooneyRivlinLaw& law) {
  return {law.C1, law.C2};
}

material::Ogden stated(const workflow::OgdenLaw& law) {
  material::Ogden ogden;
  ogden.count = static_cast<int>(law.terms.size());
  for (std::size_t i = 0; i < std::min(law.terms.size(), ogden.terms.size()); ++i) {
    ogden.terms[i] = {law.terms[i].mu, law.terms[i].alpha};
  }
  return ogden;
}

material::Plasticity stated(const workflow::J2Law& law) {
  material::Plasticity plasticity;
  plasticity.elasticity = {law.E, law.nu};
  for (const workflow::HardeningBranch& branch : law.hardening) {
    plasticity.hardening.push_back({branch.stress, branch.modulus});
  }
  const bool is_plastic = law.modulus == workflow::ModulusKind::plastic;
  plasticity.modulus = is_plastic ? material::ModulusKind::plastic : material::ModulusKind::tangent;
  plasticity.softening = law.softening;
  if (law.viscosity) {
    const bool is_peric = law.viscosity->model == workflow::ViscositySettings::Model::peric;
    plasticity.viscosity = {is_peric ? material::Overstress::peric : material::Overstress::perzyna, law.viscosity->mu,
                            law.viscosity->epsilon, law.viscosity->threshold};
  }
  return plasticity;
}

// What is wrong with the law of a material at a temperature that it has values for; tables show it when they are
// fitted.
std::vector<material::Fault> faults_at(const workflow::Material& m, double temperature) {
  return std::visit(
      []<class L>(const L& law) -> std::vector<material::Fault> {
        if constexpr (std::is_same_v<L, workflow::TableLaw>) {
          return {};
        } else {
          return material::faults(stated(law));
        }
      },
      law_at(m, temperature));
}

Problem problem_of(const workflow::Material& m, const material::Fault& fault, double temperature) {
  std::string at;
  if (!m.other.empty() && temperature != m.at) {
    const bool has_own = std::ranges::any_of(m.other, [&](const auto& other) { return other.at == temperature; });
    at = fmt::format("at {:.4g} degC{}: ", celsius(temperature),
                     has_own ? "" : ", between two temperatures of its table");
  }
  return problem_of(place_of(m, fault.parameter, temperature), m, at + fault.message, fault.error);
}

// Why a material has no values for a temperature; empty: it has.
std::string outside_of(const workflow::Material& m, double temperature) {
  const auto range = temperatures_of(m);
  if (!range || (temperature >= (*range)[0] && temperature <= (*range)[1])) return "";
  return fmt::format("its values are for {:.4g} to {:.4g} degC, not {:.4g} degC", celsius((*range)[0]),
                     celsius((*range)[1]), celsius(temperature));
}

material::Law with_tension_field(const material::Law& law) {
  return std::visit(
      []<class L>(const L& taut) -> material::Law {
        if constexpr (std::is_constructible_v<material::Law, material::TensionField<L>>) {
          return material::TensionField<L>{taut};
        } else {
          return taut; // has one
        }
      },
      law);
}

// What makes the laws of one set of materials at one temperature.
class Maker {
public:
  Maker(const std::map<std::string, workflow::Material>& materials, double temperature)
      : materials_(materials), temperature_(temperature) {}

  // Without tension field.
  MaterialLaw make(const workflow::Material& m) const {
    if (const std::string outside = outside_of(m, temperature_); !outside.empty()) refuse(m, outside);
    std::vector<std::string> errors;
    for (const material::Fault& fault : faults_at(m, temperature_)) {
      if (fault.error) errors.push_back(to_string(problem_of(m, fault, temperature_)));
    }
    if (!errors.empty()) throw base::InputError(fmt::format("{}", fmt::join(errors, "\n")));
    return std::visit([&](const auto& law) { return make(m, law); }, law_at(m, temperature_));
  }

private:
  template <class L>
  MaterialLaw make(const workflow::Material&, const L& law) const {
    return {stated(law), {}, {}};
  }

  MaterialLaw make(const workflow::Material&, const workflow::J2Law& law) const {
    const material::Plasticity plasticity = stated(law);
    const material::Flow flow = material::flow_of(plasticity);
    if (law.logarithmic) return {material::Logarithmic{plasticity.elasticity, flow}, {}, {}};
    return {material::J2{plasticity.elasticity, flow}, {}, {}};
  }

  MaterialLaw make(const workflow::Material& m, const workflow::TableLaw& law) const {
    if (law.fit_to) return fitted(m, law);
    const test_data::MissingTests missing = test_data::missing_tests(law.points, law.has_axes());
    if (missing.useless) refuse(m, "its table cannot be fitted: " + missing.message);
    MaterialLaw made = fitted(m, law);
    const std::array ratios = test_data::least_stress_ratios(law.points, law.has_axes());
    if (const double ratio = std::max(ratios[0], ratios[1]); std::isfinite(ratio)) made.least_stress_ratio = ratio;
    made.missing_tests = missing.message;
    return made;
  }

  MaterialLaw fitted(const workflow::Material& m, const workflow::TableLaw& law) const {
    material::NurbsOptions options;
    options.net = law.net;
    options.degree = law.degree;
    options.potential = law.potential;
    options.smoothing = law.smoothing;
    if (law.range) options.range = material::StrainRange{(*law.range)[0], (*law.range)[1]};
    std::vector<material::StressPoint> points;
    for (const workflow::TableLaw::Point& p : law.points) {
      points.push_back({p.strain_1, p.strain_2, p.stress_1, p.stress_2, p.weight});
    }
    std::vector<material::ShearPoint> shear;
    for (const workflow::TableLaw::ShearPoint& p : law.shear_points) shear.push_back({p.strain, p.stress, p.weight});
    std::optional<material::Law> model;
    if (law.fit_to) model = make(materials_.at(*law.fit_to)).law;
    try {
      if (law.kind == workflow::TableLaw::Kind::pd_nurbs) {
        const material::PdFit fit =
            model ? material::fit_pd_nurbs(*model, options, 0, points) : material::fit_pd_nurbs(points, options);
        return {material::PdNurbs{fit.table, law.goes_on, law.nu}, fit.report, {}};
      }
      const material::LeFit fit =
          model ? material::fit_le_nurbs(*model, options) : material::fit_le_nurbs(points, shear, options);
      return {material::LeNurbs{fit.table, law.goes_on, law.nu}, fit.report, fit.shear_report};
    } catch (const std::invalid_argument& error) {
      refuse(m, fmt::format("its table cannot be fitted: {}", error.what()));
    }
  }

  const std::map<std::string, workflow::Material>& materials_;
  double temperature_;
};

// "rms 0.02 MPa, at most 0.1 MPa (0.4 % of 25 MPa) at strains (0.1, 0.02)"
std::string text_of(const material::FitReport& fit) {
  std::string text =
      fmt::format("rms {:.2g} MPa, at most {:.2g} MPa ({:.2g} % of {:.3g} MPa) at strains ({:.3g}, {:.3g})",
                  fit.rms / megapascal, fit.max / megapascal, 100 * fit.max / fit.largest_stress,
                  fit.largest_stress / megapascal, fit.where[0], fit.where[1]);
  text += fmt::format("; smoothing {:.0e}", fit.smoothing);
  if (fit.uncovered > 0) text += fmt::format("; {:.0f} % of the table holds no point", 100 * fit.uncovered);
  if (fit.integrability_defect > 0) {
    text += fmt::format("; without a potential, integrability defect {:.2g}: equilibrium takes more iterations",
                        fit.integrability_defect);
  }
  return text;
}

std::vector<std::string> warnings_of(const std::string& name, const MaterialLaw& made) {
  constexpr const char* help = "a coarser net, more points or, where `smoothing` is given, more of it may help";
  std::vector<std::string> warnings;
  if (made.fit && !made.fit->monotone) {
    warnings.push_back(
        fmt::format("the stress of the table `{}` does not rise with the strain everywhere, least at strains ({:.3g}, "
                    "{:.3g}): {}",
                    name, made.fit->not_monotone[0], made.fit->not_monotone[1], help));
  }
  if (made.shear_fit && !made.shear_fit->monotone) {
    warnings.push_back(fmt::format("the shear stress of the table `{}` does not rise with the strain everywhere, least "
                                   "at a shear strain of {:.3g}: {}",
                                   name, made.shear_fit->not_monotone[0], help));
  }
  return warnings;
}

} // namespace

std::vector<Problem> problems_of_law(const workflow::Material& m, double temperature) {
  std::set<std::pair<std::string, std::string>> told; // parameter, message
  std::vector<Problem> problems;
  const auto judge = [&](double at) {
    for (const material::Fault& fault : faults_at(m, at)) {
      if (told.emplace(fault.parameter, fault.message).second) problems.push_back(problem_of(m, fault, at));
    }
  };
  judge(m.at);
  for (const auto& [at, law] : m.other) judge(at);
  // between two laws of which one is none is none
  if (std::ranges::any_of(problems, &Problem::error)) return problems;
  if (const std::string outside = outside_of(m, temperature); !outside.empty()) {
    problems.push_back(problem_of(place_of(m), m, outside));
  } else {
    judge(temperature);
  }
  return problems;
}

void tell(std::vector<Problem> problems) {
  const auto place = [](const Problem& p) { return std::tie(p.mark.file, p.mark.line, p.mark.column); };
  std::ranges::stable_sort(problems, {}, place);
  std::set<std::string> told;
  std::string errors;
  for (const Problem& problem : problems) {
    const std::string line = to_string(problem);
    if (!told.insert(line).second) continue;
    if (problem.error) {
      errors += (errors.empty() ? "" : "\n") + line;
    } else {
      fmt::print(stderr, "{}\n", line);
    }
  }
  if (!errors.empty()) throw base::InputError(errors);
}

void check_laws(const std::map<std::string, workflow::Material>& materials, double temperature) {
  std::vector<Problem> problems;
  for (const auto& [name, m] : materials) {
    for (Problem& problem : problems_of_law(m, temperature)) problems.push_back(std::move(problem));
  }
  tell(std::move(problems));
}

MaterialLaw law_of(const std::map<std::string, workflow::Material>& materials, const std::string& name,
                   double temperature) {
  const workflow::Material& m = materials.at(name);
  MaterialLaw made = Maker(materials, temperature).make(m);
  if (m.tension_field) made.law = with_tension_field(made.law);
  return made;
}

void say_fit(const std::string& name, const MaterialLaw& made) {
  if (made.fit) {
    std::string text = text_of(*made.fit);
    if (!made.missing_tests.empty()) text += "; no test near uniaxial stress";
    base::say(fmt::format("table of `{}`: {}", name, text));
  }
  if (made.shear_fit) base::say(fmt::format("its shear: {}", text_of(*made.shear_fit)));
  for (const std::string& warning : warnings_of(name, made)) base::warn(warning);
}

MaterialLaws laws_of(const workflow::Workflow& workflow) {
  MaterialLaws laws;
  for (const workflow::FoilSettings& foil : workflow.cushion.foils) {
    const auto [at, is_new] = laws.try_emplace(foil.material);
    if (!is_new) continue;
    at->second = law_of(workflow.materials, foil.material, workflow.site.temperature);
    say_fit(foil.material, at->second);
  }
  return laws;
}

void summarize(const MaterialLaws& laws, Summary& summary) {
  for (const auto& [name, made] : laws) {
    const std::pair<const char*, const std::optional<material::FitReport>*> reports[] = {
        {"fit", &made.fit}, {"shear_fit", &made.shear_fit}};
    for (const auto& [what, report] : reports) {
      if (!*report) continue;
      const material::FitReport& fit = **report;
      const std::string key = fmt::format("materials.{}.{}.", name, what);
      summary.set(key + "rms", fit.rms);
      summary.set(key + "max", fit.max);
      summary.set(key + "largest_stress", fit.largest_stress);
      summary.set(key + "strain_1", fit.where[0]);
      summary.set(key + "strain_2", fit.where[1]);
      summary.set(key + "smoothing", fit.smoothing);
      summary.set(key + "uncovered", fit.uncovered);
      summary.set(key + "monotone", fit.monotone);
      summary.set(key + "integrability_defect", fit.integrability_defect);
    }
    if (made.least_stress_ratio) {
      summary.set(fmt::format("materials.{}.fit.least_stress_ratio", name), *made.least_stress_ratio);
    }
    for (const std::string& warning : warnings_of(name, made)) summary.append("warnings", warning);
    if (!made.missing_tests.empty()) {
      summary.append("warnings", fmt::format("table `{}`: {}", name, made.missing_tests));
    }
  }
}

} // namespace pneuma::stages::common
