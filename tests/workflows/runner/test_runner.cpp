// SPDX-License-Identifier: GPL-3.0-or-later
// The runner with stages that are small shell scripts: they copy their settings and their input to their state.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/places.h"
#include "tests/unit/pipeline/workflow/example.h"

namespace pneuma::pipeline::workflow {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

const std::filesystem::path runner = std::filesystem::path(tests::program_folder) / "pneuma";

// `fail-ID`: ends with the code in it; `slow-ID`: works for a minute; `meet-ID`: needs the stage named in it at its
// side; `steps-ID`: writes those steps; `verdict-ID`: the summary of a stage that fails. `check-KIND`: commands that
// answer --check, with the settings in `$config`; each check is noted in `checks`.
constexpr const char* script = R"sh(#!/bin/sh
here=$(dirname "$0")
if [ "$1" = --check ]; then
  config=$3
  kind=$(basename "$0")
  echo "${kind#pneuma-}" >>"$here/checks"
  [ -f "$here/check-${kind#pneuma-}" ] && . "$here/check-${kind#pneuma-}"
  exit 0
fi
while [ $# -gt 0 ]; do
  case "$1" in --config) config=$2 ;; --in) in=$2 ;; --out) out=$2 ;; --threads) threads=$2 ;; esac
  shift 2
done
id=$(basename "$(dirname "$config")")
echo "$id" >>"$here/runs"
echo "threads $threads"
echo $$ >"$here/started-$id"
[ -f "$here/slow-$id" ] && exec sleep 60
if [ -f "$here/meet-$id" ]; then
  for i in $(seq 20); do [ -f "$here/started-$(cat "$here/meet-$id")" ] && met=yes && break; sleep 0.05; done
  [ -n "$met" ] || exit 9
fi
steps=$(cat "$here/steps-$id" 2>/dev/null)
for step in $steps; do # a path that is written step by step, and entered among the outputs
  mkdir -p "$(dirname "$out")/steps"
  echo "steps/$step.hdf" >>"$(dirname "$out")/.state.hdf.outputs"
  echo "step $step" >"$(dirname "$out")/steps/$step.hdf"
done
[ -f "$here/fail-$id" ] && [ -f "$here/verdict-$id" ] && cp "$here/verdict-$id" "$(dirname "$out")/summary.json"
[ -f "$here/fail-$id" ] && echo "a complaint" >&2 && exit "$(cat "$here/fail-$id")"
{ sed '/^origin:/,$d' "$config"; if [ -n "$in" ]; then cat "$in"; fi; } >"$out.new"
sha256sum <"$out.new" | cut -c1-64 >"$out.sha256"
mv "$out.new" "$out"
echo '{"verdict": "fine", "chambers": {"top": {"gauge_pressure": 400, "volume": 3.25}}}' >"$(dirname "$out")/summary.json"
)sh";

struct Outcome {
  int code = 0;
  std::string text;
};

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

