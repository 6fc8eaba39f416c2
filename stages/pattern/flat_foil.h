// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/fabrication/fabrication.h"
#include "geometry/mesh.h"
#include "geometry/strips/cut.h"
#include "geometry/strips/sides.h"
#include "solver/flattening/flattening.h"
#include "solver/material/material.h"

namespace pneuma::stages::pattern {

using base::Index;
using base::Mat3;
using base::Vec2;
using base::Vec3;

// What the flat strips of a foil shall be when they are assembled.
struct Wanted {
  double direction = 0;      // rad, of the roll from the plan's x axis
  Vec3 stretch{1, 1, 0};     // (G11, G22, G12), flat to form, in the frame of the roll
  double decompensation = 0; // m, zone along clamped edges where the stretch along the edge fades in; 0: none
  Mat3 weight = Mat3::Identity();
  bool tied = true; // mating seams equally long
  solver::flattening::Options options;
};

// Stretch and weight for a foil that shall carry `prestress` (isotropic, N/m): G of the law (numerics 11), and the
// square of the stress that it answers a deviation with.
struct ElasticStretch {
  Vec3 stretch;
  Mat3 weight;
};
std::optional<ElasticStretch> elastic_stretch(const solver::material::Law& law, double thickness, double prestress);

// One foil's strips in the plane.
struct FlatFoil {
  solver::flattening::FlatNodes nodes;
  solver::flattening::Flat flat;
  std::vector<double> wanted;                                  // stretch [element][point][3], faded near clamped edges
  std::vector<solver::flattening::PointStretch> stretches;     // [element][point]
  std::vector<std::vector<geometry::strips::StripSide>> sides; // per strip, nodes of the mesh
  std::vector<std::vector<std::vector<Index>>> flat_sides;     // the same, flat nodes
};

FlatFoil flatten_foil(const geometry::Mesh& mesh, Index block, geometry::StressRule rule,
                      const geometry::strips::CutFoil& cut, const Wanted& wanted);

// Coordinates per element corner [element][node][3], z = 0: the reference of the welded foil.
std::vector<double> corner_coordinates(const FlatFoil& foil);

std::string strip_name(const std::string& foil, Index strip); // "upper-1"
std::string seam_name(Index seam);                            // "S1"

// Net outlines with names, for drawing, allowances and nesting.
std::vector<geometry::fabrication::FlatStrip> outlines(const FlatFoil& foil, const geometry::Mesh& mesh, Index block);

} // namespace pneuma::stages::pattern
