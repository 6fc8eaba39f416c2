# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that a README shows, and the figures beside them."""
import dataclasses
import re

INLINE = re.compile(r"(\w+=\S+ )*(\./\w|\.build/|cmake --|sed |pneuma .*\.(yaml|hdf|csv|json)\b)")
FORM_OF_USE = re.compile(r"[<\[]|\.\.\.")  # `pneuma material M.yaml [NAME ...]`
DECIMAL = re.compile(r"(?<![\w.^])-?\d+\.\d+(?:e-?\d+)?(?![\w^]|\.\d)")
NOISE = 1e-12  # of rounding: another processor has other digits


@dataclasses.dataclass
class Command:
    readme: str
    line: int  # from 1
    text: str  # without the comment behind it
    exit_code: int = 0
    output: list = dataclasses.field(default_factory=list)  # lines of the block `output` that follows
    row: str = ""  # of the table in which it stands
    table: str = ""  # that follows


def commands_of(readme, text):
    """All commands of a README: lines of indented blocks and of fences without language or of `sh`, and what stands
    between backticks and begins as a command does."""
    lines = text.split("\n")
    commands, fence = [], None
    for at, line in enumerate(lines):
        if line.startswith("```"):
            fence = line[3:].strip() if fence is None else None
        elif fence == "output":
            commands[-1].output.append(line)
        elif fence in ("", "sh") or (fence is None and line.startswith("    ")):
            if line.strip():
                commands.append(command(readme, at, line.strip()))
        elif fence is None:
            for span in re.findall(r"`([^`]+)`", line):
                if INLINE.match(span) and not FORM_OF_USE.search(span):
                    commands.append(command(readme, at, span))
                    if line.startswith("|"):
                        commands[-1].row = line
                    else:
                        commands[-1].table = table_after(lines, at + 1)
    return commands


def command(readme, at, text):
    text, _, comment = re.match(r"(.*?)(\s+#\s+(.*))?$", text).groups()
    code = re.search(r"exit code (\d+)", comment or "")
    return Command(readme, at + 1, text, int(code.group(1)) if code else 0)


def table_after(lines, at):
    rows = []
    for line in lines[at:]:
        if line.startswith("|"):
            rows.append(line)
        elif line or rows:
            break
    return "\n".join(rows)


def as_printed(shown, printed):
    """Whether a printed number, to the digits that are shown, is the one shown."""
    if abs(float(shown)) < NOISE:
        return abs(float(printed)) < NOISE
    digits = len(re.match(r"-?\d+\.(\d+)", shown).group(1)) - int(shown.partition("e")[2] or 0)
    return abs(float(shown) - float(printed)) <= 0.5001 * 10.0**-digits


def missing_rows(shown, printed):
    """The rows of a table whose decimal numbers do not all stand, rounded, in one line of an output."""
    lines = [DECIMAL.findall(line) for line in printed.split("\n")]

    def stands_in(row, numbers):
        return all(any(as_printed(figure, number) for number in numbers) for figure in DECIMAL.findall(row))

    return [row for row in shown.split("\n") if not any(stands_in(row, numbers) for numbers in lines)]


def missing_lines(shown, printed):
    """The lines that an output does not have in this order: letter for letter but for numbers that are rounding; a
    line that ends in `...` is the beginning of one."""
    rest, missing = iter(printed.split("\n")), []
    for line in filter(None, shown):
        if not any(same_line(line, candidate) for candidate in rest):
            missing.append(line)
            rest = iter(printed.split("\n"))
    return missing


def same_line(shown, printed):
    if shown.endswith("..."):
        shown = shown[:-3]
        printed = printed[: len(shown)]
    if DECIMAL.split(shown) != DECIMAL.split(printed):
        return False
    pairs = zip(DECIMAL.findall(shown), DECIMAL.findall(printed))
    return all(a == b or max(abs(float(a)), abs(float(b))) < NOISE for a, b in pairs)
