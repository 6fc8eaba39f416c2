// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/strips/cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/place.h"
#include "geometry/box_grid.h"
#include "geometry/mesh_check.h"
#include "geometry/meshing/filled.h"
#include "geometry/polygon.h"
#include "geometry/rim.h"
#include "geometry/strips/rim_stations.h"
#include "geometry/strips/track.h"

namespace pneuma::geometry::strips {

namespace {

using base::GeometryError;

constexpr double narrowest = 1.5; // elements: more than that are two when rounded

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// The stations of a foil in plan, before its strips are filled: those of the rim first, then those of each line.
struct Outline {
  std::vector<Vec2> points;
  std::vector<std::vector<Index>> lines;  // stations of each line from end to end, those of the rim included
  std::vector<std::vector<Vec2>> middles; // of each line, between its stations
};

// A strip: the part of the plan within a ring of stations.
struct Face {
  std::vector<Index> ring;              // stations counterclockwise
  std::vector<std::vector<Index>> runs; // places in the ring that follow the rim, both ends included
  Vec2 centre = Vec2::Zero();
};

// A foil's strips, and those to the left and right of each line.
struct Division {
  std::vector<Face> faces;
  std::vector<std::array<Index, 2>> beside; // [line]: left, right
};

// A foil's mesh in plan.
struct Sheet {
  std::vector<Vec2> points;            // those of the outline first
  std::vector<Index> cells;            // [cell][corner]
  std::vector<Index> strip_of_element; // [cell]
};

// The line with its ends at two points of the rim. The move fades along the line, so that a straight one stays
// straight.
std::vector<Vec2> moved(const CuttingLine& line, const Vec2& from, const Vec2& to) {
  std::vector<double> run = {0.0};
  for (std::size_t k = 0; k + 1 < line.plan.size(); ++k)
    run.push_back(run.back() + (line.plan[k + 1] - line.plan[k]).norm());
  const Vec2 first = from - line.plan.front();
  const Vec2 last = to - line.plan.back();
  std::vector<Vec2> plan;
  for (std::size_t k = 0; k < line.plan.size(); ++k) {
    const double part = run[k] / run.back();
    plan.push_back(line.plan[k] + (1 - part) * first + part * last);
  }
  plan.front() = from;
  plan.back() = to;
  return plan;
}

void check_line(const Plan& plan, const CuttingLine& line, std::size_t number, double size) {
  if (line.plan.size() < 2) throw GeometryError(fmt::format("line {} has fewer than two points", number + 1));
  for (const auto& [point, position] :
       {std::pair(line.plan.front(), line.from), std::pair(line.plan.back(), line.to)}) {
    const double away = (rim_point(plan, position) - point).norm();
    if (!(away <= size / 3)) {
      throw GeometryError(
          fmt::format("line {} ends at {}, {:.3g} m from its position on the rim: it must end on the rim", number + 1,
                      base::place_text(point), away));
    }
  }
}

// Puts stations on a foil's lines, at equal lengths on the surface.
Outline outline_of(const Plan& plan, const Cut& foil, const RimStations& rim, std::span<const RimStations::Ends> ends,
                   double size, bool even) {
  Outline outline;
  outline.points = rim.points;
  std::vector<CuttingLine> lines;
  for (std::size_t l = 0; l < foil.lines.size(); ++l) {
    check_line(plan, foil.lines[l], l, size);
    lines.push_back(foil.lines[l]);
    lines[l].plan = moved(foil.lines[l], rim.points[at(ends[l].from)], rim.points[at(ends[l].to)]);
  }
  if (const std::string fault = crossing(lines); !fault.empty())
    throw GeometryError(fault + ": lines of one foil must keep apart");
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const Track track(foil.surface->chart, lines[l].plan, size / 8);
    if (track.length() < narrowest * size) {
      throw GeometryError(fmt::format(
          "line {} at {} is {:.3g} m long, too short for elements of {:.3g} m: at most {:.3g} "
          "m would do",
          l + 1, base::place_text(lines[l].plan.front()), track.length(), size, track.length() / narrowest));
    }
    const int sides = sides_in(track.length(), size, even);
    auto& stations = outline.lines.emplace_back();
    auto& middles = outline.middles.emplace_back();
    stations.push_back(ends[l].from);
    for (int i = 1; i < sides; ++i) {
      stations.push_back(static_cast<Index>(outline.points.size()));
      outline.points.push_back(track.at(track.length() * i / sides));
    }
    stations.push_back(ends[l].to);
    for (int i = 0; i < sides; ++i) middles.push_back(track.at(track.length() * (i + 0.5) / sides));
  }
  return outline;
}

// Refuses lines that come too near to each other or to the rim. Next to its ends a line may be as near to the rim as an
// angle of about ten degrees brings it.
void check_width(const Plan& plan, const Outline& outline, double size) {
  constexpr double flattest = 0.2;
  const double width = narrowest * size;
  struct Station {
    std::size_t line;
    Vec2 place;
  };
  std::vector<Station> stations;
  std::vector<PlanBox> boxes;
  for (std::size_t l = 0; l < outline.lines.size(); ++l) {
    const std::vector<Index>& line = outline.lines[l];
    for (std::size_t k = 0; k < line.size(); ++k) {
      const Vec2 place = outline.points[at(line[k])];
      stations.push_back({l, place});
      boxes.push_back({place.array() - width, place.array() + width});
      const double from_end = size * static_cast<double>(std::min(k, line.size() - 1 - k));
      const double limit = std::min(size, flattest * from_end);
      const double distance = (rim_point(plan, rim_position(plan, place)) - place).norm();
      if (distance >= limit) continue;
      throw GeometryError(fmt::format("line {} comes as near as {:.3g} m to the rim at {}, too near for elements of "
                                      "{:.3g} m: move the line, or take smaller elements",
                                      l + 1, distance, base::place_text(place), size));
    }
  }
  if (stations.empty()) return;
  const BoxGrid grid(boxes);
  for (const Station& station : stations) {
    for (const Index k : grid.at(station.place)) {
      const Station& other = stations[at(k)];
      const double distance = (other.place - station.place).norm();
      if (other.line == station.line || distance >= width) continue;
      throw GeometryError(fmt::format(
          "lines {} and {} come as near as {:.3g} m to each other at {}: the strip between them is too narrow for two "
          "elements of {:.3g} m; fewer strips, or elements of at most {:.3g} m, would do",
          std::min(station.line, other.line) + 1, std::max(station.line, other.line) + 1, distance,
          base::place_text(station.place), size, distance / narrowest));
    }
  }
}

std::vector<Vec2> places_of(const Face& face, const Outline& outline) {
  std::vector<Vec2> ring;
  ring.reserve(face.ring.size());
  for (const Index i : face.ring) ring.push_back(outline.points[at(i)]);
  return ring;
}

Vec2 centre_of(std::span<const Vec2> ring) {
  const Vec2& origin = ring.front();
  Vec2 moment = Vec2::Zero();
  double doubled = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 a = ring[k] - origin;
    const Vec2 b = ring[(k + 1) % ring.size()] - origin;
    doubled += cross(a, b);
    moment += cross(a, b) * (a + b) / 3;
  }
  return origin + moment / doubled;
}

