// SPDX-License-Identifier: GPL-3.0-or-later
// The damages themselves: that each is the one step it says, and that the verdicts see what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/workflows/damage/verdict.h"
#include "tests/workflows/damage/yaml_text.h"

namespace pneuma::tests::damage {
namespace {

const std::string text = "a: {b: 1 m, c: [1, 2]} # d: 5\n" // line 1
                         "list:\n"
                         "  - {name: x}\n"
                         "  - name: y\n"
                         "    k: &anchor word\n" // line 5
                         "z: *anchor\n"
                         "last:\n"
                         "  called: x\n";

Damage only(Kind kind, const std::string& path) {
  for (const Damage& damage : damages_of(text)) {
    if (damage.kind == kind && damage.path == path) return damage;
  }
  ADD_FAILURE() << to_string(kind) << " at " << path << " is not made";
  return {};
}

// The damaged text where it differs: its lines `first` to `last`.
std::string lines(const Damage& damage, int first, int last) {
  const std::string now = damaged(text, damage);
  std::string found;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const int line = line_of(now, i);
    if (line >= first && line <= last) found += now[i];
  }
  return found;
}

TEST(Damages, KeysGoInFlowInBlockAndBehindADash) {
  EXPECT_EQ(lines(only(Kind::key_dropped, "a.b"), 1, 1), "a: {c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "a.c"), 1, 1), "a: {b: 1 m} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "list.0.name"), 3, 3), "  - {}\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "list.1.name"), 4, 5), "  - k: &anchor word\nz: *anchor\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "list.1.k"), 4, 5), "  - name: y\nz: *anchor\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "list"), 1, 2), "a: {b: 1 m, c: [1, 2]} # d: 5\nz: *anchor\n");
  EXPECT_EQ(lines(only(Kind::key_dropped, "last.called"), 7, 8), "last:\n  {}\n");
}

TEST(Damages, KeysAreDoubledAndMisspelt) {
  EXPECT_EQ(lines(only(Kind::key_doubled, "a.b"), 1, 1), "a: {b: 1 m, b: 1 m, c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::key_doubled, "list.1.name"), 4, 5), "  - name: y\n    name: y\n");
  EXPECT_EQ(only(Kind::key_doubled, "list.1.name").at.first, 5);
  EXPECT_EQ(lines(only(Kind::key_misspelt, "list"), 2, 2), "lsit:\n");
}

TEST(Damages, ListsAreShorterLongerAndEmpty) {
  EXPECT_EQ(lines(only(Kind::list_shortened, "a.c"), 1, 1), "a: {b: 1 m, c: [1]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::list_lengthened, "a.c"), 1, 1), "a: {b: 1 m, c: [1, 2, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::list_shortened, "list"), 2, 4), "list:\n  - {name: x}\nz: *anchor\n");
  EXPECT_EQ(lines(only(Kind::list_lengthened, "list"), 6, 7), "  - name: y\n    k: &anchor word\n");
  EXPECT_EQ(lines(only(Kind::list_emptied, "list"), 2, 3), "list: []\nz: *anchor\n");
}

TEST(Damages, UnitsAndValuesAreOthers) {
  EXPECT_EQ(lines(only(Kind::unit_dropped, "a.b"), 1, 1), "a: {b: 1, c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::unit_doubled, "a.b"), 1, 1), "a: {b: 1 m m, c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::value_negative, "a.b"), 1, 1), "a: {b: -1 m, c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::number_behind, "a.c.1"), 1, 1), "a: {b: 1 m, c: [1, 2 50]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::value_empty, "a.b"), 1, 1), "a: {b: , c: [1, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::value_empty, "a.c.0"), 1, 1), "a: {b: 1 m, c: [~, 2]} # d: 5\n");
  EXPECT_EQ(lines(only(Kind::value_as_number, "list"), 2, 3), "list: 7\nz: *anchor\n");
}

TEST(Damages, NamesAreCalledElsewhere) {
  EXPECT_THAT(only(Kind::name_unknown, "list.0.name").references, testing::ElementsAre(8));
}

TEST(Verdicts, RefusalsPointAtTheLineAndNameTheKeyOnce) {
  const Damage damage = only(Kind::unit_dropped, "a.b");
  const Names names;
  EXPECT_EQ(wrong_refusal(damage, "damaged.yaml:1:8: `b`: `1` has no unit\n", names), "");
  EXPECT_EQ(wrong_refusal(damage, "damaged.yaml:3:8: `b`: `1` has no unit\n", names), "the message points elsewhere");
  EXPECT_EQ(wrong_refusal(damage, "damaged.yaml:1:8: something is wrong\n", names),
            "the message names neither key nor value");
  EXPECT_EQ(wrong_refusal(damage, "damaged.yaml:1:8: `b` 1\ndamaged.yaml:1:8: `b` 2\n", names),
            "two messages at one place");
  EXPECT_EQ(wrong_refusal(damage, "`b`: `1` has no unit\n", names), "a message without a place");
  EXPECT_EQ(wrong_refusal(damage, "damaged.yaml:1:8: warning: `b` is unusual\n", names), "no message");
}

TEST(Verdicts, AcceptedDamagesChangeWhatTheySayAndNothingElse) {
  const Damage damage = only(Kind::value_negative, "a.b");
  Settings before, after;
  before.values = {{"a.b", "1 m"}, {"other", "5"}};
  after.values = {{"a.b", "-1 m"}, {"other", "5"}};
  EXPECT_EQ(wrong_acceptance(damage, before, after, false), "");
  after.values["a.b"] = "1 m";
  EXPECT_EQ(wrong_acceptance(damage, before, after, false), "accepted, and nothing changed");
  after.values["a.b"] = "2 m";
  EXPECT_EQ(wrong_acceptance(damage, before, after, false), "1 m became 2 m in a.b");
  after.values = {{"a.b", "-1 m"}, {"other", "6"}};
  EXPECT_EQ(wrong_acceptance(damage, before, after, false), "something else changed: other");
  EXPECT_EQ(wrong_acceptance(only(Kind::unit_dropped, "a.b"), before, before, false), "accepted");
}

TEST(Verdicts, ADroppedKeyIsItsDefaultOrGone) {
  const Damage damage = only(Kind::key_dropped, "a.b");
  Settings dropped, written;
  dropped.values = {{"other", "5"}};
  EXPECT_EQ(wrong_default(damage, dropped, nullptr, false), "");
  written.values = {{"a.b", "2 m"}, {"other", "5"}};
  EXPECT_NE(wrong_default(damage, dropped, &written, false), "");
  dropped.values["a.b"] = "2 m";
  EXPECT_EQ(wrong_default(damage, dropped, &written, false), "");
  EXPECT_NE(wrong_default(damage, dropped, nullptr, false), "");
}

} // namespace
} // namespace pneuma::tests::damage
