// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/box_grid.h"
#include "geometry/mesh.h"

namespace pneuma::geometry {

// A block's surface as a graph over the plan: over every place (x, y) lies one point of it, found by a grid of cells
// and Newton's method in the element's own coordinates.
class Chart {
public:
  // Copies what it needs. Throws GeometryError with the place where the surface stands upright (an
  // element steeper than 83 degrees in the mean) or folds over.
  Chart(const Mesh& mesh, const Block& block, std::span<const Vec3> positions);

  struct Place {
    Index element = 0;
    double xi = 0, eta = 0;
  };
  // None where the surface does not reach.
  std::optional<Place> locate(const Vec2& plan) const;

  // The point over a place in plan, and the unit normal there. Beside the surface (a curved rim's sagitta) the nearest
  // element is extrapolated along its tangents; farther than an element's size away: throws GeometryError.
  Vec3 lift(const Vec2& plan) const;
  Vec3 normal(const Vec2& plan) const;

private:
  struct Nearest {
    Place place;
    Vec2 beside; // m, from the element's point to the wanted place; zero on the surface
  };
  Nearest nearest(const Vec2& plan) const;
  template <ElementType E>
  Eigen::Matrix<double, 3, nodes_per_element(E)> element(Index e) const;
  template <ElementType E>
  void check_graph() const;

  ElementType type_;
  std::vector<Index> connectivity_; // [element][node]
  std::vector<Vec3> positions_;
  BoxGrid grid_;
};

} // namespace pneuma::geometry
