// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/schema/quantity.h"
#include "stages/material/curves.h"

namespace pneuma::stages::material {

// A point of a test: engineering strains and 2 E12, -; nominal stresses and S12, Pa.
struct TestPoint {
  Vec3 strain = Vec3::Zero();
  Vec3 stress = Vec3::Zero();
  std::optional<double> time; // s
  double weight = 1;
};

using pipeline::schema::celsius;

// What a test machine measured of one piece, in the order of time.
struct TestCurve {
  std::string name;
  std::vector<TestPoint> points;
  Ratio ratio;                       // of the stresses
  std::optional<double> temperature; // K, mean
};

// Reads a file of test data (pipeline/test_data), one test a file. The ratio of its stresses is their least-squares
// one, the larger 1; below 1 % the smaller is taken to be none, as where it was not measured. A file of shear strains
// without others is a test in shear. Warns of what is implausible. Throws InputError with every fault, each with file,
// line and column, and where the stresses have no common ratio.
TestCurve read_test(const std::filesystem::path& file);

// How far a law's stresses are from those of a test: the piece is pulled through the measured strains along the axis of
// the larger stress, with the test's ratio of stresses.
struct Misfit {
  int points = 0;      // compared
  double rms = 0;      // of the stress along both axes, or along the first alone of a uniaxial test, Pa
  double max = 0;      // Pa
  double at = 0;       // engineering strain along the driven axis where it is
  double measured = 0; // largest measured stress, Pa
  std::string end;     // why the law could not be taken through all points; empty: it was
};
// `rate` holds where the test names no times.
Misfit misfit(const solver::material::Law& law, const TestCurve& test, const Options& options,
              std::optional<double> rate);

} // namespace pneuma::stages::material
