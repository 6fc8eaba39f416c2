// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/flat_foil.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/flattening/parameterization.h"
#include "geometry/flattening/rotation.h"
#include "geometry/strips/strip_surface.h"
#include "solver/material/prestress.h"

namespace pneuma::stages::pattern {

namespace {

namespace flattening = solver::flattening;
namespace strips = geometry::strips;
using base::Mat2;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Every strip by itself: conformal, laid over its plan turned so that the roll direction is x.
std::vector<Vec2> conformal_start(const flattening::FlatNodes& nodes, const flattening::Problem& problem,
                                  std::span<const Index> strip_of_element, Index count, double direction) {
  const Eigen::Rotation2Dd turn(-direction);
  std::vector<Vec2> start(nodes.node.size());
  for (Index strip = 0; strip < count; ++strip) {
    const strips::StripSurface piece =
        strips::strip_surface(problem.element, nodes.connectivity, strip_of_element, strip, problem.form);
    std::vector<Vec2> plan;
    for (const Vec3& x : piece.surface.points) plan.emplace_back(turn * x.head<2>());
    const std::vector<Vec2> flat =
        geometry::flattening::laid_over(geometry::flattening::conformal(piece.surface), plan);
    for (std::size_t i = 0; i < flat.size(); ++i) start[at(piece.nodes[i])] = flat[i];
  }
  return start;
}

// That no triangle between nodes was turned over, mid-side nodes included.
void check_unfolded(const flattening::FlatNodes& nodes, const flattening::Problem& problem,
                    std::span<const Index> strip_of_element, Index count, std::span<const Vec2> points) {
  for (Index strip = 0; strip < count; ++strip) {
    const strips::StripSurface piece =
        strips::strip_surface(problem.element, nodes.connectivity, strip_of_element, strip, problem.form);
    for (const auto& [i, j, k] : piece.surface.triangles) {
      const Vec2& a = points[at(piece.nodes[at(i)])];
      const Vec2 u = points[at(piece.nodes[at(j)])] - a;
      const Vec2 v = points[at(piece.nodes[at(k)])] - a;
      if (u.x() * v.y() - u.y() * v.x() > 0) continue;
      const Vec3& x = piece.surface.points[at(i)];
      throw base::GeometryError(fmt::format("laid flat, strip {} folds over at {} m: take "
                                            "narrower strips or smaller elements",
                                            strip + 1, base::place_text(x)));
    }
  }
}

using FlatOf = std::map<std::pair<Index, Index>, Index>; // (strip, node of the mesh) -> flat node

struct Segment {
  Vec3 from, to; // on the form
};

// The clamped edges of the foil.
std::vector<Segment> clamped_segments(const geometry::Mesh& mesh) {
  std::vector<Segment> all;
  for (const geometry::Edge& edge : mesh.edges) {
    for (std::size_t i = 0; i + 1 < edge.nodes.size() + (edge.closed ? 1 : 0); ++i) {
      all.push_back({mesh.nodes[at(edge.nodes[i])], mesh.nodes[at(edge.nodes[(i + 1) % edge.nodes.size()])]});
    }
  }
  return all;
}

double distance(const Segment& segment, const Vec3& x) {
  const Vec3 along = segment.to - segment.from;
  const double t = std::clamp((x - segment.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (x - segment.from - t * along).norm();
}

// The wanted stretch at every stress point; near clamped edges its part along the edge fades out, since the frame does
// not stretch.
std::vector<double> stretch_field(const geometry::Mesh& mesh, const geometry::Block& block, std::size_t per_element,
                                  const Wanted& wanted) {
  std::vector<double> field;
  const bool fades = wanted.decompensation > 0;
  const std::vector<Segment> segments = fades ? clamped_segments(mesh) : std::vector<Segment>();
  const Eigen::Rotation2Dd turn(-wanted.direction); // strips lie over their plan, the roll along x
  for (Index e = 0; e < mesh.element_count(block); ++e) {
    Vec3 g = wanted.stretch;
    if (fades) {
      Vec3 centre = Vec3::Zero();
      const std::span<const Index> nodes = mesh.element_nodes(block, e);
      for (const Index node : nodes) centre += mesh.nodes[at(node)] / static_cast<double>(nodes.size());
      double nearest = std::numeric_limits<double>::infinity();
      Vec2 t = Vec2::UnitX();
      for (const Segment& segment : segments) {
        const double d = distance(segment, centre);
        if (d >= nearest) continue;
        nearest = d;
        t = turn * (segment.to - segment.from).head<2>().normalized();
      }
      const double part = std::max(0.0, 1 - nearest / wanted.decompensation);
      const double along = (g[0] - 1) * t.x() * t.x() + (g[1] - 1) * t.y() * t.y() + 2 * g[2] * t.x() * t.y();
      g -= part * along * Vec3(t.x() * t.x(), t.y() * t.y(), t.x() * t.y());
    }
    for (std::size_t k = 0; k < per_element; ++k) field.insert(field.end(), {g[0], g[1], g[2]});
  }
  return field;
}

// A side through corners and mid-side nodes with two more points an element: its sides are parabolas.
std::vector<Vec2> along_parabolas(const std::vector<Vec2>& nodes) {
  std::vector<Vec2> points{nodes.front()};
  for (std::size_t k = 0; k + 2 < nodes.size(); k += 2) {
    const Vec2 &a = nodes[k], &b = nodes[k + 1], &c = nodes[k + 2];
    points.emplace_back(0.375 * a + 0.75 * b - 0.125 * c);
    points.push_back(b);
    points.emplace_back(-0.125 * a + 0.75 * b + 0.375 * c);
    points.push_back(c);
  }
  return points;
}

std::vector<Index> flat_of(const FlatOf& flat, Index strip, std::span<const Index> nodes) {
  std::vector<Index> result;
  for (const Index node : nodes) result.push_back(flat.at({strip, node}));
  return result;
}

} // namespace

std::optional<ElasticStretch> elastic_stretch(const solver::material::Law& law, double thickness, double prestress) {
  const auto g = solver::material::predeformation(law, thickness, Vec3(prestress, prestress, 0));
  if (!g) return std::nullopt;
  solver::material::Batch batch;
  batch.count = 1;
  Mat2 stretch;
  stretch << (*g)[0], (*g)[2], (*g)[2], (*g)[1];
  const Mat2 c = stretch * stretch;
  batch.strain[0] = Vec3(0.5 * (c(0, 0) - 1), 0.5 * (c(1, 1) - 1), c(0, 1));
  std::vector<double> history(at(solver::material::history_components(law)), 0.0);
  std::vector<double> unused = history;
  batch.old_history = history.data();
  batch.new_history = unused.data();
  if (solver::material::evaluate(law, batch) >= 0) return std::nullopt;
  const Mat3 d = batch.response[0].tangent;
  return ElasticStretch{*g, d.transpose() * Vec3(1, 1, 2).asDiagonal() * d};
}

FlatFoil flatten_foil(const geometry::Mesh& mesh, Index block, geometry::StressRule rule, const strips::CutFoil& cut,
                      const Wanted& wanted) {
  const geometry::Block& b = mesh.blocks[at(block)];
  FlatFoil foil;
  foil.nodes = flattening::flat_nodes(mesh.element, b.connectivity, cut.strip_of_element, cut.strips);
  FlatOf flat;
  for (std::size_t i = 0; i < foil.nodes.node.size(); ++i) {
    flat[{foil.nodes.strip[i], foil.nodes.node[i]}] = static_cast<Index>(i);
  }
  std::vector<std::vector<Index>> seam_nodes;
  for (const strips::Seam& seam : cut.seams) seam_nodes.push_back(seam.nodes);
  for (Index strip = 0; strip < cut.strips; ++strip) {
    foil.sides.push_back(strips::sides_of(mesh, b, cut.strip_of_element, strip, seam_nodes));
    auto& flat_sides = foil.flat_sides.emplace_back();
    for (const strips::StripSide& side : foil.sides.back()) flat_sides.push_back(flat_of(flat, strip, side.nodes));
  }

  flattening::Problem problem;
  problem.element = mesh.element;
  problem.rule = rule;
  problem.nodes = &foil.nodes;
  for (const Index node : foil.nodes.node) problem.form.push_back(mesh.nodes[at(node)]);
  problem.weight = wanted.weight;
  const std::vector<Vec2> start =
      conformal_start(foil.nodes, problem, cut.strip_of_element, cut.strips, wanted.direction);
  foil.wanted = stretch_field(mesh, b, geometry::stress_rule(mesh.element, rule).size(), wanted);
  problem.stretch = foil.wanted;
  for (const strips::Seam& seam : cut.seams) {
    if (!wanted.tied) break;
    const std::vector<Index> left = flat_of(flat, seam.left, seam.nodes);
    const std::vector<Index> right = flat_of(flat, seam.right, seam.nodes);
    for (std::size_t k = 0; k + 1 < left.size(); ++k) {
      problem.ties.push_back({{left[k], left[k + 1]}, {right[k], right[k + 1]}});
    }
  }
  if (wanted.decompensation > 0) {
    for (std::size_t s = 0; s < foil.sides.size(); ++s) {
      for (std::size_t k = 0; k < foil.sides[s].size(); ++k) {
        if (foil.sides[s][k].edge < 0) continue;
        const std::vector<Index>& nodes = foil.flat_sides[s][k];
        for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
          const double length = (problem.form[at(nodes[i + 1])] - problem.form[at(nodes[i])]).norm();
          problem.ties.push_back({{nodes[i], nodes[i + 1]}, {-1, -1}, length});
        }
      }
    }
  }
  foil.flat = flattening::flatten(problem, start, wanted.options);
  check_unfolded(foil.nodes, problem, cut.strip_of_element, cut.strips, foil.flat.points);
  foil.stretches = flattening::stretches(problem, foil.flat.points);
  return foil;
}

std::vector<double> corner_coordinates(const FlatFoil& foil) {
  std::vector<double> coordinates;
  coordinates.reserve(foil.nodes.connectivity.size() * 3);
  for (const Index node : foil.nodes.connectivity) {
    const Vec2& x = foil.flat.points[at(node)];
    coordinates.insert(coordinates.end(), {x.x(), x.y(), 0.0});
  }
  return coordinates;
}

std::string strip_name(const std::string& foil, Index strip) {
  return fmt::format("{}-{}", foil, strip + 1);
}

std::string seam_name(Index seam) {
  return fmt::format("S{}", seam + 1);
}

std::vector<geometry::fabrication::FlatStrip> outlines(const FlatFoil& foil, const geometry::Mesh& mesh, Index block) {
  const std::string& name = mesh.blocks[at(block)].name;
  std::vector<geometry::fabrication::FlatStrip> result;
  for (std::size_t s = 0; s < foil.sides.size(); ++s) {
    geometry::fabrication::FlatStrip strip;
    strip.name = strip_name(name, static_cast<Index>(s));
    for (std::size_t k = 0; k < foil.sides[s].size(); ++k) {
      const strips::StripSide& side = foil.sides[s][k];
      geometry::fabrication::Side out;
      if (side.seam >= 0) {
        out.name = seam_name(side.seam);
        out.seam = true;
        out.reversed = side.reversed;
      } else if (side.edge >= 0) {
        out.name = mesh.edges[at(side.edge)].name;
      }
      for (const Index node : foil.flat_sides[s][k]) out.points.push_back(foil.flat.points[at(node)]);
      if (side.edge >= 0 && geometry::is_quadratic(mesh.element)) out.points = along_parabolas(out.points);
      strip.sides.push_back(std::move(out));
    }
    result.push_back(std::move(strip));
  }
  return result;
}

} // namespace pneuma::stages::pattern