bool happens(const std::function<bool()>& condition) {
  for (int i = 0; i < 400; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  return false;
}

class RunnerTest : public testing::Test {
protected:
  RunnerTest() {
    for (const char* run : {"mesh", "formfind", "pattern", "inflate", "wind"}) {
      const auto file = folder.write(fmt::format("bin/pneuma-{}", run), script);
      std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    write(example + "  calm: {run: wind, from: inflated, factors: {push: 0.1}, loads: [{name: push, foil: upper, wind: "
                    "0.1 kPa}]}\n");
  }

  void write(const std::string& text) {
    workflow = text;
    folder.write("w.yaml", text);
  }
  void change(const std::string& before, const std::string& after) { write(replaced(workflow, before, after)); }
  void arm(const std::string& what, const std::string& text = "") const { folder.write("bin/" + what, text); }
  void disarm(const std::string& what) const { std::filesystem::remove(folder.path() / "bin" / what); }
  std::filesystem::path out(const std::string& name) const { return folder.path() / "out" / "w" / name; }

  pid_t start(std::vector<std::string> words) const {
    words.insert(words.begin(), runner);
    const pid_t pid = fork();
    if (pid != 0) return pid;
    const std::string log = folder.path() / "output", stages = folder.path() / "bin";
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    setenv("PNEUMA_STAGES", stages.c_str(), 1);
    if (chdir(folder.path().c_str()) != 0) _exit(126);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv(pointers[0], pointers.data());
    _exit(127);
  }

  Outcome end_of(pid_t pid) const {
    int status = 0;
    waitpid(pid, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), text_of(folder.path() / "output")};
  }

  Outcome pneuma(const std::vector<std::string>& words) const {
    for (const char* notes : {"runs", "checks"}) std::filesystem::remove(folder.path() / "bin" / notes);
    return end_of(start(words));
  }

  // Stages that ran in the last call, in the order of their start.
  std::vector<std::string> ran() const { return noted("runs"); }

  std::vector<std::string> noted(const std::string& notes) const {
    std::istringstream lines(text_of(folder.path() / "bin" / notes));
    std::vector<std::string> all;
    for (std::string one; std::getline(lines, one);) all.push_back(one);
    return all;
  }

  bool has_started(const std::string& id) const {
    return happens([&] { return !text_of(folder.path() / "bin" / ("started-" + id)).empty(); });
  }

  const Folder folder;
  std::string workflow;
};

TEST_F(RunnerTest, RunsAllStagesInTheOrderOfTheGraph) {
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(ran(), ElementsAre("mesh", "form", "inflated", testing::_, testing::_));
  for (const char* id : {"mesh", "form", "inflated", "gust", "calm"}) {
    for (const char* file : {"stage.yaml", "state.hdf", "state.hdf.sha256", "provenance.json", "log.txt"}) {
      EXPECT_TRUE(std::filesystem::exists(out(id) / file)) << id << "/" << file;
    }
  }
  EXPECT_THAT(outcome.text, HasSubstr("mesh: runs: it has not run yet\nmesh: threads "));
  EXPECT_THAT(text_of(out("gust") / "log.txt"), HasSubstr("threads "));
}

TEST_F(RunnerTest, SecondRunFindsAllUpToDate) {
  pneuma({"w.yaml"});
  const Outcome outcome = pneuma({"run", "w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(ran(), IsEmpty());
  EXPECT_EQ(outcome.text,
            "mesh: up to date\nform: up to date\ninflated: up to date\ngust: up to date\ncalm: up to date\n");
}

TEST_F(RunnerTest, LayoutAndCommentsMakeNothingStale) {
  pneuma({"w.yaml"});
  change("mesh: {element: T6, size: 0.15 m}", "# finer?\n\nmesh:\n    size: 15 cm\n    element: T6");
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), IsEmpty());
}

TEST_F(RunnerTest, NamesSourcesAndStrengthsMakeNothingStale) {
  pneuma({"w.yaml"});
  change("name: Test cushion", "name: Another");
  change("  etfe: {", "  etfe: {source: a book, strength: {characteristic: 21 MPa}, ");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_THAT(ran(), IsEmpty());
  EXPECT_THAT(text_of(out("gust") / "stage.yaml"), HasSubstr("characteristic"));
}

TEST_F(RunnerTest, ChangedSettingRunsItsStageAndWhatDependsOnIt) {
  pneuma({"w.yaml"});
  change("kappa: 1.4", "kappa: 1.2");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("gust"));
  EXPECT_THAT(outcome.text, HasSubstr("gust: runs: settings changed (stages.gust.gas.top.kappa 1.4 -> 1.2)\n"));
  change("bottom: 300 Pa", "bottom: 310 Pa");
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), UnorderedElementsAre("inflated", "gust", "calm"));
}

TEST_F(RunnerTest, ChangedProgramRunsItsStagesAgain) {
  pneuma({"w.yaml"});
  folder.write("bin/pneuma-inflate", std::string(script) + "# changed\n");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("inflated")); // its state is the same, so nothing after it runs
  EXPECT_THAT(outcome.text, HasSubstr("inflated: runs: its program changed\n"));
}

