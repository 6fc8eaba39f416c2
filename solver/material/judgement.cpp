// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/judgement.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuma::solver::material {

namespace {

using Faults = std::vector<Fault>;

// A number of a law.
struct Number {
  std::string parameter;
  double value = 0;
  const char* unit = ""; // as it is shown; none: without dimension
};

Number stress(std::string parameter, double value) {
  return {std::move(parameter), value / 1e6, " MPa"};
}

std::string text(const Number& number) {
  if (*number.unit == 0) return fmt::format("{}", number.value);
  return fmt::format("{:.6g}{}", number.value, number.unit);
}

std::string megapascal(double value) {
  return text(stress("", value));
}

// A number by itself is finite and `allowed`; `wanted` says what it must be.
void need(Faults& found, const Number& number, bool allowed = true, const char* wanted = "") {
  const bool is_finite = std::isfinite(number.value);
  if (is_finite && allowed) return;
  const std::string name = number.parameter.substr(number.parameter.rfind('.') + 1);
  found.push_back({number.parameter,
                   fmt::format("`{}` must be {}, not {}", name, is_finite ? wanted : "a finite number", text(number))});
}

void need_elasticity(Faults& found, double E, double nu) {
  need(found, stress("E", E), E > 0, "positive");
  need(found, {"nu", nu}, nu > -1 && nu <= 0.5, "above -1, up to 0.5");
}

std::string of_branch(std::size_t i, const char* member) {
  return fmt::format("hardening.{}.{}", i, member);
}

// Why a branch does not lead to the next one.
Fault no_way(std::size_t i, const HardeningBranch& branch, const HardeningBranch& next) {
  const std::string from = megapascal(branch.stress), to = megapascal(next.stress);
  if (branch.modulus > 0 && next.stress <= branch.stress) {
    return {of_branch(i + 1, "stress"),
            fmt::format("yield stresses must rise from branch to branch: {} after {}", to, from)};
  }
  if (branch.modulus < 0 && next.stress >= branch.stress) {
    return {of_branch(i + 1, "stress"),
            fmt::format("after a branch that softens the yield stress must be lower: {} after {}", to, from)};
  }
  return {of_branch(i, "modulus"), fmt::format("a branch of modulus {} never comes to the next one's yield stress, {}; "
                                               "only the last branch may be level",
                                               megapascal(branch.modulus), to)};
}

// The modulus of a branch beside E and nu. `plastic`: as a plastic modulus.
std::optional<Fault> fault_of_modulus(const Plasticity& law, std::size_t i, double plastic) {
  const double stated = law.hardening[i].modulus, E = law.elasticity.youngs_modulus;
  const double steepest = law.elasticity.steepest_softening();
  const auto fault = [i](std::string message) { return Fault{of_branch(i, "modulus"), std::move(message)}; };
  if (law.modulus == ModulusKind::tangent && !(stated < E && std::isfinite(plastic))) {
    return fault(fmt::format("a tangent modulus must be below E, {}, not {}; is it a plastic modulus? then say "
                             "`modulus: plastic`",
                             megapascal(E), megapascal(stated)));
  }
  if (stated < 0 && !law.softening) {
    return fault(fmt::format("a modulus of {} means softening: strains then gather in one row of elements and results "
                             "depend on the mesh; say `softening: on` if it is meant",
                             megapascal(stated)));
  }
  if (!(plastic > steepest)) {
    return fault(fmt::format("the yield stress falls too steeply: as a plastic modulus {:.4g} MPa, which must be above "
                             "{:.4g} MPa",
                             plastic / 1e6, steepest / 1e6));
  }
  return std::nullopt;
}

void judge_hardening(Faults& found, const Plasticity& law) {
  const std::vector<HardeningBranch> plastic = plastic_branches(law);
  for (std::size_t i = 0; i < plastic.size(); ++i) {
    if (const std::optional<Fault> fault = fault_of_modulus(law, i, plastic[i].modulus)) {
      found.push_back(*fault);
    } else if (i + 1 < plastic.size()) {
      if (!length_of(plastic[i], plastic[i + 1])) found.push_back(no_way(i, law.hardening[i], law.hardening[i + 1]));
    } else if (plastic[i].modulus < 0) {
      found.push_back({of_branch(i, "modulus"),
                       "the last branch must not soften: it would end below a yield stress of zero; add one with "
                       "`modulus: 0 MPa` where the softening ends"});
    }
  }
}

// Of a law whose branches lead to one another.
void judge_threshold(Faults& found, const Plasticity& law) {
  if (law.viscosity.model == Overstress::none || !law.viscosity.threshold) return;
  const double threshold = *law.viscosity.threshold, first = law.hardening.front().stress;
  const auto fail = [&](std::string message) { found.push_back({"viscosity.threshold", std::move(message)}); };
  if (threshold > first) {
    fail(fmt::format("`threshold` must be at most the first yield stress, {}, not {}: without it the foil flows from "
                     "there on",
                     megapascal(first), megapascal(threshold)));
  } else if (!flow_of(law).onset_stays_positive()) {
    double least = first;
    for (const HardeningBranch& branch : law.hardening) least = std::min(least, branch.stress);
    fail(fmt::format("`threshold` must be above {}, by which the softening lowers the yield stress, not {}: the foil "
                     "would flow without stress",
                     megapascal(first - least), megapascal(threshold)));
  }
}

std::string of_term(int k, const char* member) {
  return fmt::format("terms.{}.{}", k, member);
}

void need_terms(Faults& found, const Ogden& law) {
  constexpr double largest = 100; // (l1 l2)^alpha is a number wherever a foil can be
  if (law.count < 1 || law.count > Ogden::capacity) {
    found.push_back({"terms", fmt::format("`terms` must have 1 to {} entries, not {}", Ogden::capacity, law.count)});
    return;
  }
  for (int k = 0; k < law.count; ++k) {
    const auto& [mu, alpha] = law.terms[static_cast<std::size_t>(k)];
    need(found, stress(of_term(k, "mu"), mu));
    need(found, {of_term(k, "alpha"), alpha}, std::abs(alpha) <= largest, "from -100 to 100");
    if (alpha == 0) {
      found.push_back({of_term(k, "alpha"), "`alpha` must not be 0: the term would have no meaning"});
    } else if (mu == 0) {
      found.push_back({of_term(k, "mu"), "`mu` must not be 0: the term would have no effect"});
    }
  }
}

// Where Ogden's constants are unstable; empty: nowhere.
std::string unstable_ranges(const Ogden& law) {
  // a foil is not stretched further, and constants from tests seldom hold beyond
  constexpr double least = 0.25, most = 4;
  constexpr const char* names[] = {"uniaxial tension", "equibiaxial tension", "pure shear"};
  std::vector<std::string> where;
  for (const Instability& range : instabilities(law, least, most)) {
    where.push_back(fmt::format("in {} at stretches from {:.3g} to {:.3g}", names[static_cast<std::size_t>(range.pull)],
                                range.from, range.to));
  }
  return fmt::format("{}", fmt::join(where, ", "));
}

void judge_terms(Faults& found, const Ogden& law) {
  double twice_shear_modulus = 0;
  for (int k = 0; k < law.count; ++k) {
    const auto& [mu, alpha] = law.terms[static_cast<std::size_t>(k)];
    twice_shear_modulus += mu * alpha;
    if ((mu > 0) == (alpha > 0)) continue;
    found.push_back({fmt::format("terms.{}", k),
                     fmt::format("`mu` {} and `alpha` {} have different signs: such a term may make the foil "
                                 "unstable in some range of stretch; from 1/4 to 4 no such range was found",
                                 megapascal(mu), alpha),
                     false});
  }
  std::string error;
  if (!(twice_shear_modulus > 0)) {
    error = fmt::format("the shear modulus, half the sum of mu alpha, must be positive, not {:.4g} MPa",
                        twice_shear_modulus / 2e6);
  } else if (const std::string where = unstable_ranges(law); !where.empty()) {
    error = fmt::format("its Ogden constants are unstable, more strain needs less stress, {}; terms whose mu and alpha "
                        "have one sign are stable",
                        where);
  }
  if (!error.empty()) found = Faults{Fault{"terms", error}};
}

} // namespace

