// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <csignal>
#include <limits>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "pipeline/digest/digest.h"
#include "pipeline/state/state_file.h"
#include "tests/unit/pipeline/state/cushion_state.h"
#include "tests/unit/pipeline/state/same_state.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::pipeline::state {
namespace {

using geometry::ElementType;
using testing::HasSubstr;
using tests::bytes_of;
using tests::cushion_state;
using tests::expect_same;
using tests::put_bytes;
using tests::TemporaryFolder;

// What `body` tells its user, and that it ends in `code`.
template <class Body>
std::string complaint(base::ExitCode code, Body&& body) {
  try {
    body();
  } catch (const base::Error& error) {
    EXPECT_EQ(error.code(), code);
    return error.what();
  }
  ADD_FAILURE() << "no complaint";
  return {};
}

class StateOfEachElement : public testing::TestWithParam<ElementType> {};

TEST_P(StateOfEachElement, IsReadBackBitForBit) {
  const TemporaryFolder folder;
  const State state = cushion_state(GetParam(), 3, 2);
  write_state(state, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), state);
}

TEST_P(StateOfEachElement, GivesEqualBytesWhenWrittenAgain) {
  const TemporaryFolder folder;
  write_state(cushion_state(GetParam(), 3, 2), folder / "a.hdf");
  write_state(read_state(folder / "a.hdf"), folder / "b.hdf");
  EXPECT_EQ(bytes_of(folder / "a.hdf"), bytes_of(folder / "b.hdf"));
}

TEST(StateFile, KeepsWhichChambersAreConnected) {
  const TemporaryFolder folder;
  State state = cushion_state(ElementType::T3, 3, 2);
  state.chambers.push_back(state.chambers[0]);
  state.chambers[1].name = "second";
  state.chambers[1].connected_to = 0;
  write_state(state, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), state);
}

INSTANTIATE_TEST_SUITE_P(StateFile, StateOfEachElement,
                         testing::Values(ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9),
                         [](const auto& test) { return std::string(geometry::name_of(test.param)); });

TEST(StateFile, KeepsEveryBitOfOddNumbers) {
  const TemporaryFolder folder;
  State state = cushion_state(ElementType::T6, 2, 1);
  const auto nan_with_payload = std::bit_cast<double>(0x7ff0000000abcdefULL); // signalling
  state.fields[1].values[0] = nan_with_payload;
  state.fields[1].values[1] = -0.0;
  state.fields[1].values[2] = std::numeric_limits<double>::denorm_min();
  state.fields[1].values[3] = -std::numeric_limits<double>::infinity();
  state.mesh.nodes[0].y() = std::numeric_limits<double>::denorm_min();
  state.provenance.load_factor = nan_with_payload;
  write_state(state, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), state);
}

TEST(StateFile, KeepsLongTextsAndTextsBeyondAscii) {
  const TemporaryFolder folder;
  State state = cushion_state(ElementType::T3, 1, 1);
  state.provenance.settings = "\ncushion: \u00dcberdruck 250 \u00b5m\t ";
  state.provenance.settings.append(300'000, 'x');
  state.mesh.blocks[0].name = "\u4e0a";
  state.fields[0].name = "Kr\u00fcmmung [1\\m]";
  state.fields[0].unit = "\u00b5m";
  write_state(state, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), state);
}

TEST(StateFile, KeepsAnEmptyState) {
  const TemporaryFolder folder;
  write_state(State{}, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), State{});
}

TEST(StateFile, KeepsAMeshWithoutResultsAndABaseWithoutFoil) {
  const TemporaryFolder folder;
  State state = cushion_state(ElementType::Q9, 2, 1);
  state.stress_rule = geometry::StressRule::reduced;
  state.mesh.blocks[1].kind = geometry::BlockKind::base;
  state.foils[0].reference.clear();
  state.foils[0].predeformation.clear();
  state.foils[0].prestress.clear();
  state.foils[0].history.clear();
  state.foils[1] = {};
  state.chambers.clear();
  state.fields.clear();
  state.provenance = {};
  write_state(state, folder / "a.hdf");
  expect_same(read_state(folder / "a.hdf"), state);
}

TEST(StateFile, HasADigestThatSha256sumUnderstands) {
  const TemporaryFolder folder;
  write_state(cushion_state(ElementType::T3, 1, 1), folder / "a.hdf");
  EXPECT_EQ(bytes_of(folder / "a.hdf.sha256"), digest::sha256_of_file(folder / "a.hdf") + "  a.hdf\n");
}

TEST(StateFile, IsReadWithoutItsDigestToo) {
  const TemporaryFolder folder;
  const State state = cushion_state(ElementType::T6, 2, 2);
  write_state(state, folder / "a.hdf");
  std::filesystem::remove(folder / "a.hdf.sha256");
  expect_same(read_state(folder / "a.hdf"), state);
}

