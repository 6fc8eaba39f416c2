// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "stages/material/comparison.h"

namespace pneuma::stages::material {

// Stresses along the driven axes of one material's curves at ten strains, strain that is left after unloading.
std::string table(std::span<const Curve> curves, const Options& options);

// All points of all curves; the columns of a file of test data among them. Throws StateError with the system's reason.
void write_csv(std::span<const Curve> curves, const Options& options);

// Along the driven axes, tests as marks, of long ones some. Throws like write_csv.
void write_svg(std::span<const Curve> curves, std::span<const TestCurve> tests, const Options& options);

} // namespace pneuma::stages::material
