// SPDX-License-Identifier: GPL-3.0-or-later
// Every program answers every line in the same way.
#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// A program or a command of the runner, and words by which its line would be whole.
struct Called {
  std::string words;   // "pneuma run"
  std::string needed;  // "w.yaml"
  std::string surplus; // further words by place; none: takes any number
  std::string option;  // that takes a value, and not twice; none: there is none
  std::string program() const { return words.substr(0, words.find(' ')); }
};

void PrintTo(const Called& called, std::ostream* out) {
  *out << called.words;
}

const std::string stage_line = "--check --config stage.yaml";

class CommandLines : public InFolder, public testing::WithParamInterface<Called> {
protected:
  Outcome call_with(const std::string& words) const {
    return call("cd " + folder.string() + " && " + (programs / GetParam().words).string() + " " + words);
  }
  void refuses(const std::string& words, const std::string& complaint) const {
    const Outcome outcome = call_with(words + " </dev/null");
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.text, StartsWith(complaint)) << words;
    EXPECT_THAT(outcome.text, EndsWith("\n`" + GetParam().words + " --help` shows all options\n"));
    EXPECT_EQ(call_with(words + " 2>/dev/null >said; cat said; rm said").text, "") << "errors go to standard error";
  }
  ~CommandLines() override { EXPECT_TRUE(fs::is_empty(folder)); }
};

TEST_P(CommandLines, HelpAndVersionGoToStandardOutputWhateverElseIsSaid) {
  const std::string& needed = GetParam().needed;
  for (const std::string words : {"", needed.c_str(), "--nonsense"}) {
    for (const char* option : {" --help", " -h"}) {
      const Outcome help = call_with(words + option + " 2>/dev/null");
      EXPECT_EQ(help.code, 0);
      EXPECT_THAT(help.text, StartsWith(GetParam().words + ": "));
      EXPECT_THAT(help.text, HasSubstr("\nusage: " + GetParam().words));
      EXPECT_THAT(help.text, HasSubstr("  --version"));
      EXPECT_THAT(help.text, HasSubstr("\n  " + (GetParam().option.empty() ? "-h," : GetParam().option) + " "));
      std::istringstream lines(help.text);
      for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
    }
    const Outcome version = call_with(words + " --version 2>/dev/null");
    EXPECT_EQ(version.code, 0);
    EXPECT_EQ(version.text, GetParam().program() + " " + PNEUMA_VERSION + "\n");
  }
}

TEST_P(CommandLines, WrongOnesAreNamed) {
  const auto& [words, needed, surplus, option] = GetParam();
  refuses(needed + " --nonsense", "unknown option `--nonsense`");
  refuses(needed + " -x", "unknown option `-x`");
  if (!surplus.empty()) refuses(needed + " " + surplus, "unexpected argument `" + surplus + "`");
  if (option.empty()) return;
  const std::string typo = option.substr(0, option.size() - 1);
  refuses(needed + " " + typo + " 1", "unknown option `" + typo + "`; did you mean `" + option + "`?");
  refuses(needed + " " + option, option + " needs a value");
  refuses(needed + " " + option + " 1 " + option + " 1", option + " is given twice");
}

const std::string picture = "a.hdf --field sag --out a.png";

INSTANTIATE_TEST_SUITE_P(All, CommandLines,
                         testing::Values(Called{"pneuma run", "w.yaml", "more", "--only"},
                                         Called{"pneuma check", "w.yaml", "more", ""},
                                         Called{"pneuma status", "w.yaml", "more", "--out"},
                                         Called{"pneuma keys", "", "more", ""}, Called{"pneuma schema", "", "more", ""},
                                         Called{"pneuma-mesh", stage_line, "more", "--threads"},
                                         Called{"pneuma-formfind", stage_line, "more", "--threads"},
                                         Called{"pneuma-pattern", stage_line, "more", "--threads"},
                                         Called{"pneuma-inflate", stage_line, "more", "--threads"},
                                         Called{"pneuma-wind", stage_line, "more", "--threads"},
                                         Called{"pneuma-picture", picture, "b.hdf", "--size"},
                                         Called{"pneuma-material", "m.yaml", "", "--steps"}));

TEST_F(InFolder, ProgramsNameWhatIsMissing) {
  const auto says = [&](const std::string& words, const std::string& complaint) {
    const Outcome outcome = call("cd " + folder.string() + " && " + (programs / words).string());
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.text, StartsWith(complaint));
  };
  says("pneuma", "no command is given");
  says("pneuma run", "WORKFLOW.yaml is missing");
  says("pneuma picture --field sag --out a.png", "STATE.hdf is missing");
  says("pneuma-picture a.hdf --out a.png", "--field is missing");
  says("pneuma-picture a.hdf --field sag", "--out is missing");
  says("pneuma-material", "MATERIALS.yaml is missing");
  says("pneuma-mesh", "--config is missing");
  says("pneuma-mesh --config stage.yaml", "--out is missing");
  says("pneuma-wind --config stage.yaml --out a.hdf", "--in is missing");
  says("pneuma-wind --config stage.yaml --check --threads 0", "--threads: `0` is not a whole number from 1");
  says("pneuma-picture a.hdf --field sag --out a.png --range 5 -.5", "--range: 5 is not below -.5");
  EXPECT_TRUE(fs::is_empty(folder));
}

} // namespace
} // namespace pneuma::tests
