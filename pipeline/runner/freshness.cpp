// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/runner/freshness.h"

#include <fstream>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/digest/digest.h"
#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::runner {

StageFiles::StageFiles(std::filesystem::path stage_folder)
    : folder(std::move(stage_folder)), config(folder / "stage.yaml"), state(folder / "state.hdf"),
      digest(folder / "state.hdf.sha256"), summary(folder / "summary.json"), log(folder / "log.txt"),
      provenance(folder / "provenance.json") {}

std::optional<Provenance> read_provenance(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto text = [&](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  return Provenance{text("settings"), text("input"), text("executable"), text("state")};
}

void write_provenance(const std::filesystem::path& file, const Provenance& provenance) {
  const nlohmann::ordered_json json = {{"settings", provenance.settings},
                                       {"input", provenance.input},
                                       {"executable", provenance.executable},
                                       {"state", provenance.state}};
  std::filesystem::path unfinished = file;
  unfinished += ".new";
  std::ofstream stream(unfinished);
  stream << json.dump(2) << '\n';
  stream.close();
  if (!stream) throw std::runtime_error(fmt::format("{} cannot be written; is the disk full?", unfinished.string()));
  std::filesystem::rename(unfinished, file);
}

std::string good_state(const StageFiles& files) {
  std::ifstream stream(files.digest);
  std::string digest;
  if (!(stream >> digest) || !std::filesystem::is_regular_file(files.state)) return {};
  return digest::sha256_of_file(files.state) == digest ? digest : std::string();
}

std::string changed_keys(const std::string& before, const std::string& after) {
  const auto values = [](const std::string& text) {
    std::vector<yaml::Problem> ignored;
    const yaml::Node tree = yaml::parse_yaml(text, "stage.yaml", ignored);
    std::map<std::string, std::string> by_path;
    for (const auto& [path, leaf] : yaml::leaves(tree)) {
      if (!path.starts_with("origin.") && path != "name") by_path[path] = leaf->text;
    }
    return by_path;
  };
  const auto then = values(before), now = values(after);
  std::vector<std::string> changes;
  for (const auto& [path, value] : now) {
    const auto old = then.find(path);
    if (old == then.end()) {
      changes.push_back(fmt::format("{} {} is new", path, value));
    } else if (old->second != value) {
      changes.push_back(fmt::format("{} {} -> {}", path, old->second, value));
    }
  }
  for (const auto& [path, value] : then) {
    if (!now.contains(path)) changes.push_back(fmt::format("{} {} is gone", path, value));
  }
  if (changes.empty()) return {};
  const std::string first = changes.front();
  return changes.size() == 1 ? first : fmt::format("{}; and {} more", first, changes.size() - 1);
}

Verdict examine(const StageFiles& files, const Provenance& wanted, const std::string& stage_yaml) {
  const std::optional<Provenance> made = read_provenance(files.provenance);
  if (!made)
    return {false, std::filesystem::exists(files.config) ? "it did not finish last time" : "it has not run yet"};
  if (made->settings != wanted.settings) {
    std::vector<yaml::Problem> ignored;
    const std::string keys = changed_keys(yaml::read_text(files.config, {}, ignored), stage_yaml);
    return {false, keys.empty() ? "settings changed" : fmt::format("settings changed ({})", keys)};
  }
  if (made->input != wanted.input) return {false, "the state it starts from changed"};
  if (made->executable != wanted.executable) return {false, "its program changed"};
  const std::string state = good_state(files);
  if (state.empty()) {
    return {false,
            std::filesystem::exists(files.state) ? "its state does not match its digest" : "its state is missing"};
  }
  if (state != made->state) return {false, "its state was replaced"};
  if (!std::filesystem::exists(files.summary)) return {false, "its summary.json is missing"};
  return {true, ""};
}

} // namespace pneuma::pipeline::runner
