// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/box_grid.h"
#include "geometry/geodesics/geodesics.h"
#include "geometry/polygon.h"

namespace pneuma::geometry::geodesics {

namespace {

constexpr Index none = -1;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Triangles that share sides one after the other.
using Sleeve = std::vector<Index>;

// The triangles with what lies across their sides. "Left", "right" and turns are seen from the side on which their
// corners run counterclockwise.
class Surface {
public:
  explicit Surface(const Triangulation& surface) : surface_(surface) {
    across_.resize(surface.triangles.size(), {none, none, none});
    std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> open; // triangle and side
    open.reserve(2 * surface.triangles.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& corners = surface.triangles[t];
        const auto [found, fresh] = open.try_emplace(side_key(corners[k], corners[(k + 1) % 3]), t, k);
        if (fresh) continue;
        const auto [other, side] = found->second;
        across_[t][k] = static_cast<Index>(other);
        across_[other][side] = static_cast<Index>(t);
      }
    }
  }

  const Vec3& point(Index vertex) const { return surface_.points[at(vertex)]; }
  const std::array<Index, 3>& corners(Index triangle) const { return surface_.triangles[at(triangle)]; }
  const std::array<Index, 3>& across(Index triangle) const { return across_[at(triangle)]; }

  // Which corner of the triangle a vertex is; none if it is no corner.
  Index corner_of(Index triangle, Index vertex) const {
    const auto& c = corners(triangle);
    for (Index k = 0; k < 3; ++k) {
      if (c[at(k)] == vertex) return k;
    }
    return none;
  }
  bool has(Index triangle, Index vertex) const { return corner_of(triangle, vertex) != none; }

  // The next triangle around one of the triangle's corners; none beyond the boundary.
  Index turned(Index triangle, Index vertex, bool counterclockwise) const {
    const std::size_t k = at(corner_of(triangle, vertex));
    return across(triangle)[counterclockwise ? (k + 2) % 3 : k];
  }

  double angle(Index triangle, Index vertex) const {
    const std::size_t k = at(corner_of(triangle, vertex));
    const Vec3 a = point(corners(triangle)[(k + 1) % 3]) - point(vertex);
    const Vec3 b = point(corners(triangle)[(k + 2) % 3]) - point(vertex);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  // Sum of the angles around a vertex, 2 pi where the surface is flat; infinite on the boundary, around which no line
  // can be led.
  double angle_around(Index first, Index vertex) const {
    double sum = 0;
    for (Index t = first;;) {
      sum += angle(t, vertex);
      t = turned(t, vertex, true);
      if (t == none) return std::numeric_limits<double>::infinity();
      if (t == first) return sum;
    }
  }

  std::size_t triangle_count() const { return surface_.triangles.size(); }

private:
  const Triangulation& surface_;
  std::vector<std::array<Index, 3>> across_; // [triangle][side], side k from corner k to corner k + 1
};

// Finds triangles in plan.
class Locator {
public:
  explicit Locator(const Triangulation& surface) : surface_(surface), grid_(boxes(surface)) {}

  double cell() const { return grid_.cell(); }

  // The triangle in which a place lies deepest; none if it lies in none.
  Index find(const Vec2& place) const {
    constexpr double outside = -1e-9;
    Index best = none;
    double deepest = outside;
    for (const Index t : grid_.at(place)) {
      const double depth = depth_in(t, place);
      if (depth <= deepest) continue;
      deepest = depth;
      best = t;
    }
    return best;
  }

private:
  static std::vector<PlanBox> boxes(const Triangulation& surface) {
    std::vector<PlanBox> boxes;
    boxes.reserve(surface.triangles.size());
    for (const auto& [i, j, k] : surface.triangles) {
      const Vec2 a = surface.points[at(i)].head<2>();
      const Vec2 b = surface.points[at(j)].head<2>();
      const Vec2 c = surface.points[at(k)].head<2>();
      boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
    }
    return boxes;
  }

  // smallest of the place's area coordinates
  double depth_in(Index triangle, const Vec2& place) const {
    const auto& [i, j, k] = surface_.triangles[at(triangle)];
    const Vec2 a = surface_.points[at(i)].head<2>() - place;
    const Vec2 b = surface_.points[at(j)].head<2>() - place;
    const Vec2 c = surface_.points[at(k)].head<2>() - place;
    const double total = cross(a, b) + cross(b, c) + cross(c, a);
    return std::min({cross(a, b) / total, cross(b, c) / total, cross(c, a) / total});
  }

