// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/gap.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/box_grid.h"
#include "geometry/plan_point.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

using base::Mat3;
using base::MatX;

struct Place {
  double xi, eta;
};

constexpr Place triangle_nodes[] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
constexpr Place square_nodes[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
// points inside, about as dense as the nodes
constexpr Place triangle_inside[] = {{1.0 / 3, 1.0 / 3}, {1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
constexpr Place square_inside[] = {{0, 0}, {-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};

std::span<const Place> inside_of(ElementType type) {
  switch (type) {
  case ElementType::T3:
    return std::span(triangle_inside).first(1);
  case ElementType::T6:
    return triangle_inside;
  case ElementType::Q4:
    return std::span(square_inside).first(1);
  default:
    return std::span(square_inside).subspan(1); // the middle is a node
  }
}

template <ElementType E>
using Element = Eigen::Matrix<double, 3, nodes_per_element(E)>;

template <ElementType E>
Element<E> gather(const MatX& local, const std::vector<Index>& connectivity, Index e) {
  constexpr int n = nodes_per_element(E);
  Element<E> x;
  for (int k = 0; k < n; ++k) x.col(k) = local.col(connectivity[static_cast<std::size_t>(e * n + k)]);
  return x;
}

template <ElementType E>
BoxGrid make_grid(const MatX& local, const std::vector<Index>& connectivity) {
  const auto count = static_cast<Index>(connectivity.size()) / nodes_per_element(E);
  std::vector<PlanBox> boxes;
  boxes.reserve(static_cast<std::size_t>(count));
  for (Index e = 0; e < count; ++e) {
    const Element<E> x = gather<E>(local, connectivity, e);
    const Vec2 low = x.template topRows<2>().rowwise().minCoeff();
    const Vec2 high = x.template topRows<2>().rowwise().maxCoeff();
    const double margin = is_quadratic(E) ? 0.2 * (high - low).maxCoeff() : 0.0;
    boxes.push_back({low.array() - margin, high.array() + margin});
  }
  return BoxGrid(boxes);
}

} // namespace

GapSearch::GapSearch(const Mesh& mesh, const Block& upper, const Block& lower, const Vec3& normal)
    : element_(mesh.element), upper_{upper.connectivity, samples_of(mesh, upper, mesh.element_count(lower))},
      lower_{lower.connectivity, samples_of(mesh, lower, mesh.element_count(upper))} {
  const Vec3 vertical = normal.normalized();
  const Vec3 first = vertical.unitOrthogonal();
  frame_.row(0) = first;
  frame_.row(1) = vertical.cross(first);
  frame_.row(2) = vertical;
}

std::vector<GapSearch::Sample> GapSearch::samples_of(const Mesh& mesh, const Block& block, Index others) {
  std::vector<Sample> samples;
  std::vector<bool> done(mesh.nodes.size(), false); // nodes already sampled, and those on edges
  for (const Edge& edge : mesh.edges) {
    for (const Index i : edge.nodes) done[static_cast<std::size_t>(i)] = true;
  }
  const bool triangle = corners_per_element(mesh.element) == 3;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const Index hint = std::min(e, others - 1); // stacked blocks are copies: the same element is the likeliest
    const auto nodes = mesh.element_nodes(block, e);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto i = static_cast<std::size_t>(nodes[k]);
      const Place place = triangle ? triangle_nodes[k % 6] : square_nodes[k];
      if (!done[i]) samples.push_back({e, place.xi, place.eta, nodes[k], hint});
      done[i] = true;
    }
    for (const Place& place : inside_of(mesh.element)) samples.push_back({e, place.xi, place.eta, -1, hint});
  }
  return samples;
}

Gap GapSearch::smallest(std::span<const Vec3> positions) {
  return dispatch(element_, [&]<ElementType E>() { return search<E>(positions); });
}

template <ElementType E>
Gap GapSearch::search(std::span<const Vec3> positions) {
  local_.resize(3, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i)
    local_.col(static_cast<Eigen::Index>(i)).noalias() = frame_ * positions[i];
  Gap gap;
  search_from<E>(upper_, lower_, 1, gap);
  search_from<E>(lower_, upper_, -1, gap);
  return gap;
}

// `sign`: 1 from the upper block down, -1 from the lower one up.
template <ElementType E>
void GapSearch::search_from(Side& from, const Side& other, double sign, Gap& gap) {
  std::optional<BoxGrid> grid; // made when a point has left its element
  for (Sample& sample : from.samples) {
    Vec3 point;
    if (sample.node >= 0) {
      point = local_.col(sample.node);
    } else {
      point = gather<E>(local_, from.connectivity, sample.element) * shape_functions<E>(sample.xi, sample.eta).value;
    }
    const Vec2 at = point.head<2>();
    std::optional<PlanPlace> opposite = place_in_plan<E>(gather<E>(local_, other.connectivity, sample.hint), at);
    if (!opposite) {
      if (!grid) grid = make_grid<E>(local_, other.connectivity);
      for (const Index e : grid->at(at)) {
        opposite = place_in_plan<E>(gather<E>(local_, other.connectivity, e), at);
        if (opposite) {
          sample.hint = e;
          break;
        }
      }
    }
    if (!opposite) {
      ++gap.skipped;
      continue;
    }
    ++gap.located;
    const double value = sign * (point.z() - opposite->height);
    if (value < gap.value) {
      gap.value = value;
      if (sign < 0) point.z() = opposite->height;
      gap.at = frame_.transpose() * point;
    }
  }
}

} // namespace pneuma::geometry
