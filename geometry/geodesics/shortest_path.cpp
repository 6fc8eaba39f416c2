// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/geodesics/geodesics.h"

namespace pneuma::geometry::geodesics {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Search = CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Surface>>;
using Vertex = Surface::Vertex_index;

} // namespace

Path shortest_path(const Triangulation& surface, Index from, Index to) {
  Surface mesh;
  // vertices of triangles only: the search stumbles over isolated ones (CGAL issue 5280)
  std::vector<Vertex> vertices(surface.points.size(), Surface::null_vertex());
  const auto vertex = [&](Index i) {
    Vertex& v = vertices[static_cast<std::size_t>(i)];
    const Vec3& p = surface.points[static_cast<std::size_t>(i)];
    if (v == Surface::null_vertex()) v = mesh.add_vertex({p.x(), p.y(), p.z()});
    return v;
  };
  for (const auto& [a, b, c] : surface.triangles) {
    if (mesh.add_face(vertex(a), vertex(b), vertex(c)) == Surface::null_face()) {
      const Vec3& p = surface.points[static_cast<std::size_t>(a)];
      throw base::GeometryError(
          fmt::format("the surface is no manifold, or not oriented alike, at {}", base::place_text(p)));
    }
  }
  const auto end = [&](Index i) {
    const Vertex v = vertices[static_cast<std::size_t>(i)];
    if (v == Surface::null_vertex()) throw base::GeometryError(fmt::format("vertex {} is in no triangle", i));
    return v;
  };

  Search search(mesh);
  search.add_source_point(end(to)); // paths run towards the source
  Path path;
  std::vector<Kernel::Point_3> points;
  path.length = search.shortest_path_points_to_source_points(end(from), std::back_inserter(points)).first;
  if (path.length < 0) {
    const Vec3& a = surface.points[static_cast<std::size_t>(from)];
    const Vec3& b = surface.points[static_cast<std::size_t>(to)];
    throw base::GeometryError(
        fmt::format("no path on the surface leads from {} to {}", base::place_text(a), base::place_text(b)));
  }
  std::transform(points.begin(), points.end(), std::back_inserter(path.points),
                 [](const Kernel::Point_3& p) { return Vec3(p.x(), p.y(), p.z()); });
  return path;
}

} // namespace pneuma::geometry::geodesics
