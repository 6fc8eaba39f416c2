// SPDX-License-Identifier: GPL-3.0-or-later
// What users are told about texts that are no YAML.
#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/yaml/node.h"
#include "pipeline/yaml/text.h"

namespace pneuma::pipeline::yaml {
namespace {

struct Case {
  std::string text, place, words;
};

class Slips : public testing::TestWithParam<Case> {};

TEST_P(Slips, AreToldInWordsWhereTheyBegan) {
  std::vector<Problem> problems;
  parse_yaml(GetParam().text, "a.yaml", problems);
  ASSERT_EQ(problems.size(), 1U) << GetParam().text;
  const std::string message = to_string(problems[0]);
  EXPECT_THAT(message, testing::StartsWith("a.yaml:" + GetParam().place + ": "));
  EXPECT_THAT(message, testing::HasSubstr(GetParam().words));
}

INSTANTIATE_TEST_SUITE_P(
    Quotes, Slips,
    testing::Values(Case{"a: \"b\nc: 1\nd: 2\n", "1:4", "the quote \" that begins here is not closed"},
                    Case{"a: 1\nb: &x 'c\n", "2:7", "the quote ' that begins here is not closed"},
                    Case{"a: [1, \"b]\nc: 1\n", "1:8", "the quote \" that begins here is not closed"},
                    Case{"a: \"b\n---\nc: 1\n", "1:4", "the quote \" that begins here is not closed"},
                    Case{"a: \"b\nc: \"d\"\n", "1:4", "ends in line 2 only, before `d\"`"},
                    Case{"a: 'it's'\n", "1:8", "`s'` follows a closing quote; a quote inside quotes is written `''`"},
                    Case{"a: \"b\\d\"\n", "1:6", "in double quotes `\\` begins a special character"}));

INSTANTIATE_TEST_SUITE_P(
    Brackets, Slips,
    testing::Values(Case{"a: {b: 1\nc: 2\n", "1:4", "the `{` that begins here is not closed by `}`"},
                    Case{"a: 1\nb: [1, 2\n", "2:4", "the `[` that begins here is not closed by `]`"},
                    Case{"a: [1, 2", "1:4", "the `[` that begins here is not closed by `]`"},
                    Case{"a: [1, 2\nb: 3\n", "1:4", "the `[` that begins here is not closed by `]`"},
                    Case{"a: {b: 1 c: 2}\n", "1:11", "a comma is missing before"},
                    Case{"a: {b: [1, 2}\n", "1:13", "`}` cannot close the `[` of line 1; `]` is missing"},
                    Case{"a: 1]\nb: ]\n", "2:4", "`]` closes nothing"},
                    Case{"a: [- 1]\n", "1:5", "parted by commas, without `-`"}));

INSTANTIATE_TEST_SUITE_P(
    Indentation, Slips,
    testing::Values(Case{"a:\n\tb: 1\n", "2:1", "line 2 is indented with a tab; use spaces"},
                    Case{"a:\n  b: 1\n  \tc: 1\n", "3:3", "line 3 is indented with a tab; use spaces"},
                    Case{"a: 1\n  b: 2\n", "2:3",
                         "`b` is indented deeper than line 1, whose key has its value already"},
                    Case{"a: 1\n# so\n  b: 2\n", "3:3", "`b: 2` fits nothing above"},
                    Case{"a:\n  b: 1\n c: 2\n", "3:2", "`c: 2` fits nothing above"},
                    Case{"  a: 1\nb: 2\n", "2:1", "`b: 2` fits nothing above"},
                    Case{"- a\nb: 2\n", "2:1", "`b: 2` fits nothing above: keys and items of a list do not mix"},
                    Case{"a:\n  - 1\n - 2\n", "3:2", "fits nothing above"},
                    Case{"a: - b\n", "1:4", "on a line of its own"}));

INSTANTIATE_TEST_SUITE_P(
    Signs, Slips,
    testing::Values(Case{"a: 1\nb:2\nc: 3\n", "2:1", "a blank is missing after the `:` of `b:2`"},
                    Case{"a: 1\nb:2\n", "2:1", "a blank is missing after the `:` of `b:2`"},
                    Case{"a: {b:2}\n", "1:5", "a blank is missing after the `:` of `b:2`"},
                    Case{"a: 1\nb\n", "2:1", "`b` is no `key: value`"}, Case{"\"a\":1\n", "1:4", "a blank is missing"},
                    Case{"a: 1\nb\nc: 3\n", "2:1", "`b` is no `key: value`"},
                    Case{"name: a: b\n", "1:8", "a second `: ` in one line"},
                    Case{"a: @b\n", "1:4", "`@b` cannot stand here; put a text that begins so in quotes"},
                    Case{"a: `b`\n", "1:4", "cannot stand here"}, Case{"a: %b\n", "1:4", "`%b` cannot stand here"},
                    Case{"a: 1\n%b: 2\n", "2:1", "a line cannot begin with `%`"},
                    Case{"a: *b\n", "1:4", "no value above is named `&b`"},
                    Case{"a: * b\n", "1:5", "`*` and `&` begin the name of a value"},
                    Case{"a: !!binary aGk=\n", "1:4", "the tag `!!binary` is not known here"},
                    Case{"a: !b [1]\n", "1:4", "the tag `!b` is not known here"},
                    Case{"a: > 5\n", "1:6", "begin a block of text"}, Case{"a: ? b\n", "1:4", "goes in quotes"}));

INSTANTIATE_TEST_SUITE_P(NoText, Slips,
                         testing::Values(Case{std::string("\x7f"
                                                          "ELF\0\1\2",
                                                          7),
                                              "1:1", "this is no text file in UTF-8; the character 0x7f stands here"},
                                         Case{std::string("a\0:\0", 4), "1:2", "the character 0x00"},
                                         Case{"\xff\xfe"
                                              "a",
                                              "1:1", "this is no text file in UTF-8, but in UTF-16"},
                                         Case{"a: 1\nb: \xfc\n", "2:4", "the byte 0xfc"},
                                         Case{"a: \xc2\x9b\n", "1:4", "character 0x9b"},
                                         Case{"a: 1\x04\nb: 2\n", "1:5", "the character 0x04"},
                                         Case{"a: \"\\_\"\n", "1:4", "are not known in quotes"},
                                         Case{"test: 1,stress\n1,2\n3,4\n", "3:1", "`3,4` is no `key: value`"},
                                         Case{"%PDF-1.4\n%\xe2\xe3\n", "1:1", "a line cannot begin with `%`"}));

TEST(Message, IsOneLineOfPrintableTextOfBoundedLength) {
  const Problem problem{{"a\n.yaml", 1, 2},
                        "\x1b[2J`\xc2\x9b"
                        "1m\xe2\x80\xae` \xff"
                        "ok \xc3\xa4",
                        true};
  EXPECT_EQ(to_string(problem), "a\\n.yaml:1:2: \\x1b[2J`\\x9b1m\\u202e` \\xffok \xc3\xa4");
  std::string umlauts;
  for (int i = 0; i < 100000; ++i) umlauts += "\xc3\xa4";
  const std::string message = to_string({{"a.yaml", 1, 1}, "x" + umlauts + "; keep one", true});
  EXPECT_LT(message.size(), 1000U);
  EXPECT_THAT(message, testing::EndsWith("; keep one"));
  EXPECT_EQ(message.find("\\x"), std::string::npos);
}

const std::vector<std::string> samples = {
    "pneuma: 1\nname: a\nmaterials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45}\nlist:\n  - a: 1\n    b: [1, 2]\n  - "
    "c\n",
    "x-a: &a {b: 1, c: \"d # e\"}\nf: {<<: *a, c: 2}\ng: {<<: [*a, {h: 'i''j'}]}\n",
    "# text\ntext: |\n  one [\n  two \"\nfolded: >-\n  a\n  b\nlast: {a: {b: {c: []}}}\nnull: ~\n",
    "[{\"a\": 1, \"b\": [true, null, -1e3]}, {\"c\": \"\\u00e4\\n\"}]\n",
    "? a\n: b\nc: &x [1, &y z]\nd: *x\ne: *y\nf:\n- 1\n- - 2\n  - 3\n"};

std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  static const std::string signs = "\"'[]{}:,-?*&!|>%@`#\n\t \r\\~<\x01\x04\x7f\x80\xc3\xff";
  for (std::size_t n = 1 + below(3); n > 0 && !text.empty(); --n) {
    const std::size_t at = below(text.size()), line = text.find('\n', at);
    switch (below(6)) {
    case 0:
      text[at] = static_cast<char>(below(256));
      break;
    case 1:
      text.erase(at, 1 + below(4));
      break;
    case 2:
      text.resize(at);
      break;
    case 3:
      text.insert(at, text.substr(at, line - at));
      break;
    case 4:
      text.insert(at, 1, signs[below(signs.size())]);
      break;
    default:
      text.insert(at, std::vector<std::string>{": ", "- ", "<<: ", "\n ", "*a", "&a ", "\n---\n"}[below(7)]);
      break;
    }
  }
  return text;
}

// Why a message is none that may be printed; empty: it may.
std::string flaw(const Problem& problem, int lines) {
  const std::string message = to_string(problem);
  for (std::size_t at = 0; at < message.size();) {
    const auto [code, size, valid] = character_at(message, at);
    if (!valid || is_control(code)) return "control character";
    at += size;
  }
  for (const char* jargon : {"illegal", "end of ", "not found", "yaml-cpp", "bad file", "scalar", "flow"}) {
    if (message.find(jargon) != std::string::npos) return jargon;
  }
  const Mark& mark = problem.mark;
  return mark.line >= 1 && mark.line <= lines && mark.column >= 1 && message.size() < 1300 ? "" : "place or size";
}

TEST(Damaged, TextsAreRefusedAtAPlaceInTheFileOrReadBackTheSame) {
  std::mt19937 random(11);
  for (int run = 0; run < 20000; ++run) {
    const std::string text = damaged(samples[static_cast<std::size_t>(run) % samples.size()], random);
    std::vector<Problem> problems;
    const Node tree = parse_yaml(text, "a.yaml", problems);
    const int lines =
        std::max(1, static_cast<int>(std::count(text.begin(), text.end(), '\n')) + (text.ends_with('\n') ? 0 : 1));
    for (const Problem& problem : problems) {
      ASSERT_EQ(flaw(problem, lines), "") << text << "\n" << to_string(problem);
    }
    for (const auto& [path, leaf] : leaves(tree)) ASSERT_LE(leaf->mark.line, lines) << text << "\n" << path;
    const std::string written = write_yaml(tree);
    std::vector<Problem> again;
    ASSERT_EQ(write_yaml(parse_yaml(written, "b.yaml", again)), written) << text;
    for (const Problem& problem : again) ADD_FAILURE() << to_string(problem) << "\n" << written;
  }
}

} // namespace
} // namespace pneuma::pipeline::yaml
