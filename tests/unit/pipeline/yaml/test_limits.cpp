// SPDX-License-Identifier: GPL-3.0-or-later
// No file, however large or odd, takes all the memory or never ends.
#include <filesystem>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::yaml {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string repeated(int times, const std::string& text) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

std::string first_problem(const std::string& text) {
  std::vector<Problem> problems;
  parse_yaml(text, "a.yaml", problems);
  return problems.empty() ? "" : to_string(problems.front());
}

// Runs in a process of its own, which may take 600 MB more than it has, and 60 s of work.
void check_within_limits(const std::function<bool()>& act) {
#ifndef __SANITIZE_ADDRESS__
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  const rlim_t bytes = pages * static_cast<rlim_t>(::getpagesize()) + 600'000'000;
  const rlimit memory{bytes, bytes};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
  const rlimit work{60, 60};
  ::setrlimit(RLIMIT_CPU, &work);
  ::_exit(act() ? 0 : 1);
}

void expect_within_limits(const std::string& what, const std::function<bool()>& act) {
  EXPECT_EXIT(check_within_limits(act), testing::ExitedWithCode(0), "") << what;
}

void expect_refused(const std::string& text, const std::string& words) {
  expect_within_limits(text.substr(0, 40), [&] { return first_problem(text).find(words) != std::string::npos; });
}

void expect_read(const std::string& text) {
  expect_within_limits(text.substr(0, 40), [&] { return first_problem(text).empty(); });
}

const std::string too_large =
    "with its aliases written out the file holds more than 1000000 keys and values, or 256 MB";

TEST(Limits, NestedAnchorsAreNotKeptTwice) {
  const std::string long_text(103'000, 'x');
  const auto nested = [&](int depth) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += fmt::format("&a{} [", i);
    return "a: " + text + long_text + std::string(static_cast<std::size_t>(depth), ']') + "\n";
  };
  expect_refused(nested(400), "nested deeper than 100 levels");
  expect_read(nested(99));
  expect_read("a: &x " + long_text + "\n" + "b: [*x, *x]\n");
}

