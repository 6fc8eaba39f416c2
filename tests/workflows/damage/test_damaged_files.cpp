// SPDX-License-Identifier: GPL-3.0-or-later
// Every value and key of our files wrong in one way: what the programs say. PNEUMA_LONG=1 takes all of them (minutes);
// PNEUMA_TABLES names a folder that keeps the table and the corpus; PNEUMA_BIN one of other programs to test.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/places.h"
#include "tests/workflows/damage/corpus.h"

namespace pneuma::tests::damage {
namespace {

namespace fs = std::filesystem;

const fs::path top = source_folder;
constexpr std::uint32_t seed = 11;
constexpr std::size_t in_ci = 300;

bool is_long() {
  return std::getenv("PNEUMA_LONG") != nullptr;
}

struct Count {
  std::size_t all = 0, accepted = 0, by_stage = 0, refused = 0, wrong = 0;

  void add(const Answer& answer) {
    ++all;
    accepted += answer.code == 0 && !answer.by_stage ? 1 : 0;
    by_stage += answer.by_stage ? 1 : 0;
    refused += answer.code == 2 ? 1 : 0;
    wrong += answer.wrong.empty() ? 0 : 1;
  }
};

std::string row(const std::string& name, const Count& count) {
  return fmt::format("{:<52} {:>6} {:>6} {:>6} {:>6} {:>6}\n", name, count.all, count.accepted, count.by_stage,
                     count.refused, count.wrong);
}

std::string table(const std::map<std::string, Count>& counts, const char* title) {
  std::string text = fmt::format("{:<52} {:>6} {:>6} {:>6} {:>6} {:>6}\n", title, "all", "0", "stage 2", "2", "wrong");
  for (const auto& [name, count] : counts) text += row(name, count);
  return text;
}

// Without the warnings, which the undamaged file has too.
std::string errors_in(const std::string& messages) {
  std::string errors;
  std::istringstream lines(messages);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(": warning: ") == std::string::npos) errors += line + "\n";
  }
  return errors.substr(0, errors.rfind('\n', 2000) + 1); // whole lines
}

std::string shown(const Job& job, const Answer& answer) {
  const Damage& damage = *job.damage;
  return fmt::format("{}: {} at `{}`, line {}: `{}` -> `{}`\n  {}\n  now:  {}\n  says: {}", job.source->name,
                     to_string(damage.kind), damage.path, damage.at.first, damage.before, damage.with, answer.wrong,
                     damage.line, errors_in(answer.messages));
}

nlohmann::ordered_json record(const Job& job, const Answer& answer) {
  const Damage& damage = *job.damage;
  return {{"file", job.source->name},      {"kind", to_string(damage.kind)},
          {"path", damage.path},           {"before", damage.before},
          {"line", damage.line},           {"is_materials", job.source->kind == Source::Kind::materials},
          {"user", job.source->user_text}, {"text", damaged(job.source->text, damage)},
          {"code", answer.code},           {"by_stage", answer.by_stage},
          {"wrong", answer.wrong},         {"messages", errors_in(answer.messages)}};
}

void keep(const std::string& name, const std::string& text) {
  if (const char* folder = std::getenv("PNEUMA_TABLES")) std::ofstream(fs::path(folder) / name) << text;
}

std::string lines_of(const std::vector<Job>& jobs, const std::vector<Answer>& found) {
  std::string lines;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto json = record(jobs[i], found[i]);
    lines += json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  }
  return lines;
}

TEST(DamagedFiles, AreAnsweredAtTheirPlace) {
  const std::vector<Source> files = sources(top);
  const std::vector<Job> jobs = is_long() ? all_jobs(files, seed) : sample(files, in_ci, seed);
  ASSERT_GE(jobs.size(), in_ci);
  std::vector<Answer> found;
  constexpr std::size_t part = 2000; // for those who wait
  for (std::size_t i = 0; i < jobs.size(); i += part) {
    const auto begin = jobs.begin() + static_cast<std::ptrdiff_t>(i);
    const std::vector<Job> some(begin, begin + static_cast<std::ptrdiff_t>(std::min(part, jobs.size() - i)));
    const std::vector<Answer> more = answers(some, top, true);
    found.insert(found.end(), more.begin(), more.end());
    if (is_long()) fmt::print(stderr, "{} of {}\n", found.size(), jobs.size());
    keep(fmt::format("damage_{:02}.jsonl", i / part), lines_of(some, more));
  }
  std::map<std::string, Count> kinds, names, both;
  std::map<std::string, std::size_t> groups; // of the wrong ones, of which the first few are shown
  constexpr std::size_t few = 3;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::string kind = to_string(jobs[i].damage->kind);
    kinds[kind].add(found[i]);
    names[jobs[i].source->name].add(found[i]);
    both[jobs[i].source->name + ", " + kind].add(found[i]);
    if (found[i].wrong.empty()) continue;
    if (++groups[kind + ": " + found[i].wrong] <= few) ADD_FAILURE() << shown(jobs[i], found[i]);
  }
  keep("damage.txt", table(kinds, "kind") + "\n" + table(names, "file") + "\n" + table(both, "file and kind"));
  fmt::print("{}\n{}", table(kinds, "kind"), table(names, "file"));
  for (const auto& [group, count] : groups) fmt::print("{:>6} wrong: {}\n", count, group);
}

// What `check` accepts, the JSON schema accepts; what the schema refuses, `check` refuses; see schema_agrees.py.
TEST(DamagedFiles, TheSchemaAgrees) {
  const std::vector<Source> files = sources(top);
  std::vector<Job> jobs = is_long() ? all_jobs(files, seed) : sample(files, in_ci, seed);
  std::erase_if(jobs, [](const Job& job) { return job.source->kind == Source::Kind::stage; });
  const std::vector<Answer> found = answers(jobs, top, false);
  const fs::path folder = fs::temp_directory_path() / fmt::format("pneuma-schema-{}", getpid());
  fs::create_directory(folder);
  std::ofstream(folder / "corpus.jsonl") << lines_of(jobs, found);
  const Ending schema = run_limited({program("pneuma"), "schema"}, folder);
  EXPECT_EQ(schema.code, 0) << schema.text;
  std::ofstream(folder / "schema.json") << schema.text;
  const int seconds = is_long() ? 1800 : 120;
  const Ending agreed = run_limited(
      {PNEUMA_PYTHON, top / "tests/workflows/damage/schema_agrees.py", folder / "schema.json", folder / "corpus.jsonl"},
      folder, {seconds, 4});
  fs::remove_all(folder);
  fmt::print("{}", agreed.text);
  EXPECT_EQ(agreed.code, 0) << agreed.text;
}

} // namespace
} // namespace pneuma::tests::damage