// The end of a line on the rim.
struct End {
  Index station;
  std::size_t line;
  bool last; // the line's last point
};

// Walks around each strip: along the rim counterclockwise to the next end of a line, along the line to its other end,
// and so on. Throws GeometryError where lines cross.
std::vector<Face> faces_of(const Outline& outline, Index stations, const std::vector<End>& ends,
                           std::vector<std::array<Index, 2>>& beside) {
  std::vector<Face> faces;
  const auto walk_rim = [&](Face& face, Index from, Index to) {
    std::vector<Index>& run = face.runs.emplace_back();
    for (Index s = from;; s = (s + 1) % stations) {
      run.push_back(static_cast<Index>(face.ring.size()));
      if (s == to) break;
      face.ring.push_back(s);
    }
  };
  std::vector<std::array<std::size_t, 2>> number(outline.lines.size()); // of each line's ends
  for (std::size_t e = 0; e < ends.size(); ++e) number[ends[e].line][ends[e].last ? 1 : 0] = e;
  std::vector<bool> walked(ends.size(), false); // the rim behind each end
  for (std::size_t first = 0; first < ends.size(); ++first) {
    if (walked[first]) continue;
    Face face;
    std::size_t e = first;
    do {
      walked[e] = true;
      const std::size_t reached = (e + 1) % ends.size();
      walk_rim(face, ends[e].station, ends[reached].station);
      const auto& [station, line, last] = ends[reached];
      std::vector<Index> along = outline.lines[line];
      if (last) std::reverse(along.begin(), along.end());
      beside[line][last ? 1 : 0] = static_cast<Index>(faces.size()); // walked forwards, it is to the left of the line
      face.ring.insert(face.ring.end(), along.begin(), along.end() - 1);
      e = number[line][last ? 0 : 1];
    } while (!walked[e]);
    faces.push_back(std::move(face));
  }
  return faces;
}