TEST(StateFile, LeavesNothingElseInTheFolder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 2; ++i) write_state(cushion_state(ElementType::T3, 1, 1), folder / "a.hdf");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2);
}

TEST(StateFile, WithAWrongDigestCountsAsNotDone) {
  const TemporaryFolder folder;
  write_state(cushion_state(ElementType::T3, 1, 1), folder / "a.hdf");
  const std::string digest = bytes_of(folder / "a.hdf.sha256");
  write_state(cushion_state(ElementType::T3, 2, 1), folder / "a.hdf");
  for (const std::string& other : {digest, digest.substr(0, 20), std::string()}) {
    put_bytes(folder / "a.hdf.sha256", other);
    const std::string text = complaint(base::ExitCode::bad_state, [&] { read_state(folder / "a.hdf"); });
    EXPECT_THAT(text, HasSubstr((folder / "a.hdf").string()));
    EXPECT_THAT(text, HasSubstr("does not match its digest"));
    EXPECT_THAT(text, HasSubstr("run the stage"));
  }
}

TEST(StateFile, OnAFullDiskKeepsTheOldPair) {
  const TemporaryFolder folder;
  const State old = cushion_state(ElementType::T3, 1, 1);
  write_state(old, folder / "a.hdf");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 10'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string text = complaint(base::ExitCode::machine_refuses,
                                     [&] { write_state(cushion_state(ElementType::T6, 8, 8), folder / "a.hdf"); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(text, HasSubstr((folder / "a.hdf").string()));
  EXPECT_THAT(text, HasSubstr("File too large"));
  expect_same(read_state(folder / "a.hdf"), old);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.hdf.tmp"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.hdf.sha256.tmp"));
}

TEST(StateFile, CannotBeWrittenWhereThereIsNoFolder) {
  const TemporaryFolder folder;
  const std::string text =
      complaint(base::ExitCode::machine_refuses, [&] { write_state(State{}, folder / "none/a.hdf"); });
  EXPECT_THAT(text, HasSubstr("No such file or directory"));
}

