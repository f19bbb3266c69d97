#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts each stage's instructions with callgrind and compares them with test/instructions/counts.txt.

usage: tools/proof/check_instructions.py [DRIVER] [--update] [--counts FILE]

DRIVER is test/instructions/instruction_counts of a release build by g++; the default is that of
build/release, built by `cmake --build --preset release --target instruction_counts`. A count more than
3 % above the one in the file is a slow-down; one more than 10 % below it makes the file useless as a
reference, so it must be renewed: --update writes the new counts.

Exit code: 0 all as in the file (or written), 1 a count is off, or runs and file differ, 2 bad usage,
77 not comparable: no valgrind, or the file is for another compiler or processor.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SLOWER = 0.03
FASTER = 0.10
SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[2]
COUNTS = ROOT / "test" / "instructions" / "counts.txt"
DRIVER = ROOT / "build" / "release" / "test" / "instructions" / "instruction_counts"
RENEW = "renew the file with tools/proof/check_instructions.py --update"


def run_driver(driver):
    """What the driver printed, and the instructions of each of its counted runs, in their order."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        # Bound at the start, symbols are not looked up while a stage is counted.
        result = subprocess.run(
            ["valgrind", "--tool=callgrind", "--toggle-collect=CountedRun",
             "--dump-after=CountedRun", f"--callgrind-out-file={out}", driver],
            env={**os.environ, "LD_BIND_NOW": "1"}, capture_output=True, text=True)
        if result.returncode != 0:
            sys.exit(f"check_instructions: {driver} failed: {result.stderr.strip()[-500:]}")
        parts = sorted(pathlib.Path(folder).glob("out.*"), key=lambda part: int(part.suffix[1:]))
        totals = [int(re.search(r"^totals: (\d+)", part.read_text(), re.M)[1]) for part in parts]
    return result.stdout.splitlines(), totals


def assemble(lines, totals):
    """The driver's first lines as they are; then "stage scene" and its count."""
    described, runs = lines[:2], lines[2:]
    if not runs or len(runs) != len(totals):
        sys.exit(f"check_instructions: {len(runs)} runs, but {len(totals)} counts")
    return described, {run: total for run, total in zip(runs, totals)}


def read_counts(path):
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    counts = (line.rsplit(" ", 1) for line in lines[2:])
    return lines[:2], {run: int(count) for run, count in counts}


def write_counts(path, described, counts):
    head = ["# SPDX-License-Identifier: Apache-2.0",
            "# Instructions of one run of each stage on a built-in scene, counted by callgrind.",
            "# tools/proof/check_instructions.py compares with it, and writes it (--update)."]
    path.write_text("\n".join(head + described +
                              [f"{run} {count}" for run, count in counts.items()]) + "\n")


def compare(expected, counted):
    """One line for each count that is off; empty when there is none."""
    faults = []
    for run in expected.keys() | counted.keys():
        if run not in counted:
            faults.append(f"{run}: in the file, but was not run; {RENEW}")
        elif run not in expected:
            faults.append(f"{run}: not in the file; {RENEW}")
        else:
            change = counted[run] / expected[run] - 1.0
            figures = f"{run}: {counted[run]} instructions, {change:+.1%} of {expected[run]}"
            if change > SLOWER:
                faults.append(f"{figures}: a slow-down")
            elif change < -FASTER:
                faults.append(f"{figures}: so much faster that a later slow-down would not be seen;"
                              f" {RENEW}")
    return sorted(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("driver", metavar="DRIVER", nargs="?", type=pathlib.Path, default=DRIVER)
    parser.add_argument("--update", action="store_true", help="write the file")
    parser.add_argument("--counts", type=pathlib.Path, default=COUNTS, metavar="FILE")
    options = parser.parse_args()
    if not options.driver.exists():
        parser.error(f"{options.driver} is not there: build instruction_counts")
    if shutil.which("valgrind") is None:
        print("skipped: valgrind is not installed (tools/check.sh --deps)")
        return SKIPPED
    described, counted = assemble(*run_driver(options.driver))
    if options.update:
        write_counts(options.counts, described, counted)
        print(f"{len(counted)} counts written to {options.counts}")
        return 0
    expected_of, expected = read_counts(options.counts)
    if described != expected_of:
        print(f"skipped: {options.counts} is of {', '.join(expected_of)}; this is "
              f"{', '.join(described)}")
        return SKIPPED
    faults = compare(expected, counted)
    for fault in faults:
        print(fault)
    if not faults:
        print(f"{len(counted)} counts are as in {options.counts}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