// The mean direction of lines, those against the first one turned.
Vec2 mean_direction(const Outline& outline) {
  Vec2 sum = Vec2::Zero();
  for (const std::vector<Index>& line : outline.lines) {
    const Vec2 along = (outline.points[at(line.back())] - outline.points[at(line.front())]).normalized();
    sum += along.dot(sum) < 0 ? -along : along;
  }
  return sum;
}

// Numbers the strips from left to right.
void order(Division& division, const Vec2& direction) {
  std::vector<std::size_t> by_place(division.faces.size());
  std::iota(by_place.begin(), by_place.end(), std::size_t{0});
  std::stable_sort(by_place.begin(), by_place.end(), [&](std::size_t a, std::size_t b) {
    return cross(direction, division.faces[a].centre) > cross(direction, division.faces[b].centre);
  });
  std::vector<Face> faces;
  std::vector<Index> number(by_place.size());
  for (std::size_t k = 0; k < by_place.size(); ++k) {
    number[by_place[k]] = static_cast<Index>(k);
    faces.push_back(std::move(division.faces[by_place[k]]));
  }
  division.faces = std::move(faces);
  for (auto& [left, right] : division.beside) {
    left = number[at(left)];
    right = number[at(right)];
  }
}

// Refuses strips too small for two elements at the rim.
void check_size(const Division& division, const Outline& outline, double size, int corners) {
  for (const Face& face : division.faces) {
    if (corners == 4 && face.ring.size() < 6) {
      throw GeometryError(fmt::format("the strip around {} is too small for quadrilaterals of {:.3g} m: move the line, "
                                      "or take smaller elements",
                                      base::place_text(face.centre), size));
    }
    for (const std::vector<Index>& run : face.runs) {
      double width = 0;
      for (std::size_t k = 0; k + 1 < run.size(); ++k) {
        width += (outline.points[at(face.ring[at(run[k + 1])])] - outline.points[at(face.ring[at(run[k])])]).norm();
      }
      if (width >= narrowest * size * (1 - 1e-9)) continue;
      const Vec2& place = outline.points[at(face.ring[at(run.front())])];
      throw GeometryError(fmt::format("a strip is {:.3g} m wide at the rim behind {}, too narrow for two elements of "
                                      "{:.3g} m: fewer strips, or elements of at most {:.3g} m, would do",
                                      width, base::place_text(place), size, width / narrowest));
    }
  }
}

Division divide(const Outline& outline, const RimStations& rim, std::span<const RimStations::Ends> line_ends) {
  const auto stations = static_cast<Index>(rim.points.size());
  Division division;
  if (outline.lines.empty()) {
    Face whole;
    whole.ring.resize(rim.points.size());
    std::iota(whole.ring.begin(), whole.ring.end(), 0);
    whole.runs = {whole.ring};
    division.faces.push_back(std::move(whole));
    return division;
  }
  std::vector<End> ends;
  for (std::size_t l = 0; l < line_ends.size(); ++l) {
    ends.push_back({line_ends[l].from, l, false});
    ends.push_back({line_ends[l].to, l, true});
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.station < b.station; });
  division.beside.resize(outline.lines.size());
  division.faces = faces_of(outline, stations, ends, division.beside);
  if (division.faces.size() != outline.lines.size() + 1) {
    throw GeometryError(fmt::format("the lines from {} on cross each other",
                                    base::place_text(outline.points[at(ends.front().station)])));
  }
  for (Face& face : division.faces) {
    face.centre = centre_of(places_of(face, outline));
  }
  order(division, mean_direction(outline));
  return division;
}

// A strip's outline and its elements. Foils that are cut alike (the two of a symmetric cushion) share them: most of the
// time goes into filling.
struct Filled {
  std::vector<Vec2> ring;
  std::vector<std::vector<Index>> runs;
  meshing::CornerMesh mesh;
};

