// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/meshing/fill.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <string>
#include <unordered_map>

#include <fmt/format.h>
#include <gmsh.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/polygon.h"

// gmsh sets an option of windows that are never opened, and FLTK then writes its settings to the user's home and to
// /etc: Fl::option(Fl_Option, bool) is answered here instead.
extern "C" void set_fltk_option(int option, bool value) __asm__("_ZN2Fl6optionENS_9Fl_OptionEb");
extern "C" void set_fltk_option(int, bool) {}

namespace pneuma::geometry::meshing {

namespace {

// gmsh keeps one global state: one session at a time, without the user's settings, silent.
class Session {
public:
  Session() : lock_(mutex_) {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::option::setNumber("Mesh.Algorithm", 6); // 8, made for quadrilaterals, crashes in 4.8.4
    gmsh::logger::start();
  }
  ~Session() {
    try {
      gmsh::finalize();
    } catch (...) { // nothing is left to be done about it
    }
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

private:
  static inline std::mutex mutex_;
  std::lock_guard<std::mutex> lock_;
};

// what gmsh last said about an error
std::string complaint() {
  std::vector<std::string> log;
  gmsh::logger::get(log);
  std::string last;
  for (const std::string& line : log) {
    if (line.starts_with("Error")) last = line;
  }
  return last;
}

// gmsh 4.8.4 aborts the process at a ring that crosses itself: its exception does not leave an OpenMP region.
void check_simple(std::span<const Vec2> ring) {
  if (!(signed_area(ring) > 0)) throw base::GeometryError("a polygon to be meshed must run counterclockwise");
  if (const auto sides = crossing_sides(ring)) {
    const Vec2& a = ring[sides->first];
    const Vec2& b = ring[sides->second];
    throw base::GeometryError(fmt::format("the outline crosses or touches itself: its sides near {} and {} meet",
                                          base::place_text(a), base::place_text(b)));
  }
}

// Coordinates are scaled by the ring's extent: gmsh's tolerances are absolute.
Filling fill_scaled(std::span<const Vec2> ring, bool quadrilaterals, const Vec2& origin, double scale) {
  const std::size_t count = ring.size();
  const auto tag = [](std::size_t k) { return static_cast<int>(k) + 1; };
  std::vector<int> lines;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 at = (ring[k] - origin) / scale;
    const double before = (ring[k] - ring[(k + count - 1) % count]).norm();
    const double after = (ring[(k + 1) % count] - ring[k]).norm();
    gmsh::model::geo::addPoint(at.x(), at.y(), 0, (before + after) / (2 * scale), tag(k));
  }
  for (std::size_t k = 0; k < count; ++k) {
    lines.push_back(gmsh::model::geo::addLine(tag(k), tag((k + 1) % count)));
    gmsh::model::geo::mesh::setTransfiniteCurve(lines.back(), 2);
  }
  const int surface = gmsh::model::geo::addPlaneSurface({gmsh::model::geo::addCurveLoop(lines)});
  if (quadrilaterals) {
    // Blossom pairs best, but its time grows with the square of the number: 30 s for 60 000 quadrilaterals
    double around = 0;
    for (std::size_t k = 0; k < count; ++k) around += (ring[(k + 1) % count] - ring[k]).norm();
    const double side = around / static_cast<double>(count);
    constexpr double affordable = 1e4;
    const int greedy = 0;
    const int blossom = 1;
    gmsh::option::setNumber("Mesh.RecombinationAlgorithm",
                            signed_area(ring) < affordable * side * side ? blossom : greedy);
    gmsh::model::geo::mesh::setRecombine(2, surface);
  }
  gmsh::model::geo::synchronize();
  gmsh::model::mesh::generate(2);

  Filling filling;
  filling.points.assign(ring.begin(), ring.end());
  std::unordered_map<std::size_t, Index> number;
  std::vector<std::size_t> tags;
  std::vector<double> coordinates;
  std::vector<double> parameters;
  for (std::size_t k = 0; k < count; ++k) {
    gmsh::model::mesh::getNodes(tags, coordinates, parameters, 0, tag(k));
    if (tags.size() == 1) number[tags.front()] = static_cast<Index>(k);
  }
  gmsh::model::mesh::getNodes(tags, coordinates, parameters, 2, surface);
  for (std::size_t k = 0; k < tags.size(); ++k) {
    number[tags[k]] = static_cast<Index>(filling.points.size());
    filling.points.push_back(origin + scale * Vec2(coordinates[3 * k], coordinates[3 * k + 1]));
  }
  const auto read = [&]<std::size_t N>(int type, std::vector<std::array<Index, N>>& cells) {
    std::vector<std::size_t> elements; // both empty: gmsh takes filled ones for arrays to be written in part
    std::vector<std::size_t> nodes;
    gmsh::model::mesh::getElementsByType(type, elements, nodes, surface);
    cells.resize(nodes.size() / N);
    for (std::size_t k = 0; k < nodes.size(); ++k) cells[k / N][k % N] = number.at(nodes[k]);
    for (std::array<Index, N>& cell : cells) {
      const auto at = [&](std::size_t k) -> const Vec2& { return filling.points[static_cast<std::size_t>(cell[k])]; };
      // twice the signed area of a triangle, or of a quadrilateral by its diagonals
      if (cross(at(2) - at(0), at(N - 1) - at(1)) < 0) std::reverse(cell.begin() + 1, cell.end());
    }
  };
  constexpr int triangle = 2; // gmsh's numbers of the element types
  constexpr int quadrilateral = 3;
  read(triangle, filling.triangles);
  read(quadrilateral, filling.quadrilaterals);
  return filling;
}

} // namespace

Filling fill(std::span<const Vec2> ring, bool quadrilaterals) {
  if (ring.size() < 3) throw base::GeometryError("a polygon to be meshed needs three points at least");
  Vec2 low = ring.front();
  Vec2 high = ring.front();
  for (const Vec2& point : ring) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double extent = (high - low).norm();
  if (!std::isfinite(extent) || extent <= 0) throw base::GeometryError("a polygon to be meshed has no extent");
  check_simple(ring);

  const Session session;
  std::string reason;
  try {
    Filling filling = fill_scaled(ring, quadrilaterals, (low + high) / 2, extent);
    if (!filling.triangles.empty() || !filling.quadrilaterals.empty()) return filling;
    reason = complaint();
  } catch (const std::string& message) { // what gmsh 4.8 throws
    reason = message;
  } catch (const std::exception& error) {
    reason = error.what();
  }
  throw base::GeometryError(fmt::format("gmsh found no mesh of the polygon of {} points around {}: {}", ring.size(),
                                        base::place_text(Vec2((low + high) / 2)), reason));
}

} // namespace pneuma::geometry::meshing
