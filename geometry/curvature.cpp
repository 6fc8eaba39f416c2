// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>

namespace pneuma::geometry {

namespace {

using base::Mat2;
using base::Mat3;
using base::Mat32;
using base::MatX;
using base::Vec2;
using base::VecX;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Number of coefficients of a polynomial of two variables.
constexpr int terms(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

constexpr std::size_t enough = 3 * terms(4) / 2 + 1;

// Elements at each node.
struct Neighbourhood {
  const Mesh& mesh;
  const Block& block;
  std::vector<Index> first, elements; // of node i: elements[first[i]] .. elements[first[i + 1] - 1]
  std::vector<Index> seen;            // by which node each node was met last

  Neighbourhood(const Mesh& m, const Block& b)
      : mesh(m), block(b), first(m.nodes.size() + 1, 0), elements(b.connectivity.size()), seen(m.nodes.size(), -1) {
    for (const Index i : block.connectivity) ++first[at(i) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<Index> next = first;
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      for (const Index i : mesh.element_nodes(block, e)) elements[at(next[at(i)]++)] = e;
    }
  }

  // Nodes of the elements around `node`, then of those around these, and a third ring where a polynomial of degree four
  // needs it; the first `inner` belong to the first ring.
  void rings(Index node, std::vector<Index>& nodes, std::size_t& inner) {
    nodes = {node};
    seen[at(node)] = node;
    std::size_t from = 0;
    for (int ring = 0; ring < 2 || (ring < 3 && nodes.size() < enough); ++ring) {
      const std::size_t to = nodes.size();
      for (; from < to; ++from) {
        const Index centre = nodes[from];
        for (Index k = first[at(centre)]; k < first[at(centre) + 1]; ++k) {
          for (const Index i : mesh.element_nodes(block, elements[at(k)])) {
            if (seen[at(i)] == node) continue;
            seen[at(i)] = node;
            nodes.push_back(i);
          }
        }
      }
      if (ring == 0) inner = nodes.size();
    }
  }
};

// Mean normal of the corners' polygons around each node: where the fit looks along.
std::vector<Vec3> rough_normals(const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  std::vector<Vec3> normals(mesh.nodes.size(), Vec3::Zero());
  const auto corners = at(corners_per_element(mesh.element));
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < corners; ++k) {
      normal += (positions[at(nodes[k])] - positions[at(nodes[0])])
                    .cross(positions[at(nodes[k + 1])] - positions[at(nodes[0])]);
    }
    for (const Index i : nodes) normals[at(i)] += normal;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

// First six coefficients of the polynomial 1, u, v, uu, uv, vv, ... closest to the heights over the tangent plane, or
// false where the points do not determine them.
bool fit(const Eigen::Matrix<double, 3, Eigen::Dynamic>& local, Eigen::Matrix<double, 6, 1>& coefficients) {
  const auto count = static_cast<int>(local.cols());
  for (int degree = 4; degree >= 2; --degree) {
    const int unknowns = terms(degree);
    // half as many points again as unknowns, or noise is fitted too; the last resort takes what there is
    if (2 * count < (degree > 2 ? 3 : 2) * unknowns) continue;
    MatX powers(count, unknowns);
    VecX heights(count);
    for (int i = 0; i < count; ++i) {
      const double u = local(0, i);
      const double v = local(1, i);
      const double weight = 1 / (0.1 + u * u + v * v);
      // each degree is the one before times u, and its last term times v
      powers(i, 0) = weight;
      for (int d = 1, column = 1; d <= degree; ++d, column += d) {
        for (int k = 0; k < d; ++k) powers(i, column + k) = u * powers(i, column - d + k);
        powers(i, column + d) = v * powers(i, column - 1);
      }
      heights[i] = weight * local(2, i);
    }
    Eigen::ColPivHouseholderQR<MatX> factor(powers);
    factor.setThreshold(1e-9);
    if (factor.rank() < unknowns) continue;
    const VecX solution = factor.solve(heights);
    coefficients = solution.head<6>();
    return true;
  }
  return false;
}

} // namespace

std::vector<FittedCurvature> fitted_curvatures(const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  std::vector<FittedCurvature> result(mesh.nodes.size());
  std::vector<bool> rim(mesh.nodes.size(), false);
  for (const Edge& edge : mesh.edges) {
    for (const Index i : edge.nodes) rim[at(i)] = true;
  }
  Neighbourhood neighbourhood(mesh, block);
  const std::vector<Vec3> normals = rough_normals(mesh, block, positions);

  std::vector<Index> nodes;
  std::size_t inner = 0;
  Eigen::Matrix<double, 3, Eigen::Dynamic> local;
  for (std::size_t n = 0; n < result.size(); ++n) {
    if (neighbourhood.first[n] == neighbourhood.first[n + 1]) continue; // a node of another block
    neighbourhood.rings(static_cast<Index>(n), nodes, inner);

    Mat3 frame; // columns: two tangents, normal
    frame.col(2) = normals[n];
    frame.col(0) = normals[n].unitOrthogonal();
    frame.col(1) = normals[n].cross(Vec3(frame.col(0)));
    local.resize(3, static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k)
      local.col(static_cast<Eigen::Index>(k)) = frame.transpose() * (positions[at(nodes[k])] - positions[n]);
    const double radius = local.topRows<2>().colwise().norm().maxCoeff();
    if (!(radius > 0) || !std::isfinite(radius)) continue;
    local /= radius;
    Eigen::Matrix<double, 6, 1> c;
    if (!fit(local, c)) continue;

    // fundamental forms of the graph (u, v, h(u, v)); lengths are in units of the radius
    const Vec2 slope(c[1], c[2]);
    const double stretch = std::sqrt(1 + slope.squaredNorm());
    const Mat2 metric = Mat2::Identity() + slope * slope.transpose();
    Mat2 bending;
    bending << 2 * c[3], c[4], c[4], 2 * c[5];
    bending *= -1 / (stretch * radius);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Mat2> principal(bending, metric); // ascending
    Mat32 tangents;
    tangents << Mat2::Identity(), slope.transpose();

    FittedCurvature& out = result[n];
    out.first = principal.eigenvalues()[1];
    out.second = principal.eigenvalues()[0];
    out.first_direction = frame * tangents * principal.eigenvectors().col(1);
    out.second_direction = frame * tangents * principal.eigenvectors().col(0);
    out.normal = frame * Vec3(-slope[0], -slope[1], 1) / stretch;
    out.reliable = std::none_of(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(inner),
                                [&](Index i) { return rim[at(i)]; });
  }
  return result;
}

} // namespace pneuma::geometry
