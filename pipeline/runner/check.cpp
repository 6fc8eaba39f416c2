// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/runner/check.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/files/file.h"
#include "pipeline/runner/process.h"

namespace pneuma::pipeline::runner {

using base::ExitCode;
using workflow::Workflow;

namespace fs = std::filesystem;

namespace {

class TemporaryFolder {
public:
  TemporaryFolder() {
    std::error_code failure;
    std::string name = (fs::temp_directory_path(failure) / "pneuma-check-XXXXXX").string();
    if (failure) refuse(failure.message());
    if (mkdtemp(name.data()) == nullptr) refuse(std::strerror(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path write(const std::string& name, const std::string& text) const {
    fs::path file = path_ / name;
    files::write_file(file, text);
    return file;
  }

private:
  [[noreturn]] static void refuse(const std::string& why) {
    throw base::MachineError(
        fmt::format("no temporary folder can be made: {}; let TMPDIR name a folder that has space", why));
  }

  fs::path path_;
};

// The workflow with files in its places named as read_workflow names them in messages, not from the workflow's folder.
Workflow with_places_as_told(Workflow workflow) {
  std::map<std::string, std::string> told = {{workflow.file.filename().string(), workflow.file.generic_string()}};
  for (const auto& [name, material] : workflow.materials) {
    for (const auto& [key, place] : material.places) {
      const auto origin = workflow.origins.find(fmt::format("materials.{}.{}", name, key));
      if (origin != workflow.origins.end()) told.try_emplace(origin->second.file, place.file);
    }
  }
  for (auto& [path, place] : workflow.origins) {
    const auto known = told.find(place.file);
    place.file = known != told.end() ? known->second
                                     : (workflow.file.parent_path() / place.file).lexically_normal().generic_string();
  }
  return workflow;
}

// What a program prints until it ends.
std::string output_of(const Child& child, const Interrupts& interrupts) {
  std::string text;
  std::array<char, 1 << 14> buffer{};
  while (true) {
    std::array<pollfd, 2> watched = {{{interrupts.descriptor(), POLLIN, 0}, {child.output, POLLIN, 0}}};
    if (poll(watched.data(), watched.size(), -1) < 0 && errno != EINTR) return text;
    if (watched[0].revents != 0 && interrupts.take() != 0) { // the programs die with this one
      throw base::Error(ExitCode::interrupted, "interrupted");
    }
    if (watched[1].revents == 0) continue;
    const ssize_t count = read(child.output, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

// The code with which all ends where a program's check ended so; the loader of programs says 127.
ExitCode meaning_of(int code) {
  for (const ExitCode known : {ExitCode::bad_input, ExitCode::impossible_geometry, ExitCode::machine_refuses}) {
    if (code == static_cast<int>(known)) return known;
  }
  return code == 127 ? ExitCode::machine_refuses : ExitCode::bug;
}

} // namespace

void check_by_stages(const Workflow& workflow, MeshCheck mesh) {
  const Workflow told = with_places_as_told(workflow);
  const Interrupts interrupts; // outlives the folder, which nothing then leaves behind
  const TemporaryFolder folder;
  std::set<std::string> kinds;
  std::vector<std::pair<std::string, Child>> asked; // by the name of the program
  for (const workflow::StageSettings& stage : told.stages) {
    if ((stage.run == "mesh" && mesh == MeshCheck::left_out) || !kinds.insert(stage.run).second) continue;
    const fs::path program = program_folder() / ("pneuma-" + stage.run);
    if (mesh == MeshCheck::left_out && !is_program(program)) continue; // the stage itself will say so
    check_program(program);
    const fs::path config = folder.write(stage.run + ".yaml", workflow::stage_yaml(told, stage));
    asked.emplace_back(program.filename().string(), start(program, {"--check", "--config", config.string()}));
  }
  std::set<std::string> known;
  std::string lines;
  const auto add = [&](const std::string& line) {
    if (known.insert(line).second) lines += (lines.empty() ? "" : "\n") + line;
  };
  ExitCode worst = ExitCode::done;
  for (const auto& [program, child] : asked) {
    std::istringstream output(output_of(child, interrupts));
    for (std::string line; std::getline(output, line);) add(line);
    close(child.output);
    const int code = wait_for(child);
    if (code == 0) continue;
    const ExitCode meaning = meaning_of(code);
    if (worst == ExitCode::done || meaning == ExitCode::bug) worst = meaning;
    if (code == 127)
      add(fmt::format("{} cannot be started; raise the limit of memory (ulimit -v), or set up again", program));
    if (meaning != ExitCode::bug) continue;
    const std::string end = code > 128 ? fmt::format("signal {}", code - 128) : fmt::format("exit code {}", code);
    add(fmt::format("{} --check ended by {}; please report it", program, end));
  }
  if (worst != ExitCode::done) throw base::Error(worst, lines);
  if (!lines.empty()) fmt::print(stderr, "{}\n", lines);
}

} // namespace pneuma::pipeline::runner
