// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

using base::Mat2;
using base::Mat32;

template <ElementType E>
using Element = Eigen::Matrix<double, 3, nodes_per_element(E)>;

template <ElementType E>
PlanBox box_of(const Element<E>& x) {
  return {x.template topRows<2>().rowwise().minCoeff(), x.template topRows<2>().rowwise().maxCoeff()};
}

// Boxes of the elements in plan; curved sides leave the box of their nodes.
std::vector<PlanBox> boxes_of(const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  std::vector<PlanBox> boxes;
  boxes.reserve(static_cast<std::size_t>(mesh.element_count(block)));
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    PlanBox box{positions[static_cast<std::size_t>(nodes[0])].head<2>(),
                positions[static_cast<std::size_t>(nodes[0])].head<2>()};
    for (const Index i : nodes) {
      box.low = box.low.cwiseMin(positions[static_cast<std::size_t>(i)].head<2>());
      box.high = box.high.cwiseMax(positions[static_cast<std::size_t>(i)].head<2>());
    }
    const double margin = (is_quadratic(mesh.element) ? 0.1 : 1e-9) * (box.high - box.low).maxCoeff();
    boxes.push_back({box.low.array() - margin, box.high.array() + margin});
  }
  return boxes;
}

// The nearest place of the reference element, in its own coordinates.
template <ElementType E>
Vec2 clamped(const Vec2& place) {
  if constexpr (corners_per_element(E) == 4) {
    return place.cwiseMax(-1.0).cwiseMin(1.0);
  } else {
    const Vec2 positive = place.cwiseMax(0.0);
    return positive.sum() > 1 ? Vec2(positive / positive.sum()) : positive;
  }
}

template <ElementType E>
Vec2 middle() {
  return corners_per_element(E) == 3 ? Vec2(1.0 / 3, 1.0 / 3) : Vec2(0, 0);
}

// Element's own coordinates of a place in plan, inside or outside. Newton's method.
template <ElementType E>
std::optional<Vec2> coordinates(const Element<E>& x, const Vec2& plan) {
  const PlanBox box = box_of<E>(x);
  const double size = (box.high - box.low).maxCoeff();
  Vec2 place = middle<E>();
  constexpr int most = E == ElementType::T3 ? 2 : 20;
  for (int iteration = 0; iteration < most; ++iteration) {
    const auto shape = shape_functions<E>(place[0], place[1]);
    const Vec2 miss = plan - x.template topRows<2>() * shape.value;
    if (miss.norm() <= 1e-13 * size) return place;
    const Mat2 jacobian = x.template topRows<2>() * shape.derivative;
    if (!(std::abs(jacobian.determinant()) > 1e-14 * size * size)) return {};
    const Vec2 step = jacobian.inverse() * miss;
    place += step;
    if (!(place.cwiseAbs().maxCoeff() < 10)) return {};
    if (step.norm() < 1e-14) return place; // far from the origin the miss cannot become smaller
  }
  // rounding keeps coordinates of large meshes from the tolerance above
  const Vec2 miss = plan - x.template topRows<2>() * shape_functions<E>(place[0], place[1]).value;
  return miss.norm() <= 1e-9 * size ? std::optional(place) : std::nullopt;
}

} // namespace

Chart::Chart(const Mesh& mesh, const Block& block, std::span<const Vec3> positions)
    : type_(mesh.element), connectivity_(block.connectivity), positions_(positions.begin(), positions.end()),
      grid_(boxes_of(mesh, block, positions)) {
  dispatch(type_, [&]<ElementType E>() { check_graph<E>(); });
}

template <ElementType E>
Eigen::Matrix<double, 3, nodes_per_element(E)> Chart::element(Index e) const {
  constexpr int n = nodes_per_element(E);
  Element<E> x;
  for (int k = 0; k < n; ++k)
    x.col(k) = positions_[static_cast<std::size_t>(connectivity_[static_cast<std::size_t>(e * n + k)])];
  return x;
}

