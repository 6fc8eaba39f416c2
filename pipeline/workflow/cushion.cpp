// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/schema/spelling.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

void Site::check(Reader& reader, const At<Site>& site) {
  const double ambient = site->ambient_pressure.pascal;
  if (ambient == 0 || (ambient >= 5e4 && ambient <= 1.1e5)) return;
  const auto key = site[&Site::ambient_pressure];
  reader.warn(key.path, fmt::format("{} {} Pa is unusual: 101325 Pa at sea level, 70 kPa at 3000 m, 0 Pa for the "
                                    "thesis' gas law; is it meant?",
                                    schema::name(&Site::ambient_pressure), ambient));
}

const std::string& Cushion::air_of(const std::string& chamber) const {
  const auto found =
      std::find_if(chambers.begin(), chambers.end(), [&](const ChamberSettings& one) { return one.name == chamber; });
  return found == chambers.end() || !found->connected_to ? chamber : *found->connected_to;
}

namespace {

// Position of a wall from the weather side inwards; the base comes after the last foil. None: there is no such foil.
std::optional<std::size_t> position_of(const std::string& wall, const Cushion& cushion) {
  const std::vector<FoilSettings>& foils = cushion.foils;
  const auto found =
      std::find_if(foils.begin(), foils.end(), [&](const FoilSettings& foil) { return foil.name == wall; });
  if (found == foils.end() && wall != "base") return std::nullopt;
  return static_cast<std::size_t>(found - foils.begin());
}

void check_walls(Reader& reader, const At<Cushion>& cushion) {
  std::map<std::size_t, std::string> gaps; // between foils -> chamber
  for (const At<ChamberSettings>& chamber : items(cushion[&Cushion::chambers])) {
    const auto between = chamber[&ChamberSettings::between];
    const auto& [one, other] = between.value;
    const auto a = position_of(one, cushion.value), b = position_of(other, cushion.value);
    if (!a || !b) continue;
    const auto [first, second] = std::minmax(*a, *b);
    if (second == cushion->foils.size() && !cushion->rigid_base) {
      const auto wall = between.at(one, one == "base" ? "0" : "1");
      reader.fail(wall.path, "the cushion has no base; say `base: rigid` in `cushion`, or name two foils");
    } else if (second - first != 1) {
      reader.fail(between.path,
                  fmt::format("`{}` and `{}` are no neighbours; from the weather side inwards: {}{}", one, other,
                              schema::joined(reader.names("foil")), cushion->rigid_base ? ", base" : ""));
    } else if (const auto [gap, is_new] = gaps.emplace(first, chamber->name); !is_new) {
      reader.fail(between.path, fmt::format("between these foils lies the chamber `{}` already", gap->second));
    }
  }
}

void check_connections(Reader& reader, const At<Cushion>& cushion) {
  for (const At<ChamberSettings>& chamber : items(cushion[&Cushion::chambers])) {
    if (!chamber->connected_to) continue;
    const std::string &own = chamber->name, &other = *chamber->connected_to;
    const std::string next = cushion->air_of(other), path = chamber[&ChamberSettings::connected_to].path;
    if (other == own) {
      reader.fail(path, fmt::format("`{}` cannot be connected to itself", own));
    } else if (next == own) {
      reader.fail(path, fmt::format("`{}` is connected to `{}` in turn; say it at one of the two", other, own));
    } else if (next != other) {
      reader.fail(path, fmt::format("`{0}` is itself connected to `{1}`; connect both to `{1}`", other, next));
    }
  }
}

} // namespace

void Cushion::check(Reader& reader, const At<Cushion>& cushion) {
  check_walls(reader, cushion);
  check_connections(reader, cushion);
}

} // namespace pneuma::pipeline::workflow

namespace pneuma::pipeline::schema {

using workflow::length;
using workflow::ring;

namespace {

std::string fault_of_corners(const std::vector<base::Vec2>& corners) {
  return geometry::plan_fault(geometry::Polygon{corners});
}

} // namespace

void declare(Keys<geometry::Rectangle>& keys) {
  keys.rule([](Reader& reader, const At<geometry::Rectangle>& plan) {
    if (const std::string fault = geometry::plan_fault(plan.value); !fault.empty()) reader.fail(plan.path, fault);
  });
  keys("length", &geometry::Rectangle::length, length(), "along x");
  keys("width", &geometry::Rectangle::width, length(), "along y");
  keys.is("rectangle", "edges south, east, north, west");
}

void declare(Keys<geometry::Circle>& keys) {
  keys("radius", &geometry::Circle::radius, length(), "of the rim");
  keys.is("circle", "edge rim");
}

void declare(Keys<geometry::Triangle>& keys) {
  using geometry::Triangle;
  const auto no_side = [](const Triangle&) -> const double* { return nullptr; };
  keys("side", mapped<Triangle>(length(), geometry::equilateral, no_side).stands_for("points"),
       "of an equilateral triangle");
  keys(
      "points",
      mapped<Triangle>(
          ring(3).judged([](const std::vector<base::Vec2>& corners) {
            return corners.size() == 3 ? fault_of_corners(corners)
                                       : fmt::format("a triangle has 3 corners, not {}", corners.size());
          }),
          [](const std::vector<base::Vec2>& p) {
            return Triangle{{p[0], p[1], p[2]}};
          },
          [](const Triangle& plan) { return std::vector<base::Vec2>(std::begin(plan.points), std::end(plan.points)); }),
      "the three corners");
  keys.is("triangle", "edges e1, e2, e3");
  keys.exactly_one({"side", "points"});
}

void declare(Keys<geometry::Polygon>& keys) {
  keys("points", &geometry::Polygon::points, ring().judged(fault_of_corners), "corners in order, either way round");
  keys.is("polygon", "edges e1 (from the first point to the second), e2, ...; re-entrant corners are allowed");
}

} // namespace pneuma::pipeline::schema
