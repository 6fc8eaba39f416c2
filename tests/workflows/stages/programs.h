// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/places.h"

namespace pneuma::tests {

namespace fs = std::filesystem;
using nlohmann::json;

inline const fs::path programs = program_folder;

struct Outcome {
  int code = 0;
  std::string text; // both streams
};

inline Outcome call(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.text += buffer.data();
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000;
  return outcome;
}

// A workflow of one round foil of 1 m over a base, inflated from flat as stage `up`. `material`: the keys of its foil,
// `site`: more keys of the site, `stages`: further stages, indented by two.
inline std::string foil_over_base(const std::string& material, const std::string& pressure,
                                  const std::string& site = "", const std::string& stages = "") {
  return "pneuma: 1\nmaterials: {foil: {" + material + "}}\nsite: {gravity: off" + site + R"(}
cushion:
  plan: {shape: circle, radius: 0.5 m}
  foils: [{name: foil, material: foil, thickness: 200 um}]
  base: rigid
  chambers: [{name: air, between: [foil, base]}]
mesh: {element: T6, size: 0.12 m}
stages:
  up: {run: inflate, from: mesh, gauge_pressure: {air: )" +
         pressure + "}, prestress: {all: 100 N/m}}\n" + stages;
}

// A small cushion that goes through every kind of stage.
inline const std::string every_stage = R"(pneuma: 1
materials: {foil: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}}
cushion:
  plan: {shape: rectangle, length: 2 m, width: 1 m}
  foils: [{name: upper, material: foil, thickness: 200 um}, {name: lower, material: foil, thickness: 200 um}]
  chambers: [{name: main, between: [upper, lower]}]
mesh: {element: T6, size: 0.25 m}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {main: 400 Pa}, prestress: {all: 0.5 kN/m}}
  strips: {run: pattern, from: form, strips_per_foil: 2, direction: 0 deg, lines: straight}
  up: {run: inflate, from: strips, gauge_pressure: {main: 400 Pa}}
  gust: {run: wind, from: up, loads: [{name: s, foil: upper, wind: -0.3 kPa}]}
)";

// A folder of its own with the workflow `w.yaml`, removed at the end.
class InFolder : public testing::Test {
protected:
  InFolder() {
    std::string name = (fs::temp_directory_path() / "pneuma-stages-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~InFolder() override { fs::remove_all(folder); }

  void write(const std::string& text) const { std::ofstream(folder / "w.yaml") << text; }
  Outcome pneuma(const std::string& words) const {
    return call("cd " + folder.string() + " && " + (programs / "pneuma").string() + " " + words);
  }
  fs::path out(const std::string& stage) const { return folder / "out" / "w" / stage; }
  json summary(const std::string& stage) const { return json::parse(std::ifstream(out(stage) / "summary.json")); }

  fs::path folder;
};

} // namespace pneuma::tests
