// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/workflows/damage/damage.h"
#include "tests/workflows/damage/limited.h"
#include "tests/workflows/damage/verdict.h"

namespace pneuma::tests::damage {

// A file that is damaged.
struct Source {
  enum class Kind : std::uint8_t { workflow, materials, stage } kind = Kind::workflow;
  std::string name;             // "projects/single_chamber/workflow.yaml"; of a stage file with its stage behind
  std::filesystem::path folder; // from the top, where the damaged file is put
  std::string text;
  std::string program;   // of a stage file: "pneuma-wind"
  std::string user_text; // of a file of materials: a workflow that uses them all
  Settings settings;     // undamaged; not of a stage file
  std::vector<Damage> damages;
};

struct Job {
  const Source* source = nullptr;
  const Damage* damage = nullptr;
};

struct Answer {
  int code = -1;         // of `check`, or of the stage program; -1: a signal, or it hung
  bool by_stage = false; // refused by a stage program's --check
  std::string wrong;     // empty: as it must be
  std::string messages;
};

// All that is in projects/ and configs/, and a stage.yaml of each kind of each project's workflow.yaml, by name.
// `top`: of the source tree. Throws where a file is not accepted undamaged.
std::vector<Source> sources(const std::filesystem::path& top);

// All, shuffled: the first thousand show what the rest will be like.
std::vector<Job> all_jobs(const std::vector<Source>& sources, std::uint32_t seed);
// `count` of them, as many of each kind and file as can be; the same for the same sources.
std::vector<Job> sample(const std::vector<Source>& sources, std::size_t count, std::uint32_t seed);

// Damages, runs and judges, on two threads. `with_stages`: what `check` accepts is given to `pneuma-<stage> --check`.
std::vector<Answer> answers(const std::vector<Job>& jobs, const std::filesystem::path& top, bool with_stages);

// The programs under test, the folder of PNEUMA_BIN or of the build.
std::filesystem::path program(const std::string& name);

std::string read_file(const std::filesystem::path& file);

} // namespace pneuma::tests::damage
