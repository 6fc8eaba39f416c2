// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_check.h"
#include "geometry/base/place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/quadrature.h"
#include "geometry/shape_functions.h"

namespace pneuma::geometry {

namespace {

using base::Mat32;

constexpr double degree = std::numbers::pi / 180;
constexpr double needle_angle = 5 * degree;
constexpr double no_angle = 0.01 * degree;
constexpr double long_aspect = 50;
constexpr double same_place = 1e-10; // of the mesh's extent

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

struct Report {
  std::vector<MeshFault> faults;
  std::array<int, 14> counts{};

  void add(FaultKind kind, Severity severity, const Vec3& place, const std::string& what) {
    constexpr int most = 20;
    int& count = counts[static_cast<std::size_t>(kind)];
    if (++count > most) return;
    std::string text = fmt::format("{} at {}", what, base::place_text(place));
    if (count == most) text += "; further faults of this kind are not listed";
    faults.push_back({kind, severity, text, place});
  }
};

// One side of one element between two corners.
struct Side {
  Index low, high;
  Index element;
  Index middle; // mid-side node, or -1
  bool forward; // from low to high
};

bool same_ends(const Side& a, const Side& b) {
  return a.low == b.low && a.high == b.high;
}

// The check of one mesh; `report` grows.
struct Checker {
  const Mesh& mesh;
  Report report{};
  double extent = 0;
  bool flat = false;
  std::vector<bool> on_edge{};
  std::vector<std::pair<Index, Index>> edge_sides{}; // low and high corner, sorted

  const Vec3& node(Index i) const { return mesh.nodes[at(i)]; }
  Vec3 middle(std::span<const Index> nodes) const {
    Vec3 sum = Vec3::Zero();
    for (const Index i : nodes) sum += node(i);
    return sum / static_cast<double>(nodes.size());
  }
  std::string name(const Block& block, Index e) const { return fmt::format("element {} of {}", e, block.name); }

  // Nothing else can be looked at where this fails.
  bool numbers_are_good() {
    const auto count = static_cast<Index>(mesh.nodes.size());
    const auto bad = [&](Index i) { return i < 0 || i >= count; };
    const auto fault = [&](const std::string& what) {
      report.add(FaultKind::bad_number, Severity::error, Vec3::Zero(), what);
    };
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      if (!mesh.nodes[i].allFinite()) fault(fmt::format("node {} has no finite place", i));
    }
    if (mesh.blocks.empty()) fault("the mesh has no elements");
    for (const Block& block : mesh.blocks) {
      const auto n = at(nodes_per_element(mesh.element));
      if (block.connectivity.empty() || block.connectivity.size() % n != 0)
        fault(fmt::format("{} has {} node numbers, not a multiple of {}", block.name, block.connectivity.size(), n));
      for (const Index i : block.connectivity) {
        if (bad(i)) fault(fmt::format("{} uses node {} of {}", block.name, i, count));
      }
    }
    for (const Edge& edge : mesh.edges) {
      const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
      const std::size_t extra = edge.closed ? 0 : 1;
      if (edge.nodes.size() < step + extra || (edge.nodes.size() - extra) % step != 0)
        fault(fmt::format("edge {} has {} nodes, which makes no row of sides", edge.name, edge.nodes.size()));
      for (const Index i : edge.nodes) {
        if (bad(i)) fault(fmt::format("edge {} uses node {} of {}", edge.name, i, count));
      }
    }
    return report.faults.empty();
  }

  void gather() {
    Vec3 low = mesh.nodes.front();
    Vec3 high = low;
    for (const Vec3& x : mesh.nodes) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    extent = (high - low).norm();
    flat = high.z() - low.z() <= 1e-12 * extent;
    on_edge.assign(mesh.nodes.size(), false);
    const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
    for (const Edge& edge : mesh.edges) {
      for (const Index i : edge.nodes) on_edge[at(i)] = true;
      const std::size_t n = edge.nodes.size();
      for (std::size_t k = 0; k + step < n + (edge.closed ? step : 0); k += step)
        edge_sides.push_back(std::minmax(edge.nodes[k], edge.nodes[(k + step) % n]));
    }
    std::sort(edge_sides.begin(), edge_sides.end());
  }