const meshing::CornerMesh& filled_once(std::vector<Filled>& known, std::vector<Vec2> ring, const Face& face,
                                       int corners) {
  constexpr double same = 1e-9; // m: of lines that were found apart
  const auto found = std::ranges::find_if(known, [&](const Filled& other) {
    return other.runs == face.runs &&
           std::ranges::equal(other.ring, ring, [](const Vec2& a, const Vec2& b) { return (a - b).norm() < same; });
  });
  if (found != known.end()) return found->mesh;
  meshing::CornerMesh mesh = meshing::filled(ring, face.runs, corners);
  known.push_back({std::move(ring), face.runs, std::move(mesh)});
  return known.back().mesh;
}

Sheet fill_strips(const Outline& outline, const Division& division, int corners, std::vector<Filled>& known) {
  Sheet sheet;
  sheet.points = outline.points;
  for (std::size_t strip = 0; strip < division.faces.size(); ++strip) {
    const Face& face = division.faces[strip];
    const meshing::CornerMesh& mesh = filled_once(known, places_of(face, outline), face, corners);
    const std::size_t ring = face.ring.size();
    const auto shift = static_cast<Index>(sheet.points.size() - ring);
    sheet.points.insert(sheet.points.end(), mesh.points.begin() + static_cast<std::ptrdiff_t>(ring), mesh.points.end());
    for (const Index i : mesh.cells) sheet.cells.push_back(at(i) < ring ? face.ring[at(i)] : i + shift);
    sheet.strip_of_element.insert(sheet.strip_of_element.end(), mesh.cell_count(), static_cast<Index>(strip));
  }
  return sheet;
}

// Puts foils into the new mesh, one after the other.
class Assembly {
public:
  Assembly(const Plan& plan, const Mesh& old, const RimStations& rim) : rim_(rim) {
    const bool closed = std::holds_alternative<Circle>(plan);
    mesh_.element = old.element;
    for (std::size_t i = 0; i < rim.points.size(); ++i) {
      mesh_.nodes.emplace_back(rim.points[i].x(), rim.points[i].y(), 0);
      if (quadratic()) mesh_.nodes.emplace_back(rim.middles[i].x(), rim.middles[i].y(), 0);
    }
    for (std::size_t e = 0; e < old.edges.size(); ++e) {
      Edge edge{old.edges[e].name, closed, {}};
      const std::vector<Index>& stations = rim.edges[e];
      for (std::size_t k = 0; k < stations.size(); ++k) {
        edge.nodes.push_back(rim_node(stations[k]));
        if (quadratic() && (k + 1 < stations.size() || edge.closed)) edge.nodes.push_back(rim_node(stations[k]) + 1);
      }
      mesh_.edges.push_back(std::move(edge));
    }
  }

  // Adds a block and returns the nodes of its seams.
  std::vector<std::vector<Index>> add(const Block& old, const Chart& chart, const Outline& outline,
                                      const Sheet& sheet) {
    Block block{old.name, old.kind, {}};
    numbers_.assign(sheet.points.size(), none);
    middles_.clear();
    const auto stations = static_cast<Index>(rim_.points.size());
    for (Index i = 0; i < stations; ++i) {
      numbers_[at(i)] = rim_node(i);
      if (quadratic()) middles_[side_key(i, (i + 1) % stations)] = rim_node(i) + 1;
    }
    std::vector<std::vector<Index>> seams;
    for (std::size_t l = 0; l < outline.lines.size(); ++l)
      seams.push_back(seam(chart, outline.lines[l], outline.middles[l], sheet));

    const auto corners = at(corners_per_element(mesh_.element));
    for (std::size_t c = 0; c < sheet.cells.size(); c += corners)
      add_element(block, chart, sheet, std::span(sheet.cells).subspan(c, corners));
    mesh_.blocks.push_back(std::move(block));
    return seams;
  }

  Mesh take() { return std::move(mesh_); }

private:
  static constexpr Index none = -1;

  bool quadratic() const { return is_quadratic(mesh_.element); }
  Index rim_node(Index station) const { return quadratic() ? 2 * station : station; }

  Index new_node(const Chart& chart, const Vec2& place) {
    mesh_.nodes.push_back(chart.lift(place));
    return static_cast<Index>(mesh_.nodes.size() - 1);
  }

