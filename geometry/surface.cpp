// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/base/errors.h"
#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

using base::Mat2;
using base::Mat3;
using base::Mat32;
using base::Vec2;

template <ElementType E>
Eigen::Matrix<double, 3, nodes_per_element(E)> gather(const Mesh& mesh, const Block& block,
                                                      std::span<const Vec3> positions, Index element) {
  Eigen::Matrix<double, 3, nodes_per_element(E)> x;
  int k = 0;
  for (const Index i : mesh.element_nodes(block, element)) x.col(k++) = positions[static_cast<std::size_t>(i)];
  return x;
}

template <ElementType E>
using Values = Eigen::Matrix<double, nodes_per_element(E), 1>;

// Where a scalar field over an element is largest.
struct Peak {
  double value;
  Vec2 at; // xi, eta
};

// Bernstein's coefficient in the middle of a quadratic through a, m, b: the quadratic stays below the largest of a, b
// and it.
double control(double a, double m, double b) {
  return 2 * m - (a + b) / 2;
}

// A bound of the field from above, which a quadratic element approaches with the square of its size.
template <ElementType E>
double upper_bound(const Values<E>& v) {
  double bound = v.maxCoeff();
  if constexpr (E == ElementType::T6) {
    bound = std::max({bound, control(v[0], v[3], v[1]), control(v[1], v[4], v[2]), control(v[2], v[5], v[0])});
  } else if constexpr (E == ElementType::Q9) {
    const double south = control(v[0], v[4], v[1]);
    const double north = control(v[3], v[6], v[2]);
    const double across = control(v[7], v[8], v[5]);
    bound = std::max(
        {bound, south, north, control(v[0], v[7], v[3]), control(v[1], v[5], v[2]), control(south, across, north)});
  }
  return bound;
}

// Place of the maximum on [-1, 1] of the quadratic through a, m, b at -1, 0, 1.
double line_peak(double a, double m, double b) {
  const double curvature = a - 2 * m + b;
  const double ends = b > a ? 1 : -1;
  if (curvature >= 0) return ends;
  return std::clamp((a - b) / (2 * curvature), -1.0, 1.0);
}

constexpr double triangle_nodes[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
constexpr double square_nodes[9][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};

template <ElementType E>
Peak peak_of(const Values<E>& v) {
  const auto value = [&](const Vec2& at) { return shape_functions<E>(at[0], at[1]).value.dot(v); };
  const auto place = [](int node) {
    const auto& at = corners_per_element(E) == 3 ? triangle_nodes[node % 6] : square_nodes[node];
    return Vec2(at[0], at[1]);
  };
  int node = 0;
  Peak best{v.maxCoeff(&node), place(node)};
  const auto offer = [&](const Vec2& at) {
    const double here = value(at);
    if (here > best.value) best = {here, at};
  };
  if constexpr (E == ElementType::T6) {
    // along the sides, then inside, where the gradient is linear
    offer({(1 + line_peak(v[0], v[3], v[1])) / 2, 0});
    offer({0, (1 + line_peak(v[0], v[5], v[2])) / 2});
    const double t = (1 + line_peak(v[1], v[4], v[2])) / 2;
    offer({1 - t, t});
    const Vec2 gradient = shape_functions<E>(0, 0).derivative.transpose() * v;
    Mat2 hessian;
    const double mixed = v[0] - v[3] + v[4] - v[5];
    hessian << v[0] + v[1] - 2 * v[3], mixed, mixed, v[0] + v[2] - 2 * v[5];
    hessian *= 4;
    if (hessian.determinant() > 1e-14 * hessian.squaredNorm()) {
      const Vec2 at = -hessian.inverse() * gradient;
      if (at.minCoeff() >= 0 && at.sum() <= 1) offer(at);
    }
  } else if constexpr (E == ElementType::Q9) {
    // up along xi and eta by turns from every node, then Newton's method; the field is quadratic along each line
    for (int start = 0; start < 9; ++start) {
      Vec2 at = place(start);
      for (int turn = 0; turn < 4; ++turn) {
        at[0] = line_peak(value({-1, at[1]}), value({0, at[1]}), value({1, at[1]}));
        at[1] = line_peak(value({at[0], -1}), value({at[0], 0}), value({at[0], 1}));
      }
      offer(at);
    }
    const auto gradient = [&](const Vec2& at) {
      return Vec2(shape_functions<E>(at[0], at[1]).derivative.transpose() * v);
    };
    Vec2 at = best.at;
    for (int iteration = 0; iteration < 8 && at.cwiseAbs().maxCoeff() < 1; ++iteration) {
      // central differences are exact: along each line the derivatives are linear or quadratic
      Mat2 hessian;
      hessian.col(0) = (gradient({1, at[1]}) - gradient({-1, at[1]})) / 2;
      hessian.col(1) = (gradient({at[0], 1}) - gradient({at[0], -1})) / 2;
      const double mixed = (gradient({at[0] + 1, at[1]}) - gradient({at[0] - 1, at[1]}))[1] / 2;
      hessian(0, 1) = hessian(1, 0) = mixed;
      if (hessian.determinant() <= 1e-14 * hessian.squaredNorm()) break;
      at -= hessian.inverse() * gradient(at);
    }
    if (at.cwiseAbs().maxCoeff() <= 1) offer(at);
  }
  return best;
}

} // namespace