  void check_use_of_nodes() {
    constexpr int nobody = -1;
    std::vector<int> owner(mesh.nodes.size(), nobody);
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      for (const Index i : mesh.blocks[b].connectivity) {
        int& first = owner[at(i)];
        if (first != nobody && first != static_cast<int>(b) && !on_edge[at(i)]) {
          report.add(FaultKind::shared_inside, Severity::error, node(i),
                     fmt::format("{} and {} share node {}, which lies on no edge", mesh.blocks[at(first)].name,
                                 mesh.blocks[b].name, i));
        }
        first = static_cast<int>(b);
      }
    }
    for (std::size_t i = 0; i < owner.size(); ++i) {
      if (owner[i] == nobody)
        report.add(FaultKind::unused_node, Severity::error, mesh.nodes[i], fmt::format("node {} is in no element", i));
    }
  }

  // Two nodes of a block at one place: neighbours in the order along a direction in which a grid has no rows.
  void check_coincidence(const Block& block) {
    const Vec3 direction(0.754877, 0.569840, 0.324718);
    std::vector<std::pair<double, Index>> order;
    std::vector<bool> seen(mesh.nodes.size(), false);
    for (const Index i : block.connectivity) {
      if (!seen[at(i)]) order.emplace_back(direction.dot(node(i)), i);
      seen[at(i)] = true;
    }
    std::sort(order.begin(), order.end());
    const double near = same_place * extent;
    for (std::size_t a = 0; a < order.size(); ++a) {
      for (std::size_t b = a + 1; b < order.size() && order[b].first - order[a].first <= near; ++b) {
        if ((node(order[a].second) - node(order[b].second)).norm() <= near) {
          report.add(
              FaultKind::coincident_nodes, Severity::error, node(order[a].second),
              fmt::format("nodes {} and {} of {} lie at one place", order[a].second, order[b].second, block.name));
        }
      }
    }
  }

  void check_sides(const Block& block) {
    const auto corners = at(corners_per_element(mesh.element));
    std::vector<Side> sides;
    sides.reserve(at(mesh.element_count(block)) * corners);
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      const auto nodes = mesh.element_nodes(block, e);
      for (std::size_t k = 0; k < corners; ++k) {
        const Index a = nodes[k];
        const Index b = nodes[(k + 1) % corners];
        sides.push_back(
            {std::min(a, b), std::max(a, b), e, is_quadratic(mesh.element) ? nodes[corners + k] : -1, a < b});
      }
    }
    std::stable_sort(sides.begin(), sides.end(),
                     [](const Side& a, const Side& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
    std::vector<bool> edge_met(edge_sides.size(), false);
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
      while (last < sides.size() && same_ends(sides[first], sides[last])) ++last;
      const Side& side = sides[first];
      const Vec3 place = (node(side.low) + node(side.high)) / 2;
      const std::pair ends(side.low, side.high);
      if (last - first == 1) {
        const auto found = std::lower_bound(edge_sides.begin(), edge_sides.end(), ends);
        if (found != edge_sides.end() && *found == ends) {
          edge_met[static_cast<std::size_t>(found - edge_sides.begin())] = true;
        } else {
          report.add(FaultKind::side_without_edge, Severity::error, place,
                     fmt::format("{} has an open side that belongs to no edge", name(block, side.element)));
        }
      } else if (last - first > 2) {
        report.add(FaultKind::non_manifold_side, Severity::error, place,
                   fmt::format("{} elements of {} meet at one side", last - first, block.name));
      } else {
        const Side& other = sides[first + 1];
        if (side.forward == other.forward) {
          report.add(
              FaultKind::flipped_neighbour, Severity::error, place,
              fmt::format("elements {} and {} of {} look to opposite sides", side.element, other.element, block.name));
        }
        if (side.middle != other.middle) {
          report.add(FaultKind::torn_side, Severity::error, place,
                     fmt::format("elements {} and {} of {} have different mid-side nodes", side.element, other.element,
                                 block.name));
        }
      }
    }
    for (std::size_t k = 0; k < edge_sides.size(); ++k) {
      if (!edge_met[k]) {
        report.add(FaultKind::edge_inside, Severity::error,
                   (node(edge_sides[k].first) + node(edge_sides[k].second)) / 2,
                   fmt::format("an edge runs where {} has no open side", block.name));
      }
    }
  }

