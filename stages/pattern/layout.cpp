// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/rim.h"
#include "stages/pattern/fabrication.h"
#include "stages/pattern/flat_foil.h"

namespace pneuma::stages::pattern {

namespace {

namespace fabrication = geometry::fabrication;
namespace strips = geometry::strips;
namespace workflow = pipeline::workflow;
using strips::CuttingLine;

constexpr double degrees = 180 / std::numbers::pi;

Vec2 along(double direction) {
  return {std::cos(direction), std::sin(direction)};
}
Vec2 across(double direction) {
  return {-std::sin(direction), std::cos(direction)};
}

// Extent of the plan across a direction.
std::pair<double, double> extent_across(const geometry::Plan& plan, double direction) {
  const double around = geometry::perimeter(plan);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  const auto take = [&](double position) {
    const double o = across(direction).dot(geometry::rim_point(plan, position));
    low = std::min(low, o);
    high = std::max(high, o);
  };
  for (const double corner : geometry::rim_corners(plan)) take(corner);
  for (int k = 0; k < 720; ++k) take(around * k / 720); // curved rims
  return {low, high};
}

// What strips would come out of some lines, measured on a coarse copy.
struct Trial {
  std::vector<double> width; // of the cut strips, m
  double distortion = 0;     // largest
  double waste = 0;
};

class Planner {
public:
  Planner(const strips::Surface& surface, const workflow::PatternSettings& settings, std::string foil, int least)
      : surface_(surface), settings_(settings), foil_(std::move(foil)), least_(least),
        allowances_(allowances_of(settings)), rough_(surface) {
    rough_.fine = rough_.coarse;
  }

  Layout given_curves() const {
    Layout layout;
    for (const std::vector<Vec2>& curve : settings_.curves.at(foil_)) {
      layout.lines.push_back(strips::given_line(surface_, curve));
    }
    if (const std::string crossing = strips::crossing(layout.lines); !crossing.empty()) {
      throw base::GeometryError(fmt::format("foil `{}`: {}", foil_, crossing));
    }
    const Vec2 chord = layout.lines.front().plan.back() - layout.lines.front().plan.front();
    layout.direction = std::atan2(chord.y(), chord.x());
    layout.reason = "given curves";
    return layout;
  }

  Layout in_direction(double direction) const {
    return settings_.strips_per_foil ? equal_strips(direction, *settings_.strips_per_foil) : fewest_strips(direction);
  }

  Layout best_direction() const {
    std::optional<Layout> best;
    double least = std::numeric_limits<double>::infinity();
    std::string refusal;
    for (const double direction : candidates()) {
      try {
        Layout layout = in_direction(direction);
        const Trial trial = measure(layout.lines, direction);
        const bool by_waste = settings_.chosen_by == workflow::ChosenBy::waste;
        const double score = by_waste ? trial.waste : trial.distortion;
        if (score >= least * (1 - 1e-3) - 1e-6) continue; // the first of equals
        least = score;
        layout.reason += fmt::format(", best of the edges' directions by {} (about {:.2f} %)",
                                     by_waste ? "waste" : "distortion", 100 * score);
        best = std::move(layout);
      } catch (const base::GeometryError& error) {
        if (refusal.empty()) refusal = error.what();
      }
    }
    if (!best) throw base::GeometryError(refusal);
    return *best;
  }

private:
  // Along the plan's edges and across them; x for a circle.
  std::vector<double> candidates() const {
    std::vector<double> found;
    const auto add = [&](double angle) {
      angle = std::remainder(angle, std::numbers::pi); // -90 .. 90 degrees
      if (angle <= -std::numbers::pi / 2 + 1e-9) angle += std::numbers::pi;
      const bool known = std::any_of(found.begin(), found.end(), [&](double other) {
        return std::abs(std::remainder(angle - other, std::numbers::pi)) < 1 / degrees;
      });
      if (!known) found.push_back(angle);
    };
    const std::vector<double> corners = geometry::rim_corners(surface_.plan);
    for (std::size_t k = 0; corners.size() > 2 && k < corners.size(); ++k) {
      const Vec2 edge = geometry::rim_point(surface_.plan, corners[(k + 1) % corners.size()]) -
                        geometry::rim_point(surface_.plan, corners[k]);
      add(std::atan2(edge.y(), edge.x()));
    }
    if (found.empty()) return {0};
    const std::size_t edges = found.size();
    for (std::size_t k = 0; k < edges; ++k) add(found[k] + std::numbers::pi / 2);
    return found;
  }

