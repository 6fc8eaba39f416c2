// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/plan_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "geometry/base/errors.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

using base::Mat2;

template <ElementType E>
using PlanElement = Eigen::Matrix<double, 2, nodes_per_element(E)>;

template <ElementType E>
PlanElement<E> gather(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, Index element) {
  PlanElement<E> x;
  int k = 0;
  for (const Index i : mesh.element_nodes(block, element))
    x.col(k++) = positions[static_cast<std::size_t>(i)].template head<2>();
  return x;
}

// A point of an element: where it lies in plan, and in the reference element.
struct Vertex {
  Vec2 plan, reference;
};

// What stays of a polygon inside a convex counterclockwise one (Sutherland and Hodgman 1974). The reference coordinates
// are carried along, so that no map is inverted: elements that stand upright do no harm.
void clip(std::vector<Vertex>& polygon, std::span<const Vec2> window, std::vector<Vertex>& scratch) {
  for (std::size_t k = 0; k < window.size() && !polygon.empty(); ++k) {
    const Vec2& a = window[k];
    const Vec2 side = window[(k + 1) % window.size()] - a;
    const auto inside = [&](const Vertex& v) { return cross(side, v.plan - a); };
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vertex& here = polygon[i];
      const Vertex& next = polygon[(i + 1) % polygon.size()];
      const double d = inside(here);
      const double e = inside(next);
      if (d >= 0) scratch.push_back(here);
      if ((d > 0 && e < 0) || (d < 0 && e > 0)) {
        const double t = d / (d - e);
        scratch.push_back(
            {here.plan + t * (next.plan - here.plan), here.reference + t * (next.reference - here.reference)});
      }
    }
    std::swap(polygon, scratch);
  }
}

// 25 points on the triangle (0,0) (1,0) (0,1), exact for degree 8: Gauss' rule on the square, collapsed.
std::vector<QuadraturePoint> collapsed_rule() {
  const double a = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3;
  const double b = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3;
  const double wa = (322 + 13 * std::sqrt(70.0)) / 900;
  const double wb = (322 - 13 * std::sqrt(70.0)) / 900;
  const std::array x = {-b, -a, 0.0, a, b};
  const std::array w = {wb, wa, 128.0 / 225, wa, wb};
  std::vector<QuadraturePoint> rule;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j < 5; ++j) {
      const double u = (1 + x[i]) / 2;
      const double v = (1 + x[j]) / 2;
      rule.push_back({u * (1 - v), u * v, u * w[i] * w[j] / 4});
    }
  }
  return rule;
}

// The region as convex counterclockwise windows, and its outline.
struct Windows {
  std::vector<std::vector<Vec2>> convex;
  std::vector<Vec2> outline;
};

Windows windows_of(const PlanRegion& region) {
  if (const auto* rectangle = std::get_if<PlanRectangle>(&region)) {
    const Vec2& a = rectangle->low;
    const Vec2& b = rectangle->high;
    if (!(a.x() < b.x() && a.y() < b.y()))
      throw base::GeometryError("a rectangular region needs its lower corner left of and below its upper one");
    const std::vector<Vec2> ring = {a, {b.x(), a.y()}, b, {a.x(), b.y()}};
    return {{ring}, ring};
  }
  const std::vector<Vec2>& ring = std::get<PlanPolygon>(region).points;
  Windows windows{{}, ring};
  for (const auto& triangle : triangulate(ring)) {
    auto& window = windows.convex.emplace_back();
    for (const Index i : triangle) window.push_back(ring[static_cast<std::size_t>(i)]);
  }
  return windows;
}

// Whether the segment a-b may reach into the box: never wrong where it does, sometimes where it passes by.
bool near_box(const Vec2& a, const Vec2& b, const Vec2& low, const Vec2& high) {
  if ((a.cwiseMax(b).array() < low.array()).any() || (a.cwiseMin(b).array() > high.array()).any()) return false;
  const Vec2 across(a.y() - b.y(), b.x() - a.x());
  const double reach = across.cwiseAbs().dot(high - low) / 2;
  return std::abs(across.dot((low + high) / 2 - a)) <= reach * (1 + 1e-12);
}

