// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/geodesics/geodesics.h"
#include "geometry/meshing/fill.h"
#include "geometry/polygon.h"
#include "geometry/rim.h"
#include "geometry/strips/track.h"

namespace pneuma::geometry::strips {

namespace {

using base::GeometryError;

constexpr double most_triangles = 1500; // of the coarse copy: the exact search takes some hundredths of a second

constexpr double longest = 1e-5; // by how much a line may be longer than the shortest on the triangles, relative

double mean_side(const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  const auto corners = static_cast<std::size_t>(corners_per_element(mesh.element));
  double sum = 0;
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    const auto nodes = mesh.element_nodes(block, e);
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec3 side =
          positions[static_cast<std::size_t>(nodes[(k + 1) % corners])] - positions[static_cast<std::size_t>(nodes[k])];
      sum += side.head<2>().norm();
    }
  }
  return sum / (static_cast<double>(mesh.element_count(block)) * static_cast<double>(corners));
}

// The plan's outline as a polygon with sides of about `size`.
std::vector<Vec2> ring(const Plan& plan, double size) {
  std::vector<Vec2> points;
  std::vector<double> corners = rim_corners(plan);
  corners.push_back(perimeter(plan));
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const double length = corners[k + 1] - corners[k];
    const int parts = std::max(static_cast<int>(std::round(length / size)), 2);
    for (int i = 0; i < parts; ++i) points.push_back(rim_point(plan, corners[k] + length * i / parts));
  }
  return points;
}

Triangulation coarse_copy(const Plan& plan, const Chart& chart) {
  // equilateral triangles, and some to spare: gmsh makes more than these
  const double size = std::sqrt(area(plan) / (0.7 * most_triangles * std::sqrt(3.0) / 4));
  const std::vector<Vec2> rim = ring(plan, size);
  meshing::Filling filling = meshing::fill(rim, false);
  Triangulation coarse;
  for (const Vec2& point : filling.points) {
    const bool on_rim = coarse.points.size() < rim.size();
    coarse.points.push_back(on_rim ? Vec3(point.x(), point.y(), 0) : chart.lift(point));
  }
  coarse.triangles = std::move(filling.triangles);
  return coarse;
}

// The open sides of a surface, which can be divided.
class Boundary {
public:
  explicit Boundary(Triangulation& surface) : surface_(surface) {
    std::unordered_map<std::uint64_t, int> uses;
    uses.reserve(2 * surface.triangles.size());
    const auto each_side = [&](auto&& visit) {
      for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
          visit(side_key(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]), t, k);
      }
    };
    each_side([&](std::uint64_t key, std::size_t, std::size_t) { ++uses[key]; });
    each_side([&](std::uint64_t key, std::size_t t, std::size_t k) {
      if (uses[key] == 1) sides_.push_back({t, k});
    });
  }

  // Number of the vertex at a point of the boundary, made by dividing the side beside it. The point may lie off a
  // side that is the chord of a curved rim.
  Index vertex_at(const Vec3& point) {
    constexpr double same = 1e-6; // of the side
    const Vec2 place = point.head<2>();
    std::size_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const auto [a, b] = ends(sides_[s]);
      const Vec2 start = surface_.points[static_cast<std::size_t>(a)].head<2>();
      const Vec2 along = surface_.points[static_cast<std::size_t>(b)].head<2>() - start;
      const double part = std::clamp((place - start).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const double away = (start + part * along - place).norm();
      if (away >= distance) continue;
      distance = away;
      nearest = s;
    }
    const Side side = sides_[nearest];
    const auto [a, b] = ends(side);
    const Vec2 start = surface_.points[static_cast<std::size_t>(a)].head<2>();
    const Vec2 end = surface_.points[static_cast<std::size_t>(b)].head<2>();
    if ((place - start).norm() <= same * (end - start).norm()) return a;
    if ((place - end).norm() <= same * (end - start).norm()) return b;

    const auto middle = static_cast<Index>(surface_.points.size());
    surface_.points.push_back(point);
    std::array<Index, 3> second = surface_.triangles[side.triangle];
    second[side.corner] = middle;
    surface_.triangles[side.triangle][(side.corner + 1) % 3] = middle;
    sides_.push_back({surface_.triangles.size(), side.corner});
    surface_.triangles.push_back(second);
    // another side of the triangle that went to its second half may be open too
    for (Side& other : sides_) {
      if (other.triangle == side.triangle && other.corner == (side.corner + 1) % 3)
        other.triangle = surface_.triangles.size() - 1;
    }
    return middle;
  }

private:
  struct Side {
    std::size_t triangle, corner;
  };
  std::pair<Index, Index> ends(const Side& side) const {
    const auto& corners = surface_.triangles[side.triangle];
    return {corners[side.corner], corners[(side.corner + 1) % 3]};
  }

  Triangulation& surface_;
  std::vector<Side> sides_;
};

