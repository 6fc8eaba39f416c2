#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schema_agrees.py SCHEMA.json CORPUS.jsonl: what `pneuma check` accepts, the JSON schema accepts; what the schema
refuses, `check` refuses; on keys, types, counts and missing units both say the same. Reads files as the YAML of an
editor (YAML 1.2: `on` is a word, `true` is none; 1e400 is a number), a key that stands twice is refused. Exit code 1
where they differ."""
import collections
import json
import re
import sys

import jsonschema
import yaml

ALIKE = {  # kinds of damage whose verdict needs no more than keys, types, counts and units
    "key dropped", "key misspelt", "key doubled", "unit dropped", "list shortened", "list lengthened", "list emptied",
    "value as list", "value as map", "value as word", "value as number", "value empty",
}
# What `check` says of names that are called elsewhere, of files, of numbers and places beside others, and of laws ("w.yaml:4:9:
# material `etfe`: ..."): no schema can.
BEYOND = re.compile(
    r"there is no \w+ `|: material `|says nothing about|a second \w+ `|must rise|cannot be read|no neighbours|"
    r"lies the chamber|cushion has no |which gravity needs|from a formfind stage|lacks the key `chamber`; chambers|"
    r"anchor|changes nothing|has no effect|the region of load|of the patch|lies (beside|on) the|are the most|"
    r"from rim to rim|GB of memory|thousandth of the plan")


class Loader(yaml.SafeLoader):
    """The core schema of YAML 1.2."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        if len(set(map(str, keys))) != len(keys):
            raise yaml.YAMLError("a key stands twice")
        return super().construct_mapping(node, deep)


Loader.yaml_implicit_resolvers = {}
for tag, pattern, first in (
        ("null", r"^(~|null|Null|NULL|)$", ["~", "n", "N", ""]),
        ("bool", r"^(true|True|TRUE|false|False|FALSE)$", list("tTfF")),
        ("int", r"^([-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)$", list("-+0123456789")),
        ("float", r"^([-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))$",
         list("-+.0123456789"))):
    Loader.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile(pattern), first)
Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value, 0 if "x" in node.value or
                                                                         "o" in node.value else 10))


def real(_, node):
    text = node.value.lower().replace(".inf", "inf").replace(".nan", "nan")
    return float(text)


Loader.add_constructor("tag:yaml.org,2002:float", real)


def document(case):
    """The damaged workflow; of a file of materials the workflow that has them in place."""
    read = yaml.load(case["text"], Loader)
    if not case["is_materials"]:
        return read
    whole = yaml.load(case["user"], Loader)
    whole["materials"] = read
    return whole


def as_keys(value):
    """JSON has words for keys only."""
    if isinstance(value, dict):
        return {str(key): as_keys(inner) for key, inner in value.items()}
    return [as_keys(inner) for inner in value] if isinstance(value, list) else value


def main():
    with open(sys.argv[1]) as file:
        schema = json.load(file)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    counts = collections.Counter()
    wrong = collections.defaultdict(list)
    for line in open(sys.argv[2]):
        case = json.loads(line)
        if case["code"] not in (0, 2):  # a crash is no verdict
            counts["without verdict"] += 1
            continue
        try:
            accepted = validator.is_valid(as_keys(document(case)))
        except yaml.YAMLError:
            accepted = False
        checked = case["code"] == 0
        counts[f"check {'accepts' if checked else 'refuses'}, schema {'accepts' if accepted else 'refuses'}"] += 1
        if accepted == checked:
            continue
        if checked:
            wrong[f"{case['kind']}: the schema refuses what check accepts"].append(case)
        elif case["kind"] in ALIKE and not all(
                BEYOND.search(message) for message in case["messages"].splitlines()):
            wrong[f"{case['kind']}: the schema accepts what check refuses"].append(case)
    for name, count in sorted(counts.items()):
        print(f"{count:6} {name}")
    for name, cases in sorted(wrong.items()):
        print(f"{len(cases):6} wrong: {name}")
        seen = set()
        for case in cases:
            key = (re.sub(r"[0-9]+", "N", case["path"]).split(".")[-1], case["messages"].split(": ")[-1][:40])
            if key in seen or len(seen) > 6:
                continue
            seen.add(key)
            errors = case["messages"].splitlines()
            print(f"         {case['file']} {case['path']}: {case['line'].strip()[:140]}\n"
                  f"           {errors[0][:200] if errors else ''}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