  CuttingLine line(const strips::Surface& surface, double from, double to) const {
    return settings_.lines == workflow::CuttingLines::geodesic ? strips::geodesic_line(surface, from, to)
                                                               : strips::straight_line(surface, from, to);
  }

  std::vector<CuttingLine> lines_at(const strips::Surface& surface, const std::vector<double>& offsets,
                                    double direction) const {
    std::vector<CuttingLine> lines;
    for (const double offset : offsets | std::views::reverse) { // the first line lies between the first two strips
      const std::vector<double> crossings =
          geometry::rim_crossings(surface_.plan, offset * across(direction), along(direction));
      try {
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
          lines.push_back(line(surface, crossings[k], crossings[k + 1]));
      } catch (const base::GeometryError& error) {
        throw base::GeometryError(
            fmt::format("foil `{}`: {}; another direction or number of strips, or `curves`, puts it elsewhere", foil_,
                        error.what()));
      }
    }
    if (const std::string crossing = strips::crossing(lines); !crossing.empty()) {
      throw base::GeometryError(
          fmt::format("foil `{}`: {}; straight lines or fewer strips would not", foil_, crossing));
    }
    return lines;
  }

  Trial measure(const std::vector<CuttingLine>& lines, double direction) const {
    const std::vector<strips::Cut> cut{{&surface_, lines}};
    geometry::Mesh names; // the cut keeps names and element type
    names.element = geometry::ElementType::T3;
    names.blocks.push_back({foil_, geometry::BlockKind::foil, {}});
    for (const std::string& name : geometry::edge_names(surface_.plan)) names.edges.push_back({name, false, {}});
    const double area = geometry::area(surface_.plan);
    double size = std::sqrt(area / 500);
    // three elements across the narrowest strip, as far as the mesh itself has them
    size = std::max(std::min(size, std::sqrt(area) / static_cast<double>(4 * (lines.size() + 1))), element_size(cut));
    const strips::CutMesh mesh = strips::cut(surface_.plan, names, cut, size);
    Wanted wanted;
    wanted.direction = direction;
    wanted.tied = false;
    const FlatFoil flat = flatten_foil(mesh.mesh, 0, geometry::StressRule::full, mesh.foils[0], wanted);
    Trial trial;
    std::vector<fabrication::CutStrip> cuts;
    std::vector<std::string> strip_names;
    for (const fabrication::FlatStrip& outline : outlines(flat, mesh.mesh, 0)) {
      cuts.push_back(fabrication::cut_strip(outline, allowances_));
      strip_names.push_back(outline.name);
      trial.width.push_back(cuts.back().high.y() - cuts.back().low.y());
    }
    const workflow::Roll roll = settings_.roll_or_usual();
    const double roll_width = std::max(roll.width, fabrication::roll_width_for(cuts, roll.selvedge));
    trial.waste = fabrication::nest(cuts, strip_names, roll_width, roll.selvedge, RollSheet{}.gap).waste_fraction;
    for (const solver::flattening::PointStretch& s : flat.stretches) {
      trial.distortion = std::max({trial.distortion, s.larger - 1, 1 - s.smaller});
    }
    return trial;
  }

