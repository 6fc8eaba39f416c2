// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that is full at any moment of a run: it is said with what to do, what is there is whole, and with room the run
// goes on.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

class FullDisk : public InFolder {
protected:
  // Runs the workflow with its results on a disk of so many kB, then on the same with room; the disk goes with the
  // shell. What is said first, and after `first` and `second` the exit codes.
  Outcome run_on(int kilobytes) const {
    const std::string disk = (folder / "disk").string(),
                      run = (programs / "pneuma").string() + " run w.yaml --out disk/o";
    fs::create_directory(disk);
    return call(
        fmt::format("cd {} && unshare --mount sh -c 'mount -t tmpfs -o size={}k none disk || exit 9; {}; echo "
                    "first $?; for d in disk/o/*/state.hdf.sha256; do [ ! -f $d ] || (cd ${{d%/*}} && sha256sum "
                    "--status -c ${{d##*/}}) || echo damaged $d; done; find disk -name \"*.tmp*\" -o -name "
                    "\"*pending*\"; mount -o remount,size=64m disk; {} >/dev/null; echo second $?'",
                    folder.string(), kilobytes, run, run));
  }
};

TEST_F(FullDisk, LosesNothingAndIsSaid) {
  if (call("unshare --mount mount -t tmpfs none /mnt").code != 0) GTEST_SKIP() << "mounts are forbidden here";
  write(every_stage);
  int refused = 0;
  for (const int kilobytes : {8, 60, 160, 280, 400, 560}) {
    const Outcome outcome = run_on(kilobytes);
    SCOPED_TRACE(fmt::format("{} kB: {}", kilobytes, outcome.text));
    EXPECT_THAT(outcome.text, Not(HasSubstr("damaged")));
    EXPECT_THAT(outcome.text, Not(HasSubstr("please report")));
    EXPECT_THAT(outcome.text, HasSubstr("second 0"));
    if (outcome.text.find("first 0") != std::string::npos) continue;
    ++refused;
    EXPECT_THAT(outcome.text, HasSubstr("first 6"));
    EXPECT_THAT(outcome.text, HasSubstr("No space left on device; make room, or choose a folder on another disk"));
  }
  EXPECT_GE(refused, 3);
}

} // namespace
} // namespace pneuma::tests