TEST_F(RunnerTest, OnlyRunsOneStage) {
  pneuma({"w.yaml"});
  change("bottom: 300 Pa", "bottom: 310 Pa");
  const Outcome outcome = pneuma({"run", "w.yaml", "--only", "inflated"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(ran(), ElementsAre("inflated"));
}

TEST_F(RunnerTest, OnlyWithoutItsInputIsABadState) {
  const Outcome outcome = pneuma({"run", "w.yaml", "--only", "inflated"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.text, HasSubstr("run `form` first, or leave --only away"));
  EXPECT_THAT(ran(), IsEmpty());
}

TEST_F(RunnerTest, FromRunsItAndAllThatDependsOnItAnew) {
  pneuma({"w.yaml"});
  pneuma({"run", "w.yaml", "--from", "inflated"});
  EXPECT_THAT(ran(), UnorderedElementsAre("inflated", "gust", "calm"));
}

TEST_F(RunnerTest, ForceRunsDependentsOnlyIfItsStateChanged) {
  pneuma({"w.yaml"});
  const Outcome outcome = pneuma({"run", "w.yaml", "--force", "form"});
  EXPECT_THAT(ran(), ElementsAre("form"));
  EXPECT_THAT(outcome.text, HasSubstr("form: runs: asked for\n"));
}

TEST_F(RunnerTest, ForceGoesWithOnlyAndFromWhereItsStageIsSelected) {
  pneuma({"w.yaml"});
  EXPECT_EQ(pneuma({"run", "w.yaml", "--only", "inflated", "--force", "inflated"}).code, 0);
  EXPECT_THAT(ran(), ElementsAre("inflated"));
  EXPECT_EQ(pneuma({"w.yaml", "--from", "gust", "--force", "form"}).code, 0);
  EXPECT_THAT(ran(), UnorderedElementsAre("form", "gust"));
}

TEST_F(RunnerTest, ForceOfAStageThatIsNotSelectedIsRefused) {
  const Outcome only = pneuma({"run", "w.yaml", "--only", "form", "--force", "gust", "--force", "form"});
  EXPECT_EQ(only.code, 2);
  EXPECT_THAT(only.text, HasSubstr("--force gust: --only form runs `form` alone"));
  const Outcome from = pneuma({"run", "w.yaml", "--force", "calm", "--from", "gust"});
  EXPECT_EQ(from.code, 2);
  EXPECT_THAT(from.text, HasSubstr("--force calm: --from gust runs what `gust` needs"));
  const Outcome both = pneuma({"run", "w.yaml", "--only", "gust", "--from", "gust"});
  EXPECT_EQ(both.code, 2);
  EXPECT_THAT(both.text, HasSubstr("leave one of them away\n`pneuma run --help` shows all options"));
  const Outcome empty = pneuma({"run", "w.yaml", "--only", ""});
  EXPECT_EQ(empty.code, 2);
  EXPECT_THAT(empty.text, HasSubstr("--only: the name of the stage is empty"));
  EXPECT_THAT(ran(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(RunnerTest, UnknownStageIsBadInput) {
  const Outcome outcome = pneuma({"run", "w.yaml", "--force", "gusst"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("there is no stage `gusst`; did you mean `gust`?"));
}

TEST_F(RunnerTest, FailedStageStopsItsDependentsNotItsSiblings) {
  write(workflow + "  other: {run: inflate, from: mesh, gauge_pressure: {top: 1 Pa, bottom: 1 Pa}}\n");
  arm("fail-form", "5");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 5);
  EXPECT_THAT(ran(), UnorderedElementsAre("mesh", "form", "other"));
  EXPECT_THAT(outcome.text, HasSubstr("form: a complaint\n"));
  EXPECT_THAT(outcome.text, HasSubstr("inflated: not run: `form` has no result\n"));
  EXPECT_THAT(outcome.text, HasSubstr("gust: not run: `inflated` has no result\n"));
  disarm("fail-form");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_THAT(ran(), UnorderedElementsAre("form", "inflated", "gust", "calm")); // mesh and other are kept
}

TEST_F(RunnerTest, ExitCodeIsThatOfTheFirstFailedStageInTheFile) {
  arm("fail-calm", "4");
  arm("fail-gust", "5");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 5);
}

TEST_F(RunnerTest, StageThatLeavesNoGoodStateHasFailed) {
  const auto file = folder.write("bin/pneuma-inflate", "#!/bin/sh\nexit 0\n");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("inflated: failed: it ended well but left no state that matches its digest"));
}

TEST_F(RunnerTest, StageKilledByASignalHasFailed) {
  folder.write("bin/pneuma-inflate", "#!/bin/sh\n[ \"$1\" = --check ] && exit 0\nkill -SEGV $$\n");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("inflated: failed: ended by signal 11"));
}

TEST_F(RunnerTest, MissingStageProgramIsSaid) {
  disarm("pneuma-wind");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.text, ContainsRegex("gust: failed: the program `.*/pneuma-wind` cannot be run: No such file"));
  EXPECT_THAT(ran(), ElementsAre("mesh", "form", "inflated"));
  EXPECT_EQ(pneuma({"check", "w.yaml"}).code, 6);
}

TEST_F(RunnerTest, DamagedStateIsComputedAgain) {
  pneuma({"w.yaml"});
  std::ofstream(out("form") / "state.hdf", std::ios::app) << "x";
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("form")); // it is what it was: nothing after it runs
  EXPECT_THAT(outcome.text, HasSubstr("form: runs: its state.hdf was changed\n"));
  std::filesystem::remove(out("gust") / "state.hdf");
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("gust"));
  std::filesystem::remove(out("gust") / "summary.json");
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("gust"));
}