// Whether the map from the reference element to the plan is affine to rounding.
template <ElementType E>
bool is_affine(const PlanElement<E>& x, double size) {
  if constexpr (E == ElementType::T3) return true;
  constexpr int corners = corners_per_element(E);
  double off = 0;
  if constexpr (corners == 4) off = (x.col(0) - x.col(1) + x.col(2) - x.col(3)).norm();
  if constexpr (is_quadratic(E)) {
    for (int k = 0; k < corners; ++k)
      off = std::max(off, (x.col(corners + k) - (x.col(k) + x.col((k + 1) % corners)) / 2).norm());
  }
  if constexpr (E == ElementType::Q9)
    off = std::max(off, (x.col(8) - (x.col(0) + x.col(1) + x.col(2) + x.col(3)) / 4).norm());
  return off <= 1e-13 * size;
}

// Triangles that make up the reference element, `n` to a side and row, each counterclockwise.
template <ElementType E>
std::vector<std::array<Vec2, 3>> divided_reference(int n) {
  std::vector<std::array<Vec2, 3>> triangles;
  constexpr bool triangle = corners_per_element(E) == 3;
  const auto at = [&](int i, int j) {
    return triangle ? Vec2(static_cast<double>(i) / n, static_cast<double>(j) / n)
                    : Vec2(2.0 * i / n - 1, 2.0 * j / n - 1);
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < (triangle ? n - j : n); ++i) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (!triangle || i + j + 1 < n) triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return triangles;
}

// Adds the points of the part of the element inside the windows; returns its area in the reference element.
template <ElementType E>
double add_points(const PlanElement<E>& x, bool affine, const Windows& windows, std::vector<QuadraturePoint>& points) {
  constexpr int divisions = 8;
  static const std::vector<std::array<Vec2, 3>> once = divided_reference<E>(1);
  static const std::vector<std::array<Vec2, 3>> finely = divided_reference<E>(divisions);
  static const std::vector<QuadraturePoint> high = collapsed_rule();
  // the pressure on an undivided Q9 has degree 7
  const std::span<const QuadraturePoint> rule =
      E == ElementType::Q9 && affine ? std::span<const QuadraturePoint>(high) : pressure_rule(ElementType::T6);
  double area = 0;
  std::vector<Vertex> polygon;
  std::vector<Vertex> scratch;
  for (const std::array<Vec2, 3>& triangle : affine ? once : finely) {
    for (const std::vector<Vec2>& window : windows.convex) {
      polygon.clear();
      for (const Vec2& corner : triangle)
        polygon.push_back({x * shape_functions<E>(corner[0], corner[1]).value, corner});
      clip(polygon, window, scratch);
      for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
        const Vec2& origin = polygon[0].reference;
        Mat2 map;
        map << polygon[k].reference - origin, polygon[k + 1].reference - origin;
        const double doubled = map.determinant();
        if (doubled <= 0) continue;
        area += doubled / 2;
        for (const QuadraturePoint& q : rule) {
          const Vec2 at = origin + map * Vec2(q.xi, q.eta);
          points.push_back({at[0], at[1], q.weight * doubled});
        }
      }
    }
  }
  return area;
}

} // namespace

namespace {

// Convex pieces that make up a plan. A circle is one, with straight sides that touch it.
std::vector<std::vector<Vec2>> pieces_of(const Plan& plan) {
  std::vector<std::vector<Vec2>> pieces;
  if (const auto* circle = std::get_if<Circle>(&plan)) {
    constexpr int sides = 1024;
    const double reach = circle->radius / std::cos(std::numbers::pi / sides);
    auto& ring = pieces.emplace_back();
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      ring.emplace_back(reach * std::cos(angle), reach * std::sin(angle));
    }
    return pieces;
  }
  const std::vector<Vec2> corners = corner_points(plan);
  for (const auto& triangle : triangulate(corners)) {
    auto& piece = pieces.emplace_back();
    for (const Index i : triangle) piece.push_back(corners[static_cast<std::size_t>(i)]);
  }
  return pieces;
}

} // namespace

