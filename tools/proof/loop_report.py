#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reports whether the tests enter every loop of core and hal, and how close they come to its record.

usage: tools/proof/loop_report.py [--all] REPORT

REPORT is the file named by HARDPACK_LOOP_REPORT, to which programs of the counting build append
(test/loop_count/loop_counter.cpp). The tests say nothing about a record that they never reach. Loops
of consteval functions are not part of the program.

  --all  print each loop: its place, the largest count, its bound

Prints the records that were never entered, their number, and the number of loops that iterated as
often as their record says. Exit code: 0 every one was entered, 1 one was not, 2 bad usage.
"""

import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORD = re.compile(r"\s*HP_LOOP_BOUND\w*\(")
FUNCTION = re.compile(r"(?! *(?:for|if|while|switch) ) {0,2}(?:inline |\[\[.*?\]\] )*"
                      r"(consteval)?.*\) (?:const )?\{")
# Records that no test can reach, by file and by the line after them.
NOT_ENTERED = {
    # Once in 2^30 columns, which halves them: a range of fixed length.
    ("core/safety/reaction_meter.cpp", "for (uint32_t& bin : time_) {"),
    ("core/safety/reaction_meter.cpp", "for (uint32_t& bin : radius_) {"),
    # Called only in constant evaluation, by functions that are not consteval.
    ("hal/onboard/control/status_report.cpp",
     "for (int i = 0; text[i] != '\\0'; ++i) Add(static_cast<uint8_t>(text[i]));"),
}
LINE = re.compile(r"(?P<file>\S+):(?P<line>\d+) (?P<bound>\d+) (?P<count>\d+)")


def declared():
    """{(file, line)} of the records in the sources."""
    places = set()
    for layer in ("core", "hal"):
        for path in sorted((ROOT / layer).rglob("*")):
            if path.suffix not in (".cpp", ".h") or path.name == "loop_bound.h":
                continue
            lines = path.read_text("utf-8").splitlines()
            name = str(path.relative_to(ROOT))
            is_consteval = False
            for number, line in enumerate(lines, 1):
                function = FUNCTION.fullmatch(line)
                if function:
                    is_consteval = function.group(1) is not None
                if (RECORD.match(line) and not is_consteval and
                        (name, lines[number].strip()) not in NOT_ENTERED):
                    places.add((name, number))
    return places


def entered(report):
    """{(file, line): (largest count, its bound)}. A bound may depend on the lidar's beams: the count
    that comes nearest to its own is told."""
    most = {}
    for text in report.read_text("utf-8").splitlines():
        match = LINE.fullmatch(text)
        path = re.search(r"(?:^|/)((?:core|hal)/\S+)", match["file"]) if match else None
        if path is None:
            continue
        place = (path.group(1), int(match["line"]))
        count, bound = int(match["count"]), int(match["bound"])
        if place not in most or count * most[place][1] > most[place][0] * bound:
            most[place] = (count, bound)
    return most


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("report", type=pathlib.Path)
    options = parser.parse_args(arguments)
    if not options.report.is_file():
        print(f"loop_report: there is no {options.report}", file=sys.stderr)
        return 2
    places = declared()
    most = {place: found for place, found in entered(options.report).items() if place in places}
    if options.all:
        for (file, line), (count, bound) in sorted(most.items()):
            print(f"{file}:{line} {count} of {bound}")
    for file, line in sorted(places - most.keys()):
        print(f"never entered: {file}:{line}")
    reached = sum(1 for count, bound in most.values() if count >= bound)
    print(f"loops: {len(places)} have records, {len(most)} were entered, {reached} of them gone round as "
          "often as they may")
    return 0 if places and len(most) == len(places) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
