// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/workflows/damage/corpus.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/places.h"
#include "tests/workflows/damage/yaml_text.h"

namespace pneuma::tests::damage {

namespace fs = std::filesystem;

namespace {

constexpr const char* damaged_name = "damaged.yaml";
constexpr const char* user_name = "uses.yaml";
constexpr double stage_gigabytes = 8; // OpenBLAS reserves address space

// A folder that is gone at the end, with the YAML files of the source tree.
class Tree {
public:
  explicit Tree(const fs::path& top) {
    std::string name = (fs::temp_directory_path() / "pneuma-damage-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
    fs::create_directory(folder / "out");
    for (const char* part : {"projects", "configs"}) {
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(top / part)) {
        if (entry.path().extension() != ".yaml") continue;
        const fs::path there = folder / fs::relative(entry.path(), top);
        fs::create_directories(there.parent_path());
        fs::copy_file(entry.path(), there);
      }
    }
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  ~Tree() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  fs::path folder;
};

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

// What the programs take from a workflow file in a folder of the tree.
Settings settings_of(const Tree& tree, const fs::path& folder, const std::string& file) {
  const fs::path out = tree.folder / "out";
  const Ending ending = run_limited({fs::path(program_folder) / "damage_effective", file, out}, tree.folder / folder);
  if (ending.code != 0) throw std::runtime_error(fmt::format("{}: {}\n{}", file, ending.words(), ending.text));
  Settings settings;
  std::istringstream lines(ending.text);
  for (std::string run, id; lines >> run && std::getline(lines >> std::ws, id);) {
    if (run.find(':') != std::string::npos) continue; // a warning
    const std::string text = read_file(out / fmt::format("{}.yaml", settings.stages.size()));
    add_values(text, settings.values);
    settings.stages.push_back({run, id, text});
  }
  return settings;
}

// A flat foil of every material, one above the other.
std::string workflow_of(const Piece& materials) {
  std::string foils, chambers, pressures;
  for (std::size_t i = 0; i < materials.keys.size(); ++i) {
    foils += fmt::format("    - {{name: f{}, material: {}, thickness: 200 um}}\n", i, materials.keys[i].text);
    if (i == 0) continue;
    chambers += fmt::format("    - {{name: c{0}, between: [f{1}, f{0}]}}\n", i, i - 1);
    pressures += fmt::format("{}c{}: 300 Pa", i == 1 ? "" : ", ", i);
  }
  return fmt::format("pneuma: 1\nmaterials: {}\ncushion:\n  plan: {{shape: circle, radius: 1 m}}\n  foils:\n{}"
                     "  chambers:\n{}mesh: {{size: 0.2 m}}\nstages:\n"
                     "  up: {{run: inflate, from: mesh, gauge_pressure: {{{}}}}}\n",
                     damaged_name, foils, chambers, pressures);
}

// The values only: where they stand moves with every line.
std::string without_places(const std::string& stage_yaml) {
  return stage_yaml.substr(0, stage_yaml.find("\norigin:"));
}

// The default that the JSON schema names for a path, as YAML. `values`: what stands in the file, to choose a kind by.
class Defaults {
public:
  explicit Defaults(const std::string& schema) : schema_(nlohmann::json::parse(schema)) {}

  std::optional<std::string> at(const std::string& path, const std::map<std::string, std::string>& values) const {
    std::vector<const nlohmann::json*> nodes = {&schema_};
    std::string above;
    for (std::size_t from = 0; from <= path.size();) {
      const std::size_t to = std::min(path.find('.', from), path.size());
      const std::string name = path.substr(from, to - from);
      std::vector<const nlohmann::json*> next;
      for (const nlohmann::json* node : nodes) descend(*node, name, above, values, next);
      nodes = std::move(next);
      above = path.substr(0, to);
      from = to + 1;
    }
    for (const nlohmann::json* node : nodes) {
      if (!node->contains("default")) continue;
      const nlohmann::json& value = node->at("default");
      return value.is_string() ? value.get<std::string>() : value.dump();
    }
    return std::nullopt;
  }

private:
  static void descend(const nlohmann::json& node, const std::string& name, const std::string& above,
                      const std::map<std::string, std::string>& values, std::vector<const nlohmann::json*>& found) {
    for (const char* choice : {"anyOf", "oneOf", "allOf"}) {
      if (!node.contains(choice)) continue;
      for (const nlohmann::json& one : node.at(choice)) descend(one, name, above, values, found);
    }
    if (node.contains("properties")) {
      for (const auto& [key, value] : node.at("properties").items()) { // another kind than the file's
        const auto tag = values.find(above.empty() ? key : above + "." + key);
        if (value.contains("const") && tag != values.end() && value.at("const") != tag->second) return;
      }
    }
    if (node.contains("properties") && node.at("properties").contains(name)) {
      found.push_back(&node.at("properties").at(name));
    } else if (node.contains("additionalProperties") && node.at("additionalProperties").is_object()) {
      found.push_back(&node.at("additionalProperties"));
    } else if (node.contains("items")) {
      found.push_back(&node.at("items"));
    }
  }