double surface_area(const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    double area = 0;
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const auto x = gather<E>(mesh, block, positions, e);
      for (const QuadraturePoint& q : pressure_rule(E)) {
        const Mat32 tangents = x * shape_functions<E>(q.xi, q.eta).derivative;
        area += q.weight * tangents.col(0).cross(tangents.col(1)).norm();
      }
    }
    return area;
  });
}

Vec3 point_on(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, Index element, double xi,
              double eta) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    return Vec3(gather<E>(mesh, block, positions, element) * shape_functions<E>(xi, eta).value);
  });
}

Vec3 normal_at(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, Index element, double xi,
               double eta) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    const Mat32 tangents = gather<E>(mesh, block, positions, element) * shape_functions<E>(xi, eta).derivative;
    const Vec3 normal = tangents.col(0).cross(tangents.col(1));
    return Vec3(normal.normalized());
  });
}

Plane edge_plane(const Mesh& mesh, std::span<const Vec3> positions) {
  std::vector<Index> nodes;
  for (const Edge& edge : mesh.edges) nodes.insert(nodes.end(), edge.nodes.begin(), edge.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  if (nodes.size() < 3) throw base::GeometryError("the edges of the mesh have fewer than three nodes: no plane");
  const auto x = [&](Index i) -> const Vec3& { return positions[static_cast<std::size_t>(i)]; };

  Vec3 centre = Vec3::Zero();
  for (const Index i : nodes) centre += x(i);
  centre /= static_cast<double>(nodes.size());
  Mat3 spread = Mat3::Zero();
  for (const Index i : nodes) spread += (x(i) - centre) * (x(i) - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(spread); // ascending
  if (!(eigen.eigenvalues()[1] > 1e-12 * eigen.eigenvalues()[2]))
    throw base::GeometryError("the nodes of the edges lie on a line: no plane");

  Vec3 around = Vec3::Zero();
  for (const Edge& edge : mesh.edges) {
    const std::size_t n = edge.nodes.size();
    for (std::size_t k = 0; k + 1 < n + (edge.closed ? 1 : 0); ++k)
      around += (x(edge.nodes[k]) - centre).cross(x(edge.nodes[(k + 1) % n]) - centre);
  }
  const Vec3 normal = eigen.eigenvectors().col(0);
  return {centre, normal.dot(around) < 0 ? Vec3(-normal) : normal};
}

DeepestPoint deepest_point(const Mesh& mesh, const Block& block, std::span<const Vec3> positions, const Plane& plane) {
  return dispatch(mesh.element, [&]<ElementType E>() {
    DeepestPoint deepest;
    deepest.distance = -1;
    const auto search = [&](Index e, const Values<E>& distance) {
      const Peak peak = peak_of<E>(distance);
      if (peak.value > deepest.distance) deepest = {peak.value, Vec3::Zero(), e, peak.at[0], peak.at[1]};
    };
    // the largest node first, so that nearly all elements are passed over
    double at_nodes = 0;
    for (const Index i : block.connectivity)
      at_nodes = std::max(at_nodes, std::abs(plane.distance(positions[static_cast<std::size_t>(i)])));
    at_nodes *= 1 - 1e-12; // the same distance computed below may be rounded otherwise
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const auto x = gather<E>(mesh, block, positions, e);
      const Values<E> distance = (x.colwise() - plane.point).transpose() * plane.normal;
      const Values<E> below = -distance;
      if (upper_bound<E>(distance) >= at_nodes) search(e, distance);
      if (upper_bound<E>(below) >= at_nodes) search(e, below);
    }
    deepest.at = point_on(mesh, block, positions, deepest.element, deepest.xi, deepest.eta);
    return deepest;
  });
}

Box bounding_box(std::span<const Vec3> positions) {
  Box box{Vec3::Zero(), Vec3::Zero()};
  if (positions.empty()) return box;
  box = {positions.front(), positions.front()};
  for (const Vec3& x : positions) {
    box.low = box.low.cwiseMin(x);
    box.high = box.high.cwiseMax(x);
  }
  return box;
}

double span_of(std::span<const Vec3> positions) {
  const Box box = bounding_box(positions);
  return (box.high - box.low).maxCoeff();
}

} // namespace pneuma::geometry
