// SPDX-License-Identifier: GPL-3.0-or-later
// Under any limit of memory at which a program starts at all it ends: well, or with exit code 6 and what to do.
#include <gmock/gmock.h>

#include "tests/workflows/damage/limited.h"
#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using damage::Ending;
using damage::run_limited;
using testing::AnyOf;
using testing::HasSubstr;

using LimitsOfMemory = InFolder;

constexpr int seconds = 10; // of processor time: one that asks for memory for ever uses it up

struct OneStage {
  const char *id, *run, *from;
};

void expect_answer(const Ending& ending, double gigabytes) {
  SCOPED_TRACE(gigabytes);
  EXPECT_THAT(ending.code, AnyOf(0, 6)) << ending.words() << '\n' << ending.text;
  EXPECT_TRUE(ending.code != 6 || ending.text.find("memory") != std::string::npos) << ending.text;
  EXPECT_THAT(ending.text, testing::Not(HasSubstr("please report")));
}

TEST_F(LimitsOfMemory, EveryStageEndsUnderEveryLimitAtWhichItStarts) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a sanitizer takes terabytes of addresses";
#endif
  write(every_stage);
  const Outcome whole = pneuma("run w.yaml");
  ASSERT_EQ(whole.code, 0) << whole.text;
  for (const OneStage& stage :
       {OneStage{"mesh", "mesh", nullptr}, OneStage{"form", "formfind", "mesh"}, OneStage{"strips", "pattern", "form"},
        OneStage{"up", "inflate", "strips"}, OneStage{"gust", "wind", "up"}}) {
    SCOPED_TRACE(stage.id);
    const std::string program = programs / (std::string("pneuma-") + stage.run);
    std::vector<std::string> words = {program, "--config", out(stage.id) / "stage.yaml", "--out", folder / "o.hdf"};
    if (stage.from != nullptr) words.insert(words.end(), {"--in", out(stage.from) / "state.hdf"});
    int answered = 0;
    for (const double gigabytes : {0.09, 0.12, 0.15, 0.18, 0.21, 0.24, 0.27, 0.3, 0.36, 0.45, 0.6}) {
      if (run_limited({program, "--version"}, folder, {seconds, gigabytes}).code != 0) continue; // it does not start
      ++answered;
      expect_answer(run_limited(words, folder, {seconds, gigabytes}), gigabytes);
    }
    EXPECT_GT(answered, 4);
  }
}

TEST_F(LimitsOfMemory, CheckEndsUnderEveryLimitAtWhichItStarts) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a sanitizer takes terabytes of addresses";
#endif
  write(every_stage);
  for (const double gigabytes : {0.03, 0.05, 0.1, 0.16, 0.2, 0.25, 0.3, 0.6}) {
    const std::vector<std::string> words = {programs / "pneuma", "check", "w.yaml"};
    if (run_limited({words[0], "--version"}, folder, {seconds, gigabytes}).code == 127) continue;
    expect_answer(run_limited(words, folder, {seconds, gigabytes}), gigabytes);
  }
}

} // namespace
} // namespace pneuma::tests
