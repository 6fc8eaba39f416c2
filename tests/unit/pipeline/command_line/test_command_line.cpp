// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/command_line/command_line.h"

#include <sstream>

#include <gmock/gmock.h>

#include "geometry/base/errors.h"
#include "tests/unit/message_of.h"

namespace pneuma::pipeline::command_line {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// A program with an option of every kind, and what was set, in its order: "--range -5 5".
class CommandLine : public testing::Test {
protected:
  std::function<void(const Words&)> note(const std::string& name) {
    return [this, name](const Words& values) {
      std::string text = name;
      for (const std::string& value : values) text += " " + value;
      set.push_back(text);
    };
  }

  Command program() {
    return {
        "draw",
        "draws a state",
        {{"STATE", "", "the state", note("STATE"), Times::once},
         {"NAME", "", "what is drawn [all]", note("NAME"), Times::any},
         {"--field", "NAME", "its colours", note("--field"), Times::once},
         {"--range", "A B", "ends of the colours [smallest and largest value]", note("--range")},
         {"--title", "TEXT", "above the picture [none]", note("--title")},
         {"--data", "FILE", "tests", note("--data"), Times::any},
         {"--steps", "N", "of loading [1]",
          [this](const Words& values) { note("--steps")({std::to_string(whole_number("--steps", values[0], 1, 9))}); }},
         {"--flat", "", "without light", note("--flat")}},
        {},
        [this] {
          if (set.size() > 5) throw base::InputError("too much at once");
        }};
  }

  Words set_by(const Words& words) {
    set.clear();
    EXPECT_EQ(read(program(), words), "");
    return set;
  }

  // The first line of the error; the second says how to get help.
  std::string error(const Words& words) {
    const std::string text = tests::message_of<base::InputError>([&] { read(program(), words); });
    EXPECT_THAT(text, EndsWith("\n`draw --help` shows all options"));
    return text.substr(0, text.find('\n'));
  }

  std::string printed(const Command& command, const Words& words) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(read(command, words), std::nullopt);
    return testing::internal::GetCapturedStdout();
  }

  Words set;
};

TEST_F(CommandLine, SetsInTheOrderOfTheDeclaration) {
  EXPECT_THAT(set_by({"--flat", "--data", "b", "a.hdf", "--data", "a", "--field", "sag"}),
              ElementsAre("STATE a.hdf", "--field sag", "--data b", "--data a", "--flat"));
  EXPECT_THAT(set_by({"--field=sag", "a.hdf", "upper", "lower"}),
              ElementsAre("STATE a.hdf", "NAME upper", "NAME lower", "--field sag"));
}

TEST_F(CommandLine, ValuesMayBeginWithAMinusOrBeEmpty) {
  for (const std::string value : {"-.5", "-30 deg", "-5", "-", "--", "-e", "--draft", "", "a=b", "[a,b]", "STATE"}) {
    EXPECT_THAT(set_by({"a", "--field", "sag", "--title", value}), testing::Contains("--title " + value));
    EXPECT_THAT(set_by({"a", "--field", "sag", "--title=" + value}), testing::Contains("--title " + value));
  }
  EXPECT_THAT(set_by({"--range", "-5", "-.5", "--field", "sag", "a"}), testing::Contains("--range -5 -.5"));
  EXPECT_THAT(set_by({"--range=-5", "5", "--field", "sag", "a"}), testing::Contains("--range -5 5"));
  EXPECT_THAT(set_by({"a", "--field", "sag", "--title=--flat"}), testing::Contains("--title --flat"));
}

TEST_F(CommandLine, WordsBehindTwoMinusAreByPlace) {
  EXPECT_THAT(set_by({"--field", "sag", "--", "-a", "--help", "--"}),
              ElementsAre("STATE -a", "NAME --help", "NAME --", "--field sag"));
}

TEST_F(CommandLine, ErrorsNameWhatIsWrongAndWhatIsNear) {
  EXPECT_EQ(error({"a", "--feild", "sag"}), "unknown option `--feild`; did you mean `--field`?");
  EXPECT_EQ(error({"a", "--feild=sag"}), "unknown option `--feild`; did you mean `--field`?");
  EXPECT_EQ(error({"a", "--quite-other"}), "unknown option `--quite-other`");
  EXPECT_THAT(error({"a", "-s", "1"}), StartsWith("unknown option `-s`"));
  EXPECT_EQ(error({"a", "--fie", "sag"}), "unknown option `--fie`"); // no abbreviations
  EXPECT_EQ(error({"--field", "sag"}), "STATE is missing");
  EXPECT_EQ(error({"a"}), "--field is missing");
  EXPECT_EQ(error({"a", "--field", ""}), "--field is missing");
  EXPECT_EQ(error({"a", "--field"}), "--field needs a value: NAME");
  EXPECT_EQ(error({"a", "--field", "--flat"}), "--field needs a value: NAME");
  EXPECT_EQ(error({"a", "--field", "sag", "--range", "1"}), "--range needs 2 values: A B");
  EXPECT_EQ(error({"a", "--field", "sag", "--field", "sag"}), "--field is given twice");
  EXPECT_EQ(error({"a", "--flat", "--flat"}), "--flat is given twice");
  EXPECT_EQ(error({"a", "--flat=yes"}), "--flat takes no value");
  EXPECT_EQ(error({"a", "b", "c", "--field", "sag", "--flat", "--range", "1", "2"}), "too much at once");
  Command one = program();
  one.options[1].times = Times::at_most_once;
  EXPECT_THAT(tests::message_of<base::InputError>([&] {
                read(one, {"a", "b", "c"});
              }),
              StartsWith("unexpected argument `c`\n"));
}

