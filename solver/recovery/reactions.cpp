// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/recovery/reactions.h"

#include <map>

#include <Eigen/SparseCholesky>

namespace pneuma::solver::recovery {

LineLoad line_load(const geometry::Mesh& mesh, std::span<const Vec3> positions, std::span<const double> forces) {
  LineLoad result;
  std::map<Index, Eigen::Index> number;
  for (const geometry::Edge& edge : mesh.edges) {
    for (const Index node : edge.nodes) {
      if (number.emplace(node, static_cast<Eigen::Index>(result.nodes.size())).second) result.nodes.push_back(node);
    }
  }
  const bool quadratic = geometry::is_quadratic(mesh.element);
  const std::size_t step = quadratic ? 2 : 1;
  std::vector<Eigen::Triplet<double>> entries;
  for (const geometry::Edge& edge : mesh.edges) {
    const std::size_t count = edge.nodes.size();
    const std::size_t last = edge.closed ? count : count - 1;
    for (std::size_t k = 0; k + step <= last; k += step) {
      std::array<Index, 3> node{};
      for (std::size_t i = 0; i <= step; ++i) node[i] = edge.nodes[(k + i) % count];
      constexpr double gauss[3][2] = {{-0.7745966692414834, 5.0 / 9}, {0, 8.0 / 9}, {0.7745966692414834, 5.0 / 9}};
      for (const auto& [t, weight] : gauss) {
        const double value[3] = {quadratic ? 0.5 * t * (t - 1) : 0.5 * (1 - t),
                                 quadratic ? (1 - t) * (1 + t) : 0.5 * (1 + t), 0.5 * t * (t + 1)};
        const double slope[3] = {quadratic ? t - 0.5 : -0.5, quadratic ? -2 * t : 0.5, t + 0.5};
        Vec3 tangent = Vec3::Zero();
        for (std::size_t i = 0; i <= step; ++i) tangent += slope[i] * positions[static_cast<std::size_t>(node[i])];
        for (std::size_t i = 0; i <= step; ++i) {
          for (std::size_t j = 0; j <= step; ++j) {
            entries.emplace_back(number[node[i]], number[node[j]], weight * tangent.norm() * value[i] * value[j]);
          }
        }
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(result.nodes.size());
  Eigen::SparseMatrix<double> mass(size, size);
  mass.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixXd right(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto node = static_cast<std::size_t>(result.nodes[static_cast<std::size_t>(i)]);
    for (Eigen::Index c = 0; c < 3; ++c) right(i, c) = forces[3 * node + static_cast<std::size_t>(c)];
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(mass);
  const Eigen::MatrixXd load = factor.solve(right);
  for (Eigen::Index i = 0; i < size; ++i) result.load.emplace_back(load.row(i));
  return result;
}

} // namespace pneuma::solver::recovery
