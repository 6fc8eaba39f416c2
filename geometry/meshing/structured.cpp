// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/structured.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/meshing/divisions.h"

namespace pneuma::geometry::meshing {

namespace {

// Adds the quadrilateral a b c d, or its two triangles divided along a-c or b-d.
void add_cell(CornerMesh& mesh, Index a, Index b, Index c, Index d, bool along_ac) {
  if (mesh.corners == 4) {
    mesh.cells.insert(mesh.cells.end(), {a, b, c, d});
  } else if (along_ac) {
    mesh.cells.insert(mesh.cells.end(), {a, b, c, a, c, d});
  } else {
    mesh.cells.insert(mesh.cells.end(), {a, b, d, b, c, d});
  }
}

// Adds an n x m grid of cells; node(i, j) is the number of a grid point. Diagonals alternate: for even divisions the
// pattern is symmetric, and it is the same everywhere (where diagonals of one direction meet those of another along a
// line, linear elements lose a logarithm of the mesh size in their point values). At a corner the diagonal starts in
// it, so that no triangle is held at all three points.
template <class Node>
void add_grid(CornerMesh& mesh, int n, int m, Node&& node) {
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const bool corner = (i == 0 || i == n - 1) && (j == 0 || j == m - 1);
      const bool rising = corner ? (i == 0) == (j == 0) : (i + j) % 2 == 0;
      add_cell(mesh, node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1), rising);
    }
  }
}

CornerMesh mesh_rectangle(const Rectangle& plan, const MeshOptions& options) {
  const auto [n, m] = divisions_of(plan, options);
  CornerMesh mesh;
  mesh.corners = corners_per_element(options.element);
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i)
      mesh.points.emplace_back(plan.length * (2 * i - n) / (2.0 * n), plan.width * (2 * j - m) / (2.0 * m));
  }
  const auto node = [columns = n + 1](int i, int j) { return static_cast<Index>(j * columns + i); };
  add_grid(mesh, n, m, node);

  mesh.edges.resize(4);
  for (int i = 0; i <= n; ++i) mesh.edges[0].push_back(node(i, 0));
  for (int j = 0; j <= m; ++j) mesh.edges[1].push_back(node(n, j));
  for (int i = n; i >= 0; --i) mesh.edges[2].push_back(node(i, m));
  for (int j = m; j >= 0; --j) mesh.edges[3].push_back(node(0, j));
  return mesh;
}

// Half of the core's east side at t in [0, 1] from the x axis to the corner, for radius 1, mirrored for t < 0: between
// a square and a circle, so that about 120 degrees lie between all three edges at a corner of the core.
constexpr double core_corner = 0.6;
constexpr double core_bulge = 0.32;
Vec2 core_side(double t) {
  const double angle = t * std::numbers::pi / 4;
  const double half = core_corner / std::numbers::sqrt2;
  return (1 - core_bulge) * Vec2(half, half * t) + core_bulge * core_corner * Vec2(std::cos(angle), std::sin(angle));
}

// anticlockwise by a number of right angles
Vec2 turned(Vec2 p, int quarters) {
  for (int q = 0; q < quarters; ++q) p = Vec2(-p.y(), p.x());
  return p;
}

CornerMesh mesh_circle(const Circle& plan, const MeshOptions& options) {
  const auto [n, rings] = divisions_of(plan, options);
  CornerMesh mesh;
  mesh.corners = corners_per_element(options.element);

  // the core: Coons' patch of its four sides, which are turned copies of one
  const double corner = core_side(1).x();
  const auto along = [n = n](int i) { return static_cast<double>(2 * i - n) / n; };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double u = along(i);
      const double v = along(j);
      const Vec2 at_u = core_side(u);
      const Vec2 at_v = core_side(v);
      mesh.points.emplace_back(plan.radius * (u * at_v.x() + at_u.y() - u * corner),
                               plan.radius * (v * at_u.x() + at_v.y() - v * corner));
    }
  }
  const auto core = [columns = n + 1](int i, int j) { return static_cast<Index>(j * columns + i); };
  add_grid(mesh, n, n, core);

  // the rings: lines from the core's outline to the rim; ring 0 is the outline, counterclockwise from its lower right
  const auto around = [n = n](int p) { return std::pair(p / n % 4, p % n); };
  const auto first = static_cast<Index>(mesh.points.size());
  for (int ring = 1; ring <= rings; ++ring) {
    const double outward = static_cast<double>(ring) / rings;
    for (int p = 0; p < 4 * n; ++p) {
      const auto [quarter, i] = around(p);
      const double angle = along(i) * std::numbers::pi / 4;
      const Vec2 rim(std::cos(angle), std::sin(angle));
      const Vec2 inner = core_side(along(i));
      const Vec2 point = ring == rings ? rim : Vec2(inner + outward * (rim - inner));
      mesh.points.push_back(plan.radius * turned(point, quarter));
    }
  }
  const auto node = [&, n = n](int ring, int p) {
    if (ring > 0) return first + (ring - 1) * 4 * n + p % (4 * n);
    const auto [quarter, i] = around(p);
    return quarter == 0 ? core(n, i) : quarter == 1 ? core(n - i, n) : quarter == 2 ? core(0, n - i) : core(i, 0);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int p = 0; p < 4 * n; ++p) {
      add_cell(mesh, node(ring, p), node(ring + 1, p), node(ring + 1, p + 1), node(ring, p + 1), (ring + p) % 2 == 0);
    }
  }
  mesh.edges.resize(1);
  for (int p = 0; p < 4 * n; ++p) mesh.edges[0].push_back(node(rings, p));
  return mesh;
}