  const Triangulation& surface_;
  BoxGrid grid_;
};

// Appends the way with the fewest triangles from the sleeve's last triangle to another. `reached_by` is scratch memory:
// none for every triangle, before and after.
void connect(const Surface& surface, Sleeve& sleeve, Index to, std::vector<Index>& reached_by) {
  const Index from = sleeve.back();
  Sleeve reached = {from};
  reached_by[at(from)] = from;
  for (std::size_t i = 0; i < reached.size() && reached_by[at(to)] == none; ++i) {
    for (const Index t : surface.across(reached[i])) {
      if (t == none || reached_by[at(t)] != none) continue;
      reached_by[at(t)] = reached[i];
      reached.push_back(t);
    }
  }
  if (reached_by[at(to)] == none) {
    const Vec3& p = surface.point(surface.corners(to)[0]);
    throw base::GeometryError(fmt::format("the surface is torn before {}: no line leads there", base::place_text(p)));
  }
  const auto end = static_cast<std::ptrdiff_t>(sleeve.size());
  for (Index t = to; t != from; t = reached_by[at(t)]) sleeve.push_back(t);
  std::reverse(sleeve.begin() + end, sleeve.end());
  for (const Index t : reached) reached_by[at(t)] = none;
}

// Cuts off loops, and what lies before the last triangle at `from` and after the first at `to` behind it.
void tidy(const Surface& surface, Index from, Index to, Sleeve& sleeve) {
  std::unordered_map<Index, std::size_t> place;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sleeve.size(); ++i) {
    const Index t = sleeve[i];
    if (surface.has(t, from)) {
      place.clear();
      kept = 0;
    } else if (const auto seen = place.find(t); seen != place.end()) {
      const std::size_t back = seen->second;
      for (std::size_t k = back; k < kept; ++k) place.erase(sleeve[k]);
      kept = back;
    }
    place[t] = kept;
    sleeve[kept++] = t;
    if (surface.has(t, to)) {
      const bool returns = std::any_of(sleeve.begin() + static_cast<std::ptrdiff_t>(i) + 1, sleeve.end(),
                                       [&](Index later) { return surface.has(later, from); });
      if (!returns) break;
    }
  }
  sleeve.resize(kept);
}

// The sleeve below a line in plan. The line is sampled, and triangles that follow each other without a common side are
// connected: so that lines along sides, through vertices or just beside the rim need no care.
Sleeve sleeve_below(const Triangulation& triangulation, const Surface& surface, Index from, Index to,
                    const std::vector<base::Vec2>& line) {
  const auto triangle_at = [&](Index vertex) {
    for (std::size_t t = 0; t < surface.triangle_count(); ++t) {
      if (surface.has(static_cast<Index>(t), vertex)) return static_cast<Index>(t);
    }
    throw base::GeometryError(fmt::format("vertex {} is in no triangle", vertex));
  };
  const Locator locator(triangulation);
  std::vector<Index> reached_by(surface.triangle_count(), none);
  Sleeve sleeve = {triangle_at(from)};
  const auto visit = [&](Index t) {
    if (t != none && t != sleeve.back()) connect(surface, sleeve, t, reached_by);
  };
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec2 along = line[k + 1] - line[k];
    const int samples = static_cast<int>(std::ceil(2 * along.norm() / locator.cell())) + 1;
    for (int i = 0; i < samples; ++i) visit(locator.find(line[k] + (i + 0.5) / samples * along));
  }
  visit(triangle_at(to));
  tidy(surface, from, to, sleeve);
  return sleeve;
}

// A side between two triangles of a sleeve that has been unfolded into the plane. The last one of a sleeve is its end.
struct Gate {
  Index right_vertex, left_vertex;
  Vec2 right, left;
};

