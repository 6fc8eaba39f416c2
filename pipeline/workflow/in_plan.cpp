// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/in_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "geometry/base/place.h"
#include "geometry/plan_region.h"
#include "geometry/rim.h"
#include "pipeline/workflow/limits.h"

namespace pneuma::pipeline::workflow {

namespace {

using geometry::Plan;
using geometry::PlanRectangle;
using geometry::PlanRegion;
using schema::below;

// What rounding leaves between two ways to say one place, m.
double slack_of(const Plan& plan) {
  const PlanRectangle box = geometry::extent(plan);
  return 1e-6 * (box.high - box.low).norm();
}

// `range` of a region along an axis, held against that of the plan; true: it lies within.
bool within(Reader& reader, const std::string& path, const std::string& load, std::array<double, 2> range,
            std::array<double, 2> plan, const char* axis, double slack) {
  if (range[0] >= plan[0] - slack && range[1] <= plan[1] + slack) return true;
  reader.fail(path,
              fmt::format("the region of load `{0}` reaches from {1} = {2:.10g} to {3:.10g} m, the plan only from "
                          "{4:.10g} to {5:.10g} m: keep it on the foil, or leave `{1}` out for all of it",
                          load, axis, range[0], range[1], plan[0], plan[1]));
  return false;
}

void check_region(Reader& reader, const Plan& plan, const At<Load>& load, const At<Region>& region) {
  const PlanRectangle box = geometry::extent(plan);
  const double slack = slack_of(plan);
  PlanRectangle reach = box;
  PlanRegion part;
  std::string x = region[&Region::x].path, y = region[&Region::y].path;
  if (region->polygon) {
    x = y = region[&Region::polygon].path;
    part = geometry::PlanPolygon{*region->polygon};
    reach = geometry::extent(geometry::Polygon{*region->polygon});
  }
  if (region->x) reach.low.x() = (*region->x)[0], reach.high.x() = (*region->x)[1];
  if (region->y) reach.low.y() = (*region->y)[0], reach.high.y() = (*region->y)[1];
  if (!region->polygon) part = reach;
  const bool in_x =
      within(reader, x, load->name, {reach.low.x(), reach.high.x()}, {box.low.x(), box.high.x()}, "x", slack);
  const bool in_y =
      within(reader, y, load->name, {reach.low.y(), reach.high.y()}, {box.low.y(), box.high.y()}, "y", slack);
  if (!in_x || !in_y) return;
  const double inside = geometry::area_inside(plan, part);
  if (inside > 1e-9 * geometry::area(plan)) return;
  reader.fail(region.path,
              fmt::format("nothing of the region of load `{}` lies on the foil `{}`: move it", load->name, load->foil));
}

void check_patch(Reader& reader, const Plan& plan, const At<Load>& load, const At<PatchLoad>& patch) {
  const Vec2 half = 0.5 * patch->size;
  const double wanted = patch->size.prod();
  const double inside = geometry::area_inside(plan, PlanRectangle{patch->center - half, patch->center + half});
  if (inside >= (1 - 1e-6) * wanted) return;
  reader.fail(patch[&PatchLoad::center].path,
              fmt::format("only {:.4g} of the {:.4g} m2 of the patch `{}` lie on the foil `{}`: move it, or make it "
                          "smaller",
                          inside, wanted, load->name, load->foil));
}

// The length that a mesh's elements do not exceed, m; none: the mesh is not known.
double largest_element(const Plan& plan, const MeshSettings* mesh) {
  const PlanRectangle box = geometry::extent(plan);
  const double size = (box.high - box.low).norm();
  if (mesh == nullptr) return size;
  return mesh->size ? *mesh->size : size / std::min((*mesh->divisions)[0], (*mesh->divisions)[1]);
}

void check_curve(Reader& reader, const Plan& plan, const At<std::vector<Vec2>>& curve, double element) {
  const double slack = slack_of(plan);
  const auto at = [&](std::size_t k) { return below(curve.path, std::to_string(k)); };
  for (const std::size_t k : {std::size_t{0}, curve->size() - 1}) {
    const Vec2& end = curve.value[k];
    const Vec2 rim = geometry::rim_point(plan, geometry::rim_position(plan, end));
    if ((rim - end).norm() <= element / 10) continue; // put on it when the foil is cut
    reader.fail(at(k), fmt::format("a curve goes from rim to rim, and this end {} lies {:.3g} m from it: end it at {}",
                                   base::place_text(end) + " m", (rim - end).norm(), base::place_text(rim) + " m"));
    return;
  }
  for (std::size_t k = 1; k + 1 < curve->size(); ++k) {
    if (geometry::inside(plan, curve.value[k], slack)) continue;
    return reader.fail(
        at(k), fmt::format("the point {} of the curve lies beside the plan", base::place_text(curve.value[k]) + " m"));
  }
}

// The smallest distance between two parallel lines that have the plan between them, m.
double least_width(const Plan& plan) {
  if (const auto* circle = std::get_if<geometry::Circle>(&plan)) return 2 * circle->radius;
  const std::vector<Vec2> corners = geometry::corner_points(plan);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < corners.size(); ++a) {
    for (std::size_t b = a + 1; b < corners.size(); ++b) { // a side of the hull is among these
      const Vec2 along = (corners[b] - corners[a]).normalized();
      double low = 0, high = 0;
      for (const Vec2& corner : corners) {
        const double across = geometry::cross(along, corner - corners[a]);
        low = std::min(low, across), high = std::max(high, across);
      }
      least = std::min(least, high - low);
    }
  }
  return least;
}

void check_roll(Reader& reader, const Plan& plan, const At<Roll>& roll) {
  const double usable = roll->width - roll->weld - 2 * roll->selvedge;
  const double strips = std::ceil(least_width(plan) / usable * (1 - 1e-9));
  if (strips <= most_strips) return;
  reader.fail(
      roll[&Roll::width].path,
      fmt::format("{:.3g} m of the roll carry, of which a foil would need {:.0f} strips at least; {} are the most",
                  usable, strips, most_strips));
}

} // namespace

