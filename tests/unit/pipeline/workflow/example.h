// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

// A workflow without fault that uses three foils, two chambers and all kinds of stages.
inline const std::string example = R"(pneuma: 1
name: Test cushion
materials:
  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}
cushion:
  plan: {shape: rectangle, length: 6 m, width: 3 m}
  edges: {all: clamped}
  foils:
    - {name: upper, material: etfe, thickness: 250 um}
    - {name: middle, material: etfe, thickness: 100 um}
    - {name: lower, material: etfe, thickness: 200 um}
  chambers:
    - {name: top, between: [upper, middle]}
    - {name: bottom, between: [middle, lower]}
mesh: {element: T6, size: 0.15 m}
stages:
  form: {run: formfind, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 0.89 kN/m}}
  inflated: {run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed}
  gust:
    run: wind
    from: inflated
    gas: {top: {law: closed, kappa: 1.4}}
    loads: [{name: suction, foil: upper, wind: -0.6 kPa}]
)";

inline std::string replaced(std::string text, const std::string& before, const std::string& after) {
  const auto at = text.find(before);
  if (at == std::string::npos) throw std::logic_error("the example does not hold `" + before + "`");
  return text.replace(at, before.size(), after);
}

// A folder of its own for each test, removed with it.
class Folder {
public:
  Folder() {
    std::string name = (std::filesystem::path(testing::TempDir()) / "pneuma_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

} // namespace pneuma::pipeline::workflow