// A copy of a surface with vertices at two points of the rim.
struct WithEnds {
  Triangulation surface;
  Index from, to;
};

WithEnds with_ends(const Triangulation& surface, const Vec2& from, const Vec2& to) {
  WithEnds result{surface, 0, 0};
  Boundary boundary(result.surface);
  result.from = boundary.vertex_at({from.x(), from.y(), 0});
  result.to = boundary.vertex_at({to.x(), to.y(), 0});
  return result;
}

std::vector<Vec2> in_plan(const geodesics::Path& path) {
  std::vector<Vec2> plan;
  plan.reserve(path.points.size());
  for (const Vec3& point : path.points) plan.emplace_back(point.head<2>());
  return plan;
}

// Points at equal parts of a polyline's length.
std::vector<Vec2> at_equal_parts(std::span<const Vec2> line, int parts) {
  std::vector<double> run{0};
  for (std::size_t k = 0; k + 1 < line.size(); ++k) run.push_back(run.back() + (line[k + 1] - line[k]).norm());
  std::vector<Vec2> points;
  std::size_t piece = 0;
  for (int i = 0; i <= parts; ++i) {
    const double wanted = run.back() * i / parts;
    while (piece + 2 < run.size() && run[piece + 1] < wanted) ++piece;
    const double length = run[piece + 1] - run[piece];
    const double part = length > 0 ? (wanted - run[piece]) / length : 0;
    points.push_back(line[piece] + std::clamp(part, 0.0, 1.0) * (line[piece + 1] - line[piece]));
  }
  return points;
}

// A line bent to the left by `offset` in the middle; empty where it would leave the plan.
std::vector<Vec2> beside(const Surface& surface, std::span<const Vec2> line, double offset) {
  constexpr int parts = 32;
  std::vector<Vec2> points = at_equal_parts(line, parts);
  const std::vector<Vec2> straight = points;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec2 along = (straight[i + 1] - straight[i - 1]).normalized();
    const double t = static_cast<double>(i) / parts;
    points[i] += std::min(1.0, 8 * t * (1 - t)) * offset * Vec2(-along.y(), along.x());
    if (!inside(surface.plan, points[i], 0)) return {};
  }
  return points;
}

CuttingLine between(const CuttingLine& left, const CuttingLine& right) {
  const int parts = static_cast<int>(std::max(left.plan.size(), right.plan.size()));
  CuttingLine line = left;
  line.plan = at_equal_parts(left.plan, parts);
  const std::vector<Vec2> other = at_equal_parts(right.plan, parts);
  for (std::size_t i = 0; i < line.plan.size(); ++i) line.plan[i] = (line.plan[i] + other[i]) / 2;
  line.plan.back() = left.plan.back();
  return line;
}

// Refuses lines that leave the plan or run along its rim; near their ends they may be as near as they like.
void check_inside(const Surface& surface, std::span<const Vec2> line) {
  double whole = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) whole += (line[k + 1] - line[k]).norm();
  if (!(whole > surface.size))
    throw GeometryError(fmt::format("the line at {} is shorter than an element", base::place_text(line[0])));
  // calls visit(place, length to the nearer end)
  const auto each_sample = [&](auto&& visit) {
    double run = 0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      const Vec2 along = line[k + 1] - line[k];
      const int parts = std::max(static_cast<int>(std::ceil(4 * along.norm() / surface.size)), 1);
      for (int i = 0; i < parts; ++i) {
        const double part = (i + 0.5) / parts;
        const double length = run + part * along.norm();
        visit(Vec2(line[k] + part * along), std::min(length, whole - length));
      }
      run += along.norm();
    }
  };
  each_sample([&](const Vec2& place, double) {
    if (inside(surface.plan, place, 1e-9 * whole)) return;
    throw GeometryError(fmt::format("the line from {} to {} leaves the plan at {}: move its ends, or divide the plan",
                                    base::place_text(line.front()), base::place_text(line.back()),
                                    base::place_text(place)));
  });
  const double free = std::min(surface.size, whole / 3); // length at the ends
  each_sample([&](const Vec2& place, double length) {
    const Vec2 rim = rim_point(surface.plan, rim_position(surface.plan, place));
    if (length <= free || (rim - place).norm() >= 0.05 * free) return;
    throw GeometryError(fmt::format("the line from {} to {} runs along the rim at {}: a line must join two different "
                                    "parts of the rim through the inside",
                                    base::place_text(line.front()), base::place_text(line.back()),
                                    base::place_text(place)));
  });
}

} // namespace