  Layout equal_strips(double direction, int count) const {
    const auto [low, high] = extent_across(surface_.plan, direction);
    std::vector<double> offsets = equal_middles(direction, count, low, high);
    Layout layout{direction, {}, fmt::format("{} strips at {:.1f} degrees", count, direction * degrees)};
    constexpr int rounds = 3;
    const auto inner = [&] { return std::vector<double>(offsets.begin() + 1, offsets.end() - 1); };
    try {
      for (int round = 0; round < rounds; ++round) {
        std::vector<double> width = measure(lines_at(rough_, inner(), direction), direction).width;
        std::reverse(width.begin(), width.end()); // strips are numbered from the left, where offsets are largest
        if (width.size() != static_cast<std::size_t>(count)) break; // a plan with bays: strips in parts
        const auto [least, most] = std::minmax_element(width.begin(), width.end());
        if (*most - *least < 0.005 * *most) break;
        offsets = balanced(offsets, width);
      }
    } catch (const base::GeometryError&) {
      // the trial's own mesh is too coarse for these lines: they stay where they are
    }
    layout.lines = lines_at(surface_, inner(), direction);
    return layout;
  }

  // Offsets of the ends of lines whose middles divide the surface's section across the middle of the plan into equal
  // lengths; both sides of the plan included. Geodesics bow outwards from their ends, the more the steeper the surface.
  std::vector<double> equal_middles(double direction, int count, double low, double high) const {
    const auto [back, front] = extent_across(surface_.plan, direction + std::numbers::pi / 2);
    constexpr int samples = 200;
    std::vector<double> run{0};
    std::optional<Vec3> last;
    for (int i = 0; i <= samples; ++i) {
      const double o = low + (high - low) * i / samples;
      // across, turned by a quarter, points backwards
      const Vec2 place = -0.5 * (back + front) * along(direction) + o * across(direction);
      const bool on = geometry::inside(surface_.plan, place, 0);
      const Vec3 x = on ? surface_.chart.lift(place) : Vec3(place.x(), place.y(), 0);
      if (last) run.push_back(run.back() + (x - *last).norm());
      last = x;
    }
    std::vector<double> offsets{low};
    std::size_t piece = 0;
    for (int k = 1; k < count; ++k) {
      const double wanted = run.back() * k / count;
      while (run[piece + 1] < wanted) ++piece;
      const double part = (wanted - run[piece]) / (run[piece + 1] - run[piece]);
      offsets.push_back(
          end_of(direction, low + (high - low) * (static_cast<double>(piece) + part) / samples, low, high));
    }
    offsets.push_back(high);
    return offsets;
  }

  // Offset of the ends of a line whose middle lies at a wanted offset.
  double end_of(double direction, double wanted, double low, double high) const {
    double offset = wanted;
    constexpr int tries = 8;
    for (int i = 0; i < tries; ++i) {
      try {
        double sum = 0;
        const std::vector<CuttingLine> lines = lines_at(rough_, {offset}, direction);
        for (const CuttingLine& line : lines) sum += across(direction).dot(line.plan[line.plan.size() / 2]);
        if (lines.empty()) return wanted;
        const double miss = wanted - sum / static_cast<double>(lines.size());
        if (std::abs(miss) < 1e-3 * (high - low)) return offset;
        offset += miss;
      } catch (const base::GeometryError&) { // too near to the rim
        offset += 0.2 * (0.5 * (low + high) - offset);
      }
    }
    return offset;
  }

  // Offsets at which strips of these widths would be equally wide: the width summed up is taken as piecewise linear.
  static std::vector<double> balanced(const std::vector<double>& offsets, const std::vector<double>& width) {
    std::vector<double> sum{0};
    for (const double w : width) sum.push_back(sum.back() + w);
    std::vector<double> result = offsets;
    std::size_t piece = 0;
    for (std::size_t k = 1; k + 1 < offsets.size(); ++k) {
      const double wanted = sum.back() * static_cast<double>(k) / static_cast<double>(width.size());
      while (sum[piece + 1] < wanted) ++piece;
      const double part = (wanted - sum[piece]) / width[piece];
      result[k] = offsets[piece] + part * (offsets[piece + 1] - offsets[piece]);
    }
    return result;
  }