template <ElementType E>
void Chart::check_graph() const {
  constexpr double upright = 0.12; // vertical part of the mean normal: steeper than 83 degrees
  // the element as a whole: a film is upright in the very corner where its plan is re-entrant, and nowhere else
  const auto count = static_cast<Index>(connectivity_.size()) / nodes_per_element(E);
  for (Index e = 0; e < count; ++e) {
    const Element<E> x = element<E>(e);
    Vec3 normal = Vec3::Zero();
    Vec3 place = Vec3::Zero();
    double area = 0;
    for (const QuadraturePoint& q : pressure_rule(E)) {
      const auto shape = shape_functions<E>(q.xi, q.eta);
      const Mat32 tangents = x * shape.derivative;
      const Vec3 part = q.weight * tangents.col(0).cross(tangents.col(1));
      normal += part;
      area += part.norm();
      place += part.norm() * (x * shape.value);
    }
    if (normal.z() > upright * area) continue;
    place /= area;
    throw base::GeometryError(
        fmt::format("the surface {} at {}, element {}: it must be a graph over its plan to be cut; less "
                    "pressure or more prestress makes it flatter",
                    normal.z() < -upright * area ? "folds over" : "stands upright", base::place_text(place), e));
  }
}

std::optional<Chart::Place> Chart::locate(const Vec2& plan) const {
  return dispatch(type_, [&]<ElementType E>() -> std::optional<Place> {
    constexpr double side = 1e-9; // a place on a side belongs to both neighbours
    for (const Index e : grid_.at(plan)) {
      const Element<E> x = element<E>(e);
      const PlanBox box = box_of<E>(x);
      const double margin = (is_quadratic(E) ? 0.1 : 1e-9) * (box.high - box.low).maxCoeff();
      if ((plan.array() < box.low.array() - margin).any() || (plan.array() > box.high.array() + margin).any()) continue;
      const std::optional<Vec2> place = coordinates<E>(x, plan);
      if (place && (clamped<E>(*place) - *place).norm() <= side) return Place{e, place->x(), place->y()};
    }
    return {};
  });
}

Chart::Nearest Chart::nearest(const Vec2& plan) const {
  if (const std::optional<Place> place = locate(plan)) return {*place, Vec2::Zero()};
  return dispatch(type_, [&]<ElementType E>() -> Nearest {
    std::optional<Nearest> best;
    for (const Index e : grid_.around(plan, 2)) {
      const Element<E> x = element<E>(e);
      const PlanBox box = box_of<E>(x);
      const std::optional<Vec2> outside = coordinates<E>(x, plan);
      if (!outside) continue;
      const Vec2 place = clamped<E>(*outside);
      const Vec2 beside = plan - x.template topRows<2>() * shape_functions<E>(place[0], place[1]).value;
      if (beside.norm() > (box.high - box.low).norm()) continue;
      if (!best || beside.norm() < best->beside.norm()) best = Nearest{{e, place[0], place[1]}, beside};
    }
    if (!best) throw base::GeometryError(fmt::format("{} lies beside the surface", base::place_text(plan)));
    return *best;
  });
}

Vec3 Chart::lift(const Vec2& plan) const {
  const Nearest found = nearest(plan);
  return dispatch(type_, [&]<ElementType E>() -> Vec3 {
    const Element<E> x = element<E>(found.place.element);
    const auto shape = shape_functions<E>(found.place.xi, found.place.eta);
    const Mat32 tangents = x * shape.derivative;
    const Mat2 jacobian = tangents.topRows<2>();
    const Vec2 step = jacobian.inverse() * found.beside;
    return {plan.x(), plan.y(), x.row(2).dot(shape.value) + tangents.row(2).dot(step)};
  });
}

Vec3 Chart::normal(const Vec2& plan) const {
  const Nearest found = nearest(plan);
  return dispatch(type_, [&]<ElementType E>() -> Vec3 {
    const Mat32 tangents =
        element<E>(found.place.element) * shape_functions<E>(found.place.xi, found.place.eta).derivative;
    return tangents.col(0).cross(tangents.col(1)).normalized();
  });
}

} // namespace pneuma::geometry