std::vector<Fault> faults(const StVenantKirchhoff& law) {
  Faults found;
  need_elasticity(found, law.youngs_modulus, law.poissons_ratio);
  return found;
}

std::vector<Fault> faults(const Orthotropic& law) {
  Faults found;
  const double E1 = law.youngs_modulus_1, E2 = law.youngs_modulus_2, nu12 = law.poissons_ratio_12;
  need(found, stress("E1", E1), E1 > 0, "positive");
  need(found, stress("E2", E2), E2 > 0, "positive");
  need(found, {"nu12", nu12});
  need(found, stress("G12", law.shear_modulus), law.shear_modulus > 0, "positive");
  if (found.empty() && !law.positive_definite()) {
    found.push_back(
        {"nu12", fmt::format("`nu12` must be between -{0:.4g} and {0:.4g}, the square root of E1 / E2, not {1}: "
                             "otherwise some strain has no positive energy; is it meant for tension along the other "
                             "axis, nu21?",
                             std::sqrt(E1 / E2), nu12)});
  }
  return found;
}

std::vector<Fault> faults(const MooneyRivlin& law) {
  Faults found;
  need(found, stress("C1", law.c1), law.c1 > 0, "positive");
  need(found, stress("C2", law.c2), law.c2 >= 0, "at least 0 Pa");
  return found;
}

std::vector<Fault> faults(const Ogden& law) {
  Faults found;
  need_terms(found, law);
  if (found.empty()) judge_terms(found, law);
  return found;
}

std::vector<Fault> faults(const Plasticity& law) {
  Faults found;
  need_elasticity(found, law.elasticity.youngs_modulus, law.elasticity.poissons_ratio);
  if (law.hardening.empty()) found.push_back({"hardening", "`hardening` must have at least one branch"});
  for (std::size_t i = 0; i < law.hardening.size(); ++i) {
    const HardeningBranch& branch = law.hardening[i];
    need(found, stress(of_branch(i, "stress"), branch.stress), branch.stress > 0, "positive");
    need(found, stress(of_branch(i, "modulus"), branch.modulus));
  }
  if (const Viscosity& v = law.viscosity; v.model != Overstress::none) {
    need(found, {"viscosity.mu", v.mu, " s"}, v.mu > 0, "positive");
    need(found, {"viscosity.epsilon", v.epsilon}, v.epsilon > 0 && v.epsilon <= 10, "above 0, up to 10");
    if (v.threshold) need(found, stress("viscosity.threshold", *v.threshold), *v.threshold >= 0, "at least 0 Pa");
  }
  if (found.empty()) judge_hardening(found, law);
  if (found.empty()) judge_threshold(found, law);
  return found;
}

} // namespace pneuma::solver::material