// Sides are rolled out one after the other from the first vertex, which comes to lie at the origin.
std::vector<Gate> unfolded(const Surface& surface, Index from, Index to, const Sleeve& sleeve) {
  std::vector<Gate> gates;
  const auto length = [&](Index a, Index b) { return (surface.point(a) - surface.point(b)).norm(); };
  // place of a vertex to the right of the unfolded side from a to b
  const auto beyond = [&](const Gate& gate, Index vertex) -> Vec2 {
    const Vec3 side = surface.point(gate.left_vertex) - surface.point(gate.right_vertex);
    const Vec3 third = surface.point(vertex) - surface.point(gate.right_vertex);
    const Vec2 along = (gate.left - gate.right).normalized();
    const Vec2 across(along.y(), -along.x());
    return gate.right + (third.dot(side) * along + third.cross(side).norm() * across) / side.norm();
  };

  const auto k = at(surface.corner_of(sleeve.front(), from));
  const Index first = surface.corners(sleeve.front())[(k + 1) % 3];
  const Index second = surface.corners(sleeve.front())[(k + 2) % 3];
  const Vec2 first_place(length(from, first), 0);
  const Vec2 second_place = beyond({first, from, first_place, Vec2::Zero()}, second);
  Gate gate{first, second, first_place, second_place};
  if (sleeve.size() == 1) {
    const Vec2 end = to == first ? first_place : to == second ? second_place : Vec2(Vec2::Zero());
    return {{to, to, end, end}};
  }
  gates.push_back(gate);
  for (std::size_t i = 1; i < sleeve.size(); ++i) {
    const Index entered = surface.corner_of(sleeve[i], gate.left_vertex); // the side runs from left to right here
    const Index third = surface.corners(sleeve[i])[at((entered + 2) % 3)];
    const Vec2 place = beyond(gate, third);
    if (i + 1 == sleeve.size()) {
      gates.push_back({third, third, place, place});
    } else if (surface.has(sleeve[i + 1], gate.left_vertex)) {
      gate.right_vertex = third;
      gate.right = place;
      gates.push_back(gate);
    } else {
      gate.left_vertex = third;
      gate.left = place;
      gates.push_back(gate);
    }
  }
  return gates;
}

// Where a line touches the end of a gate.
struct Touch {
  std::size_t gate;
  bool left;
};

// The shortest way through unfolded gates from the origin to the last one, by the ends it touches. Lee and Preparata
// 1984, in the form that restarts at each touch.
std::vector<Touch> funnel(const std::vector<Gate>& gates) {
  std::vector<Touch> touches;
  Vec2 apex = Vec2::Zero();
  Vec2 right = apex;
  Vec2 left = apex;
  std::size_t right_gate = 0;
  std::size_t left_gate = 0;
  const auto restart = [&](const Vec2& at, std::size_t gate, bool on_left) {
    touches.push_back({gate, on_left});
    apex = right = left = at;
    right_gate = left_gate = gate;
    return gate + 1;
  };
  for (std::size_t i = 0; i < gates.size();) {
    const Vec2& new_right = gates[i].right;
    const Vec2& new_left = gates[i].left;
    // a gate at the apex is passed there
    const bool fresh_right = right == apex || new_right == apex || new_left == apex;
    const bool fresh_left = left == apex || new_right == apex || new_left == apex;
    if (fresh_right || cross(right - apex, new_right - apex) >= 0) {
      if (!fresh_right && !fresh_left && cross(left - apex, new_right - apex) > 0) {
        i = restart(left, left_gate, true);
        continue;
      }
      right = new_right;
      right_gate = i;
    }
    if (fresh_left || cross(left - apex, new_left - apex) <= 0) {
      if (!fresh_right && !fresh_left && cross(right - apex, new_left - apex) < 0) {
        i = restart(right, right_gate, false);
        continue;
      }
      left = new_left;
      left_gate = i;
    }
    ++i;
  }
  return touches;
}

// The shortest way through a sleeve.
struct Shortest {
  std::vector<Gate> gates;
  std::vector<Touch> touches;
  std::vector<Vec2> places; // unfolded: the start, the touches, the end
  double length = 0;
};

Shortest shortest_in(const Surface& surface, Index from, Index to, const Sleeve& sleeve) {
  Shortest way;
  way.gates = unfolded(surface, from, to, sleeve);
  way.touches = funnel(way.gates);
  way.places.emplace_back(Vec2::Zero());
  for (const Touch& touch : way.touches)
    way.places.push_back(touch.left ? way.gates[touch.gate].left : way.gates[touch.gate].right);
  way.places.push_back(way.gates.back().left);
  for (std::size_t k = 0; k + 1 < way.places.size(); ++k) way.length += (way.places[k + 1] - way.places[k]).norm();
  return way;
}