Surface prepare(const Plan& plan, const Mesh& mesh, const Block& block, std::span<const Vec3> positions) {
  Surface surface{plan, Chart(mesh, block, positions), {}, {}, mean_side(mesh, block, positions)};
  const double flat = 1e-6 * std::sqrt(area(plan));
  for (const Edge& edge : mesh.edges) {
    for (const Index i : edge.nodes) {
      const Vec3& x = positions[static_cast<std::size_t>(i)];
      if (std::abs(x.z()) > flat) {
        throw GeometryError(fmt::format("the rim leaves the plane z = 0 at {}: only plane rims "
                                        "can be cut",
                                        base::place_text(x)));
      }
    }
  }
  surface.fine = triangulated(mesh, block, positions, is_quadratic(mesh.element) ? 2 : 1);
  const bool few = static_cast<double>(surface.fine.triangles.size()) <= most_triangles;
  surface.coarse = few ? surface.fine : coarse_copy(plan, surface.chart);
  return surface;
}

CuttingLine geodesic_line(const Surface& surface, double from, double to) {
  const Vec2 start = rim_point(surface.plan, from);
  const Vec2 end = rim_point(surface.plan, to);
  if (!((end - start).norm() > surface.size))
    throw GeometryError(
        fmt::format("the ends of the line at {} are closer than an element's size", base::place_text(start)));
  const WithEnds coarse = with_ends(surface.coarse, start, end);
  const geodesics::Path guess = geodesics::shortest_path(coarse.surface, coarse.from, coarse.to);
  const WithEnds fine = with_ends(surface.fine, start, end);
  const auto relax = [&](const std::vector<Vec2>& near) {
    const geodesics::Path path = geodesics::relaxed(fine.surface, fine.from, fine.to, near);
    CuttingLine line{from, to, in_plan(path), path.length};
    line.plan.front() = start;
    line.plan.back() = end;
    return line;
  };
  // on the surface itself: curved elements are longer than their triangles by more than lines differ
  const auto measured = [&](CuttingLine line) {
    line.length = Track(surface.chart, line.plan, surface.size / 8).length();
    return line;
  };
  CuttingLine line = measured(relax(in_plan(guess)));
  // Triangles hold their curvature in their vertices, which a shortest line passes on one side: there is one on either
  // side of a row of vertices, half a row off. The line of the smooth surface lies between them.
  const auto left = beside(surface, line.plan, surface.size);
  const auto right = beside(surface, line.plan, -surface.size);
  if (!left.empty() && !right.empty()) {
    const CuttingLine middle = measured(between(relax(left), relax(right)));
    if (middle.length <= (1 + longest) * line.length) line = middle;
  }
  check_inside(surface, line.plan);
  return line;
}

CuttingLine straight_line(const Surface& surface, double from, double to) {
  CuttingLine line{from, to, {rim_point(surface.plan, from), rim_point(surface.plan, to)}, 0};
  check_inside(surface, line.plan);
  line.length = Track(surface.chart, line.plan, surface.size / 8).length();
  return line;
}

CuttingLine given_line(const Surface& surface, std::span<const Vec2> points) {
  if (points.size() < 2) throw GeometryError("a line needs two points at least");
  CuttingLine line{rim_position(surface.plan, points.front()),
                   rim_position(surface.plan, points.back()),
                   {points.begin(), points.end()},
                   0};
  const auto put_on_rim = [&](Vec2& point, double position) {
    const Vec2 rim = rim_point(surface.plan, position);
    const double away = (rim - point).norm();
    if (!(away <= surface.size / 10)) {
      throw GeometryError(
          fmt::format("the line's end {} lies {:.3g} m from the rim, farther than a tenth of an element "
                      "({:.3g} m): end it at {}",
                      base::place_text(point), away, surface.size / 10, base::place_text(rim)));
    }
    point = rim;
  };
  put_on_rim(line.plan.front(), line.from);
  put_on_rim(line.plan.back(), line.to);
  check_inside(surface, line.plan);
  const std::string itself = crossing({&line, 1});
  if (!itself.empty()) throw GeometryError(itself);
  line.length = Track(surface.chart, line.plan, surface.size / 8).length();
  return line;
}

std::string crossing(std::span<const CuttingLine> lines) {
  std::vector<std::span<const Vec2>> plans;
  for (const CuttingLine& line : lines) plans.emplace_back(line.plan);
  const auto found = crossing_lines(plans);
  if (!found) return {};
  if (found->first == found->second) {
    return fmt::format("line {} crosses itself near {}", found->first + 1, base::place_text(found->at));
  }
  return fmt::format("lines {} and {} cross or touch near {}", found->first + 1, found->second + 1,
                     base::place_text(found->at));
}

} // namespace pneuma::geometry::strips