// Similar triangles; point (i, j) is i steps along the first side and j along the last.
CornerMesh triangles_in_triangle(const Triangle& plan, int n) {
  const auto& p = plan.points;
  CornerMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n - j; ++i) mesh.points.push_back(((n - i - j) * p[0] + i * p[1] + j * p[2]) / n);
  }
  const auto node = [n](int i, int j) { return static_cast<Index>(j * (n + 1) - j * (j - 1) / 2 + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n - j; ++i) {
      mesh.cells.insert(mesh.cells.end(), {node(i, j), node(i + 1, j), node(i, j + 1)});
      if (i + j < n - 1) mesh.cells.insert(mesh.cells.end(), {node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  }
  mesh.edges.resize(3);
  for (int i = 0; i <= n; ++i) {
    mesh.edges[0].push_back(node(i, 0));
    mesh.edges[1].push_back(node(n - i, i));
    mesh.edges[2].push_back(node(0, n - i));
  }
  release_rim(mesh); // the corner triangles are held at all three points
  return mesh;
}

// Three blocks of h x h quadrilaterals, each between a corner, the middles of its sides, and the centroid.
CornerMesh quadrilaterals_in_triangle(const Triangle& plan, int h) {
  CornerMesh mesh;
  mesh.corners = 4;
  const Vec2 centroid = (plan.points[0] + plan.points[1] + plan.points[2]) / 3;
  // Numbers: the sides with 2h points each, then three lines from the middle of a side to the centroid with h - 1
  // points each, the centroid, and the insides of the blocks.
  const int sides = 6 * h;
  const int centre = sides + 3 * (h - 1);
  const auto side = [&](int k, int i) { return static_cast<Index>((k * 2 * h + i + sides) % sides); };
  const auto spoke = [&](int k, int i) { // i = 0: middle of side k; i = h: centroid
    return static_cast<Index>(i == 0 ? side(k, h) : i == h ? centre : sides + k * (h - 1) + i - 1);
  };
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 2 * h; ++i)
      mesh.points.push_back(((2 * h - i) * plan.points[k] + i * plan.points[(k + 1) % 3]) / (2 * h));
  }
  for (int k = 0; k < 3; ++k) {
    const Vec2 middle = (plan.points[k] + plan.points[(k + 1) % 3]) / 2;
    for (int i = 1; i < h; ++i) mesh.points.push_back(((h - i) * middle + i * centroid) / h);
  }
  mesh.points.push_back(centroid);
  for (int k = 0; k < 3; ++k) {
    const int before = (k + 2) % 3; // the side that ends in corner k
    const auto first_inside = static_cast<Index>(mesh.points.size());
    const Vec2 corner = plan.points[k];
    const Vec2 next = (corner + plan.points[(k + 1) % 3]) / 2;
    const Vec2 last = (corner + plan.points[before]) / 2;
    for (int j = 1; j < h; ++j) {
      for (int i = 1; i < h; ++i) {
        mesh.points.push_back(
            ((h - i) * (h - j) * corner + i * (h - j) * next + i * j * centroid + (h - i) * j * last) / (h * h));
      }
    }
    add_grid(mesh, h, h, [&](int i, int j) { // i along side k, j back along the side before
      if (j == 0) return side(k, i);
      if (i == 0) return side(before, 2 * h - j);
      if (i == h) return spoke(k, j);
      if (j == h) return spoke(before, i);
      return static_cast<Index>(first_inside + (j - 1) * (h - 1) + i - 1);
    });
  }
  mesh.edges.resize(3);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i <= 2 * h; ++i) mesh.edges[static_cast<std::size_t>(k)].push_back(side(k, i));
  }
  return mesh;
}

CornerMesh mesh_triangle(const Triangle& plan, const MeshOptions& options) {
  const int n = divisions_of(plan, options)[0];
  const bool triangles = corners_per_element(options.element) == 3;
  if (!triangles && n % 2 != 0) {
    throw base::InputError(fmt::format("mesh divisions {}: quadrilaterals on a triangular plan need an even number of "
                                       "divisions per side, such as {}",
                                       n, n + 1));
  }
  return triangles ? triangles_in_triangle(plan, n) : quadrilaterals_in_triangle(plan, n / 2);
}

} // namespace

CornerMesh structured_mesh(const Plan& plan, const MeshOptions& options) {
  if (const auto* rectangle = std::get_if<Rectangle>(&plan)) return mesh_rectangle(*rectangle, options);
  if (const auto* circle = std::get_if<Circle>(&plan)) return mesh_circle(*circle, options);
  return mesh_triangle(std::get<Triangle>(plan), options);
}

} // namespace pneuma::geometry::meshing
