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
  files::Outputs outputs(folder / "a.hdf", "");
  StepSeries series(outputs);
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

TEST(StepSeries, EntersItsFilesAmongTheOutputs) {
  const TemporaryFolder folder;
  files::Outputs outputs(folder / "a.hdf", "");
  StepSeries(outputs).write(cushion_state(ElementType::T3, 1, 1), 0.5);
  const std::set<std::string> expected = {"steps.hdf.series", "steps/0000.hdf", "steps/0000.hdf.sha256"};
  EXPECT_EQ(files::outputs_of(folder / "a.hdf"), expected);
}

TEST(StepSeries, RefusesATimeThatJsonCannotHold) {
  const TemporaryFolder folder;
  files::Outputs outputs(folder / "a.hdf", "");
  EXPECT_THROW(StepSeries(outputs).write(State{}, std::nan("")), base::Error);
}

} // namespace
} // namespace pneuma::pipeline::state
