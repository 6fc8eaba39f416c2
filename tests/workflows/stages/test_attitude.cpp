// SPDX-License-Identifier: GPL-3.0-or-later
// Without weight no result, verdict or place depends on which way is up: roof, facade, ceiling.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

class Attitude : public InFolder {
protected:
  // Three foils under every kind of change, and crushed: the outer one meets the middle one.
  void run_with(const std::string& up) const {
    write(R"(pneuma: 1
materials: {etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}}
site: {gravity: off, up: )" +
          up + R"(}
cushion:
  plan: {shape: rectangle, length: 4 m, width: 3 m}
  foils:
    - {name: outer, material: etfe, thickness: 200 um}
    - {name: middle, material: etfe, thickness: 100 um}
    - {name: inner, material: etfe, thickness: 200 um}
  chambers: [{name: a, between: [outer, middle]}, {name: b, between: [middle, inner]}]
mesh: {size: 0.5 m}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {a: 300 Pa, b: 300 Pa}, prestress: {outer: 0.8 kN/m, middle: 0.3 kN/m, inner: 0.8 kN/m}}
  up: {run: inflate, from: form, reference: prestressed, gauge_pressure: {a: 300 Pa, b: 300 Pa}}
  suction: {run: wind, from: up, gas: {a: {law: closed}, b: {law: closed}}, loads: [{name: s, foil: outer, wind: -0.3 kPa}]}
  pressed: {run: wind, from: up, loads: [{name: s, foil: outer, wind: 0.1 kPa}]}
  emptier: {run: wind, from: up, gas: {a: {law: regulated, gauge_pressure: 280 Pa}}}
  crushed: {run: wind, from: up, loads: [{name: s, foil: outer, patch: {center: [0.5 m, 0.2 m], size: [1 m, 1 m], force: [0 N, 0 N, -2 kN]}}]}
)");
    EXPECT_EQ(pneuma("run w.yaml").code, 5) << up;
  }

  // What a stage says, without what its time and memory were.
  json told(const std::string& stage) const {
    json all = summary(stage);
    for (const char* cost : {"timing", "memory_peak"}) all.erase(cost);
    return all;
  }
};

void expect_same(const json& a, const json& b, const std::string& path) {
  if (a.is_number() && b.is_number()) {
    const double x = a.get<double>(), y = b.get<double>();
    EXPECT_NEAR(x, y, 1e-9 * std::max(1.0, std::abs(x))) << path;
  } else if (a.is_structured() && a.size() == b.size()) {
    for (const auto& [key, value] : a.items()) {
      expect_same(value, a.is_array() ? b.at(std::stoul(key)) : b.value(key, json()), path + "/" + key);
    }
  } else {
    EXPECT_EQ(a, b) << path;
  }
}

TEST_F(Attitude, ChangesNothingWithoutWeight) {
  const std::vector<std::string> stages = {"up", "suction", "pressed", "emptier", "crushed"};
  std::map<std::string, json> roof;
  run_with("[0, 0, 1]");
  for (const std::string& stage : stages) roof[stage] = told(stage);
  EXPECT_THAT(roof["crushed"]["verdict"].get<std::string>(), testing::HasSubstr("contact at load factor"));
  EXPECT_EQ(roof["emptier"]["verdict"], "converged");
  for (const char* up : {"[0, 1, 0]", "[-1, 0, 0]", "[0, 0, -1]", "[0.3, -0.5, 0.4]"}) {
    run_with(up);
    for (const std::string& stage : stages) expect_same(roof[stage], told(stage), std::string(up) + " " + stage);
  }
}

} // namespace
} // namespace pneuma::tests
