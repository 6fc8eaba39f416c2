// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/quadrature.h"

namespace pneuma::pipeline::state {

using base::Index;
using base::Vec3;

// Version of the layout below and of the file; a file of another version is refused with a message.
inline constexpr int schema_version = 5;

// Where a state comes from. Text only: nothing here takes part in computing.
struct Provenance {
  std::string program;                       // "pneuma-inflate 0.1.0"
  std::string stage_kind;                    // mesh, formfind, pattern, inflate, wind
  std::string stage_id;                      // key in the workflow file
  std::map<std::string, std::string> inputs; // name -> sha256 (state, ...)
  std::string settings;                      // effective settings of the stage, as YAML
  std::string verdict;                       // one sentence: how it converged
  bool converged = false;                    // false: the last good state of a stage that did not reach its end
  double load_factor = 0;                    // reached, 0 .. 1
};

// A weld between two strips of a foil.
struct Seam {
  std::string name;          // "S2"
  Index left = 0, right = 0; // numbers of the strips on both sides, seen along the seam
  std::vector<Index> nodes;  // of the mesh, from end to end, mid-side nodes included; shared by both strips
};

// A foil (or the rigid base); entry i belongs to block i of the mesh. A base has no reference, history or thickness.
struct Foil {
  std::string material;  // name in the materials of the settings
  double thickness = 0;  // m, as rolled
  double warp_angle = 0; // rad, of the roll direction from the plan's x axis
  // Reference configuration: the coordinates of every element's nodes, per element corner (a seam's node has other
  // coordinates in each strip) [element][node][3], m; empty: none yet.
  std::vector<double> reference;
  // Stress-free predeformation at the Gauss points [element][point][3] = (G11, G22, G12), symmetric, in the material
  // frame; empty: identity.
  std::vector<double> predeformation;
  // Isotropic force per current length at the Gauss points that form finding asked for [element][point][3] = (n11,
  // n22, n12), N/m, in the material frame; empty: none.
  std::vector<double> prestress;
  // Material history [element][point][component]; names and count of the components; empty: the law has none.
  std::vector<double> history;
  std::vector<std::string> history_names;
  // Welded from strips: their names, the strip of every element, and the welds; empty: one piece. The strips' flat
  // shapes are the reference: every strip has plane coordinates of its own (z = 0), its roll direction along x.
  std::vector<std::string> strips;
  std::vector<Index> strip_of_element;
  std::vector<Seam> seams;
};

enum class GasLaw : std::uint8_t { regulated, closed, volume };

struct Chamber {
  std::string name;
  Index outer = 0;        // number of the block towards the weather
  Index inner = 0;        // number of the block towards the room
  double dead_volume = 0; // m3
  GasLaw law = GasLaw::regulated;
  double kappa = 1;
  double gauge_pressure = 0;   // Pa
  double ambient_pressure = 0; // Pa, absolute
  double temperature = 0;      // K
  double volume = 0;           // m3, dead volume included
  Index connected_to = -1;     // number of the chamber whose air it shares, which is not itself connected; -1: none
};

// What acts on a foil beside the air in the chambers and its weight when a stage ends; the next stage begins with it.
struct Load {
  std::string name; // in the settings
  Index block = 0;
  double pressure = 0; // along the foil's positive normal, follows it, Pa
  // Where the pressure acts: on all of the foil or, if not empty, at these places of the elements, points[offset[e]] to
  // points[offset[e + 1]] of element e.
  std::vector<Index> offset;
  std::vector<geometry::QuadraturePoint> points;
  std::vector<double> dead; // forces that keep their direction [node][3], N; empty: none
};

enum class Location : std::uint8_t { point, cell, gauss };

// A named result. point: [node][component]; cell: [element of all blocks in order][component]; gauss: one block's
// [element][point][component] (block >= 0).
struct Field {
  std::string name;
  std::string unit; // UDUNITS text, "1" if none
  Location location = Location::point;
  int components = 1;
  Index block = -1;
  std::vector<double> values;
};

// Everything one stage hands to the next: plain data, SI units.
struct State {
  Provenance provenance;
  Vec3 origin{0, 0, 0}; // where the coordinates here begin, in those of the user, m: the plan's own centre
  geometry::Mesh mesh;  // nodes: CURRENT positions
  geometry::StressRule stress_rule = geometry::StressRule::full;
  std::vector<Foil> foils;         // one per block
  std::vector<std::uint8_t> fixed; // [node][3], 1: this coordinate is held
  std::vector<Chamber> chambers;
  std::vector<Load> loads;
  std::vector<Field> fields;
};

} // namespace pneuma::pipeline::state