TEST_F(RunnerTest, EveryOutputThatIsMissingTruncatedOrEditedIsMadeAnew) {
  arm("steps-gust", "0000 0001");
  pneuma({"w.yaml"});
  const std::vector<std::string> outputs = {"state.hdf",       "state.hdf.sha256", "summary.json",  "log.txt",
                                            "provenance.json", "steps/0000.hdf",   "steps/0001.hdf"};
  for (const std::string& name : outputs) {
    const std::string whole = text_of(out("gust") / name);
    for (const char* damage : {"missing", "empty", "truncated", "edited", "longer"}) {
      SCOPED_TRACE(name + " " + damage);
      std::string text = whole;
      if (damage == std::string("edited")) text[text.size() / 2] ^= 1;
      if (damage == std::string("longer")) text += "x";
      if (damage == std::string("truncated")) text.resize(text.size() / 2);
      if (damage == std::string("empty")) text.clear();
      std::filesystem::remove(out("gust") / name);
      if (damage != std::string("missing")) std::ofstream(out("gust") / name) << text;
      EXPECT_THAT(pneuma({"status", "w.yaml"}).text, HasSubstr("gust      wind      stale: "));
      pneuma({"w.yaml"});
      EXPECT_THAT(ran(), ElementsAre("gust"));
      EXPECT_EQ(text_of(out("gust") / name), whole);
    }
  }
  std::filesystem::remove(out("gust") / "steps/0001.hdf"); // and a link of the same bytes is not what was written
  std::filesystem::copy_file(out("gust") / "steps/0000.hdf", folder.path() / "elsewhere");
  std::filesystem::create_symlink(folder.path() / "elsewhere", out("gust") / "steps/0001.hdf");
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), ElementsAre("gust"));
  EXPECT_EQ(text_of(folder.path() / "elsewhere"), "step 0000\n");
}

TEST_F(RunnerTest, WhatARunDoesNotWriteAgainIsGone) {
  arm("steps-gust", "0000 0001 0002");
  pneuma({"w.yaml"});
  folder.write("out/w/gust/mine.pvsm", "a view");
  arm("steps-gust", "0000");
  pneuma({"w.yaml", "--force", "gust"});
  EXPECT_TRUE(std::filesystem::exists(out("gust") / "steps/0000.hdf"));
  EXPECT_FALSE(std::filesystem::exists(out("gust") / "steps/0001.hdf"));
  arm("fail-gust", "5");
  disarm("steps-gust");
  EXPECT_EQ(pneuma({"w.yaml", "--force", "gust"}).code, 5);
  EXPECT_FALSE(std::filesystem::exists(out("gust") / "steps"));
  EXPECT_FALSE(std::filesystem::exists(out("gust") / "state.hdf"));
  EXPECT_FALSE(std::filesystem::exists(out("gust") / "summary.json"));
  EXPECT_TRUE(std::filesystem::exists(out("gust") / "mine.pvsm")); // no result
}

TEST_F(RunnerTest, WhatAKilledStageLeftIsGoneToo) {
  arm("steps-gust", "0000 0001");
  arm("fail-gust", "137");
  pneuma({"w.yaml"});
  EXPECT_TRUE(std::filesystem::exists(out("gust") / "steps/0001.hdf"));
  disarm("fail-gust");
  disarm("steps-gust");
  pneuma({"w.yaml"});
  EXPECT_FALSE(std::filesystem::exists(out("gust") / "steps"));
}

