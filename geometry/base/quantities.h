// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/base/namespace.h"

namespace pneuma::geometry::base {

// Pressure against still ambient air, Pa.
struct GaugePressure {
  double pascal = 0;
};

// Pressure against vacuum, Pa: what a gas law needs.
struct AbsolutePressure {
  double pascal = 0;
};

inline AbsolutePressure absolute(GaugePressure gauge, AbsolutePressure ambient) {
  return {gauge.pascal + ambient.pascal};
}

inline GaugePressure gauge(AbsolutePressure absolute, AbsolutePressure ambient) {
  return {absolute.pascal - ambient.pascal};
}

} // namespace pneuma::geometry::base
