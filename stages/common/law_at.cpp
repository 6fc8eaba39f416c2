// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "stages/common/law_at.h"

namespace pneuma::stages::common {

namespace workflow = pipeline::workflow;
using workflow::ElasticLaw;
using workflow::J2Law;
using workflow::Material;
using workflow::OrthotropicLaw;

namespace {

ElasticLaw between(const ElasticLaw& a, const ElasticLaw& b, double t) {
  return {std::lerp(a.E, b.E, t), std::lerp(a.nu, b.nu, t)};
}

OrthotropicLaw between(const OrthotropicLaw& a, const OrthotropicLaw& b, double t) {
  return {std::lerp(a.E1, b.E1, t), std::lerp(a.E2, b.E2, t), std::lerp(a.nu12, b.nu12, t), std::lerp(a.G12, b.G12, t)};
}

J2Law between(const J2Law& a, const J2Law& b, double t) {
  J2Law law = a;
  law.E = std::lerp(a.E, b.E, t);
  law.nu = std::lerp(a.nu, b.nu, t);
  for (std::size_t i = 0; i < law.hardening.size(); ++i) {
    law.hardening[i].stress = std::lerp(a.hardening[i].stress, b.hardening[i].stress, t);
    law.hardening[i].modulus = std::lerp(a.hardening[i].modulus, b.hardening[i].modulus, t);
  }
  return law;
}

// Laws whose values do not depend on the temperature.
template <class L>
L between(const L& a, const L&, double) {
  return a;
}

} // namespace

std::optional<std::array<double, 2>> temperatures_of(const Material& material) {
  if (material.other.empty()) return std::nullopt;
  std::array range = {material.at, material.at};
  for (const auto& [at, law] : material.other) range = {std::min(range[0], at), std::max(range[1], at)};
  return range;
}

workflow::MaterialLaw law_at(const Material& material, double temperature) {
  const auto range = temperatures_of(material);
  if (!range) return material.law;
  if (!(temperature >= (*range)[0] && temperature <= (*range)[1])) {
    throw std::invalid_argument(fmt::format("{} K is outside the table of `{}`, {} to {} K", temperature, material.name,
                                            (*range)[0], (*range)[1]));
  }
  std::map<double, workflow::MaterialLaw> laws = {{material.at, material.law}};
  for (const auto& [at, law] : material.other) laws.emplace(at, law);
  const auto above = laws.lower_bound(temperature);
  if (above->first == temperature) return above->second;
  const auto below = std::prev(above);
  const double t = (temperature - below->first) / (above->first - below->first);
  return std::visit(
      [&]<class L>(const L& first) -> workflow::MaterialLaw { return between(first, std::get<L>(above->second), t); },
      below->second);
}

} // namespace pneuma::stages::common