TEST(Limits, AliasesAreCountedBeforeTheyAreCopied) {
  const std::string long_text(1'000'000, 'x');
  const std::string many = "[" + repeated(90'000, "*x, ") + "]\n";
  expect_refused("a: &x " + long_text + "\nb: " + many, too_large);
  expect_refused("? &x " + long_text + "\n: 1\nb: " + many, too_large);
  expect_refused("a: &x [" + long_text.substr(0, 100'000) + "]\nb: &y [" + repeated(90, "*x, ") + "]\nc: [" +
                     repeated(90, "*y, ") + "]\n",
                 too_large);
  std::string merges = "a0: &a0 {x: 1}\n";
  for (int i = 1; i < 40; ++i) merges += fmt::format("a{0}: &a{0} {{<<: [*a{1}, *a{1}]}}\n", i, i - 1);
  expect_refused(merges, too_large);
  std::string deep = "a0: &a0 [x]\n";
  for (int i = 1; i < 2000; ++i) deep += fmt::format("a{0}: &a{0} [*a{1}]\n", i, i - 1);
  EXPECT_THAT(first_problem(deep), HasSubstr("a.yaml:100:12: this is nested deeper than 100 levels"));
}

TEST(Limits, DepthIsRefusedAtItsPlace) {
  EXPECT_THAT(first_problem(std::string(100'000, '[')), HasSubstr("this is nested deeper"));
  EXPECT_THAT(first_problem(std::string(100'000, '{')), HasSubstr("this is nested deeper"));
  EXPECT_THAT(first_problem(repeated(100'000, "- ") + "a"), HasSubstr("a.yaml:1:201: this is nested deeper"));
  EXPECT_THAT(first_problem(repeated(100'000, "? ") + "a"), HasSubstr("this is nested deeper"));
  EXPECT_THAT(first_problem(repeated(100'000, "[a: ")), HasSubstr("this is nested deeper"));
  std::string block;
  for (int i = 0; i < 1000; ++i) block += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_THAT(first_problem(block), HasSubstr("a.yaml:101:101: this is nested deeper"));
}

TEST(Limits, NothingIsTakenForMarksWithoutEnd) {
  for (const char* marks : {"[", "{", "&a ", "!a ", "*a ", "\"\" ", "- ", "? ", ": "}) {
    const std::string text = repeated(static_cast<int>(9'000'000 / std::string(marks).size()), marks);
    expect_within_limits(marks, [&] { return !first_problem(text).empty(); });
  }
  for (const char* marks : {",", "a,", "a: 1, ", "{}, "}) {
    const std::string text = "[" + repeated(static_cast<int>(9'000'000 / std::string(marks).size()), marks);
    expect_within_limits(marks, [&] { return !first_problem(text).empty(); });
  }
}

TEST(Limits, AMillionKeysAndValuesAreReadAndLittleMoreIsHeld) {
  expect_read("[" + repeated(990'000, "1, ") + "1]\n");
  expect_read("{\"b\": [" + repeated(900'000, "\"1\",") + "1]}\n");
  for (const char* marks : {"[", "a,"}) {
    const std::string text = "{" + repeated(1'240'000, marks);
    expect_within_limits(marks, [&] { return !first_problem(text).empty(); });
  }
  expect_within_limits("quotes", [&] { return !first_problem("[" + repeated(4'900'000, "\"\"")).empty(); });
}

TEST(Limits, ManyKeysAndStagesAreReadAndWrittenInLinearTime) {
  std::string keys, doubled, stages = "stages:\n";
  for (int i = 0; i < 100'000; ++i) keys += fmt::format("key{}: {}\n", i, i);
  for (int i = 0; i < 20'000; ++i) stages += fmt::format("  - {{id: s{}, run: form, at: [1, 2]}}\n", i);
  for (const std::string& text : {keys, stages, "a: [" + repeated(300'000, "1, ") + "]\n"}) {
    expect_within_limits("written", [&] {
      std::vector<Problem> problems;
      Node tree = parse_yaml(text, "a.yaml", problems);
      std::map<std::string, Mark> marks;
      for (const auto& [path, leaf] : leaves(tree)) marks[path] = leaf->mark;
      replace_marks(tree, marks);
      const std::string written = write_yaml(tree);
      return problems.empty() && write_yaml(parse_yaml(written, "a.yaml", problems)) == written;
    });
  }
  for (int i = 0; i < 100'000; ++i) doubled += "key: 1\n";
  expect_within_limits("doubled", [&] {
    std::vector<Problem> problems;
    parse_yaml(doubled, "a.yaml", problems);
    return problems.size() == 100;
  });
}

std::string reason(const std::filesystem::path& file) {
  std::vector<Problem> problems;
  EXPECT_EQ(read_text(file, {"a.yaml", 3, 4}, problems), "");
  return problems.empty() ? "" : to_string(problems.front());
}

TEST(ReadText, OnlyRegularFilesOfBoundedSizeAreRead) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / fmt::format("pneuma_read_text_{}", ::getpid());
  std::filesystem::create_directories(folder);
  EXPECT_THAT(reason(folder), HasSubstr("cannot be read: it is a folder"));
  EXPECT_THAT(reason(folder / "none"), HasSubstr("cannot be read: No such file"));
  EXPECT_EQ(reason("/dev/zero"), "a.yaml:3:4: the file `/dev/zero` cannot be read: it is a device, not a file");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(reason(folder / "pipe"), HasSubstr("it is a pipe, not a file"));
  std::ofstream(folder / "large") << "a: 1\n";
  std::filesystem::resize_file(folder / "large", 23'400'000);
  EXPECT_THAT(reason(folder / "large"), HasSubstr("it has 23.4 MB, more than 10 MB"));
  std::filesystem::resize_file(folder / "large", 5);
  std::vector<Problem> problems;
  EXPECT_EQ(read_text(folder / "large", {}, problems), "a: 1\n");
  EXPECT_THAT(reason(std::string((folder / "large").string() + std::string("\0x", 2))), HasSubstr("a zero byte"));
  std::filesystem::remove_all(folder);
}

} // namespace
} // namespace pneuma::pipeline::yaml
