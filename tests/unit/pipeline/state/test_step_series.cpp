// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/base/errors.h"
#include "pipeline/state/state_file.h"
#include "tests/unit/pipeline/state/cushion_state.h"
#include "tests/unit/pipeline/state/same_state.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::pipeline::state {
namespace {

using geometry::ElementType;
using tests::bytes_of;
using tests::cushion_state;
using tests::TemporaryFolder;

TEST(StepSeries, ListsItsStepsWithTheirTimes) {
  const TemporaryFolder folder;
  StepSeries series(folder.path());
  const State state = cushion_state(ElementType::T3, 2, 1);
  const std::vector<double> times = {0, 0.1, 1.0 / 3};
  for (const double time : times) series.write(state, time);
  EXPECT_EQ(series.count(), 3);
  const nlohmann::json json = nlohmann::json::parse(bytes_of(folder / "steps.hdf.series"));
  EXPECT_EQ(json.at("file-series-version"), "1.0");
  ASSERT_EQ(json.at("files").size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const nlohmann::json& entry = json.at("files")[i];
    EXPECT_EQ(entry.at("time").get<double>(), times[i]);
    tests::expect_same(read_state(folder / entry.at("name").get<std::string>()), state);
  }
}

TEST(StepSeries, RemovesTheStepsOfAnEarlierRunAndNothingElse) {
  const TemporaryFolder folder;
  const State state = cushion_state(ElementType::T3, 1, 1);
  StepSeries first(folder.path());
  for (int i = 0; i < 3; ++i) first.write(state, i);
  tests::put_bytes(folder / "steps/notes.txt", "mine");
  StepSeries second(folder.path());
  EXPECT_TRUE(std::filesystem::exists(folder / "steps/0002.hdf")); // until there is something new
  second.write(state, 0.5);
  EXPECT_TRUE(std::filesystem::exists(folder / "steps/0000.hdf"));
  EXPECT_FALSE(std::filesystem::exists(folder / "steps/0001.hdf"));
  EXPECT_FALSE(std::filesystem::exists(folder / "steps/0002.hdf.sha256"));
  EXPECT_TRUE(std::filesystem::exists(folder / "steps/notes.txt"));
  EXPECT_EQ(nlohmann::json::parse(bytes_of(folder / "steps.hdf.series")).at("files").size(), 1U);
}

TEST(StepSeries, RefusesATimeThatJsonCannotHold) {
  const TemporaryFolder folder;
  EXPECT_THROW(StepSeries(folder.path()).write(State{}, std::nan("")), base::Error);
}

} // namespace
} // namespace pneuma::pipeline::state
