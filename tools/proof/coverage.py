#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures which lines of core and hal the tests run.

usage: tools/proof/coverage.py [--build DIR] [--least PERCENT] [--missing]

Builds with g++ --coverage under --build (default build/coverage), runs the tests of core and hal, and
prints the share of lines that ran, per folder and in total. A line counts once, however many templates
and inlined copies contain it.

  --least PERCENT  a smaller total is a failure (default 95)
  --missing        also print the lines that did not run

Exit code: 0 passed; 1 too few lines, or a test failed; 2 the build failed.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def build(folder):
    jobs = str(os.cpu_count() or 1)
    commands = [["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
                 "-DCMAKE_CXX_COMPILER=g++", "-DCMAKE_CXX_FLAGS_DEBUG=-O1 --coverage"],
                ["cmake", "--build", folder, "-j", jobs]]
    for command in commands:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                             check=False)
        if run.returncode != 0:
            print(run.stdout[-4000:], file=sys.stderr)
            return False
    return True


def run_tests(folder):
    for old in folder.rglob("*.gcda"):
        old.unlink()
    run = subprocess.run(["ctest", "--test-dir", folder, "-j", str(os.cpu_count() or 1), "-LE", "slow",
                          "-R", "^(core|hal|config)/", "--output-on-failure"],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if run.returncode != 0:
        print(run.stdout[-4000:], file=sys.stderr)
    return run.returncode == 0


def lines_run(folder):
    """{file: {line: whether it ran}}"""
    files = {}
    notes = sorted(str(p) for layer in ("core", "hal") for p in (folder / layer).rglob("*.gcno"))
    for first in range(0, len(notes), 20):
        told = subprocess.run(["gcov", "--json-format", "--stdout", *notes[first:first + 20]],
                              cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              text=True, check=True).stdout
        for text in told.splitlines():
            for one in json.loads(text)["files"]:
                path = pathlib.Path(folder, one["file"]).resolve()
                if not path.is_relative_to(ROOT):
                    continue
                name = str(path.relative_to(ROOT))
                if not name.startswith(("core/", "hal/")):
                    continue
                lines = files.setdefault(name, {})
                for line in one["lines"]:
                    number = line["line_number"]
                    lines[number] = lines.get(number, False) or line["count"] > 0
    return files


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "coverage")
    parser.add_argument("--least", type=float, default=95.0)
    parser.add_argument("--missing", action="store_true")
    options = parser.parse_args(arguments)
    folder = options.build.resolve()
    if not build(folder):
        return 2
    passed = run_tests(folder)
    files = lines_run(folder)
    folders = {}
    for name, lines in sorted(files.items()):
        counts = folders.setdefault(str(pathlib.Path(name).parent), [0, 0])
        counts[0] += sum(lines.values())
        counts[1] += len(lines)
        missing = sorted(number for number, ran in lines.items() if not ran)
        if options.missing and missing:
            print(f"{name}: {' '.join(map(str, missing))}")
    for name, (ran, count) in folders.items():
        print(f"{name:24} {ran:6} of {count:6} lines, {100 * ran / count:5.1f} %")
    ran, count = (sum(c[i] for c in folders.values()) for i in (0, 1))
    share = 100 * ran / count if count else 0.0
    print(f"{'core and hal':24} {ran:6} of {count:6} lines, {share:5.1f} %")
    return 0 if passed and share >= options.least else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