void check_in_plan(Reader& reader, const Cushion& cushion, const At<MeshSettings>& mesh) {
  const auto key = mesh->size ? mesh[&MeshSettings::size].path : mesh[&MeshSettings::divisions].path;
  const MeshEstimate one = estimate(cushion.plan, mesh.value);
  const std::string asked = fmt::format("{}{} makes about {:.2g} elements a foil", reader.title(key),
                                        mesh->size ? fmt::format(" {} m", *mesh->size) : "", one.elements);
  const double foils = static_cast<double>(cushion.foils.size());
  const double bytes = memory_a_node * foils * one.nodes, here = machine_memory();
  if (one.elements > most_elements) {
    reader.fail(key, fmt::format("{}; {:.0g} are the most", asked, most_elements));
  } else if (bytes > here) {
    reader.fail(key, fmt::format("{}, for which {:.1f} GB of memory are needed, and a program may take {:.1f} GB here",
                                 asked, 1e-9 * bytes, 1e-9 * here));
  } else if (one.elements < 1) {
    reader.warn(key, fmt::format("{} {} m is larger than the cushion (about {:.3g} m); is it meant?", reader.title(key),
                                 *mesh->size, std::sqrt(geometry::area(cushion.plan))));
  } else if (one.elements > most_elements / 10) {
    reader.warn(key, asked + "; is it meant?");
  }
}

void check_in_plan(Reader& reader, const Plan& plan, const At<PatternSettings>& pattern, const MeshSettings* mesh) {
  if (pattern->roll && !pattern->strips_per_foil && pattern->curves.empty()) {
    const auto roll = pattern[&PatternSettings::roll];
    check_roll(reader, plan, {*pattern->roll, roll.path});
  }
  const auto at = pattern[&PatternSettings::curves];
  const double element = largest_element(plan, mesh);
  std::set<std::string> seen; // those of all foils once
  for (const auto& [foil, curves] : at.value) {
    const std::string own = below(at.path, reader.given(below(at.path, foil)) ? foil : all);
    if (!seen.insert(own).second) continue;
    for (const auto& curve : items(At<PlanCurves>{curves, own})) check_curve(reader, plan, curve, element);
    const std::vector<std::span<const Vec2>> lines(curves.begin(), curves.end());
    const auto crossing = geometry::crossing_lines(lines);
    if (!crossing) continue;
    reader.fail(below(own, std::to_string(crossing->second)),
                fmt::format("this curve {} near {}",
                            crossing->first == crossing->second
                                ? "crosses itself"
                                : fmt::format("crosses or touches curve {}", crossing->first + 1),
                            base::place_text(crossing->at) + " m"));
  }
}

void check_in_plan(Reader& reader, const Plan& plan, const At<PathSettings>& path) {
  const auto control = path[&PathSettings::control];
  const auto* displacement = std::get_if<DisplacementControl>(&control.value);
  if (displacement == nullptr || !displacement->at) return;
  const Vec2& at = *displacement->at;
  const double slack = slack_of(plan);
  const bool on_rim = (geometry::rim_point(plan, geometry::rim_position(plan, at)) - at).norm() <= slack;
  if (!on_rim && geometry::inside(plan, at, slack)) return;
  reader.fail(At<DisplacementControl>{*displacement, control.path}[&DisplacementControl::at].path,
              fmt::format("the place {} lies {}: take one inside", base::place_text(at) + " m",
                          on_rim ? "on the clamped edge, which does not move" : "beside the plan"));
}

void check_in_plan(Reader& reader, const Plan& plan, const At<WindSettings>& wind) {
  check_in_plan(reader, plan, At<PathSettings>(wind));
  for (const At<Load>& load : items(wind[&WindSettings::loads])) {
    if (load->region) check_region(reader, plan, load, {*load->region, load[&Load::region].path});
    if (const auto* patch = std::get_if<PatchLoad>(&load->kind)) {
      check_patch(reader, plan, load, {*patch, below(load.path, "patch")});
    }
  }
}

} // namespace pneuma::pipeline::workflow
