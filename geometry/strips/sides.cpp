// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/sides.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"

namespace pneuma::geometry::strips {

namespace {

// One side of an element on the strip's boundary.
struct Piece {
  Index from = 0, middle = -1, to = 0; // middle: -1 where elements have none
  Index seam = -1, edge = -1;
  bool reversed = false;
};

using Ends = std::pair<Index, Index>;

struct Label {
  Index seam = -1, edge = -1;
  bool reversed = false;
};

// Labels of the element sides on seams and edges, from corner to corner, in both directions.
std::map<Ends, Label> labels_of(const Mesh& mesh, std::span<const std::vector<Index>> seams) {
  std::map<Ends, Label> labels;
  const std::size_t step = is_quadratic(mesh.element) ? 2 : 1;
  const auto add = [&](const std::vector<Index>& nodes, bool closed, Label label) {
    const std::size_t last = closed ? nodes.size() : nodes.size() - 1;
    for (std::size_t k = 0; k < last; k += step) {
      const Index a = nodes[k];
      const Index b = nodes[(k + step) % nodes.size()];
      label.reversed = false;
      labels[{a, b}] = label;
      label.reversed = true;
      labels[{b, a}] = label;
    }
  };
  for (std::size_t s = 0; s < seams.size(); ++s) add(seams[s], false, {static_cast<Index>(s), -1, false});
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    add(mesh.edges[e].nodes, mesh.edges[e].closed, {-1, static_cast<Index>(e), false});
  }
  return labels;
}

// Element sides that belong to one element of the strip only, by the node they start from.
std::map<Index, Piece> boundary_of(const Mesh& mesh, const Block& block, std::span<const Index> strip_of_element,
                                   Index strip) {
  const auto corners = static_cast<std::size_t>(corners_per_element(mesh.element));
  std::map<Ends, Piece> open;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    if (strip_of_element[static_cast<std::size_t>(e)] != strip) continue;
    const std::span<const Index> nodes = mesh.element_nodes(block, e);
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = nodes[k];
      const Index b = nodes[(k + 1) % corners];
      if (open.erase({b, a}) > 0) continue;
      open[{a, b}] = {a, is_quadratic(mesh.element) ? nodes[corners + k] : -1, b, -1, -1, false};
    }
  }
  std::map<Index, Piece> boundary;
  for (const auto& [ends, piece] : open) {
    if (!boundary.emplace(piece.from, piece).second) {
      const Vec3& x = mesh.nodes[static_cast<std::size_t>(piece.from)];
      throw base::GeometryError(fmt::format("strip {} of `{}` touches itself at {} m: move the "
                                            "cutting lines apart",
                                            strip + 1, block.name, base::place_text(x)));
    }
  }
  return boundary;
}

} // namespace

std::vector<StripSide> sides_of(const Mesh& mesh, const Block& block, std::span<const Index> strip_of_element,
                                Index strip, std::span<const std::vector<Index>> seams) {
  const std::map<Index, Piece> boundary = boundary_of(mesh, block, strip_of_element, strip);
  if (boundary.empty()) throw base::GeometryError(fmt::format("strip {} of `{}` is empty", strip + 1, block.name));
  const std::map<Ends, Label> labels = labels_of(mesh, seams);
  std::vector<Piece> ring;
  for (Index node = boundary.begin()->first;;) {
    Piece piece = boundary.at(node);
    const auto label = labels.find({piece.from, piece.to});
    if (label != labels.end()) {
      piece.seam = label->second.seam;
      piece.edge = label->second.edge;
      piece.reversed = label->second.reversed;
    }
    ring.push_back(piece);
    node = piece.to;
    if (node == boundary.begin()->first) break;
  }
  if (ring.size() != boundary.size()) {
    throw base::GeometryError(
        fmt::format("strip {} of `{}` has a hole or falls into parts; move the cutting lines", strip + 1, block.name));
  }
  const auto same = [](const Piece& a, const Piece& b) { return a.seam == b.seam && a.edge == b.edge; };
  // start where a side begins
  for (std::size_t k = 0; k < ring.size(); ++k) {
    if (same(ring[(k + ring.size() - 1) % ring.size()], ring[k])) continue;
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(k), ring.end());
    break;
  }
  std::vector<StripSide> sides;
  for (const Piece& piece : ring) {
    if (sides.empty() || sides.back().seam != piece.seam || sides.back().edge != piece.edge) {
      sides.push_back({piece.seam, piece.edge, piece.reversed, {piece.from}});
    }
    if (piece.middle >= 0) sides.back().nodes.push_back(piece.middle);
    sides.back().nodes.push_back(piece.to);
  }
  return sides;
}

} // namespace pneuma::geometry::strips
