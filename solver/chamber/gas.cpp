// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/chamber/gas.h"

#include <cmath>

namespace pneuma::solver::chamber {

GasLine gas_line(const Gas& gas, double gauge_pressure, double volume, double load_factor) {
  GasLine line;
  if (const auto* closed = std::get_if<Closed>(&gas)) {
    line.pressure_is_unknown = true;
    const double absolute = gauge_pressure + std::lerp(closed->ambient_from, closed->ambient_to, load_factor);
    const double temperature = std::lerp(closed->temperature0, closed->temperature, load_factor);
    if (!(volume > 0) || !(absolute > 0)) {
      line.possible = false;
      return line;
    }
    // log1p of the small differences keeps the digits when p is a few hundred Pa in 1e5
    const double pressure_part = std::log1p((absolute - closed->absolute0) / closed->absolute0);
    const double volume_part = std::log1p((volume - closed->volume0) / closed->volume0);
    line.relative = pressure_part + closed->kappa * volume_part - std::log(temperature / closed->temperature0);
    line.residual = line.relative * volume / closed->kappa;
    line.compliance = volume / (closed->kappa * absolute);
  } else if (const auto* prescribed = std::get_if<PrescribedVolume>(&gas)) {
    line.pressure_is_unknown = true;
    const double wanted = std::lerp(prescribed->from, prescribed->to, load_factor);
    line.residual = volume - wanted;
    line.relative = line.residual / wanted;
    line.possible = volume > 0;
  }
  return line;
}

double prescribed_pressure(const Gas& gas, double current, double load_factor) {
  if (const auto* regulated = std::get_if<Regulated>(&gas)) {
    return std::lerp(regulated->gauge_from, regulated->gauge_to, load_factor);
  }
  return current;
}

double ambient_pressure(const Gas& gas, double otherwise, double load_factor) {
  if (const auto* closed = std::get_if<Closed>(&gas)) {
    return std::lerp(closed->ambient_from, closed->ambient_to, load_factor);
  }
  return otherwise;
}

} // namespace pneuma::solver::chamber
