// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/runner/freshness.h"

#include <fstream>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/digest/digest.h"
#include "pipeline/files/outputs.h"
#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::runner {

namespace fs = std::filesystem;

StageFiles::StageFiles(fs::path stage_folder)
    : folder(std::move(stage_folder)), config(folder / "stage.yaml"), state(folder / "state.hdf"),
      digest(folder / "state.hdf.sha256"), summary(folder / "summary.json"), log(folder / "log.txt"),
      provenance(folder / "provenance.json") {}

std::string Provenance::state() const {
  const auto found = outputs.find("state.hdf");
  return found != outputs.end() ? found->second : "";
}

namespace {

std::string text_at(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Of the last run, by what it entered itself and by what the runner noted of it.
std::set<std::string> names_of_outputs(const StageFiles& files) {
  std::set<std::string> names;
  for (const fs::path& file : {files.state, files.digest, files.summary, files.log}) {
    names.insert(file.filename().string());
  }
  names.merge(pipeline::files::outputs_of(files.state));
  return names;
}

} // namespace

std::optional<Provenance> read_provenance(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object() || !json.contains("outputs") || !json["outputs"].is_object()) return std::nullopt;
  Provenance made{text_at(json, "settings"), text_at(json, "input"), text_at(json, "executable"), {}, 0, ""};
  for (const auto& [name, digest] : json["outputs"].items())
    made.outputs[name] = text_at(json["outputs"], name.c_str());
  if (const auto code = json.find("exit_code"); code != json.end() && code->is_number_integer()) made.exit_code = *code;
  made.verdict = text_at(json, "verdict");
  return made;
}

void write_provenance(const fs::path& file, const Provenance& made) {
  const nlohmann::ordered_json json = {{"settings", made.settings},     {"input", made.input},
                                       {"executable", made.executable}, {"exit_code", made.exit_code},
                                       {"verdict", made.verdict},       {"outputs", made.outputs}};
  pipeline::files::write_file(file, json.dump(2) + "\n");
}

std::map<std::string, std::string> digests_of_outputs(const StageFiles& files) {
  std::map<std::string, std::string> digests;
  for (const std::string& name : names_of_outputs(files)) {
    if (fs::is_regular_file(files.folder / name)) digests[name] = digest::sha256_of_file(files.folder / name);
  }
  return digests;
}

void remove_results(const StageFiles& files) {
  std::set<std::string> names = names_of_outputs(files);
  if (const std::optional<Provenance> made = read_provenance(files.provenance)) {
    for (const auto& [name, digest] : made->outputs) names.insert(name);
  }
  // first that it is not done
  names.erase(files.provenance.filename().string());
  pipeline::files::remove_outputs(files.folder, {files.provenance.filename().string()});
  pipeline::files::remove_outputs(files.folder, names);
}

std::string verdict_in(const fs::path& summary) {
  std::ifstream stream(summary);
  const nlohmann::json json = stream ? nlohmann::json::parse(stream, nullptr, false) : nlohmann::json();
  return json.is_object() ? text_at(json, "verdict") : "";
}

std::string good_state(const StageFiles& files) {
  std::ifstream stream(files.digest);
  std::string digest;
  if (!(stream >> digest) || !fs::is_regular_file(files.state)) return {};
  return digest::sha256_of_file(files.state) == digest ? digest : std::string();
}

std::string changed_keys(const std::string& before, const std::string& after) {
  std::vector<yaml::Problem> ignored;
  std::vector<yaml::Difference> changes = yaml::differences(yaml::parse_yaml(before, "stage.yaml", ignored),
                                                            yaml::parse_yaml(after, "stage.yaml", ignored));
  std::erase_if(changes,
                [](const yaml::Difference& one) { return one.path.starts_with("origin.") || one.path == "name"; });
  if (changes.empty()) return {};
  const std::string first = to_string(changes.front());
  return changes.size() == 1 ? first : fmt::format("{}; and {} more", first, changes.size() - 1);
}

namespace {

// What is wrong with the files of a stage that was finished; empty: nothing.
std::string fault_of_outputs(const StageFiles& files, const Provenance& made) {
  for (const fs::path& needed : {files.state, files.digest, files.summary, files.log}) {
    if (!made.outputs.contains(needed.filename().string())) return "its record is not whole";
  }
  for (const auto& [name, digest] : made.outputs) {
    std::error_code ignored;
    if (!fs::is_regular_file(fs::symlink_status(files.folder / name, ignored)))
      return fmt::format("its {} is missing", name);
    if (digest::sha256_of_file(files.folder / name) != digest) return fmt::format("its {} was changed", name);
  }
  for (const std::string& name : pipeline::files::outputs_of(files.state)) {
    if (!made.outputs.contains(name)) return "its record is not whole";
  }
  return {};
}

} // namespace

Verdict examine(const StageFiles& files, const Provenance& wanted, const std::string& stage_yaml) {
  const std::optional<Provenance> made = read_provenance(files.provenance);
  if (!made) return {false, fs::exists(files.config) ? "it did not finish last time" : "it has not run yet"};
  if (made->settings != wanted.settings) {
    std::vector<yaml::Problem> ignored;
    const std::string keys = changed_keys(yaml::read_text(files.config, {}, ignored), stage_yaml);
    return {false, keys.empty() ? "settings changed" : fmt::format("settings changed ({})", keys)};
  }
  if (made->input != wanted.input) return {false, "the state it starts from changed"};
  if (made->executable != wanted.executable) return {false, "its program changed"};
  if (made->exit_code != 0) {
    return {false, made->verdict.empty() ? fmt::format("it ended with exit code {}", made->exit_code)
                                         : fmt::format("it ended: {}", made->verdict)};
  }
  const std::string fault = fault_of_outputs(files, *made);
  return {fault.empty(), fault};
}

} // namespace pneuma::pipeline::runner