// Leads the sleeve around the other side of a vertex that lies to its left or right; not beyond the boundary.
bool flip(const Surface& surface, Sleeve& sleeve, Index vertex, bool left) {
  const auto touches = [&](Index t) { return surface.has(t, vertex); };
  const auto first = std::find_if(sleeve.begin(), sleeve.end(), touches);
  if (first == sleeve.end()) return false;
  const auto last = std::find_if(sleeve.rbegin(), sleeve.rend(), touches).base() - 1;
  Sleeve around = {*first};
  while (around.back() != *last) {
    const Index t = surface.turned(around.back(), vertex, !left);
    if (t == none) return false;
    around.push_back(t);
  }
  const auto place = sleeve.erase(first, last + 1);
  sleeve.insert(place, around.begin(), around.end());
  return true;
}

// Flips the sleeve at every vertex where the other side is shorter: where the angle there is less than pi.
bool flip_bends(const Surface& surface, Index from, Index to, const Shortest& way, Sleeve& sleeve) {
  constexpr double straight = 1e-9;
  bool any = false;
  for (std::size_t k = 0; k < way.touches.size(); ++k) {
    const auto& [gate, left] = way.touches[k];
    const Index vertex = left ? way.gates[gate].left_vertex : way.gates[gate].right_vertex;
    const auto triangle = std::find_if(sleeve.begin(), sleeve.end(), [&](Index t) { return surface.has(t, vertex); });
    if (triangle == sleeve.end()) continue;
    const Vec2 before = way.places[k + 1] - way.places[k];
    const Vec2 after = way.places[k + 2] - way.places[k + 1];
    const double turn = std::abs(std::atan2(cross(before, after), before.dot(after)));
    const double other_side = surface.angle_around(*triangle, vertex) - std::numbers::pi - turn;
    if (other_side < std::numbers::pi - straight && flip(surface, sleeve, vertex, left)) {
      tidy(surface, from, to, sleeve);
      any = true;
    }
  }
  return any;
}

// The way on the surface: the points where it crosses the gates.
Path folded(const Surface& surface, Index from, Index to, const Shortest& way) {
  Path path;
  path.points.push_back(surface.point(from));
  const double scale = way.length;
  const auto add = [&](const Vec3& point) {
    const double step = (point - path.points.back()).norm();
    if (step <= 1e-12 * scale) return;
    path.length += step;
    path.points.push_back(point);
  };
  std::size_t leg = 0;
  for (std::size_t i = 0; i + 1 < way.gates.size(); ++i) {
    const Gate& gate = way.gates[i];
    const Vec2 along = way.places[leg + 1] - way.places[leg];
    const Vec2 side = gate.left - gate.right;
    const double slope = cross(along, side);
    if (std::abs(slope) > 1e-14 * along.norm() * side.norm()) { // else it runs along the gate
      const double part = std::clamp(cross(along, way.places[leg] - gate.right) / slope, 0.0, 1.0);
      add((1 - part) * surface.point(gate.right_vertex) + part * surface.point(gate.left_vertex));
    }
    while (leg < way.touches.size() && way.touches[leg].gate == i) {
      add(surface.point(way.touches[leg].left ? gate.left_vertex : gate.right_vertex));
      ++leg;
    }
  }
  add(surface.point(to));
  return path;
}

} // namespace

Path relaxed(const Triangulation& triangulation, Index from, Index to, const std::vector<base::Vec2>& start) {
  const Surface surface(triangulation);
  Sleeve sleeve = sleeve_below(triangulation, surface, from, to, start);
  Shortest way = shortest_in(surface, from, to, sleeve);
  // every round shortens the way; rounding ends it where that is not so
  while (flip_bends(surface, from, to, way, sleeve)) {
    Shortest next = shortest_in(surface, from, to, sleeve);
    if (!(next.length < way.length * (1 - 1e-15))) break;
    way = std::move(next);
  }
  return folded(surface, from, to, way);
}

} // namespace pneuma::geometry::geodesics
