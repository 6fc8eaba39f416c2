// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/options.h"

#include <algorithm>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/command_line/command_line.h"
#include "pipeline/schema/quantity.h"

namespace pneuma::stages::material {

namespace {

using base::InputError;
using pipeline::command_line::Command;
using pipeline::command_line::Times;
using pipeline::command_line::whole_number;
using pipeline::command_line::Words;
using pipeline::schema::parse_number;

// A number in `unit` or, with a unit behind it, any quantity of its kind.
double quantity(const std::string& option, const std::string& text, const std::string& unit) {
  if (const auto plain = parse_number(text)) return *plain;
  const pipeline::schema::Quantity read = pipeline::schema::parse_quantity(text, unit);
  if (!read.error.empty()) throw InputError(fmt::format("{}: {}", option, read.error));
  return read.value;
}

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> result;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    result.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return result;
}

void set_strain(Options& options, const std::string& text) {
  options.strain = quantity("--strain", text, "1");
  if (!(options.strain > 0 && options.strain <= most_strain)) {
    throw InputError(
        fmt::format("--strain: `{}` is not above 0 and up to {:g} ({:g} %)", text, most_strain, 100 * most_strain));
  }
  constexpr double usual = 5;
  if (options.strain >= usual && parse_number(text)) {
    base::warn(fmt::format("--strain: {0} is {1:g} %; is `{0} %` meant?", text, 100 * options.strain));
  }
}

void set_rates(Options& options, const std::string& text) {
  options.rates.clear();
  for (const std::string& one : parts(text)) {
    options.rates.push_back(quantity("--rate", one, "1/s"));
    if (!(options.rates.back() > 0)) throw InputError(fmt::format("--rate: `{}` is not positive", one));
  }
}

void set_ratios(Options& options, const std::string& text) {
  options.ratios.clear();
  for (const std::string& one : parts(text)) {
    if (one == "shear") {
      options.ratios.push_back(pure_shear);
      continue;
    }
    const std::size_t colon = one.find(':');
    const auto a = parse_number(one.substr(0, colon));
    const auto b = parse_number(colon == std::string::npos ? std::string() : one.substr(colon + 1));
    if (!a || !b || (*a == 0 && *b == 0)) {
      throw InputError(
          fmt::format("--ratios: `{}` is no ratio of stresses such as 1:0 (uniaxial), 1:1 or 2:1, nor `shear`", one));
    }
    options.ratios.push_back({*a, *b});
  }
}

void set_temperature(Options& options, const std::string& text) {
  const pipeline::schema::Quantity read = pipeline::schema::parse_quantity(text, "K");
  if (!read.error.empty()) throw InputError(fmt::format("--temperature: {}", read.error));
  options.temperature = read.value;
}

void set_angle(Options& options, const std::string& text) {
  const pipeline::schema::Quantity read = pipeline::schema::parse_quantity(text, "rad");
  if (!read.error.empty()) throw InputError(fmt::format("--angle: {}", read.error));
  options.angle = read.value;
}

void check_together(const Options& options) {
  if (!options.csv.empty() && std::find(options.data.begin(), options.data.end(), options.csv) != options.data.end()) {
    throw InputError(fmt::format("--csv: `{}` holds the test data", options.csv.string()));
  }
  if (options.true_measures && !options.data.empty()) {
    throw InputError("--true: tests are in engineering strain and nominal stress; leave --data out, or --true");
  }
  const auto is_shear = [](const Ratio& ratio) { return ratio.shear; };
  if (options.true_measures && std::any_of(options.ratios.begin(), options.ratios.end(), is_shear)) {
    throw InputError("--true: has no meaning in shear; leave `shear` out of --ratios, or --true");
  }
  if (!options.svg.empty() && options.svg.extension() != ".svg") {
    throw InputError(fmt::format("--svg: `{}` does not end in .svg", options.svg.string()));
  }
}

Command program(Options& o) {
  return {
      "pneuma-material",
      "pulls test pieces of materials, draws their curves, compares them with tests, and fits hardening to those",
      {{"MATERIALS.yaml", "", "file of materials", [&](const Words& v) { o.materials = v[0]; }, Times::once},
       {"NAME", "", "materials of the file [all]", [&](const Words& v) { o.names.push_back(v[0]); }, Times::any},
       {"--strain", "E", "pull the pieces to this engineering strain, and back to no force [10 %]",
        [&](const Words& v) { set_strain(o, v[0]); }},
       {"--ratios", "A:B,...",
        "nominal stresses along the two axes; 1:0 is uniaxial; shear: 2 E12, with free sides [1:0,1:1,2:1]",
        [&](const Words& v) { set_ratios(o, v[0]); }},
       {"--rate", "R,...", "strain rates of foils that know time, 1/s or with a unit [0.001]",
        [&](const Words& v) { set_rates(o, v[0]); }},
       {"--temperature", "T", "of the foil, with a unit, where its values depend on it [that of the tests; 23 degC]",
        [&](const Words& v) { set_temperature(o, v[0]); }},
       {"--angle", "A", "from the warp direction to the first axis, with a unit [0 deg]",
        [&](const Words& v) { set_angle(o, v[0]); }},
       {"--true", "", "logarithmic strain and Cauchy stress [engineering strain and nominal stress]",
        [&](const Words&) { o.true_measures = true; }},
       {"--steps", "N", "of loading, 10 to 100000 [100]",
        [&](const Words& v) { o.steps = whole_number("--steps", v[0], 10, 100000); }},
       {"--data", "FILE.csv", "data of a test to compare with: the misfit, and marks in the picture; again for more",
        [&](const Words& v) { o.data.emplace_back(v[0]); }, Times::any},
       {"--csv", "FILE.csv", "write all points of the curves", [&](const Words& v) { o.csv = v[0]; }},
       {"--svg", "FILE.svg", "draw the curves", [&](const Words& v) { o.svg = v[0]; }},
       {"--fit", "N", "the N hardening branches, 1 to 8, nearest to the uniaxial test data, or to the curve itself",
        [&](const Words& v) { o.branches = whole_number("--fit", v[0], 1, 8); }},
       {"--softening", "", "branches before the last may fall", [&](const Words&) { o.softening = true; }}},
      {},
      [&] { check_together(o); }};
}

} // namespace

std::string name_of(const Ratio& ratio) {
  if (ratio.shear) return "shear";
  if (ratio.b == 0) return "uniaxial";
  return fmt::format("{:.4g}:{:.4g}", ratio.a, ratio.b);
}

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  if (!pipeline::command_line::read(program(options), Words(argv + 1, argv + argc))) return std::nullopt;
  return options;
}

} // namespace pneuma::stages::material