TEST_F(RunnerTest, FilesOfOneStemDoNotShareAFolder) {
  pneuma({"w.yaml"});
  std::filesystem::copy_file(folder.path() / "w.yaml", folder.path() / "w.yml");
  pneuma({"w.yml"});
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/w.yml/gust/state.hdf"));
  pneuma({"w.yaml"});
  EXPECT_THAT(ran(), IsEmpty());
}

TEST_F(RunnerTest, StatusCallsAStageThatEndedByItsVerdict) {
  arm("fail-gust", "5");
  arm("verdict-gust", R"({"verdict": "contact", "load_factor": 0.4})");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 5);
  EXPECT_THAT(pneuma({"status", "w.yaml"}).text, HasSubstr("gust      wind      stale: it ended: contact\n"));
  disarm("verdict-gust");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 5);
  EXPECT_THAT(pneuma({"status", "w.yaml"}).text, HasSubstr("gust      wind      stale: it ended with exit code 5\n"));
}

TEST_F(RunnerTest, NoLinkLeadsResultsElsewhere) {
  std::filesystem::create_directories(folder.path() / "elsewhere");
  std::filesystem::create_directories(out("x").parent_path());
  std::filesystem::create_directory_symlink(folder.path() / "elsewhere", out("gust"));
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.text, HasSubstr("a link has its name"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "elsewhere"));
  EXPECT_TRUE(std::filesystem::exists(out("calm") / "state.hdf")); // its sibling has run
  std::filesystem::remove(out("gust"));
  folder.write("precious", "kept");
  for (const char* name : {"stage.yaml", "log.txt", "provenance.json", "summary.json"}) {
    std::filesystem::create_directories(out("gust"));
    std::filesystem::create_symlink(folder.path() / "precious", out("gust") / name);
  }
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_EQ(text_of(folder.path() / "precious"), "kept");
}

TEST_F(RunnerTest, WithoutAStandardOutputNothingIsSaidIntoItsFiles) {
  const pid_t pid = fork();
  if (pid == 0) {
    setenv("PNEUMA_STAGES", (folder.path() / "bin").c_str(), 1);
    for (int stream = 0; stream <= 2; ++stream) close(stream);
    if (chdir(folder.path().c_str()) != 0) _exit(126);
    execl(runner.c_str(), "pneuma", "w.yaml", nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(text_of(out("mesh").parent_path() / ".lock"), "");
  EXPECT_THAT(text_of(out("mesh") / "log.txt"), HasSubstr("threads"));
}

TEST_F(RunnerTest, SiblingsRunSideBySide) {
  arm("meet-gust", "calm");
  arm("meet-calm", "gust");
  EXPECT_EQ(pneuma({"run", "w.yaml", "--jobs", "2"}).code, 0);
  arm("meet-gust", "nobody");
  EXPECT_EQ(pneuma({"run", "w.yaml", "--jobs", "1", "--force", "gust"}).code, 9);
}

TEST_F(RunnerTest, InterruptGives130AndKeepsWhatIsDone) {
  arm("slow-gust");
  arm("slow-calm");
  const pid_t pid = start({"w.yaml"});
  ASSERT_TRUE(has_started("gust"));
  kill(pid, SIGINT);
  const Outcome outcome = end_of(pid);
  EXPECT_EQ(outcome.code, 130) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("interrupted: the running stages end; what is done is kept"));
  EXPECT_THAT(outcome.text, HasSubstr("gust: interrupted\n"));
  disarm("slow-gust");
  disarm("slow-calm");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_THAT(ran(), UnorderedElementsAre("gust", "calm"));
}

TEST_F(RunnerTest, AHangUpEndsLikeAnInterruptButNotUnderNohup) {
  arm("slow-gust");
  pid_t pid = start({"w.yaml"});
  ASSERT_TRUE(has_started("gust"));
  kill(pid, SIGHUP);
  EXPECT_EQ(end_of(pid).code, 130);
  std::filesystem::remove(folder.path() / "bin/started-gust");
  const auto handler = std::signal(SIGHUP, SIG_IGN);
  pid = start({"w.yaml"});
  std::signal(SIGHUP, handler);
  ASSERT_TRUE(has_started("gust"));
  kill(pid, SIGHUP);
  kill(pid, SIGTERM);
  EXPECT_THAT(end_of(pid).text, Not(HasSubstr("interrupted again")));
}

TEST_F(RunnerTest, SecondInterruptKillsAStageThatDoesNotListen) {
  folder.write("bin/pneuma-wind", "#!/bin/sh\n[ \"$1\" = --check ] && exit 0\ntrap '' INT\necho $$ >\"$(dirname "
                                  "\"$0\")/started-wind\"\nsleep 60\n");
  const pid_t pid = start({"w.yaml"});
  ASSERT_TRUE(has_started("wind"));
  kill(pid, SIGINT);
  ASSERT_TRUE(happens([&] { return text_of(folder.path() / "output").find("interrupted") != std::string::npos; }));
  kill(pid, SIGINT);
  EXPECT_EQ(end_of(pid).code, 130);
}

TEST_F(RunnerTest, KilledRunnerLeavesNoStageBehindAndTheNextGoesOn) {
  arm("slow-form");
  const pid_t pid = start({"w.yaml"});
  ASSERT_TRUE(has_started("form"));
  const pid_t stage = std::stoi(text_of(folder.path() / "bin" / "started-form"));
  kill(pid, SIGKILL);
  end_of(pid);
  EXPECT_TRUE(happens([&] { return kill(stage, 0) != 0; }));
  disarm("slow-form");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("mesh: up to date\nform: runs: it did not finish last time\n"));
}

