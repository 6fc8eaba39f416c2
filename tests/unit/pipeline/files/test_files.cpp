// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>

#include <sys/resource.h>
#include <sys/stat.h>

#include "geometry/base/errors.h"
#include "pipeline/files/outputs.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::pipeline::files {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::bytes_of;
using tests::put_bytes;
using tests::TemporaryFolder;

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const base::Error& error) {
    EXPECT_EQ(error.code(), base::ExitCode::machine_refuses) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

TEST(Files, AreWrittenWholeAndWithoutALinkThatHasTheirName) {
  const TemporaryFolder folder;
  put_bytes(folder / "elsewhere", "kept");
  for (const char* name : {"a.txt", "a.txt.tmp"}) fs::create_symlink(folder / "elsewhere", folder / name);
  write_file(folder / "a.txt", "new");
  EXPECT_EQ(bytes_of(folder / "a.txt"), "new");
  EXPECT_FALSE(fs::is_symlink(folder / "a.txt"));
  EXPECT_EQ(bytes_of(folder / "elsewhere"), "kept");
  EXPECT_FALSE(fs::exists(fs::symlink_status(folder / "a.txt.tmp")));
}

TEST(Files, ThatGrowBeginAnewAndFollowNoLink) {
  const TemporaryFolder folder;
  put_bytes(folder / "elsewhere", "kept");
  fs::create_symlink(folder / "elsewhere", folder / "log");
  GrowingFile log(folder / "log");
  log.add("a\n");
  EXPECT_EQ(bytes_of(folder / "log"), "a\n");
  log.add("b\n");
  EXPECT_EQ(bytes_of(folder / "log"), "a\nb\n");
  EXPECT_EQ(bytes_of(folder / "elsewhere"), "kept");
}

TEST(Files, WhatTheSystemRefusesIsToldWithWhatHelps) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { write_file(folder / "none/a.txt", "x"); }), HasSubstr("No such file or directory"));
  EXPECT_THAT(refusal([&] { write_file(folder / std::string(300, 'a'), "x"); }),
              AllOf(HasSubstr("File name too long"), HasSubstr("choose a shorter name")));
  put_bytes(folder / "file", "");
  EXPECT_THAT(refusal([&] { make_folder(folder / "file/in"); }),
              AllOf(HasSubstr("Not a directory"), HasSubstr("a file has the name of a folder")));
  fs::create_directory(folder / "real");
  fs::create_directory_symlink(folder / "real", folder / "link");
  EXPECT_THAT(refusal([&] { make_folder(folder / "link"); }), HasSubstr("remove it"));
  EXPECT_NO_THROW(make_folder(folder / "link", Links::followed));
  EXPECT_NO_THROW(make_folder(folder / "x/y/z"));
}

TEST(Files, OnAFullDiskTheOldOneStays) {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{10'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string text = refusal([&] { write_file(folder / "a", std::string(20'000, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(text, HasSubstr("File too large"));
  EXPECT_EQ(bytes_of(folder / "a"), "old");
  EXPECT_FALSE(fs::exists(folder / "a.tmp"));
}

TEST(Outputs, OfTheLastRunAreGoneAndTheUsersOwnFilesStay) {
  const TemporaryFolder folder;
  {
    Outputs first(folder / "a.hdf", "");
    for (const char* name : {"a.hdf", "steps/0000.hdf", "steps/0001.hdf", "upper.dxf"}) {
      put_bytes(first.file(name), "x");
    }
  }
  EXPECT_THAT(outputs_of(folder / "a.hdf"), ElementsAre("a.hdf", "steps/0000.hdf", "steps/0001.hdf", "upper.dxf"));
  put_bytes(folder / "mine.pvsm", "x");
  put_bytes(folder / "steps/mine.txt", "x");
  Outputs second(folder / "a.hdf", "");
  for (const char* name : {"a.hdf", "steps/0000.hdf", "steps/0001.hdf", "upper.dxf"}) {
    EXPECT_FALSE(fs::exists(folder / name)) << name;
  }
  EXPECT_TRUE(fs::exists(folder / "mine.pvsm"));
  EXPECT_TRUE(fs::exists(folder / "steps/mine.txt"));
  put_bytes(second.file("b.txt"), "x");
  EXPECT_THAT(outputs_of(folder / "a.hdf"), ElementsAre("b.txt"));
}

TEST(Outputs, BesideOneAnotherAreKeptApart) {
  const TemporaryFolder folder;
  Outputs form(folder / "form.hdf", "");
  put_bytes(form.file("form.hdf"), "x");
  Outputs wind(folder / "wind.hdf", folder / "form.hdf");
  put_bytes(wind.file("wind.hdf"), "x");
  EXPECT_TRUE(fs::exists(folder / "form.hdf"));
  Outputs again(folder / "wind.hdf", folder / "wind.hdf"); // starts from its own state
  EXPECT_TRUE(fs::exists(folder / "wind.hdf"));
}

TEST(Outputs, ADamagedListRemovesNothingElsewhere) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "stage");
  fs::create_directories(folder / "other");
  fs::create_directory_symlink(folder / "other", folder / "stage/steps");
  put_bytes(folder / "mine", "x");
  put_bytes(folder / "other/0000.hdf", "x");
  put_bytes(folder / "stage/.a.hdf.outputs", "../mine\n" + (folder / "mine").string() + "\nsteps/0000.hdf\n\n./\n.\n");
  EXPECT_TRUE(outputs_of(folder / "stage/a.hdf").empty()) << *outputs_of(folder / "stage/a.hdf").begin();
  const Outputs next(folder / "stage/a.hdf", "");
  EXPECT_TRUE(fs::exists(folder / "mine"));
  EXPECT_TRUE(fs::exists(folder / "other/0000.hdf"));
}

} // namespace
} // namespace pneuma::pipeline::files
