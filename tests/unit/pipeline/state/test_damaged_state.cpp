// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/base/errors.h"
#include "pipeline/state/hdf5.h"
#include "pipeline/state/layout.h"
#include "pipeline/state/state_file.h"
#include "pipeline/state/trial.h"
#include "tests/unit/pipeline/state/cushion_state.h"
#include "tests/unit/pipeline/state/same_state.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::pipeline::state {
namespace {

using geometry::ElementType;
using testing::HasSubstr;
using tests::cushion_state;
using tests::put_bytes;
using tests::TemporaryFolder;

// What read_state says of a file with these bytes and no digest; empty: it was read.
std::string verdict_on(const std::string& bytes) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.hdf", bytes);
  try {
    read_state(folder / "a.hdf");
  } catch (const base::StateError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder / "a.hdf").string()));
    return error.what();
  }
  return {};
}

// The first place where `what` stands is overwritten: our writer makes no wrong state.
std::string replaced(std::string bytes, const std::string& what, const std::string& by) {
  const std::size_t at = bytes.find(what);
  EXPECT_NE(at, std::string::npos);
  return bytes.replace(at, by.size(), by);
}

// A state's file as it is written.
std::string good_bytes() {
  const TemporaryFolder folder;
  write_state(cushion_state(ElementType::T6, 2, 1), folder / "a.hdf");
  return tests::bytes_of(folder / "a.hdf");
}

TEST(DamagedState, IsRefusedWhereverAByteIsChanged) {
  const std::string good = good_bytes();
  ASSERT_EQ(verdict_on(good), "");
  constexpr std::size_t trials = 100;
  for (std::size_t i = 0; i < trials; ++i) {
    std::string bytes = good;
    const std::size_t at = (i * 7919 + 13) * 104729 % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (i % 8)));
    EXPECT_NE(verdict_on(bytes), "") << "byte " << at;
  }
}

TEST(DamagedState, IsRefusedWhereverItsBeginningIsChanged) {
  // the superblock and the header of the root group
  const std::string good = good_bytes();
  for (std::size_t at = 0; at < 96; at += 4) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_NE(verdict_on(bytes), "") << "byte " << at;
  }
}

TEST(DamagedState, IsRefusedWhereverItIsCutOff) {
  const std::string good = good_bytes();
  for (std::size_t part = 0; part < 20; ++part) {
    EXPECT_NE(verdict_on(good.substr(0, good.size() * part / 20)), "") << part << "/20";
  }
  EXPECT_NE(verdict_on(good.substr(0, good.size() - 1)), "");
}

TEST(DamagedState, WithAnotherValueIsRefusedWithoutItsDigestToo) {
  const double pressure = 400;
  const double other = 401;
  const std::string bytes = replaced(good_bytes(), {reinterpret_cast<const char*>(&pressure), sizeof pressure},
                                     {reinterpret_cast<const char*>(&other), sizeof other});
  EXPECT_THAT(verdict_on(bytes), HasSubstr("not what its stage wrote"));
}

TEST(DamagedState, IsNamedAsSuch) {
  const std::string good = good_bytes();
  EXPECT_THAT(verdict_on(good.substr(0, good.size() / 2)), HasSubstr("damaged"));
}

TEST(DamagedState, WithNodesOutOfRangeIsRefused) {
  State state = cushion_state(ElementType::T3, 1, 1);
  const std::string good = to_bytes(state);
  const std::int64_t first[] = {0, 1, 3}; // the connectivity's beginning
  const std::int64_t wrong[] = {0, 1, 77};
  const std::string bytes = replaced(good, {reinterpret_cast<const char*>(first), sizeof first},
                                     {reinterpret_cast<const char*>(wrong), sizeof wrong});
  EXPECT_THAT(verdict_on(bytes), HasSubstr("names node 77"));
}

TEST(DamagedState, WithAnElementOfAnUnknownStripIsRefused) {
  State state = cushion_state(ElementType::T3, 2, 1);
  std::vector<Index>& strips = state.foils[0].strip_of_element;
  strips = {1, 1, 0, 1}; // as nothing else in the file
  const Index wrong[] = {1, 1, 0, 5};
  const std::string bytes =
      replaced(to_bytes(state), {reinterpret_cast<const char*>(strips.data()), strips.size() * sizeof(Index)},
               {reinterpret_cast<const char*>(wrong), sizeof wrong});
  EXPECT_THAT(verdict_on(bytes), HasSubstr("foil upper: an element is in strip 5, but there are 2"));
}

TEST(DamagedState, WithSeamsLongerThanTheirNodesIsRefused) {
  const std::int64_t counts[] = {3, 2}; // of the two seams
  for (const std::int64_t other : {1, 3, 1000, -2}) {
    const std::int64_t wrong[] = {3, other};
    const std::string bytes =
        replaced(to_bytes(cushion_state(ElementType::T6, 2, 1)), {reinterpret_cast<const char*>(counts), sizeof counts},
                 {reinterpret_cast<const char*>(wrong), sizeof wrong});
    EXPECT_THAT(verdict_on(bytes), HasSubstr("/pneuma/foils/0000/seams/count: does not sum to the nodes"));
  }
}

TEST(DamagedState, OfAnotherSchemaVersionSaysWhich) {
  const std::string text = verdict_on(hdf5::new_file(
      [](const hdf5::Group& root) { root.create("pneuma").set_attribute("schema", std::vector<std::int64_t>{99}); }));
  EXPECT_THAT(text, HasSubstr("schema version 99"));
  EXPECT_THAT(text, HasSubstr(fmt::format("reads version {}", schema_version)));
}

TEST(ForeignFile, ThatIsHdf5OfSomebodyElseIsRefused) {
  const std::string bytes =
      hdf5::new_file([](const hdf5::Group& root) { root.create("somebody").write("name", {"else"}); });
  EXPECT_THAT(verdict_on(bytes), HasSubstr("/pneuma: missing"));
}

TEST(ForeignFile, ThatIsATextIsRefused) {
  EXPECT_THAT(verdict_on("pneuma: 1\nname: not a state\n"), HasSubstr("is not a state file"));
}

TEST(ForeignFile, ThatIsEmptyIsRefused) {
  EXPECT_THAT(verdict_on(""), HasSubstr("is not a state file"));
}

TEST(ForeignFile, ThatIsAFolderIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_state(folder.path()); }, testing::ThrowsMessage<base::StateError>(HasSubstr("is a folder")));
}

TEST(ForeignFile, ThatIsMissingIsRefusedWithAdvice) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_state(folder / "a.hdf"); },
              testing::ThrowsMessage<base::StateError>(testing::AllOf(
                  HasSubstr((folder / "a.hdf").string()), HasSubstr("does not exist"), HasSubstr("run the stage"))));
}

TEST(Trial, TellsHowItsChildEnded) {
  constexpr std::size_t memory = 100'000'000;
  EXPECT_EQ(try_in_child([] {}, 5, memory), "");
  EXPECT_EQ(try_in_child([] { throw std::runtime_error("no luck"); }, 5, memory), "no luck");
  EXPECT_EQ(try_in_child([] { std::abort(); }, 5, memory), "reading crashed");
}

TEST(Trial, EndsAChildThatHangs) {
  const auto hang = [] {
    volatile bool forever = true;
    while (forever) {
    }
  };
  EXPECT_THAT(try_in_child(hang, 1, 100'000'000), HasSubstr("did not end within 1 s"));
}

} // namespace
} // namespace pneuma::pipeline::state
