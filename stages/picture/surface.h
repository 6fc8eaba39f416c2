// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pipeline/state/state.h"

namespace pneuma::stages::picture {

using base::Index;
using base::Vec3;

// One foil as triangles fine enough to look curved, with normals continuous over its elements; and its element edges.
struct Surface {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  // [point], unit length
  std::vector<double> values; // [point]; empty: no field
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::vector<Vec3>> edges;   // between elements, each once, as polygons
  std::vector<std::vector<Vec3>> borders; // those of one element only
  std::vector<std::vector<Vec3>> seams;   // between elements of different strips
};

// Quadratic elements are divided by their own shape functions. `positions`: [node]; `values`: [node], or [element of
// this block] (each element then has one colour), or empty. `strip_of_element`: of a foil welded from strips, or empty.
Surface surface_of(const geometry::Mesh& mesh, const geometry::Block& block, const std::vector<Vec3>& positions,
                   const std::vector<double>& node_values, const std::vector<double>& element_values,
                   const std::vector<Index>& strip_of_element, int divisions);

} // namespace pneuma::stages::picture
