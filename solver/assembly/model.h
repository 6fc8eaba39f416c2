// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "solver/chamber/gas.h"
#include "solver/element/membrane.h"

namespace pneuma::solver::assembly {

using base::Index;
using base::Vec3;
using base::VecX;

// A cushion and what acts on it along one stage's path: plain data. Values in pairs run linearly with the load factor
// from its start (0) to its end (1).
using Ramp = std::array<double, 2>;
inline double at(const Ramp& ramp, double load_factor) {
  return ramp[0] + load_factor * (ramp[1] - ramp[0]);
}

// Entry i belongs to block i of the mesh; none for a rigid base.
struct Foil {
  element::Reference reference;
  material::Law law;
  double thickness = 0;          // m, nominal
  std::vector<double> history{}; // of the material, [element][point][component]; empty: never loaded
};

struct Chamber {
  std::string name;
  Index outer = 0;        // block towards the weather
  Index inner = 0;        // block towards the room (foil or base)
  double dead_volume = 0; // m3
  chamber::Gas gas;
  double ambient = 0; // Pa absolute; a closed law's own ambient pressure goes before it
  // Number of the chamber whose air this one shares through a duct: one pressure, one law (that chamber's), the sum of
  // the volumes; -1: an air of its own. That chamber has an air of its own.
  Index connected_to = -1;
};

// A pressure on part of a foil, along its positive normal, that follows it.
struct PressureZone {
  Index block = 0;
  std::vector<Index> offset;                     // [element + 1] into points
  std::vector<geometry::QuadraturePoint> points; // of the elements concerned
  Ramp pressure{};                               // Pa
};

struct Model {
  geometry::Mesh mesh;             // nodes: positions at load factor 0, m
  std::vector<std::uint8_t> fixed; // [node][3]
  std::vector<std::optional<Foil>> foils;
  std::vector<Chamber> chambers;
  std::vector<Ramp> face_pressure; // per block: pressure on the whole foil beside the chambers', along its normal, Pa
  std::vector<PressureZone> zones;
  VecX dead_from, dead_to; // [3 node + component], N: forces that keep their direction
  VecX move;               // [3 node + component], m: held coordinates move by so much from load factor 0 to 1
  // Where volumes are measured from; any point serves closed chambers (none: the middle of the nodes). Where a rim is
  // free to move in a plane (symmetry), the plane stands for the missing wall and must contain this point.
  std::optional<Vec3> origin;
};

} // namespace pneuma::solver::assembly
