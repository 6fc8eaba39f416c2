// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/yaml/node.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pneuma::pipeline::yaml {
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

TEST(Yaml, SecondDocumentIsRefused) {
  EXPECT_THAT(problems_of("a: 1\n---\nb: 2\n"),
              ElementsAre("a.yaml:2:1: a second YAML document begins here; a file holds one"));
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
  EXPECT_THAT(problems_of(text),
              ElementsAre(HasSubstr("with its aliases written out the file holds more than 1000000")));
}

std::string merged(const std::string& text) {
  std::vector<Problem> problems;
  Node tree = parse_yaml(text, "a.yaml", problems);
  for (const Problem& problem : problems) ADD_FAILURE() << to_string(problem);
  drop_templates(tree);
  return write_yaml(tree);
}

TEST(Merge, ExplicitKeyWinsThenTheFirstOfAList) {
  const std::string templates = "x-one: &one {a: 1, b: 1}\nx-two: &two {b: 2, c: {d: 2, e: 2}}\n";
  EXPECT_EQ(merged(templates + "m: {<<: *one, b: 0}\n"), "m: {b: 0, a: 1}\n");
  EXPECT_EQ(merged(templates + "m: {b: 0, <<: [*two, *one]}\n"), "m:\n  b: 0\n  c: {d: 2, e: 2}\n  a: 1\n");
  EXPECT_EQ(merged(templates + "m: {<<: *two, c: {e: 0}}\n"), "m:\n  c: {e: 0}\n  b: 2\n");
  EXPECT_EQ(merged(templates + "m: {<<: {a: 3, <<: *one}}\n"), "m: {a: 3, b: 1}\n");
  EXPECT_EQ(merged("m: {\"<<\": 1}\n"), "m: {\"<<\": 1}\n");
  EXPECT_EQ(merged("m: {<<: &x {a: 1}}\nn: *x\n"), "m: {a: 1}\nn: {a: 1}\n");
}

TEST(Merge, MarksAreThoseOfTheTemplate) {
  std::vector<Problem> problems;
  const Node tree = parse_yaml("x-a: &a\n  b: 1\nm:\n  <<: *a\n  c: 2\n", "a.yaml", problems);
  const Node& map = *find(tree, "m");
  ASSERT_EQ(map.entries.size(), 2U);
  EXPECT_EQ(to_string(map.entries[1].mark), "a.yaml:2:3");
  EXPECT_EQ(to_string(map.entries[1].value.mark), "a.yaml:2:6");
  EXPECT_EQ(to_string(map.mark), "a.yaml:4:3");
}

TEST(Merge, WhatIsNoMapAndASecondMergeAreRefused) {
  const std::string words = "`<<` takes over the entries of maps: `<<: *name`, or `<<: [*name, *other]`";
  EXPECT_THAT(problems_of("a: {<<: 5}\n"), ElementsAre("a.yaml:1:5: " + words));
  EXPECT_THAT(problems_of("a: {<<: [{b: 1}, 5]}\n"), ElementsAre("a.yaml:1:5: " + words));
  EXPECT_THAT(problems_of("a:\n  <<:\n"), ElementsAre("a.yaml:2:3: " + words));
  EXPECT_THAT(problems_of("a: {<<: {b: 1}, <<: {c: 1}}\n"),
              ElementsAre(HasSubstr("the key `<<` stands here a second")));
}

TEST(Yaml, WhatIsWrongInAnAnchorIsSaidOnce) {
  EXPECT_THAT(problems_of("a: &x {b: 1, b: 2}\nc: [*x, *x]\nd: {<<: *x}\n"), ElementsAre(HasSubstr("a.yaml:1:14: ")));
}

TEST(Yaml, KeyIsAWordOfBoundedLength) {
  EXPECT_THAT(problems_of("? [a]\n: 1\n"),
              ElementsAre("a.yaml:1:3: a key must be a word, not a list or a map, nor empty"));
  EXPECT_THAT(problems_of("~: 1\n"), ElementsAre(HasSubstr("a key must be a word")));
  EXPECT_THAT(problems_of("? " + std::string(1025, 'x') + "\n: 1\n"),
              ElementsAre(HasSubstr("at most 1024 characters")));
}

TEST(Yaml, TextsThatLookLikeOthersAreQuoted) {
  using namespace std::string_literals;
  for (const std::string& text : {"null"s, "Null"s, "NULL"s, "~"s, ""s, "a\0b"s, "\xc2\x9b"s, "a\tb"s, "<<"s}) {
    std::vector<Problem> problems;
    const Node back = parse_yaml(write_yaml(scalar(text)), "a.yaml", problems);
    EXPECT_TRUE(problems.empty());
    EXPECT_EQ(back.kind, NodeKind::scalar) << text;
    EXPECT_EQ(back.text, text);
  }
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
} // namespace pneuma::pipeline::yaml
