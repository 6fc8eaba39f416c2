// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/recovery/reactions.h"

#include <algorithm>
#include <array>

#include <Eigen/SparseLU>

namespace pneuma::solver::recovery {

LineLoad line_load(const geometry::Mesh& mesh, std::span<const Vec3> positions, std::span<const double> forces) {
  LineLoad result;
  const bool quadratic = geometry::is_quadratic(mesh.element);
  const std::size_t step = quadratic ? 2 : 1;
  for (const geometry::Edge& edge : mesh.edges) {
    const std::size_t count = edge.nodes.size();
    const std::size_t last = edge.closed ? count : count - 1;
    const auto is_end = [&](std::size_t i) { return !edge.closed && (i == 0 || i == last); };
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](std::size_t i, std::size_t j, double value) {
      entries.emplace_back(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j), value);
    };
    double scale = 0; // of the mass matrix, for the lines of the ends
    for (std::size_t k = 0; k + step <= last; k += step) {
      std::array<std::size_t, 3> at{};
      for (std::size_t i = 0; i <= step; ++i) at[i] = (k + i) % count;
      constexpr double gauss[3][2] = {{-0.7745966692414834, 5.0 / 9}, {0, 8.0 / 9}, {0.7745966692414834, 5.0 / 9}};
      for (const auto& [t, weight] : gauss) {
        const double value[3] = {quadratic ? 0.5 * t * (t - 1) : 0.5 * (1 - t),
                                 quadratic ? (1 - t) * (1 + t) : 0.5 * (1 + t), 0.5 * t * (t + 1)};
        const double slope[3] = {quadratic ? t - 0.5 : -0.5, quadratic ? -2 * t : 0.5, t + 0.5};
        Vec3 tangent = Vec3::Zero();
        for (std::size_t i = 0; i <= step; ++i) {
          tangent += slope[i] * positions[static_cast<std::size_t>(edge.nodes[at[i]])];
        }
        scale = std::max(scale, tangent.norm());
        for (std::size_t i = 0; i <= step; ++i) {
          if (is_end(at[i])) continue;
          for (std::size_t j = 0; j <= step; ++j) add(at[i], at[j], weight * tangent.norm() * value[i] * value[j]);
        }
      }
    }
    if (!edge.closed) { // q0 - 2 q1 + q2 = 0
      for (const auto& [end, next, second] :
           {std::array{std::size_t{0}, std::size_t{1}, std::size_t{2}}, std::array{last, last - 1, last - 2}}) {
        add(end, end, scale);
        add(end, next, -2 * scale);
        add(end, second, scale);
      }
    }
    const auto size = static_cast<Eigen::Index>(count);
    Eigen::SparseMatrix<double> projection(size, size);
    projection.setFromTriplets(entries.begin(), entries.end());
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, 3);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_end(i)) continue;
      const auto node = static_cast<std::size_t>(edge.nodes[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        right(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = forces[3 * node + c];
      }
    }
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(projection);
    const Eigen::MatrixXd load = factor.solve(right);
    for (std::size_t i = 0; i < count; ++i) {
      result.nodes.push_back(edge.nodes[i]);
      result.load.emplace_back(load.row(static_cast<Eigen::Index>(i)));
    }
  }
  return result;
}

} // namespace pneuma::solver::recovery