PlanRectangle extent(const Plan& plan) {
  if (const auto* circle = std::get_if<Circle>(&plan)) {
    const Vec2 reach = Vec2::Constant(circle->radius);
    return {-reach, reach};
  }
  const std::vector<Vec2> corners = corner_points(plan);
  PlanRectangle box{corners.front(), corners.front()};
  for (const Vec2& corner : corners) box = {box.low.cwiseMin(corner), box.high.cwiseMax(corner)};
  return box;
}

double area_inside(const Plan& plan, const PlanRegion& region) {
  if (std::holds_alternative<WholePlan>(region)) return area(plan);
  double sum = 0;
  std::vector<Vertex> part, scratch;
  std::vector<Vec2> ring;
  const Windows windows = windows_of(region);
  for (const std::vector<Vec2>& piece : pieces_of(plan)) {
    for (const std::vector<Vec2>& window : windows.convex) {
      part.clear();
      ring.clear();
      for (const Vec2& corner : piece) part.push_back({corner, corner});
      clip(part, window, scratch);
      for (const Vertex& vertex : part) ring.push_back(vertex.plan);
      if (ring.size() > 2) sum += signed_area(ring);
    }
  }
  return sum;
}

RegionQuadrature region_quadrature(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                                   const PlanRegion& region) {
  RegionQuadrature result;
  const std::span<const QuadraturePoint> rule = pressure_rule(mesh.element);
  result.points.assign(rule.begin(), rule.end()); // whole elements share these
  const auto add_whole = [&](Index e) { result.parts.push_back({e, 0, rule.size(), true}); };
  if (std::holds_alternative<WholePlan>(region)) {
    for (Index e = 0; e < mesh.element_count(block); ++e) add_whole(e);
    return result;
  }

  const Windows windows = windows_of(region);
  dispatch(mesh.element, [&]<ElementType E>() {
    constexpr double reference_area = corners_per_element(E) == 3 ? 0.5 : 4;
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const PlanElement<E> x = gather<E>(mesh, block, positions, e);
      Vec2 low = x.rowwise().minCoeff();
      Vec2 high = x.rowwise().maxCoeff();
      const double size = (high - low).maxCoeff();
      const bool affine = is_affine<E>(x, size);
      if (is_quadratic(E) && !affine) { // curved sides leave the box of their nodes
        low.array() -= 0.2 * size;
        high.array() += 0.2 * size;
      }
      bool crossed = false;
      const std::size_t n = windows.outline.size();
      for (std::size_t k = 0; k < n && !crossed; ++k)
        crossed = near_box(windows.outline[k], windows.outline[(k + 1) % n], low, high);
      if (!crossed) {
        if (contains(windows.outline, (low + high) / 2)) add_whole(e);
        continue;
      }
      const std::size_t first = result.points.size();
      const double area = add_points<E>(x, affine, windows, result.points);
      constexpr double rounding = 1e-12;
      if (area > rounding * reference_area && area < (1 - rounding) * reference_area) {
        result.parts.push_back({e, first, result.points.size() - first, false});
        continue;
      }
      result.points.resize(first);
      if (area > reference_area / 2) add_whole(e);
    }
  });
  return result;
}

double plan_area(const Mesh& mesh, const Block& block, std::span<const Vec3> positions,
                 const RegionQuadrature& quadrature) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    double area = 0;
    for (const RegionQuadrature::Part& part : quadrature.parts) {
      const PlanElement<E> x = gather<E>(mesh, block, positions, part.element);
      for (const QuadraturePoint& q : quadrature.points_of(part)) {
        const Mat2 jacobian = x * shape_functions<E>(q.xi, q.eta).derivative;
        area += q.weight * jacobian.determinant();
      }
    }
    return area;
  });
}

} // namespace pneuma::geometry
