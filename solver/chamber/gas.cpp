// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/chamber/gas.h"

#include <algorithm>
#include <cmath>

namespace pneuma::solver::chamber {

namespace {

// ln(a / b): by the difference near one, which keeps the digits when p is a few hundred Pa in 1e5; else by the ratio,
// which stays finite where the difference rounds to -1
double log_ratio(double a, double b) {
  const double change = (a - b) / b;
  return std::abs(change) < 0.5 ? std::log1p(change) : std::log(a / b);
}

} // namespace

GasLine gas_line(const Gas& gas, double gauge_pressure, double volume, double load_factor) {
  GasLine line;
  if (const auto* closed = std::get_if<Closed>(&gas)) {
    line.pressure_is_unknown = true;
    const double absolute = gauge_pressure + std::lerp(closed->ambient_from, closed->ambient_to, load_factor);
    const double temperature = std::lerp(closed->temperature0, closed->temperature, load_factor);
    const bool air = closed->kappa > 0 && closed->absolute0 > 0 && closed->volume0 > 0 && closed->temperature0 > 0 &&
                     temperature > 0;
    if (!air || !(volume > 0) || !(absolute > 0)) {
      line.possible = false;
      return line;
    }
    line.relative = log_ratio(absolute, closed->absolute0) + closed->kappa * log_ratio(volume, closed->volume0) -
                    log_ratio(temperature, closed->temperature0);
    line.residual = line.relative * volume / closed->kappa;
    line.compliance = volume / (closed->kappa * absolute);
    line.drive = ((closed->ambient_to - closed->ambient_from) / absolute -
                  (closed->temperature - closed->temperature0) / temperature) *
                 volume / closed->kappa;
  } else if (const auto* prescribed = std::get_if<PrescribedVolume>(&gas)) {
    line.pressure_is_unknown = true;
    const double wanted = std::lerp(prescribed->from, prescribed->to, load_factor);
    const double scale = std::max(prescribed->from, prescribed->to); // `wanted` may start from a flat chamber's 0
    line.possible = prescribed->from >= 0 && prescribed->to > 0 && std::isfinite(volume);
    line.residual = volume - wanted;
    line.drive = prescribed->from - prescribed->to;
    line.relative = line.possible ? line.residual / scale : 0.0;
  }
  return line;
}

double prescribed_pressure(const Gas& gas, double current, double load_factor) {
  if (const auto* regulated = std::get_if<Regulated>(&gas)) {
    return std::lerp(regulated->gauge_from, regulated->gauge_to, load_factor);
  }
  return current;
}

double prescribed_rate(const Gas& gas) {
  const auto* regulated = std::get_if<Regulated>(&gas);
  return regulated != nullptr ? regulated->gauge_to - regulated->gauge_from : 0.0;
}

double ambient_pressure(const Gas& gas, double otherwise, double load_factor) {
  if (const auto* closed = std::get_if<Closed>(&gas)) {
    return std::lerp(closed->ambient_from, closed->ambient_to, load_factor);
  }
  return otherwise;
}

} // namespace pneuma::solver::chamber
