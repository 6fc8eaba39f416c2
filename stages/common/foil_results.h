// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solver/element/membrane.h"
#include "stages/common/stage.h"
#include "stages/common/summary.h"

namespace pneuma::stages::common {

// What is reported of one foil in a state; everything recomputed from positions and material, nothing carried along.
struct Extreme {
  double max = 0, min = 0; // of the recovered field
  double max_gauss = 0;    // at the stress points
  Vec3 at = Vec3::Zero();  // current place of max
};

struct FoilResults {
  std::string name;
  Index block = 0;
  double area = 0;            // m2
  double sag = 0;             // m, and
  double max_deflection = 0;  // m, against the stage's start: NaN of a foil that is slack all over
  double thickness_min = 0;   // m
  double compressed_area = 0; // part of the area whose smaller principal stress is negative
  double compression = 0;     // Pa, largest
  bool tension_field = false; // the law has one; only then are there
  double wrinkled_area = 0;   // parts of the stress-free area
  double slack_area = 0;
  double outside_area = 0; // strained beyond the data of a table that goes on
  bool plastic = false;    // the law has a plastic strain; only then are there
  Extreme plastic_strain;
  double dissipated = 0; // J, so far
  double stored = 0;     // J, recoverable
  Extreme von_mises, stress1, stress2, strain1, strain2;

  // recovered, per node of the mesh (0 where the foil has none): Pa, Pa, Pa, -, -, -
  std::vector<double> nodal_von_mises, nodal_stress1, nodal_stress2, nodal_strain1, nodal_strain2, nodal_plastic_strain;
  // at the stress points: Cauchy stress (s11, s22, s12), Pa, in the carried material frame; thickness, m; surface
  // state: 0 taut, 1 wrinkled, 2 slack
  std::vector<double> cauchy, thickness, surface;
};

// Stresses, strains and thickness are those of the foil itself: where it wrinkles, with the wrinkles laid flat. Where
// it is slack its position is not determined: sag and deflection are those of elements that are not slack all over.

// `strip_of_element`: of a foil welded from strips, else empty. Stress jumps at seams and its frames differ: each strip
// is recovered by itself, and a seam's node carries the larger value of its strips.
FoilResults foil_results(const geometry::Mesh& mesh, Index block, const solver::element::Membrane& membrane,
                         std::span<const Index> strip_of_element, std::span<const Vec3> start,
                         std::span<const Vec3> now, std::span<const double> history);

// Writes the keys mesh.*: elements and unknowns of the foils.
void summarize_mesh(const State& state, Summary& summary);

// Writes the keys foils.<name>.* .
void summarize(const FoilResults& results, Summary& summary);

// Adds the fields that ParaView shows: displacement; von_mises, principal stresses and strains at the nodes of each
// foil (`von_mises.upper`); the mean von Mises stress of each element and, of foils with a tension field, the mean
// surface state (`surface_state.upper`: 0 taut, 1 wrinkled, 2 slack, where positions mean nothing); stress and
// thickness at the stress points.
void add_fields(const std::vector<FoilResults>& results, std::span<const Vec3> start, State& state);

} // namespace pneuma::stages::common