TEST_F(CommandLine, NothingIsSetBeforeTheWholeLineIsRead) {
  error({"a", "--field", "sag", "--flat", "--flat"});
  error({"a", "--title", "x"});
  EXPECT_THAT(set, testing::IsEmpty());
}

TEST_F(CommandLine, WholeNumbersAreWithinTheirLimits) {
  EXPECT_THAT(set_by({"a", "--field", "sag", "--steps", "9"}), testing::Contains("--steps 9"));
  for (const std::string wrong : {"0", "10", "1.5", "x", "", "1 ", "99999999999", "-1"}) {
    EXPECT_EQ(error({"a", "--field", "sag", "--steps", wrong}),
              "--steps: `" + wrong + "` is not a whole number from 1 to 9");
  }
  EXPECT_EQ(tests::message_of<base::InputError>([] { whole_number("--threads", "0", 1); }),
            "--threads: `0` is not a whole number from 1");
}

TEST_F(CommandLine, NoErrorHidesHelpAndVersion) {
  const std::string help = printed(program(), {"--help"});
  EXPECT_EQ(printed(program(), {"--steps", "x", "--nonsense", "--title", "--help"}), help);
  EXPECT_EQ(printed(program(), {"a", "b", "-h"}), help);
  EXPECT_EQ(printed(program(), {"--nonsense", "--version"}), std::string("draw ") + version() + "\n");
  EXPECT_THAT(set, testing::IsEmpty());
}

TEST_F(CommandLine, HelpHasEveryOptionInLinesOfAHundredColumns) {
  Command command = program();
  command.options.back().text = std::string(30, 'a') + " " + std::string(30, 'b') + " " + std::string(40, 'c');
  command.footer = "See the README.";
  const std::string help = printed(command, {"--help"});
  EXPECT_THAT(help, StartsWith("draw: draws a state\nusage: draw STATE [NAME ...] --field NAME [options]\n\n"));
  EXPECT_THAT(help, HasSubstr("\n  --title TEXT  above the picture [none]\n"));
  EXPECT_THAT(help, HasSubstr("\n  --flat        aaaaaa"));
  EXPECT_THAT(help, HasSubstr("\n                cccccc"));
  EXPECT_THAT(help, EndsWith("\n  --version     the version\n\nSee the README.\n"));
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST_F(CommandLine, FirstWordOfAProgramWithCommandsIsOne) {
  const Command several = {
      "pneuma", "runs stages", {}, {{"run", "runs", program().options, {}}, {"keys", "all keys", {}, {}}}};
  EXPECT_EQ(read(several, {"run", "w", "--field", "keys"}), "run");
  EXPECT_THAT(set, ElementsAre("STATE w", "--field keys"));
  EXPECT_EQ(read(several, {"keys"}), "keys");
  EXPECT_THAT(printed(several, {"--help"}), HasSubstr("\n  run STATE [NAME ...] --field NAME  runs\n"));
  EXPECT_THAT(printed(several, {"run", "--help"}), StartsWith("pneuma run: runs\nusage: pneuma run STATE"));
  EXPECT_EQ(printed(several, {"run", "--version"}), printed(several, {"--version"}));
  const auto message = [&](const Words& words) {
    return tests::message_of<base::InputError>([&] { read(several, words); });
  };
  EXPECT_EQ(message({}), "no command is given; commands: run, keys\n`pneuma --help` shows all commands");
  EXPECT_EQ(message({"kyes"}), "there is no command `kyes`; did you mean `keys`?; commands: run, keys\n"
                               "`pneuma --help` shows all commands");
  EXPECT_THAT(message({"--flat", "run"}), StartsWith("unknown option `--flat`\n`pneuma --help`"));
  EXPECT_EQ(message({"keys", "x"}), "unexpected argument `x`\n`pneuma keys --help` shows all options");
}

} // namespace
} // namespace pneuma::pipeline::command_line
