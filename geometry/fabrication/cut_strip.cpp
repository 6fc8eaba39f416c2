// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/fabrication/fabrication.h"
#include "geometry/polygon.h"

namespace pneuma::geometry::fabrication {

namespace {

constexpr double same_point = 1e-9; // m: far below what is cut, far above rounding

// A straight piece of the net outline, on its way counterclockwise.
struct NetEdge {
  Vec2 from, along; // along: unit vector
  double allowance;

  Vec2 outwards() const { return {along.y(), -along.x()}; }
  Vec2 offset(const Vec2& point) const { return point + allowance * outwards(); }
};

[[noreturn]] void refuse(const FlatStrip& strip, const char* what, const Vec2& at) {
  throw base::GeometryError(
      fmt::format("strip {}: {} at ({:.4f} m, {:.4f} m) of the flat strip", strip.name, what, at.x(), at.y()));
}

std::vector<NetEdge> net_edges(const FlatStrip& strip, const Allowances& allowances) {
  std::vector<NetEdge> edges;
  for (std::size_t s = 0; s < strip.sides.size(); ++s) {
    const Side& side = strip.sides[s];
    const Side& next = strip.sides[(s + 1) % strip.sides.size()];
    if (side.points.size() < 2 || next.points.empty()) {
      throw base::GeometryError(fmt::format("strip {}: side {} has no length", strip.name, side.name));
    }
    if ((side.points.back() - next.points.front()).norm() > same_point) {
      refuse(strip, "the outline is open", side.points.back());
    }
    for (std::size_t i = 0; i + 1 < side.points.size(); ++i) {
      const Vec2 step = side.points[i + 1] - side.points[i];
      if (step.norm() <= same_point) continue;
      edges.push_back({side.points[i], step.normalized(), side.seam ? allowances.seam : allowances.clamp});
    }
  }
  return edges;
}

// The corner of the offset between two edges: where the offset lines meet, unless that would reach too far or cut into
// an allowance.
void add_corner(const NetEdge& a, const NetEdge& b, std::vector<Vec2>& outline) {
  const Vec2& corner = b.from;
  const double sine = cross(a.along, b.along); // of the turn; positive: convex
  const double cosine = a.along.dot(b.along);
  const double reach = mitre_limit * std::max(a.allowance, b.allowance);
  if (reach == 0) {
    outline.push_back(corner);
    return;
  }
  if (a.allowance == b.allowance && cosine > 0) { // also the many small turns of a curved side
    outline.emplace_back(corner + a.allowance / (1 + cosine) * (a.outwards() + b.outwards()));
    return;
  }
  // times the sine: how far beyond its end the line of `a` meets that of `b`, and how far before its start that of `b`
  const double beyond = b.allowance - a.allowance * cosine;
  const double before = a.allowance - b.allowance * cosine;
  const bool convex = sine >= 0;
  const bool cuts_in = convex && (beyond < 0 || before < 0);
  const bool too_far = !convex && std::hypot(beyond, a.allowance * sine) > -reach * sine;
  if (cuts_in || too_far) {
    outline.push_back(a.offset(corner));
    outline.push_back(b.offset(corner));
    return;
  }
  if (convex && cosine < 0) {
    const Vec2 tip = (a.along - b.along).normalized(); // from the corner outwards, halfway between the edges
    if (a.allowance * tip.dot(a.outwards()) * sine + tip.dot(a.along) * beyond > reach * sine) {
      const auto to_cut = [&](const NetEdge& edge) {
        return (reach - edge.allowance * tip.dot(edge.outwards())) / tip.dot(edge.along);
      };
      outline.emplace_back(a.offset(corner) + to_cut(a) * a.along);
      outline.emplace_back(b.offset(corner) + to_cut(b) * b.along);
      return;
    }
  }
  outline.emplace_back(a.offset(corner) + beyond / sine * a.along);
}

Vec2 meeting_point(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double sine = cross(b - a, d - c);
  if (sine == 0) return c; // they overlap or touch
  return a + std::clamp(cross(c - a, d - c) / sine, 0.0, 1.0) * (b - a);
}

// The offset of a hollow that is narrower than twice the allowance runs backwards there: loops as small as the
// allowance, which are cut off. A larger one means that parts of the strip would overlap.
void remove_loops(const FlatStrip& strip, double size, std::vector<Vec2>& ring) {
  while (const auto crossing = crossing_sides(ring)) {
    const auto [first, last] = std::minmax(crossing->first, crossing->second);
    const Vec2 at = meeting_point(ring[first], ring[first + 1], ring[last], ring[(last + 1) % ring.size()]);
    const auto from = ring.begin() + static_cast<std::ptrdiff_t>(first) + 1;
    const auto to = ring.begin() + static_cast<std::ptrdiff_t>(last) + 1;
    std::vector<Vec2> inner(from, to);
    std::vector<Vec2> outer(to, ring.end());
    outer.insert(outer.end(), ring.begin(), from);
    inner.push_back(at);
    outer.push_back(at);
    if (std::abs(signed_area(inner)) > std::abs(signed_area(outer))) inner.swap(outer);
    if (std::any_of(inner.begin(), inner.end(), [&](const Vec2& p) { return (p - at).norm() > size; })) {
      refuse(strip, "the cut outline crosses itself: a smaller allowance or other lines are needed", at);
    }
    ring = std::move(outer);
  }
}

std::vector<Vec2> offset(const FlatStrip& strip, const std::vector<NetEdge>& edges, const Allowances& allowances) {
  std::vector<Vec2> ring;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    add_corner(edges[(i + edges.size() - 1) % edges.size()], edges[i], ring);
  }
  const auto last =
      std::unique(ring.begin(), ring.end(), [](const Vec2& a, const Vec2& b) { return (a - b).norm() <= same_point; });
  ring.erase(last, ring.end());
  remove_loops(strip, mitre_limit * std::max(allowances.seam, allowances.clamp), ring);
  return ring;
}

Vec2 nearest_on(const std::vector<Vec2>& ring, const Vec2& point) {
  Vec2 best = ring.front();
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 side = ring[(i + 1) % ring.size()] - ring[i];
    const double along = std::clamp((point - ring[i]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    const Vec2 candidate = ring[i] + along * side;
    if ((candidate - point).norm() >= distance) continue;
    best = candidate;
    distance = (candidate - point).norm();
  }
  return best;
}

void add_notches(const Side& side, const Allowances& allowances, CutStrip& cut) {
  const double own_length = length(side);
  const double parts = std::ceil(std::max(own_length, side.mate_length) / allowances.notch_spacing * (1 - 1e-9));
  const auto step = [&](std::size_t i) -> Vec2 { return side.points[i + 1] - side.points[i]; };
  std::size_t i = 0;
  double passed = 0; // length up to point i
  for (int k = 1; k < parts; ++k) {
    const double at = k / parts * own_length;
    while (passed + step(i).norm() < at && i + 2 < side.points.size()) passed += step(i++).norm();
    const Vec2 along = step(i).normalized();
    const NetEdge edge = {side.points[i], along, allowances.seam};
    const Vec2 net = side.points[i] + (at - passed) * along;
    const int number = side.reversed ? static_cast<int>(parts) - k : k;
    cut.notches.push_back(
        {nearest_on(cut.outline, edge.offset(net)), -edge.outwards(), fmt::format("{}-{}", side.name, number)});
  }
}

} // namespace

double length(const Side& side) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < side.points.size(); ++i) sum += (side.points[i + 1] - side.points[i]).norm();
  return sum;
}

CutStrip cut_strip(const FlatStrip& strip, const Allowances& allowances) {
  const std::vector<NetEdge> edges = net_edges(strip, allowances);
  CutStrip cut;
  for (const NetEdge& edge : edges) cut.net.push_back(edge.from);
  if (const auto crossing = crossing_sides(cut.net)) {
    refuse(strip, "the net outline crosses itself", cut.net[crossing->first]);
  }
  cut.net_area = cut.net.size() < 3 ? 0 : signed_area(cut.net);
  if (!(cut.net_area > 0)) throw base::GeometryError(fmt::format("strip {} encloses no area", strip.name));

  cut.outline = offset(strip, edges, allowances);
  cut.area = signed_area(cut.outline);
  cut.low = cut.high = cut.outline.front();
  for (const Vec2& point : cut.outline) {
    cut.low = cut.low.cwiseMin(point);
    cut.high = cut.high.cwiseMax(point);
  }
  for (const Side& side : strip.sides) {
    if (side.seam && allowances.notch_spacing > 0) add_notches(side, allowances, cut);
  }
  return cut;
}

} // namespace pneuma::geometry::fabrication