  nlohmann::json schema_;
};

Answer answer(const Job& job, const Tree& tree, const Defaults& defaults, bool with_stages) {
  const Source& source = *job.source;
  const Damage& damage = *job.damage;
  const fs::path folder = tree.folder / source.folder;
  write_file(folder / damaged_name, damaged(source.text, damage));
  if (!source.user_text.empty()) write_file(folder / user_name, source.user_text);
  const bool is_stage = source.kind == Source::Kind::stage;
  const std::string file = source.kind == Source::Kind::materials ? user_name : damaged_name;

  Answer answer;
  const auto note = [&](const Ending& ending, bool refusal_is_judged) {
    answer.code = ending.code;
    answer.messages = ending.text;
    if (ending.hung || ending.signal != 0 || (ending.code != 0 && ending.code != 2)) {
      answer.wrong = ending.words();
    } else if (ending.text.find("please report") != std::string::npos) {
      answer.wrong = "please report it";
    } else if (ending.code == 2 && refusal_is_judged) {
      const Names names{damaged_name, source.user_text.empty() ? "" : user_name, source.user_text};
      answer.wrong = wrong_refusal(damage, ending.text, names);
    }
  };
  if (is_stage) {
    note(run_limited({program(source.program), "--check", "--config", file}, folder, {10, stage_gigabytes}), false);
    return answer;
  }
  note(run_limited({program("pneuma"), "check", file}, folder), true);
  if (answer.code != 0 || !answer.wrong.empty()) return answer;

  Settings now;
  try {
    now = settings_of(tree, source.folder, file);
  } catch (const std::runtime_error& error) {
    answer.wrong = error.what();
    return answer;
  }
  const bool in_materials = source.kind == Source::Kind::materials;
  answer.wrong = wrong_acceptance(damage, source.settings, now, in_materials);
  if (damage.kind == Kind::key_dropped && answer.wrong.empty()) {
    std::map<std::string, std::string> written, in_file;
    add_values(source.text, in_file);
    for (const auto& [key, value] : in_file) written[in_materials ? "materials." + key : key] = value;
    const auto text = defaults.at(in_materials ? "materials." + damage.path : damage.path, written);
    try {
      if (text) {
        std::string whole = source.text;
        whole.replace(damage.value_begin, damage.value_end - damage.value_begin, " " + *text);
        write_file(folder / damaged_name, whole);
      }
      const Settings other = text ? settings_of(tree, source.folder, file) : Settings();
      answer.wrong = wrong_default(damage, now, text ? &other : nullptr, in_materials);
    } catch (const std::runtime_error& error) {
      answer.wrong = fmt::format("its default `{}` is refused: {}", *text, error.what());
    }
  }
  if (!with_stages) return answer;
  // the first stage of each kind that is another now
  std::set<std::string> seen;
  for (const EffectiveStage& stage : now.stages) {
    const auto same = [&](const EffectiveStage& before) {
      return before.id == stage.id && without_places(before.text) == without_places(stage.text);
    };
    if (std::any_of(source.settings.stages.begin(), source.settings.stages.end(), same)) continue;
    if (!seen.insert(stage.run).second) continue;
    write_file(folder / "stage.yaml", stage.text);
    const Ending ending = run_limited({program("pneuma-" + stage.run), "--check", "--config", "stage.yaml"}, folder,
                                      {10, stage_gigabytes});
    if (ending.code == 0) continue;
    answer.wrong.clear(); // it is refused after all
    note(ending, true);
    answer.code = 0;
    answer.by_stage = true;
    if (!answer.wrong.empty()) answer.wrong = fmt::format("pneuma-{}: {}", stage.run, answer.wrong);
    break;
  }
  return answer;
}

} // namespace

std::string read_file(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return std::move(text).str();
}

fs::path program(const std::string& name) {
  const char* folder = std::getenv("PNEUMA_BIN");
  return fs::path(folder != nullptr ? folder : program_folder) / name;
}

std::vector<Source> sources(const fs::path& top) {
  const Tree tree(top);
  std::vector<fs::path> files;
  for (const char* part : {"projects", "configs"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree.folder / part)) {
      if (entry.path().extension() == ".yaml") files.push_back(fs::relative(entry.path(), tree.folder));
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Source> found;
  std::vector<Source> stages;
  for (const fs::path& file : files) {
    Source source;
    source.name = file.generic_string();
    source.folder = file.parent_path();
    source.text = read_file(tree.folder / file);
    const Piece pieces = pieces_of(source.text);
    const auto is_version = [](const Piece::Key& key) { return key.text == "pneuma"; };
    std::string whole = file.filename();
    if (std::none_of(pieces.keys.begin(), pieces.keys.end(), is_version)) {
      source.kind = Source::Kind::materials;
      source.user_text = workflow_of(pieces);
      write_file(tree.folder / source.folder / damaged_name, source.text);
      write_file(tree.folder / source.folder / user_name, source.user_text);
      whole = user_name;
    }
    source.settings = settings_of(tree, source.folder, whole);
    source.damages = damages_of(source.text);
    if (file.filename() == "workflow.yaml") {
      std::set<std::string> seen;
      for (const EffectiveStage& stage : source.settings.stages) {
        if (!seen.insert(stage.run).second) continue;
        Source one;
        one.kind = Source::Kind::stage;
        one.name = fmt::format("{}: {}", source.name, stage.run);
        one.folder = source.folder;
        one.text = stage.text;
        one.program = "pneuma-" + stage.run;
        for (const Damage& damage : damages_of(one.text)) { // one of the places stands for them all
          if (!damage.path.starts_with("origin.") || damage.path == "origin.pneuma") one.damages.push_back(damage);
        }
        stages.push_back(std::move(one));
      }
    }
    found.push_back(std::move(source));
  }
  std::move(stages.begin(), stages.end(), std::back_inserter(found));
  return found;
}

namespace {

// As the standard leaves std::shuffle open.
template <class Things>
void shuffle(Things& things, std::mt19937& random) {
  for (std::size_t i = things.size(); i > 1; --i) std::swap(things[i - 1], things[random() % i]);
}

} // namespace

std::vector<Job> all_jobs(const std::vector<Source>& sources, std::uint32_t seed) {
  std::vector<Job> jobs;
  for (const Source& source : sources) {
    for (const Damage& damage : source.damages) jobs.push_back({&source, &damage});
  }
  std::mt19937 random(seed);
  shuffle(jobs, random);
  return jobs;
}

std::vector<Job> sample(const std::vector<Source>& sources, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto of_kind = [&](Source::Kind of, std::size_t most) {
    std::vector<std::vector<Job>> groups; // of one kind of damage and one file
    for (int kind = 0; kind < kind_count; ++kind) {
      for (const Source& source : sources) {
        std::vector<Job> group;
        for (const Damage& damage : source.damages) {
          if (source.kind == of && damage.kind == static_cast<Kind>(kind)) group.push_back({&source, &damage});
        }
        shuffle(group, random);
        if (!group.empty()) groups.push_back(std::move(group));
      }
    }
    shuffle(groups, random);
    std::vector<Job> jobs;
    for (std::size_t round = 0; jobs.size() < most; ++round) {
      const std::size_t before = jobs.size();
      for (const std::vector<Job>& group : groups) {
        if (round < group.size() && jobs.size() < most) jobs.push_back(group[round]);
      }
      if (jobs.size() == before) break;
    }
    return jobs;
  };
  // a fifth of the laws, which are in few lines, a quarter of what the stage programs read
  std::vector<Job> jobs = of_kind(Source::Kind::workflow, count - count / 5 - count / 4);
  for (const auto& [kind, part] : {std::pair(Source::Kind::materials, count / 5), {Source::Kind::stage, count / 4}}) {
    const std::vector<Job> more = of_kind(kind, part);
    jobs.insert(jobs.end(), more.begin(), more.end());
  }
  return jobs;
}

std::vector<Answer> answers(const std::vector<Job>& jobs, const fs::path& top, bool with_stages) {
  const Ending schema = run_limited({program("pneuma"), "schema"}, top);
  const Defaults defaults(schema.text);
  std::vector<Answer> found(jobs.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    const Tree tree(top);
    for (std::size_t i = next++; i < jobs.size(); i = next++) found[i] = answer(jobs[i], tree, defaults, with_stages);
  };
  { const std::jthread one(work), other(work); }
  return found;
}

} // namespace pneuma::tests::damage