  Index corner(const Chart& chart, const Sheet& sheet, Index i) {
    Index& number = numbers_[at(i)];
    if (number == none) number = new_node(chart, sheet.points[at(i)]);
    return number;
  }

  std::vector<Index> seam(const Chart& chart, const std::vector<Index>& line, const std::vector<Vec2>& middles,
                          const Sheet& sheet) {
    std::vector<Index> nodes;
    for (std::size_t k = 0; k < line.size(); ++k) {
      nodes.push_back(corner(chart, sheet, line[k]));
      if (!quadratic() || k + 1 == line.size()) continue;
      nodes.push_back(middles_[side_key(line[k], line[k + 1])] = new_node(chart, middles[k]));
    }
    return nodes;
  }

  void add_element(Block& block, const Chart& chart, const Sheet& sheet, std::span<const Index> cell) {
    for (const Index i : cell) block.connectivity.push_back(corner(chart, sheet, i));
    if (!quadratic()) return;
    Vec2 centre = Vec2::Zero(); // Coons' patch of the sides in plan
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const Index a = cell[k];
      const Index b = cell[(k + 1) % cell.size()];
      const auto [found, fresh] = middles_.try_emplace(side_key(a, b), none);
      if (fresh) found->second = new_node(chart, (sheet.points[at(a)] + sheet.points[at(b)]) / 2);
      block.connectivity.push_back(found->second);
      centre += mesh_.nodes[at(found->second)].head<2>() / 2 - sheet.points[at(a)] / 4;
    }
    if (mesh_.element == ElementType::Q9) block.connectivity.push_back(new_node(chart, centre));
  }

  const RimStations& rim_;
  Mesh mesh_;
  std::vector<Index> numbers_;                       // of the present foil's points
  std::unordered_map<std::uint64_t, Index> middles_; // of its sides, by the points at their ends
};

void check_call(const Plan& plan, const Mesh& old, std::span<const Cut> foils, double size) {
  if (!std::isfinite(size) || size <= 0)
    throw GeometryError(fmt::format("the mesh size of the strips must be positive, not {} m", size));
  if (foils.size() != old.blocks.size())
    throw GeometryError(fmt::format("{} foils are to be cut, but the mesh has {}", foils.size(), old.blocks.size()));
  const std::vector<std::string> names = edge_names(plan);
  const bool same = std::ranges::equal(old.edges, names, {}, &Edge::name);
  if (!same) throw GeometryError("the mesh to be cut has other edges than the plan");
  for (std::size_t f = 0; f < foils.size(); ++f) {
    if (!foils[f].surface) throw GeometryError(fmt::format("{} has no surface to be cut on", old.blocks[f].name));
  }
}

} // namespace

CutMesh cut(const Plan& plan, const Mesh& old, std::span<const Cut> foils, double size) {
  check_call(plan, old, foils, size);
  const int corners = corners_per_element(old.element);
  const bool even = corners == 4;
  const RimStations rim = rim_stations(plan, foils, size, even);
  Assembly assembly(plan, old, rim);
  CutMesh result;
  std::vector<Filled> known;
  for (std::size_t f = 0; f < foils.size(); ++f) {
    try {
      const Outline outline = outline_of(plan, foils[f], rim, rim.ends[f], size, even);
      const Division division = divide(outline, rim, rim.ends[f]);
      check_size(division, outline, size, corners);
      check_width(plan, outline, size);
      Sheet sheet = fill_strips(outline, division, corners, known);
      const std::vector<std::vector<Index>> seams =
          assembly.add(old.blocks[f], foils[f].surface->chart, outline, sheet);
      CutFoil& foil = result.foils.emplace_back();
      foil.strips = static_cast<Index>(division.faces.size());
      foil.strip_of_element = std::move(sheet.strip_of_element);
      for (std::size_t l = 0; l < seams.size(); ++l)
        foil.seams.push_back({division.beside[l][0], division.beside[l][1], seams[l]});
    } catch (const GeometryError& error) {
      throw GeometryError(fmt::format("foil `{}`: {}", old.blocks[f].name, error.what()));
    }
  }
  result.mesh = assembly.take();
  for (const MeshFault& fault : check_mesh(result.mesh)) {
    if (fault.severity == Severity::error)
      throw GeometryError("no valid mesh of the strips: " + fault.message + "; try another size");
  }
  return result;
}

} // namespace pneuma::geometry::strips