  template <ElementType E>
  void check_shape(const Block& block, Index e) {
    constexpr int n = nodes_per_element(E);
    constexpr std::size_t corners = corners_per_element(E);
    const auto nodes = mesh.element_nodes(block, e);
    const Vec3 place = middle(nodes);

    std::array<Index, n> sorted{};
    std::copy(nodes.begin(), nodes.end(), sorted.begin());
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      report.add(FaultKind::repeated_node, Severity::error, place, fmt::format("{} has a node twice", name(block, e)));
      return;
    }
    if (std::all_of(nodes.begin(), nodes.end(), [&](Index i) { return on_edge[at(i)]; })) {
      report.add(FaultKind::held_element, Severity::error, place,
                 fmt::format("{} has all its nodes on edges", name(block, e)));
    }

    Eigen::Matrix<double, 3, n> x;
    for (int k = 0; k < n; ++k) x.col(k) = node(nodes[at(k)]);
    double shortest = extent;
    double longest = 0;
    double smallest = std::numbers::pi;
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec3 next = node(nodes[(k + 1) % corners]) - node(nodes[k]);
      const Vec3 last = node(nodes[(k + corners - 1) % corners]) - node(nodes[k]);
      shortest = std::min(shortest, next.norm());
      longest = std::max(longest, next.norm());
      const double angle = std::atan2(next.cross(last).norm(), next.dot(last));
      smallest = std::min({smallest, angle, corners == 4 ? std::numbers::pi - angle : angle});
    }
    if (smallest < no_angle || shortest < same_place * longest) {
      report.add(FaultKind::degenerate_element, Severity::error, place,
                 fmt::format("{} has no area, or corners on a line", name(block, e)));
      return;
    }
    if (smallest < needle_angle || longest > long_aspect * shortest) {
      report.add(FaultKind::needle_element, Severity::warning, place,
                 fmt::format("{} is a needle: angle {:.2g} degrees, sides 1 : {:.3g}", name(block, e),
                             smallest / degree, longest / shortest));
    }

    static const auto samples = [] { // where the Jacobian is looked at: pressure points and corners
      std::vector<Eigen::Matrix<double, n, 2>> derivatives;
      for (const QuadraturePoint& q : pressure_rule(E))
        derivatives.push_back(shape_functions<E>(q.xi, q.eta).derivative);
      constexpr double triangle[][2] = {{0, 0}, {1, 0}, {0, 1}};
      constexpr double square[][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
      for (std::size_t k = 0; k < corners; ++k) {
        const auto& corner = corners == 3 ? triangle[k] : square[k];
        derivatives.push_back(shape_functions<E>(corner[0], corner[1]).derivative);
      }
      return derivatives;
    }();
    Vec3 up = Vec3::UnitZ();
    if (!flat) {
      up.setZero();
      for (const auto& derivative : samples) {
        const Mat32 tangents = x * derivative;
        up += tangents.col(0).cross(tangents.col(1));
      }
    }
    for (const auto& derivative : samples) {
      const Mat32 tangents = x * derivative;
      if (tangents.col(0).cross(tangents.col(1)).dot(up) <= 0) {
        report.add(FaultKind::inverted_element, Severity::error, place,
                   fmt::format("{} is turned over or folded", name(block, e)));
        return;
      }
    }
  }
};

} // namespace

std::vector<MeshFault> check_mesh(const Mesh& mesh) {
  Checker checker{mesh};
  if (!checker.numbers_are_good()) return checker.report.faults;
  checker.gather();
  checker.check_use_of_nodes();
  for (const Block& block : mesh.blocks) {
    checker.check_coincidence(block);
    checker.check_sides(block);
    dispatch(mesh.element, [&]<ElementType E>() {
      for (Index e = 0; e < mesh.element_count(block); ++e) checker.check_shape<E>(block, e);
    });
  }
  return checker.report.faults;
}

} // namespace pneuma::geometry
