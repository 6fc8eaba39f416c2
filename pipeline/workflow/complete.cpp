// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "pipeline/workflow/stages.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::below;

// {FOIL or all: ...}: to these foils, or edges, each.
template <class V>
void spread(Reader& reader, std::map<std::string, V>& table, const std::string& path,
            const std::vector<std::string>& names) {
  const auto found = table.find(all);
  if (found == table.end()) return;
  const V of_all = found->second;
  table.erase(found);
  for (const std::string& name : names) {
    if (table.emplace(name, of_all).second) reader.came_from(below(path, name), below(path, all));
  }
}

std::vector<std::string> foil_names(const Cushion& cushion) {
  std::vector<std::string> names;
  for (const FoilSettings& foil : cushion.foils) names.push_back(foil.name);
  return names;
}

// Chambers have the pressure of those they are connected to.
void share(Reader& reader, const Cushion& cushion, std::map<std::string, double>& pressures, const std::string& path) {
  for (const ChamberSettings& chamber : cushion.chambers) {
    const std::string& air = cushion.air_of(chamber.name);
    if (air == chamber.name) continue;
    if (!pressures.contains(chamber.name)) reader.came_from(below(path, chamber.name), below(path, air));
    pressures[chamber.name] = pressures.at(air);
  }
}

void complete_cushion(Reader& reader, Cushion& cushion) {
  const std::vector<std::string> edges = geometry::edge_names(cushion.plan);
  spread(reader, cushion.edges, "cushion.edges", edges);
  for (const std::string& edge : edges) cushion.edges.emplace(edge, "clamped");
  const std::vector<std::string> foils = foil_names(cushion);
  for (ChamberSettings& chamber : cushion.chambers) {
    auto& [first, second] = chamber.between;
    const auto at = [&](const std::string& wall) { return std::find(foils.begin(), foils.end(), wall); };
    if (at(second) < at(first)) std::swap(first, second);
  }
}

void complete_path(Reader& reader, const Cushion& cushion, PathSettings& settings, const std::string& path) {
  std::vector<Moment>& history = settings.history;
  if (reader.given(below(path, "duration"))) {
    reader.came_from(path + ".history.0.time", below(path, "duration"));
  } else if (!history.empty() && history.front().time == 0 && history.front().factor == 0) {
    history.erase(history.begin()); // the beginning, said
  }
  std::string air;
  for (const ChamberSettings& chamber : cushion.chambers) {
    if (cushion.air_of(chamber.name) == chamber.name && air.empty()) air = chamber.name;
  }
  auto* displacement = std::get_if<DisplacementControl>(&settings.control);
  if (displacement != nullptr && displacement->foil.empty()) displacement->foil = cushion.foils.front().name;
  auto* volume = std::get_if<VolumeControl>(&settings.control);
  if (volume != nullptr && volume->chamber.empty()) volume->chamber = air;
  auto* arc = std::get_if<ArcLengthControl>(&settings.control);
  if (arc != nullptr && arc->needs_chamber() && !arc->chamber) arc->chamber = air;
}

void complete_wind(const Cushion& cushion, WindSettings& wind) {
  for (const ChamberSettings& chamber : cushion.chambers) {
    if (cushion.air_of(chamber.name) == chamber.name) wind.gas.emplace(chamber.name, RegulatedGas{});
  }
  for (const Load& load : wind.loads) wind.factors.emplace(load.name, 1);
}

} // namespace

void complete(Reader& reader, Workflow& workflow) {
  Cushion& cushion = workflow.cushion;
  complete_cushion(reader, cushion);
  const std::vector<std::string> foils = foil_names(cushion);
  for (StageSettings& stage : workflow.stages) {
    const std::string path = "stages." + stage.id;
    if (auto* form = std::get_if<FormfindSettings>(&stage.settings)) {
      share(reader, cushion, form->gauge_pressure, path + ".gauge_pressure");
      spread(reader, form->prestress, path + ".prestress", foils);
      if (!form->stress) continue;
      spread(reader, *form->stress, path + ".stress", foils);
      reader.came_from(path + ".prestress", path + ".stress");
      for (const FoilSettings& foil : cushion.foils) {
        form->prestress[foil.name] = form->stress->at(foil.name) * foil.thickness;
      }
      form->stress.reset();
    } else if (auto* pattern = std::get_if<PatternSettings>(&stage.settings)) {
      spread(reader, pattern->curves, path + ".curves", pattern->foils.value_or(foils));
    } else if (auto* inflate = std::get_if<InflateSettings>(&stage.settings)) {
      share(reader, cushion, inflate->gauge_pressure, path + ".gauge_pressure");
      if (inflate->prestress) spread(reader, *inflate->prestress, path + ".prestress", foils);
      complete_path(reader, cushion, *inflate, path);
    } else if (auto* wind = std::get_if<WindSettings>(&stage.settings)) {
      complete_wind(cushion, *wind);
      complete_path(reader, cushion, *wind, path);
    }
  }
}

} // namespace pneuma::pipeline::workflow
