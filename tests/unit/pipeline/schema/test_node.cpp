// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/node.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pneuma::pipeline::schema {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> problems_of(const std::string& text) {
  std::vector<Problem> problems;
  parse_yaml(text, "a.yaml", problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems) lines.push_back(to_string(problem));
  return lines;
}

TEST(Yaml, MarksAreOneBased) {
  std::vector<Problem> problems;
  const Node tree = parse_yaml("a: 1\nb: {c: x}\n", "a.yaml", problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(to_string(find(*find(tree, "b"), "c")->mark), "a.yaml:2:8");
  EXPECT_EQ(to_string(find(tree, "b")->mark), "a.yaml:2:4");
}

TEST(Yaml, EveryDuplicateKeyIsFound) {
  EXPECT_THAT(problems_of("a: 1\na: 2\nb: {c: 1, c: 2}\n"),
              ElementsAre("a.yaml:2:1: the key `a` stands here a second time (first in line 1); keep one",
                          "a.yaml:3:11: the key `c` stands here a second time (first in line 3); keep one"));
}

TEST(Yaml, SyntaxErrorHasItsPlace) {
  EXPECT_THAT(problems_of("a: {b: 1\nc: 2\n"), ElementsAre(HasSubstr("not valid YAML: a `{` above is not closed")));
  EXPECT_THAT(problems_of(std::string("a: \"\\\x01\0\"", 8)), ElementsAre(HasSubstr("this is no text file")));
  EXPECT_THAT(problems_of("a:\n\tb: 1\n"), ElementsAre(HasSubstr("line 2 is indented with a tab; use spaces")));
}

TEST(Yaml, SecondDocumentIsRefused) {
  EXPECT_THAT(problems_of("a: 1\n---\nb: 2\n"),
              ElementsAre("a.yaml:3:1: a second YAML document begins here; a file holds one"));
}

TEST(Yaml, AliasIsACopyAndOneThatHoldsItselfIsRefused) {
  std::vector<Problem> problems;
  const Node tree = parse_yaml("a: &x {c: 5}\nb: *x\n", "a.yaml", problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(find(*find(tree, "b"), "c")->text, "5");
  EXPECT_THAT(problems_of("a: &x [1, *x]\n"),
              ElementsAre("a.yaml:1:11: this alias refers to itself; write the values out"));
}

TEST(Yaml, AliasesThatExplodeAreRefused) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    text +=
        fmt::format("a{0}: &a{0} [{1}, {1}, {1}, {1}, {1}, {1}, {1}, {1}, {1}, {1}]\n", i, fmt::format("*a{}", i - 1));
  }
  EXPECT_THAT(problems_of(text), ElementsAre(HasSubstr("aliases blow the file up")));
}

TEST(Yaml, DeepNestingIsRefusedWithoutACrash) {
  EXPECT_THAT(problems_of(std::string(100000, '[')), ElementsAre(HasSubstr("not valid YAML")));
}

TEST(Yaml, WrittenTreeReadsBackTheSame) {
  const std::string text = "a: {b: 1, c: [x, y]}\n"
                           "list:\n"
                           "  - {name: one, at: [0, 1]}\n"
                           "  - deeper:\n"
                           "      e:\n"
                           "        f: {g: 1}\n"
                           "odd: \"a: b # \\\"c\\\" \\\\ null\"\n"
                           "empty: \"\"\n"
                           "none: []\n"
                           "nothing: {}\n"
                           "lines: \"one\\x0atwo\"\n";
  std::vector<Problem> problems;
  const Node tree = parse_yaml(text, "a.yaml", problems);
  EXPECT_TRUE(problems.empty());
  const std::string written = write_yaml(tree);
  EXPECT_EQ(write_yaml(parse_yaml(written, "a.yaml", problems)), written);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(find(parse_yaml(written, "a.yaml", problems), "odd")->text, "a: b # \"c\" \\ null");
  EXPECT_EQ(find(parse_yaml(written, "a.yaml", problems), "lines")->text, "one\ntwo");
}

TEST(Yaml, LeavesHaveThePathOfTheirKeys) {
  std::vector<Problem> problems;
  const Node tree = parse_yaml("a: {b: [x, {c: y}]}\n", "a.yaml", problems);
  std::vector<std::string> paths;
  for (const auto& [path, leaf] : leaves(tree)) paths.push_back(fmt::format("{}={}", path, leaf->text));
  EXPECT_THAT(paths, ElementsAre("a.b.0=x", "a.b.1.c=y"));
}

} // namespace
} // namespace pneuma::pipeline::schema