TEST_F(RunnerTest, TwoRunnersDoNotShareAFolder) {
  arm("slow-form");
  const pid_t pid = start({"w.yaml"});
  ASSERT_TRUE(has_started("form"));
  const Outcome second = pneuma({"w.yaml"});
  EXPECT_EQ(second.code, 2);
  EXPECT_THAT(second.text, HasSubstr("another pneuma works in `out/w`"));
  kill(pid, SIGINT);
  EXPECT_EQ(end_of(pid).code, 130);
}

TEST_F(RunnerTest, ResultsGoWhereOutSays) {
  EXPECT_EQ(pneuma({"run", "w.yaml", "--out", "elsewhere"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "elsewhere" / "gust" / "state.hdf"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(RunnerTest, BadWorkflowRunsNothing) {
  change("size: 0.15 m", "size: 0.15 kg");
  const Outcome outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("w.yaml:15:27: `size`: `0.15 kg` has a unit of another kind"));
  EXPECT_THAT(ran(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(RunnerTest, CheckFindsAllErrorsOrSaysOk) {
  EXPECT_EQ(pneuma({"check", "w.yaml"}).text,
            "w.yaml: ok: 5 stages (mesh, form, inflated, gust, calm), 3 foils, 2 chambers\n");
  change("size: 0.15 m", "size: 0.15 kg");
  change("nu: 0.45", "nu: 4.5");
  const Outcome outcome = pneuma({"check", "w.yaml"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("w.yaml:4:40: `nu`"));
  EXPECT_THAT(outcome.text, HasSubstr("w.yaml:15:27: `size`"));
}

TEST_F(RunnerTest, CheckAsksTheProgramOfEachKindOnce) {
  EXPECT_EQ(pneuma({"check", "w.yaml"}).code, 0);
  EXPECT_THAT(noted("checks"), UnorderedElementsAre("mesh", "formfind", "inflate", "wind")); // two wind stages
  EXPECT_THAT(ran(), IsEmpty());
  change("size: 0.15 m", "size: 0.15 kg");
  pneuma({"check", "w.yaml"});
  EXPECT_THAT(noted("checks"), IsEmpty());
}

TEST_F(RunnerTest, RunAsksAllProgramsButTheFirstBeforeItComputes) { // whose check is its work
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_THAT(noted("checks"), UnorderedElementsAre("formfind", "inflate", "wind"));
}

TEST_F(RunnerTest, WhatSeveralProgramsFindIsToldOnceAtItsPlace) {
  // the place is that which stage.yaml names
  const std::string place = "place=$(sed -n 's/.*materials.etfe.nu: \"\\(.*\\)\"/\\1/p' \"$config\")\n";
  const std::string both = place + "echo \"$place: warning: strange\"\necho \"$place: wrong\" >&2\nexit 2\n";
  arm("check-formfind", both);
  arm("check-wind", both);
  arm("check-inflate", place + "echo \"$place: also wrong\"\nexit 2\n");
  const std::filesystem::path file = folder.path() / "w.yaml";
  for (const std::string& name : {std::string("w.yaml"), std::string("./w.yaml"), file.string()}) {
    const Outcome outcome = pneuma({"check", name});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.text, fmt::format("{0}:4:40: warning: strange\n{0}:4:40: wrong\n{0}:4:40: also wrong\n", name));
  }
  EXPECT_EQ(pneuma({"w.yaml"}).code, 2);
  EXPECT_THAT(ran(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(RunnerTest, LawThatIsNoneIsToldAtItsPlaceAndNothingIsComputed) {
  for (const char* kind : {"formfind", "inflate", "wind"}) { // those of the build
    const auto program = runner.parent_path() / fmt::format("pneuma-{}", kind);
    arm(fmt::format("check-{}", kind), fmt::format("exec {} --check --config \"$config\"\n", program.string()));
  }
  change("law: elastic, E: 900 MPa, nu: 0.45", "law: ogden, terms: [{mu: 6 MPa, alpha: 2}, {mu: -1 MPa, alpha: 2}]");
  const std::string warning = "w.yaml:4:58: warning: material `etfe`: `mu` -1 MPa and `alpha` 2 have different signs";
  Outcome outcome = pneuma({"check", "w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, testing::StartsWith(warning));
  EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 2) << outcome.text; // and `ok`
  outcome = pneuma({"w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, testing::StartsWith(warning));

  std::filesystem::remove_all(folder.path() / "out");
  change("-1 MPa, alpha: 2", "-1 MPa, alpha: 20");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"check", "w.yaml"}, {"w.yaml"}}) {
    outcome = pneuma(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.text, "w.yaml:4:35: material `etfe`: the shear modulus, half the sum of mu alpha, must be "
                            "positive, not -4 MPa\n");
    EXPECT_THAT(ran(), IsEmpty());
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  }
}

TEST_F(RunnerTest, ProgramThatBreaksInItsCheckIsABug) {
  for (const auto& [how, words] :
       {std::pair("kill -SEGV $$", "ended by signal 11"), std::pair("exit 9", "ended by exit code 9")}) {
    arm("check-wind", how);
    const Outcome outcome = pneuma({"w.yaml"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.text, HasSubstr(fmt::format("pneuma-wind --check {}; please report it\n", words)));
    EXPECT_THAT(ran(), IsEmpty());
  }
}

TEST_F(RunnerTest, CheckLeavesNoFilesBehindWhenInterrupted) {
  const auto temporary = folder.path() / "tmp";
  std::filesystem::create_directory(temporary);
  setenv("TMPDIR", temporary.c_str(), 1);
  arm("check-wind", "echo $$ >\"$here/started-check\"\nexec sleep 60\n");
  const pid_t pid = start({"check", "w.yaml"});
  EXPECT_TRUE(has_started("check"));
  EXPECT_FALSE(std::filesystem::is_empty(temporary));
  kill(pid, SIGINT);
  EXPECT_EQ(end_of(pid).code, 130);
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
  std::filesystem::remove(temporary);
  const Outcome without = pneuma({"check", "w.yaml"});
  EXPECT_EQ(without.code, 6);
  EXPECT_THAT(without.text, HasSubstr("let TMPDIR name a folder"));
  unsetenv("TMPDIR");
}

TEST_F(RunnerTest, StatusSaysWhatIsStaleAndShowsResults) {
  EXPECT_THAT(pneuma({"status", "w.yaml"}).text, HasSubstr("mesh      mesh      stale: it has not run yet\n"));
  pneuma({"w.yaml"});
  change("bottom: 300 Pa", "bottom: 310 Pa");
  const Outcome outcome = pneuma({"status", "w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("form      formfind  fresh\n"));
  EXPECT_THAT(outcome.text, HasSubstr("    chamber top: 400 Pa, 3.25 m3\n"));
  EXPECT_THAT(
      outcome.text,
      HasSubstr(
          "inflated  inflate   stale: settings changed (stages.inflated.gauge_pressure.bottom 300 Pa -> 310 Pa)"));
  EXPECT_THAT(outcome.text, HasSubstr("gust      wind      stale: `inflated` is stale\n"));
  EXPECT_THAT(ran(), IsEmpty());
}

TEST_F(RunnerTest, StripsStandBetweenFormAndInflation) {
  change("from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed",
         "from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}");
  change("  inflated:", "  strips: {run: pattern, from: form, strips_per_foil: 4}\n  inflated:");
  EXPECT_EQ(pneuma({"w.yaml"}).code, 0);
  EXPECT_THAT(ran(), UnorderedElementsAre("mesh", "form", "strips", "inflated", "gust", "calm"));
  EXPECT_THAT(text_of(folder.path() / "out/w/strips/stage.yaml"), HasSubstr("strips_per_foil: 4"));

  change("strips_per_foil: 4", "strips_per_foil: 5");
  EXPECT_THAT(pneuma({"status", "w.yaml"}).text,
              HasSubstr("strips    pattern   stale: settings changed (stages.strips.strips_per_foil 4 -> 5)\n"));
}

TEST_F(RunnerTest, StatusOfAPatternShowsStripsWasteAndMismatch) {
  change("  inflated:", "  strips: {run: pattern, from: form, strips_per_foil: 2}\n  inflated:");
  ASSERT_EQ(pneuma({"w.yaml"}).code, 0);
  folder.write("out/w/strips/summary.json",
               R"({"verdict": "cut", "patterns": {"lower": {"strips": [{"name": "lower-1"}]}, "odd": 3,
                   "upper": {"strips": [{"name": "upper-1", "seam_mismatch_max": 2e-4},
                                        {"name": "upper-2", "seam_mismatch_max": 3e-4}],
                             "waste_fraction": 0.123, "weld_length": 12.5}}})");
  const std::string text = pneuma({"status", "w.yaml"}).text;
  EXPECT_THAT(
      text,
      HasSubstr(
          "strips    pattern   stale: its summary.json was changed\n    verdict: cut\n    pattern lower: 1 strips\n"
          "    pattern upper: 2 strips, seams differ by 0.3 mm at most, waste 12.3 %, "
          "welds 12.5 m\n"));
}

TEST_F(RunnerTest, MistypedCommandGetsASuggestion) {
  const Outcome outcome = pneuma({"statsu", "w.yaml"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("there is no command `statsu`; did you mean `status`?"));
}

TEST_F(RunnerTest, OtherProgramsAreForwardedToOrSaidToBeMissing) {
  const Outcome missing = pneuma({"material", "foils.yaml"});
  EXPECT_EQ(missing.code, 6);
  EXPECT_THAT(missing.text, HasSubstr("pneuma-material` cannot be run: No such file or directory; build it"));
  const auto file = folder.write("bin/pneuma-material", "#!/bin/sh\necho \"curves of $1\"\nexit 7\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  const Outcome forwarded = pneuma({"material", "foils.yaml"});
  EXPECT_EQ(forwarded.code, 7);
  EXPECT_EQ(forwarded.text, "curves of foils.yaml\n");
  EXPECT_THAT(pneuma({"audit", "state.hdf"}).text, HasSubstr("`pneuma audit` is not available yet"));
  EXPECT_THAT(pneuma({"study", "w.yaml"}).text, HasSubstr("`pneuma study` is not available yet"));
}

TEST_F(RunnerTest, WarningsAreShownAndStopNothing) {
  change("thickness: 250 um", "thickness: 2.5 mm");
  const Outcome outcome = pneuma({"check", "w.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("w.yaml:9:48: warning: `thickness` 2.5 mm is unusual"));
}

TEST_F(RunnerTest, HelpAndVersionEndWell) {
  EXPECT_EQ(pneuma({"--help"}).code, 0);
  EXPECT_EQ(pneuma({"run", "--help"}).code, 0);
  EXPECT_THAT(pneuma({"--version"}).text, testing::StartsWith("pneuma "));
  EXPECT_EQ(pneuma({}).code, 2);
  EXPECT_THAT(pneuma({"keys"}).text, HasSubstr("stress_rule"));
  EXPECT_THAT(pneuma({"schema"}).text, HasSubstr("draft-07"));
}

} // namespace
} // namespace pneuma::pipeline::workflow
