// SPDX-License-Identifier: GPL-3.0-or-later
// Keys declared beside the members that they fill, on a small file of ladders.
#include "pipeline/schema/keys.h"

#include <gmock/gmock.h>

namespace pneuma::pipeline::schema {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Foot {
  double width = 0; // m

  static void declare(auto& keys) {
    keys("width", &Foot::width, quantity("m").positive().such_as("5 cm"), "of a foot");
  }
};

struct Rung {
  std::string name;
  double height = 0; // m
  std::optional<double> width;

  static void declare(auto& keys) {
    keys("name", &Rung::name, name_of_a("rung"), "of the rung");
    keys("height", &Rung::height, quantity("m").positive().usual(0.1, 10, "usually 10 cm to 10 m"), "above the ground");
    keys("width", &Rung::width, quantity("m").positive(), "of the rung");
  }
};

struct Ladder {
  std::vector<Rung> rungs;
  std::optional<std::string> first; // the rung to step on
  bool leans = false;
  std::optional<double> angle; // rad
  std::optional<Foot> feet;

  static void declare(auto& keys) {
    keys("rungs", &Ladder::rungs, list(group<Rung>()).items(2, 100), "from below");
    keys("first", &Ladder::first, reference_to("rung"), "to step on");
    keys("leans", &Ladder::leans, flag().otherwise("on"), "against a wall");
    keys("angle", &Ladder::angle, quantity("rad").otherwise("20 deg"), "from upright")
        .where([](const Ladder& ladder) { return ladder.leans; }, "is for a ladder that leans");
    keys("feet", &Ladder::feet, group<Foot>(), "what it stands on");
    keys.unavailable("wheels", "feet are available");
  }
  static void check(Reader& reader, const At<Ladder>& ladder) {
    for (std::size_t i = 1; i < ladder->rungs.size(); ++i) {
      const At<Rung> rung = items(ladder[&Ladder::rungs])[i];
      if (rung->height > ladder->rungs[i - 1].height) continue;
      reader.fail(rung[&Rung::height].path, name(&Rung::height) + " must rise from rung to rung");
    }
  }
};

struct Read {
  Ladder ladder;
  bool complete = false;
  std::vector<std::string> problems;
  std::string written; // of a complete one
};

Read read(const std::string& text) {
  Reader reader;
  const Form<Ladder> form = group<Ladder>();
  Read out;
  const Node& tree = reader.keep(parse_yaml(text, "l.yaml", reader.problems));
  out.complete = form.read(reader, tree, "", out.ladder);
  reader.check_references();
  for (const Problem& problem : reader.problems) out.problems.push_back(to_string(problem));
  if (out.complete) out.written = write_yaml(form.write(out.ladder));
  return out;
}

const std::string good = "rungs: [{name: low, height: 30 cm}, {name: high, height: 60 cm, width: 0.4 m}]\n";

TEST(Keys, FillTheirMembersWithValuesInSiAndDefaults) {
  const Read out = read(good + "first: high\n");
  EXPECT_THAT(out.problems, IsEmpty());
  ASSERT_TRUE(out.complete);
  EXPECT_EQ(out.ladder.rungs[1].height, 0.6);
  EXPECT_EQ(out.ladder.rungs[1].width, 0.4);
  EXPECT_FALSE(out.ladder.rungs[0].width);
  EXPECT_TRUE(out.ladder.leans);
  EXPECT_NEAR(out.ladder.angle.value(), 0.349, 1e-3);
  EXPECT_FALSE(out.ladder.feet);
}

TEST(Keys, AreWrittenSoThatTheyReadBackToTheSameText) {
  const Read out = read(good + "leans: off\nfeet: {width: 5 cm}\n");
  EXPECT_EQ(out.written, "rungs:\n  - {name: low, height: 0.3 m}\n  - {name: high, height: 0.6 m, width: 0.4 m}\n"
                         "leans: off\nfeet: {width: 0.05 m}\n"); // no angle: it means nothing here
  EXPECT_EQ(read(out.written).written, out.written);
}

TEST(Keys, ThatAreMissingUnknownOrNotAvailableAreTold) {
  EXPECT_THAT(read("{}").problems, ElementsAre(HasSubstr("the file lacks the key `rungs`: from below")));
  EXPECT_THAT(read(good + "wheels: 4\n").problems,
              ElementsAre("l.yaml:2:1: `wheels` is not available yet; feet are available"));
  EXPECT_THAT(read(good + "frist: high\n").problems,
              ElementsAre(HasSubstr("l.yaml:2:1: unknown key `frist` in the file; did you mean `first`?")));
}

TEST(Keys, ThatAreRequiredAndMisspeltAreToldOnce) {
  EXPECT_THAT(read("rugns: []\n").problems, ElementsAre(HasSubstr("did you mean `rungs`?")));
}

TEST(Keys, ThatMeanNothingWhereTheyStandAreRefusedThere) {
  EXPECT_THAT(read(good + "leans: off\nangle: 10 deg\n").problems,
              ElementsAre("l.yaml:3:1: `angle` is for a ladder that leans; leave it out"));
}

TEST(Keys, RulesSeeCompleteValuesOnlyAndNameTheirKeys) {
  const std::string falls = "rungs: [{name: low, height: 60 cm}, {name: high, height: 30 cm}]\n";
  EXPECT_THAT(read(falls).problems, ElementsAre("l.yaml:1:58: `height` must rise from rung to rung"));
  EXPECT_THAT(read("rungs: [{name: low, height: 60 cm}, {name: high, height: 0 cm}]\n").problems,
              ElementsAre("l.yaml:1:58: `height` must be positive, not 0 cm"));
}

TEST(Keys, NamesThatAreNotThereOrThereTwiceAreTold) {
  EXPECT_THAT(read(good + "first: hihg\n").problems,
              ElementsAre("l.yaml:2:8: there is no rung `hihg`; did you mean `high`?; rungs: low, high"));
  EXPECT_THAT(read("rungs: [{name: low, height: 30 cm}, {name: low, height: 60 cm}]\n").problems,
              ElementsAre("l.yaml:1:44: a second rung `low`: every rung needs a name of its own"));
  // whether a rung with an unreadable name is meant cannot be known
  EXPECT_THAT(read("rungs: [{name: low, height: 30 cm}, {height: 60 cm}]\nfirst: high\n").problems,
              ElementsAre(HasSubstr("entry 2 of `rungs` lacks the key `name`")));
}

TEST(Keys, ExamplesFitTheKeyAndUnusualValuesAreShownAsTaken) {
  EXPECT_THAT(read(good + "feet: {width: 5}\n").problems,
              ElementsAre("l.yaml:2:15: `width`: `5` has no unit; expected a length such as `5 cm`"));
  EXPECT_THAT(read("rungs: [{name: low, height: 3 mm}, {name: high, height: 30 cm}]\n").problems,
              ElementsAre("l.yaml:1:29: warning: `height` 3 mm is unusual (usually 10 cm to 10 m), taken as 0.003 m; "
                          "is it meant?"));
}

} // namespace
} // namespace pneuma::pipeline::schema