TEST(StateFile, RefusesToReplaceAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.hdf");
  const std::string text = complaint(base::ExitCode::bad_state, [&] { write_state(State{}, folder / "a.hdf"); });
  EXPECT_THAT(text, HasSubstr("is a folder"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.hdf.sha256"));
}

struct Wrong {
  const char* name;
  void (*spoil)(State&);
  const char* complaint;
};

class WrongState : public testing::TestWithParam<Wrong> {};

TEST_P(WrongState, IsNotWritten) {
  const TemporaryFolder folder;
  State state = cushion_state(ElementType::T6, 2, 2);
  GetParam().spoil(state);
  const std::string text = complaint(base::ExitCode::bug, [&] { write_state(state, folder / "a.hdf"); });
  EXPECT_THAT(text, HasSubstr(GetParam().complaint));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.hdf"));
}

const Wrong wrong_states[] = {
    {"NodeOutOfRange", [](State& s) { s.mesh.blocks[1].connectivity[3] = 1000; }, "block lower names node 1000"},
    {"NegativeNode", [](State& s) { s.mesh.edges[0].nodes[1] = -1; }, "edge south names node -1"},
    {"HalfAnElement", [](State& s) { s.mesh.blocks[0].connectivity.pop_back(); }, "no whole number of T6 elements"},
    {"FoilMissing", [](State& s) { s.foils.pop_back(); }, "1 foils for 2 blocks"},
    {"MarksMissing", [](State& s) { s.fixed.clear(); }, "marks of held coordinates"},
    {"ShortHistory", [](State& s) { s.foils[0].history.pop_back(); },
     "foil upper: history has 47 values instead of 48"},
    {"ElementWithoutStrip", [](State& s) { s.foils[0].strip_of_element.pop_back(); },
     "foil upper: strip_of_element has 7 values instead of 8"},
    {"StripsOfElementsWithoutStrips", [](State& s) { s.foils[1].strip_of_element = {0}; },
     "foil lower: strip_of_element has 1 values instead of 0"},
    {"UnknownStrip", [](State& s) { s.foils[0].strip_of_element[3] = 2; },
     "foil upper: an element is in strip 2, but there are 2"},
    {"NegativeStrip", [](State& s) { s.foils[0].strip_of_element[3] = -1; }, "an element is in strip -1"},
    {"SameStripName", [](State& s) { s.foils[0].strips[1] = "upper-1"; }, "foil upper: two strips have the same name"},
    {"SeamToAnUnknownStrip", [](State& s) { s.foils[0].seams[0].right = 2; },
     "seam S1 of foil upper names strip 2, but there are 2"},
    {"SeamToANegativeStrip", [](State& s) { s.foils[0].seams[1].left = -1; }, "seam S2 of foil upper names strip -1"},
    {"SeamWithItself", [](State& s) { s.foils[0].seams[0].right = 0; }, "joins strip 0 with itself"},
    {"SeamOfOneNode", [](State& s) { s.foils[0].seams[1].nodes.pop_back(); }, "seam S2 of foil upper has 1 nodes"},
    {"SeamNodeOutOfRange", [](State& s) { s.foils[0].seams[0].nodes[1] = 1000; },
     "seam S1 of foil upper names node 1000"},
    {"SeamWithoutStrips", [](State& s) { s.foils[1].seams = s.foils[0].seams; },
     "seam S1 of foil lower names strip 0, but there are 0"},
    {"SeamBesideItsStrips", [](State& s) { s.foils[0].seams[0].nodes[0] = s.mesh.blocks[0].connectivity[0]; },
     "seam S1 of foil upper: its node 0 is not in the strip upper-2"},
    {"PositionThatIsNone", [](State& s) { s.mesh.nodes[2].y() = std::nan(""); },
     "the positions of the nodes: value 7 is nan"},
    {"OriginThatIsNone", [](State& s) { s.origin.x() = 1.0 / 0.0; }, "the origin: value 0 is inf"},
    {"NegativeThickness", [](State& s) { s.foils[1].thickness = -1e-4; }, "foil lower: thickness is -0.0001"},
    {"NoThickness", [](State& s) { s.foils[1].thickness = 0; }, "foil lower: thickness is 0"},
    {"EndlessThickness", [](State& s) { s.foils[1].thickness = 1.0 / 0.0; }, "foil lower: thickness is inf"},
    {"ReferenceThatIsNone", [](State& s) { s.foils[0].reference[4] = std::nan(""); },
     "foil upper: reference: value 4 is nan"},
    {"HistoryThatIsNone", [](State& s) { s.foils[0].history[1] = -1.0 / 0.0; }, "foil upper: history: value 1 is -inf"},
    {"PrestressOfCompression", [](State& s) { s.foils[0].prestress[3] = -5; },
     "foil upper: the prestress of Gauss point 1 is a compression"},
    {"PressureThatIsNone", [](State& s) { s.chambers[0].gauge_pressure = std::nan(""); },
     "chamber main: gauge pressure is nan"},
    {"NegativeAmbientPressure", [](State& s) { s.chambers[0].ambient_pressure = -1; },
     "chamber main: ambient pressure is -1"},
    {"NoTemperature", [](State& s) { s.chambers[0].temperature = 0; }, "chamber main: temperature is 0"},
    {"LoadThatIsNone", [](State& s) { s.loads[2].dead[1] = std::nan(""); }, "load snow: forces: value 1 is nan"},
    {"BaseOfStrips",
     [](State& s) {
       s.mesh.blocks[1].kind = geometry::BlockKind::base;
       s.foils[1] = {};
       s.foils[1].strips = {"lower-1"};
     },
     "the base lower has strips"},
    {"ShortField", [](State& s) { s.fields[0].values.pop_back(); }, "field displacement has"},
    {"SameName",
     [](State& s) {
       s.fields[4].name = "displacement";
       s.fields[4] = s.fields[0];
     },
     "two fields"},
    {"SlashInName", [](State& s) { s.fields[0].name = "a/b"; }, "cannot be called 'a/b'"},
    {"TakenName", [](State& s) { s.fields[1].name = "foil"; }, "written by the state itself"},
    {"NoUnit", [](State& s) { s.fields[0].unit = ""; }, "has no unit"},
    {"ChamberWithoutWall", [](State& s) { s.chambers[0].inner = 2; }, "chamber main names block 2"},
    {"ChamberConnectedToNone", [](State& s) { s.chambers[0].connected_to = 1; },
     "chamber main is connected to chamber 1, but there are 1"},
    {"ChamberConnectedToLessThanNone", [](State& s) { s.chambers[0].connected_to = -2; },
     "chamber main is connected to chamber -2, but there are 1"},
    {"ChamberConnectedToItself", [](State& s) { s.chambers[0].connected_to = 0; },
     "chamber main is connected to chamber 0, which has no air of its own"},
    {"ReducedRule", [](State& s) { s.stress_rule = geometry::StressRule::reduced; }, "exists for Q9"},
    {"NulInText", [](State& s) { s.provenance.verdict = std::string("a\0b", 3); }, "NUL"},
};
INSTANTIATE_TEST_SUITE_P(StateFile, WrongState, testing::ValuesIn(wrong_states),
                         [](const auto& test) { return test.param.name; });

} // namespace
} // namespace pneuma::pipeline::state
