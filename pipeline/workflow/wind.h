// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/path.h"

namespace pneuma::pipeline::workflow {

struct RegulatedGas {
  std::optional<double> gauge_pressure; // Pa; none: as in the `from` state

  static void declare(auto& keys) {
    keys("gauge_pressure", &RegulatedGas::gauge_pressure,
         quantity("Pa").usual(0, 2000, "cushions hold 200 to 800 Pa, seldom up to 2 kPa"),
         "set-point; without it as in the `from` state");
    keys.is("regulated", "constant pressure");
  }
};

struct ClosedGas {
  double kappa = 0;
  std::optional<double> temperature;      // K, at the end; none: as in the `from` state
  std::optional<double> ambient_pressure; // Pa absolute, at the end; none: as in the `from` state

  static void declare(auto& keys) {
    keys("kappa", &ClosedGas::kappa,
         number().within({0, 10, "above 0, up to 10", false, true}).usual(1, 1.67, "air has 1 to 1.4").otherwise("1"),
         "of p V^kappa = const: 1 slow, 1.4 gusts of seconds");
    keys("temperature", &ClosedGas::temperature,
         quantity("K").positive().usual(213.15, 373.15, "usually -60 to 100 degC"), "of the air in the end")
        .where([](const auto& gas) { return gas.kappa == 1; }, "is for kappa 1: otherwise the gas law itself sets it");
    keys("ambient_pressure", &ClosedGas::ambient_pressure,
         quantity("Pa").at_least(0, "at least 0 Pa").such_as("101325 Pa"), "absolute, in the end");
    keys.is("closed", "the air stays");
  }
};

struct VolumeGas {
  double volume = 0; // m3

  static void declare(auto& keys) {
    keys("volume", &VolumeGas::volume, quantity("m3").positive().such_as("5 m3"), "held");
    keys.is("volume", "incompressible");
  }
};

using Gas = std::variant<RegulatedGas, ClosedGas, VolumeGas>;

// A part of a foil in plan: a box, a strip across it, or a polygon.
struct Region {
  std::optional<std::array<double, 2>> x, y; // m; none: from end to end
  std::optional<std::vector<Vec2>> polygon;  // m

  static void declare(auto& keys) {
    const auto interval = tuple<2>(quantity("m").such_as("1.5 m").named("end", "coordinate in plan"))
                              .judged([](const std::array<double, 2>& ends) {
                                return ends[0] < ends[1] ? "" : "must rise: the first end must be below the second";
                              });
    keys("x", &Region::x, interval, "from, to; without it all along x");
    keys("y", &Region::y, interval, "from, to; without it all along y");
    keys("polygon", &Region::polygon,
         ring().judged([](const std::vector<Vec2>& corners) { return geometry::ring_fault(corners, "side"); }),
         "corners in plan");
    keys.at_least_one({"x", "y", "polygon"});
    keys.not_both("x", "polygon");
    keys.not_both("y", "polygon");
  }
};

struct WindLoad {
  double pressure = 0; // Pa, positive pushes against the face it acts on
};
struct SnowLoad {
  double weight = 0; // Pa, per plan area of the `from` state
};
struct PatchLoad {               // a dead force spread over a rectangle in plan
  Vec2 center{0, 0}, size{0, 0}; // m
  Vec3 force{0, 0, 0};           // N

  static void declare(auto& keys) {
    keys("center", &PatchLoad::center, point(), "in plan");
    keys("size", &PatchLoad::size, schema::vector<Vec2>(length().named("side", "side of the rectangle")), "in plan");
    keys("force", &PatchLoad::force, schema::vector<Vec3>(quantity("N").named("component", "component")), "sum, dead");
  }
};

struct Load {
  std::string name, foil;
  std::variant<WindLoad, SnowLoad, PatchLoad> kind;
  std::optional<Region> region; // none: all of the foil

  static void declare(auto& keys) {
    keys("name", &Load::name, word(), "of the load");
    keys("foil", &Load::foil, reference_to("foil"), "it acts on");
    using Kind = decltype(kind);
    const auto wind = quantity("Pa").usual(-10000, 10000, "usually up to 10 kPa");
    const auto snow = quantity("Pa").at_least(0, "at least 0 Pa").usual(0, 20000, "usually up to 20 kPa");
    keys("wind", &Load::kind, schema::as<Kind>(part<WindLoad>(wind, &WindLoad::pressure)),
         "positive pushes against the face, negative is suction; follows the foil")
        .or_another();
    keys("snow", &Load::kind, schema::as<Kind>(part<SnowLoad>(snow, &SnowLoad::weight)),
         "weight per plan area, straight down")
        .or_another();
    keys("patch", &Load::kind, schema::as<Kind>(group<PatchLoad>()), "a dead force spread over a rectangle in plan")
        .or_another();
    keys("region", &Load::region,
         word_or("all", "all of the foil", group<Region>().named("part", "a part in plan")).otherwise("all"),
         "where it acts")
        .where([](const auto& load) { return !std::holds_alternative<PatchLoad>(load.kind); },
               "is not for a patch, which says its own place with `center` and `size`");
    keys.exactly_one({"wind", "snow", "patch"});
  }
};

struct WindSettings : PathSettings {
  std::map<std::string, Gas> gas; // chamber -> law, every chamber present that is not connected to another
  std::vector<Load> loads;
  // Of every own load, and of those that the `from` stage ends with: what they go to; others stay.
  std::map<std::string, double> factors;

  static void declare(auto& keys) {
    using Self = WindSettings;
    keys("gas", &Self::gas,
         table(schema::variant<Gas>("law").otherwise("regulated").named("CHAMBER", "the air of a chamber"), "chamber")
             .otherwise("{}"),
         "per chamber [regulated]");
    keys("loads", &Self::loads, list(group<Load>().named("load", "a load")).otherwise("[]"), "what acts");
    keys("factors", &Self::factors, table(number().named("LOAD", "factor")).otherwise("{}"),
         "of the loads, by name; of a load of the wind stage before: the part of it that is left");
    PathSettings::declare(keys);
    keys.is("wind", "loads the inflated cushion");
  }
  static void check(Reader& reader, const At<WindSettings>& settings);
};

} // namespace pneuma::pipeline::workflow
