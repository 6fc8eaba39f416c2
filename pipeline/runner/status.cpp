// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/base/log.h"
#include "pipeline/digest/digest.h"
#include "pipeline/runner/freshness.h"
#include "pipeline/runner/process.h"
#include "pipeline/runner/run.h"

namespace pneuma::pipeline::runner {

namespace {

using nlohmann::json;
using workflow::StageSettings;
using workflow::Workflow;

// A number somewhere in a summary; keys that were not computed are absent.
std::optional<double> number_at(const json& summary, std::initializer_list<const char*> path) {
  const json* at = &summary;
  for (const char* key : path) {
    if (!at->is_object() || !at->contains(key)) return std::nullopt;
    at = &(*at)[key];
  }
  return at->is_number() ? std::optional<double>(at->get<double>()) : std::nullopt;
}

// Of a foil cut into strips; what the summary does not hold is left out.
std::vector<std::string> pattern_values(const json& pattern) {
  std::vector<std::string> values;
  const auto strips = pattern.is_object() ? pattern.find("strips") : pattern.end();
  if (strips != pattern.end() && strips->is_array()) {
    values.push_back(fmt::format("{} strips", strips->size()));
    std::optional<double> largest;
    for (const json& strip : *strips) {
      const auto mismatch = number_at(strip, {"seam_mismatch_max"});
      if (mismatch) largest = std::max(largest.value_or(*mismatch), *mismatch);
    }
    if (largest) values.push_back(fmt::format("seams differ by {:.3g} mm at most", *largest * 1e3));
  }
  if (const auto waste = number_at(pattern, {"waste_fraction"})) {
    values.push_back(fmt::format("waste {:.3g} %", *waste * 100));
  }
  if (const auto weld = number_at(pattern, {"weld_length"})) values.push_back(fmt::format("welds {:.4g} m", *weld));
  return values;
}

void say_results(const json& summary) {
  const auto line = [](const std::string& name, const std::vector<std::string>& values) {
    if (!values.empty()) base::say(fmt::format("    {}: {}", name, fmt::join(values, ", ")));
  };
  if (const auto found = summary.find("verdict"); found != summary.end() && found->is_string()) {
    line("verdict", {found->get<std::string>()});
  }
  if (const auto chambers = summary.find("chambers"); chambers != summary.end() && chambers->is_object()) {
    for (const auto& [name, chamber] : chambers->items()) {
      std::vector<std::string> values;
      if (const auto p = number_at(chamber, {"gauge_pressure"})) values.push_back(fmt::format("{:.6g} Pa", *p));
      if (const auto v = number_at(chamber, {"volume"})) values.push_back(fmt::format("{:.6g} m3", *v));
      line("chamber " + name, values);
    }
  }
  if (const auto foils = summary.find("foils"); foils != summary.end() && foils->is_object()) {
    for (const auto& [name, foil] : foils->items()) {
      std::vector<std::string> values;
      if (const auto sag = number_at(foil, {"sag"})) values.push_back(fmt::format("sag {:.4g} m", *sag));
      if (const auto u = number_at(foil, {"max_deflection"})) values.push_back(fmt::format("deflection {:.4g} m", *u));
      if (const auto s = number_at(foil, {"von_mises", "max"})) {
        values.push_back(fmt::format("von Mises {:.4g} MPa", *s / 1e6));
      }
      line("foil " + name, values);
    }
  }
  if (const auto patterns = summary.find("patterns"); patterns != summary.end() && patterns->is_object()) {
    for (const auto& [name, pattern] : patterns->items()) line("pattern " + name, pattern_values(pattern));
  }
}

Verdict verdict_of(const Workflow& workflow, const StageSettings& stage, const StageFiles& files,
                   const std::filesystem::path& out, const std::map<std::string, bool>& fresh) {
  if (!stage.from.empty() && !fresh.at(stage.from)) return {false, fmt::format("`{}` is stale", stage.from)};
  const auto program = program_folder() / ("pneuma-" + stage.run);
  if (!is_program(program)) return {false, fmt::format("its program pneuma-{} is not there", stage.run)};
  Provenance wanted;
  wanted.settings = digest::sha256_of_text(workflow::effective_settings(workflow, stage));
  if (!stage.from.empty()) wanted.input = good_state(StageFiles(out / stage.from));
  wanted.executable = digest::sha256_of_file(program);
  return examine(files, wanted, workflow::stage_yaml(workflow, stage));
}

// Stages in an order in which each follows the one it starts from.
std::vector<const StageSettings*> from_the_start(const Workflow& workflow) {
  std::vector<const StageSettings*> order;
  const auto add_after = [&](const auto& self, const std::string& from) -> void {
    for (const StageSettings& stage : workflow.stages) {
      if (stage.from != from) continue;
      order.push_back(&stage);
      self(self, stage.id);
    }
  };
  add_after(add_after, "");
  return order;
}

} // namespace

void show_status(const Workflow& workflow, const std::filesystem::path& out_option) {
  const std::filesystem::path out = output_folder(workflow, out_option);
  const std::vector<const StageSettings*> order = from_the_start(workflow);
  std::size_t width = 0;
  for (const StageSettings* stage : order) width = std::max(width, stage->id.size());
  std::map<std::string, bool> fresh;
  for (const StageSettings* stage : order) {
    const StageFiles files(out / stage->id);
    const Verdict verdict = verdict_of(workflow, *stage, files, out, fresh);
    fresh[stage->id] = verdict.fresh;
    base::say(fmt::format("{:<{}}  {:<8}  {}", stage->id, width, stage->run,
                          verdict.fresh ? "fresh" : "stale: " + verdict.reason));
    std::ifstream stream(files.summary);
    const json summary = stream ? json::parse(stream, nullptr, false) : json();
    if (summary.is_object()) say_results(summary);
  }
}

} // namespace pneuma::pipeline::runner
