// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/base/quantities.h"
#include "geometry/outline.h"
#include "pipeline/workflow/forms.h"

namespace pneuma::pipeline::workflow {

// Where the cushion is.
struct Site {
  base::AbsolutePressure ambient_pressure; // of the still air around
  double temperature = 0;                  // K, of air and foil
  Vec3 up{0, 0, 0};                        // opposite to gravity, of length 1
  bool gravity = false;

  static void declare(auto& keys) {
    const auto pressure = quantity("Pa").at_least(0, "at least 0 Pa").such_as("101325 Pa").otherwise("101325 Pa");
    keys("ambient_pressure", &Site::ambient_pressure,
         part<base::AbsolutePressure>(pressure, &base::AbsolutePressure::pascal),
         "absolute pressure of the still air around; 0 Pa gives the thesis' gas law");
    keys("temperature", &Site::temperature,
         quantity("K").positive().usual(213.15, 353.15, "usually -60 to 80 degC").otherwise("23 degC"),
         "of air and foil");
    keys("up", &Site::up, direction().otherwise("[0, 0, 1]"), "the direction opposite to gravity");
    keys("gravity", &Site::gravity, flag().otherwise("on"), "weight of the foils in inflate and wind; needs `density`");
  }
  static void check(Reader& reader, const At<Site>& site);
};

struct FoilSettings {
  std::string name, material;
  double thickness = 0; // m
  double warp = 0;      // rad

  static void declare(auto& keys) {
    using Self = FoilSettings;
    keys("name", &Self::name, name_of_a("foil", {all, "base"}), "of the foil");
    keys("material", &Self::material, reference_to("material"), "a name under `materials`");
    keys("thickness", &Self::thickness,
         quantity("m").positive().usual(1e-5, 1e-3, "foils are 10 um .. 1 mm thick").such_as("250 um"),
         "as rolled, unstressed");
    keys("warp", &Self::warp, quantity("rad").otherwise("0 deg"), "angle of the warp direction from x");
  }
};

struct ChamberSettings {
  std::string name;
  std::array<std::string, 2> between;      // foils from the weather side inwards; the second may be "base"
  double dead_volume = 0;                  // m3
  std::optional<std::string> connected_to; // chamber whose air it shares, which is not itself connected

  static void declare(auto& keys) {
    using Self = ChamberSettings;
    keys("name", &Self::name, name_of_a("chamber"), "of the chamber");
    keys("between", &Self::between, tuple<2>(reference_to("foil", "base").named("wall", "a foil, or base")),
         "the two neighbouring foils around it");
    keys("dead_volume", &Self::dead_volume,
         quantity("m3").at_least(0, "at least 0 m3").otherwise("0 m3").such_as("0.5 m3"), "air in ducts");
    keys("connected_to", &Self::connected_to, reference_to("chamber"),
         "another chamber, whose air it shares: one pressure, the sum of the volumes");
  }
};

struct Cushion {
  geometry::Plan plan;
  std::map<std::string, std::string> edges; // every edge -> clamped
  std::vector<FoilSettings> foils;          // from the weather side inwards
  bool rigid_base = false;
  std::vector<ChamberSettings> chambers;

  static void declare(auto& keys) {
    std::vector<schema::Option> other_shapes;
    for (const char* shape : {"regular_polygon", "outline", "file"}) {
      other_shapes.push_back(schema::not_available(shape, "rectangle, circle, triangle and polygon are available"));
    }
    const char* clamped = "clamped edges are available";
    keys("plan", &Cushion::plan,
         schema::variant<geometry::Plan>("shape", other_shapes).defines("edge", geometry::edge_names),
         "the clamped outline in z = 0; rectangle and circle are centred on the origin");
    keys("edges", &Cushion::edges,
         each("edge",
              choice<std::string>({{"clamped", "clamped", "held in all directions"},
                                   {"welded", {}, clamped},
                                   {"free", {}, clamped},
                                   {"symmetry", {}, clamped}})
                  .named("EDGE", "how the edge is held"),
              false)
             .otherwise("{}"),
         "per named edge or `all`");
    keys("foils", &Cushion::foils, list(group<FoilSettings>().named("foil", "a foil")).items(1, 16),
         "from the weather side inwards");
    keys("base", &Cushion::rigid_base, choice<bool>({{"rigid", true, "a flat base through the clamped edge"}}),
         "what the last foil faces")
        .or_another()
        .where([](const auto& cushion) { return cushion.rigid_base; }, "");
    keys("chambers", &Cushion::chambers, list(group<ChamberSettings>().named("chamber", "a chamber")).otherwise("[]"),
         "the air between neighbouring foils");
  }
  static void check(Reader& reader, const At<Cushion>& cushion);

  // The chamber whose air a chamber has: the one it is connected to, or itself.
  const std::string& air_of(const std::string& chamber) const;
};

} // namespace pneuma::pipeline::workflow

namespace pneuma::pipeline::schema {

void declare(Keys<geometry::Rectangle>& keys);
void declare(Keys<geometry::Circle>& keys);
void declare(Keys<geometry::Triangle>& keys);
void declare(Keys<geometry::Polygon>& keys);

} // namespace pneuma::pipeline::schema
