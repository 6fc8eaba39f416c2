# SPDX-License-Identifier: GPL-3.0-or-later
"""test_readmes.py SOURCES PROGRAMS: runs the commands of all READMEs in a copy of the projects with coarse meshes."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from commands import Command, commands_of, missing_lines, missing_rows

TOP, PROGRAMS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])

# What is not run, and why. Tests have their names looked up instead.
TESTS = r"(\w+=\S+ )*(\./tests/run|\.build/release/bin/test_\w+)\b"
EXCEPTIONS = {
    TESTS: "tests, which run by themselves",
    r"cmake --preset": "set-up",
    r"sed -i .*divisions": "the finer mesh takes long; `SMALLER` notices when there is no such text",
}
# Tests that take under a second: what they print is compared with the table behind the command.
QUICK_TESTS = {"SmallSlope": "test_small_slope", "CircularDisc": "test_circular_disc", "Balloon": "test_balloon"}
# Coarser meshes: in every workflow file of the project, these texts for those.
SMALLER = {
    "burst_test": [(r"divisions: \[(8, 8|16, 16)\]", "divisions: [2, 2]")],
    "circular_membrane": [(r"divisions: \[8, 8\]", "divisions: [2, 2]")],
    "double_chamber": [(r"divisions: \[28, 14\]", "divisions: [8, 4]")],
    "single_chamber": [(r"divisions: \[28, 14\]", "divisions: [12, 6]")],
    "triangular": [(r"divisions: 21\b", "divisions: 9")],
}
# What stands for a file of the reader's.
PLACEHOLDERS = {
    "W.yaml": "projects/single_chamber/workflow.yaml",
    "STATE.hdf": "projects/single_chamber/out/workflow/inflated/state.hdf",
}


def readmes():
    paths = [TOP / "README.md"]
    for folder in sorted(path.parent for path in TOP.glob("*/README.md")):
        paths += sorted(folder.rglob("README.md"))
    return {str(path.relative_to(TOP)): path.read_text() for path in paths}


def all_commands():
    return [command for readme, text in readmes().items() for command in commands_of(readme, text)]


def in_tests(files, pattern):
    """What a pattern finds in files of tests/."""
    return [match for file in (TOP / "tests").rglob(files) for match in re.findall(pattern, file.read_text(), re.M)]


def is_excepted(command):
    return any(re.match(pattern, command.text) for pattern in EXCEPTIONS)


class Copy:
    """A folder with the projects on coarse meshes, the configurations, and the runner where READMEs call it."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        for part in ("projects", "configs"):
            shutil.copytree(TOP / part, self.folder / part, ignore=shutil.ignore_patterns("out"))
        for project, edits in SMALLER.items():
            for file in (self.folder / "projects" / project).glob("*.yaml"):
                text = file.read_text()
                for before, after in edits:
                    text, count = re.subn(before, after, text)
                    assert count == 1, f"{file.name} of {project}: {before} stands there {count} times"
                file.write_text(text)
        (self.folder / "pipeline").mkdir()
        (self.folder / "pipeline/run").symlink_to(PROGRAMS / "pneuma")

    def run(self, text):
        """Exit code and output, both streams."""
        for name, file in PLACEHOLDERS.items():
            text = re.sub(rf"(?<=\s){re.escape(name)}(?!\S)", file, text)
        environment = dict(os.environ, PATH=f"{PROGRAMS}:{os.environ['PATH']}")
        ended = subprocess.run(["bash", "-c", text], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        return ended.returncode, ended.stdout


def faults(command, code, printed):
    """What is wrong with the end of a command."""
    found = []
    if code != command.exit_code:
        found.append(f"exit code {code}, not {command.exit_code}:\n{printed[-800:]}")
    if "is not available yet" in printed:
        found.append("is not available yet")
    found += [f"does not print the line {line}" for line in missing_lines(command.output, printed)]
    found += [f"does not print the figures of {row}" for row in missing_rows(command.row, printed)]
    return [f"{command.readme}:{command.line}: {command.text}\n  {fault}" for fault in found]


class Readmes(unittest.TestCase):
    def test_every_command_does_what_is_said(self):
        found = []
        with tempfile.TemporaryDirectory(prefix="pneuma-readmes-") as folder:
            copy = Copy(folder)
            for command in all_commands():
                if is_excepted(command):
                    continue
                start = time.monotonic()
                found += faults(command, *copy.run(command.text))
                print(f"{time.monotonic() - start:5.1f} s  {command.readme}:{command.line}: {command.text}", flush=True)
        if found:
            self.fail("\n".join([""] + found))

    def test_quick_tests_print_the_tables_behind_them(self):
        found, used = [], set()
        for command in all_commands():
            name = re.search(r"-R (\w+) -V$", command.text)
            if not command.table or not name or name.group(1) not in QUICK_TESTS:
                continue
            used.add(name.group(1))
            printed = subprocess.run([PROGRAMS / QUICK_TESTS[name.group(1)], f"--gtest_filter=*{name.group(1)}*"],
                                     stdout=subprocess.PIPE, text=True, check=True).stdout
            found += [f"{command.readme}:{command.line}: {command.text}\n  does not print the figures of {row}"
                      for row in missing_rows(command.table, printed)]
        self.assertEqual(used, set(QUICK_TESTS))
        if found:
            self.fail("\n".join([""] + found))

    def test_every_exception_stands_in_a_readme(self):
        commands = all_commands()
        for pattern in EXCEPTIONS:
            self.assertTrue(any(re.match(pattern, command.text) for command in commands), pattern)
        for name in PLACEHOLDERS:
            self.assertTrue(any(name in command.text.split() for command in commands), name)

    def test_every_test_that_a_readme_names_exists(self):
        tests = {".".join(names) for names in in_tests("*.cpp", r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+), (\w+)\)")}
        targets = in_tests("CMakeLists.txt", r"pneuma_test\((\w+) KIND (\w+) COST (\w+)")
        programs = {f"test_{name}" for name, _, _ in targets}
        labels = {f"{kind}-{cost}" for _, kind, cost in targets}
        for command in all_commands():
            if not re.match(TESTS, command.text):
                continue
            where = f"{command.readme}:{command.line}: {command.text}"
            for program in re.findall(r"bin/(\w+)", command.text):
                self.assertIn(program, programs, where)
            for option, quoted, plain in re.findall(r"(-R |-L |--gtest_filter=)(?:'([^']+)'|(\S+))", command.text):
                for name in (quoted or plain).rstrip("*").split("|"):
                    among = labels if option == "-L " else tests
                    self.assertTrue(any(re.search(name, one) for one in among), f"{where}\n  {name} is no test")


class TheTestItself(unittest.TestCase):
    """Sees false commands and figures."""

    TEXT = "\n".join([
        "Text with `pneuma check`, `pneuma material M.yaml [NAME ...]` and `./tests/run -R B1 -V`:", "",
        "| a | 1.25 |", "",
        "    ./pipeline/run a.yaml   # fails, exit code 5", "    false", "",
        "```output", "a  1.5 (7.03e-15)", "begins with 2.5 ...", "```", "",
        "```yaml", "a: 1", "```",
    ])

    def setUp(self):
        self.inline, self.block, self.last = commands_of("README.md", self.TEXT)

    def test_finds_commands_and_what_is_said_of_them(self):
        self.assertEqual([c.text for c in (self.inline, self.block, self.last)],
                         ["./tests/run -R B1 -V", "./pipeline/run a.yaml", "false"])
        self.assertEqual((self.block.exit_code, self.last.exit_code, self.last.line), (5, 0, 6))
        self.assertEqual(self.inline.table, "| a | 1.25 |")

    def test_sees_a_wrong_exit_code(self):
        self.assertEqual(len(faults(self.block, 0, "")), 1)
        self.assertEqual(faults(self.block, 5, ""), [])
        self.assertEqual(len(faults(self.block, 5, "this is not available yet")), 1)

    def test_sees_wrong_figures(self):
        right = "first\na  1.5 (2.1e-14)\nbetween\nbegins with 2.5 and more"
        self.assertEqual(faults(self.last, 0, right), [])
        for before, after in (("1.5", "1.6"), ("2.1e-14", "2.1e-4"), ("begins with 2.5", "begins with 2.6")):
            self.assertEqual(len(faults(self.last, 0, right.replace(before, after))), 1, after)
        self.assertEqual(missing_rows(self.inline.table, "1\n1.2468 and 3.5"), [])
        self.assertEqual(missing_rows(self.inline.table, "1.2368 and 1.2551"), ["| a | 1.25 |"])
        self.assertEqual(missing_rows("| -2.70 |", "2.7"), ["| -2.70 |"])
        self.assertEqual(missing_rows("| 1.5 | 2.5 |", "1.5\n2.5"), ["| 1.5 | 2.5 |"])
        self.assertEqual(len(faults(Command("README.md", 1, "x", row="| 0.08 % |"), 0, "0.072 %")), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
