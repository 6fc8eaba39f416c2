// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/flattening/parameterization.h"

#include <cmath>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>
#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"

namespace pneuma::geometry::flattening {

namespace {

namespace parameterization = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Plane = SurfaceMesh::Property_map<SurfaceMesh::Vertex_index, Kernel::Point_2>;

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a;
  const Vec2 v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

// To the surface's own area, the centre of area to the origin.
void scale_and_centre(const Triangulation& surface, std::vector<Vec2>& plane) {
  double wanted = 0;
  double area = 0;
  Vec2 moment = Vec2::Zero();
  for (const auto& [i, j, k] : surface.triangles) {
    const auto x = [&](Index n) -> const Vec3& { return surface.points[static_cast<std::size_t>(n)]; };
    const auto p = [&](Index n) -> const Vec2& { return plane[static_cast<std::size_t>(n)]; };
    wanted += (x(j) - x(i)).cross(x(k) - x(i)).norm() / 2;
    const double flat = turn(p(i), p(j), p(k)) / 2;
    if (!(flat > 0)) {
      throw base::GeometryError(fmt::format("flattening turned a triangle over at {} m: the strip "
                                            "is too strongly curved; take more strips",
                                            base::place_text(x(i))));
    }
    area += flat;
    moment += flat / 3 * (p(i) + p(j) + p(k));
  }
  const Vec2 centre = moment / area;
  const double scale = std::sqrt(wanted / area);
  for (Vec2& point : plane) point = scale * (point - centre);
}

} // namespace

std::vector<Vec2> conformal(const Triangulation& surface) {
  SurfaceMesh mesh;
  for (const Vec3& x : surface.points) mesh.add_vertex({x.x(), x.y(), x.z()});
  const auto vertex = [](Index i) { return SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(i)); };
  for (const auto& [i, j, k] : surface.triangles) mesh.add_face(vertex(i), vertex(j), vertex(k));
  SurfaceMesh::Halfedge_index boundary;
  for (const SurfaceMesh::Halfedge_index h : mesh.halfedges()) {
    if (!mesh.is_border(h)) continue;
    boundary = h;
    break;
  }
  if (!boundary.is_valid()) throw base::GeometryError("no flattening of a surface without a boundary");
  Plane plane = mesh.add_property_map<SurfaceMesh::Vertex_index, Kernel::Point_2>("plane").first;
  const parameterization::Error_code code =
      parameterization::parameterize(mesh, parameterization::LSCM_parameterizer_3<SurfaceMesh>(), boundary, plane);
  if (code != parameterization::OK) {
    throw base::GeometryError(fmt::format("no flattening of a strip of {} triangles: {}", surface.triangles.size(),
                                          parameterization::get_error_message(code)));
  }
  std::vector<Vec2> result;
  result.reserve(surface.points.size());
  for (const SurfaceMesh::Vertex_index v : mesh.vertices()) result.emplace_back(plane[v].x(), plane[v].y());
  scale_and_centre(surface, result);
  return result;
}

} // namespace pneuma::geometry::flattening
