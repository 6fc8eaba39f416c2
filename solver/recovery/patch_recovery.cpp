// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/recovery/patch_recovery.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "geometry/volume.h"

namespace pneuma::solver::recovery {

using base::MatX;
using base::VecX;

namespace {

struct StressPoints {
  std::vector<Vec3> at;     // [element][point]
  std::vector<Vec3> normal; // of elements, at their middle
};

StressPoints stress_points(const geometry::Mesh& mesh, const geometry::Block& block, geometry::StressRule rule,
                           std::span<const Vec3> positions) {
  return geometry::dispatch(mesh.element, [&]<geometry::ElementType E>() {
    StressPoints result;
    constexpr double middle = geometry::corners_per_element(E) == 3 ? 1.0 / 3 : 0.0;
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const geometry::ElementPositions<E> x = geometry::gather<E>(mesh.element_nodes(block, e), positions);
      for (const geometry::QuadraturePoint& q : geometry::stress_rule(E, rule)) {
        result.at.emplace_back(x * geometry::shape_functions<E>(q.xi, q.eta).value);
      }
      const base::Mat32 g = x * geometry::shape_functions<E>(middle, middle).derivative;
      result.normal.emplace_back(g.col(0).cross(g.col(1)));
    }
    return result;
  });
}

// Which nodes lie on a side of only one of the block's elements: on the rim, or on a seam where the block is a strip.
std::vector<char> on_open_sides(const geometry::Mesh& mesh, const geometry::Block& block) {
  const auto corners = static_cast<std::size_t>(geometry::corners_per_element(mesh.element));
  struct Side {
    Index low, high, middle;
  };
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(mesh.element_count(block)) * corners);
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const std::span<const Index> element = mesh.element_nodes(block, e);
    for (std::size_t k = 0; k < corners; ++k) {
      const auto [low, high] = std::minmax(element[k], element[(k + 1) % corners]);
      sides.push_back({low, high, geometry::is_quadratic(mesh.element) ? element[corners + k] : low});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  const auto same = [](const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; };
  std::vector<char> open(mesh.nodes.size(), 0);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if ((k > 0 && same(sides[k - 1], sides[k])) || (k + 1 < sides.size() && same(sides[k], sides[k + 1]))) continue;
    for (const Index node : {sides[k].low, sides[k].high, sides[k].middle}) open[static_cast<std::size_t>(node)] = 1;
  }
  return open;
}

// terms of a complete polynomial
int fill_terms(double s, double t, int terms, double* row) {
  const double all[] = {1, s, t, s * s, s * t, t * t};
  std::copy(all, all + terms, row);
  return terms;
}

} // namespace

std::vector<double> recover_at_nodes(const geometry::Mesh& mesh, const geometry::Block& block,
                                     geometry::StressRule rule, std::span<const Vec3> positions,
                                     std::span<const double> values, int components) {
  const std::size_t nodes = mesh.nodes.size();
  const auto per_element = geometry::stress_rule(mesh.element, rule).size();
  const auto corners = static_cast<std::size_t>(geometry::corners_per_element(mesh.element));
  const StressPoints points = stress_points(mesh, block, rule, positions);

  const std::vector<char> on_rim = on_open_sides(mesh, block);
  std::vector<std::vector<Index>> around(nodes); // elements at each corner node
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const std::span<const Index> element = mesh.element_nodes(block, e);
    for (std::size_t a = 0; a < corners; ++a) around[static_cast<std::size_t>(element[a])].push_back(e);
  }

  const auto width = static_cast<std::size_t>(components);
  std::vector<double> sum(nodes * width, 0.0);
  std::vector<int> count(nodes, 0);
  std::vector<char> own(nodes, 0); // has a patch of its own

  const auto fit = [&](std::size_t centre, const std::vector<Index>& elements, bool spread) {
    Vec3 normal = Vec3::Zero();
    for (const Index e : elements) normal += points.normal[static_cast<std::size_t>(e)];
    normal.normalize();
    const Vec3 t1 = normal.unitOrthogonal();
    const Vec3 t2 = normal.cross(t1);
    const Vec3 origin = positions[centre];
    double size = 0;
    for (const Index e : elements) {
      for (const Index node : mesh.element_nodes(block, e)) {
        size = std::max(size, (positions[static_cast<std::size_t>(node)] - origin).norm());
      }
    }
    const auto rows = static_cast<Eigen::Index>(elements.size() * per_element);
    int terms = geometry::is_quadratic(mesh.element) ? 6 : 3;
    if (rows < terms + (terms == 6 ? 2 : 1)) terms = rows >= 4 ? 3 : 1;
    MatX A(rows, terms);
    MatX b(rows, components);
    Eigen::Index row = 0;
    double term[6];
    for (const Index e : elements) {
      for (std::size_t k = 0; k < per_element; ++k, ++row) {
        const std::size_t i = static_cast<std::size_t>(e) * per_element + k;
        const Vec3 d = (points.at[i] - origin) / size;
        fill_terms(d.dot(t1), d.dot(t2), terms, term);
        for (int j = 0; j < terms; ++j) A(row, j) = term[j];
        for (int c = 0; c < components; ++c) b(row, c) = values[i * width + static_cast<std::size_t>(c)];
      }
    }
    const MatX coefficients = A.colPivHouseholderQr().solve(b);
    const auto add = [&](std::size_t node) {
      const Vec3 d = (positions[node] - origin) / size;
      fill_terms(d.dot(t1), d.dot(t2), terms, term);
      for (int c = 0; c < components; ++c) {
        double value = 0;
        for (int j = 0; j < terms; ++j) value += term[j] * coefficients(j, c);
        sum[node * width + static_cast<std::size_t>(c)] += value;
      }
      ++count[node];
    };
    add(centre);
    if (!spread) return;
    std::vector<Index> reached;
    for (const Index e : elements) {
      for (const Index node : mesh.element_nodes(block, e)) reached.push_back(node);
    }
    std::sort(reached.begin(), reached.end());
    reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
    for (const Index node : reached) {
      const auto k = static_cast<std::size_t>(node);
      if (k != centre && own[k] == 0) add(k);
    }
  };

  for (std::size_t node = 0; node < nodes; ++node) own[node] = !around[node].empty() && on_rim[node] == 0 ? 1 : 0;
  for (std::size_t node = 0; node < nodes; ++node) {
    if (own[node] != 0) fit(node, around[node], true);
  }
  // what no inner patch reaches (a corner of the plan, a mesh of one row): the elements around, and their neighbours
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const std::span<const Index> element = mesh.element_nodes(block, e);
    for (const Index node : element) {
      if (count[static_cast<std::size_t>(node)] > 0) continue;
      std::vector<Index> elements;
      for (std::size_t a = 0; a < corners; ++a) {
        const std::vector<Index>& more = around[static_cast<std::size_t>(element[a])];
        elements.insert(elements.end(), more.begin(), more.end());
      }
      std::sort(elements.begin(), elements.end());
      elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
      fit(static_cast<std::size_t>(node), elements, false);
    }
  }
  for (std::size_t node = 0; node < nodes; ++node) {
    for (std::size_t c = 0; c < width && count[node] > 1; ++c) sum[node * width + c] /= count[node];
  }
  return sum;
}

} // namespace pneuma::solver::recovery
