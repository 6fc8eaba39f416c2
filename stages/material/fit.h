// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solver/material/hardening_fit.h"
#include "stages/material/comparison.h"

namespace pneuma::stages::material {

// The part of a uniaxial curve up to its largest strain, without unloading; axis 1 or 2, whichever is pulled.
std::vector<TestPoint> rising_part(const TestCurve& test);

// The J2 law whose uniaxial curve is nearest to a test's in nominal stress, with this Poisson's ratio. Throws
// InputError where the test cannot carry so many branches.
struct FittedLaw {
  solver::material::HardeningFit hardening;
  double poissons_ratio = 0;
  bool logarithmic = true; // strain of the law: logarithmic, otherwise small
};
FittedLaw fit(const TestCurve& test, const Options& options, double poissons_ratio, bool logarithmic);

solver::material::Law law_of(const FittedLaw& fitted);

// As it stands in a file of materials.
std::string yaml_of(const FittedLaw& fitted, const std::string& name, const std::string& source);

} // namespace pneuma::stages::material