  Layout fewest_strips(double direction) const {
    const workflow::Roll roll = settings_.roll_or_usual();
    const double usable = roll.width - 2 * roll.selvedge;
    const auto [low, high] = extent_across(surface_.plan, direction);
    const int first = std::max(least_, static_cast<int>(std::ceil((high - low) / (usable - roll.weld))));
    double widest = 0;
    std::string refusal;
    for (int count = first; count < first + 6; ++count) {
      try {
        Layout layout = equal_strips(direction, count);
        const std::vector<double> width = measure(layout.lines, direction).width;
        widest = *std::max_element(width.begin(), width.end());
        if (widest > usable) continue;
        layout.reason += fmt::format(", about {:.0f} mm wide on a roll with {:.0f} mm", 1e3 * widest, 1e3 * usable);
        return layout;
      } catch (const base::GeometryError& error) {
        if (refusal.empty()) refusal = error.what();
      }
    }
    if (!refusal.empty()) throw base::GeometryError(refusal);
    throw base::GeometryError(
        fmt::format("foil `{}`: even {} strips are {:.0f} mm wide with their allowances, the roll "
                    "has {:.0f} mm without its selvedge: take a wider roll",
                    foil_, first + 5, 1e3 * widest, 1e3 * usable));
  }

  const strips::Surface& surface_;
  const workflow::PatternSettings& settings_;
  std::string foil_;
  int least_; // strips, where the roll decides
  fabrication::Allowances allowances_;
  strips::Surface rough_; // with the coarse copy only: for the widths of trials
};

} // namespace

Layout lay_out(const strips::Surface& surface, const workflow::PatternSettings& settings, const std::string& foil,
               int least) {
  const Planner planner(surface, settings, foil, least);
  if (settings.curves.contains(foil)) return planner.given_curves();
  if (settings.direction) return planner.in_direction(*settings.direction);
  return planner.best_direction();
}

fabrication::Allowances allowances_of(const workflow::PatternSettings& settings) {
  return {settings.roll_or_usual().weld / 2, settings.allowance.clamp, settings.allowance.notches};
}

double element_size(const std::vector<strips::Cut>& cuts) {
  constexpr double across = 1.6; // elements between two lines: two when rounded; one between line and rim
  const double size = cuts.front().surface->size;
  double narrowest = std::numeric_limits<double>::infinity();
  for (const strips::Cut& cut : cuts) {
    std::vector<std::vector<Vec2>> lines;
    for (const CuttingLine& line : cut.lines) {
      auto& points = lines.emplace_back();
      const std::size_t step = std::max<std::size_t>(line.plan.size() / 64, 1);
      for (std::size_t k = 0; k < line.plan.size(); k += step) points.push_back(line.plan[k]);
      points.push_back(line.plan.back());
      for (const Vec2& x : points) { // away from the ends, where a line comes as near to the rim as it likes
        if (std::min((x - points.front()).norm(), (x - points.back()).norm()) < 5 * size) continue;
        const geometry::Plan& plan = cut.surface->plan;
        narrowest =
            std::min(narrowest, across * (geometry::rim_point(plan, geometry::rim_position(plan, x)) - x).norm());
      }
    }
    for (std::size_t a = 0; a < lines.size(); ++a) {
      for (std::size_t b = a + 1; b < lines.size(); ++b) {
        for (const Vec2& x : lines[a]) {
          for (const Vec2& y : lines[b]) narrowest = std::min(narrowest, (x - y).norm());
        }
      }
    }
  }
  return std::clamp(narrowest / across, size / 2, size);
}

} // namespace pneuma::stages::pattern
