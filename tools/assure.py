#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what hardpack promises, and writes assurance.md.

usage: tools/assure.sh [--fuzz-minutes N] [--mutants N] [--only NAME]... [--resume] [--out FILE]
                       [--list]

On a machine with nothing but Debian and this checkout: packages are installed, everything is built in
build/, and each command below is run, one after the other, its output kept in build/assure. The page
has a line for each promise: the figure that was measured, the budget that it is held to, the command;
and how long each command took.

  --fuzz-minutes N  of all targets together (default 30)
  --mutants N       faults planted (default 300)
  --only NAME       only these commands (--list prints their names); the page then has their lines
  --resume          what has succeeded on this very commit is not run again, but read from its output;
                    nothing is resumed where sources have changed since the commit
  --out FILE        the page (default assurance.md)

Exit code: 0 every promise is kept, 1 one is not (the page says which), 2 bad usage.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parent.parent
LOGS = ROOT / "build" / "assure"


@dataclass
class Promise:
    what: str
    figure: str  # a regular expression: its groups, or lines, in the command's output
    budget: str
    form: str = "{}"  # of the groups
    times: str = "last"  # of several matches: last, or count


@dataclass
class Measurement:
    name: str
    command: str
    promises: list = field(default_factory=list)


@dataclass
class Outcome:
    succeeded: bool
    output: str
    seconds: float


PASSED = r"(100% tests passed, 0 tests failed out of \d+)"
SKIPPED = re.compile(r"^\s*\d+ - .* \(Skipped\)$", re.MULTILINE)


def bounds(processor, column):
    """A promise for each bound of config/timing.toml, whose budgets of a processor are in a column."""
    with open(ROOT / "config" / "timing.toml", "rb") as file:
        entries = tomllib.load(file)["bounds"]
    said = []
    for entry in entries:
        counted = "measured" in entry
        columns = r"\s{2,}([\d,]+)\s+[\d,]+\s+" + (r"([\d,]+)\s+([\d.]+)" if counted else "-")
        said.append(Promise(f"{processor}, instructions of: {entry['name']}",
                            r"\b" + re.escape(entry["name"]) + columns, f"{entry[column]:,}",
                            "at most {}; counted {}: {} times" if counted else "at most {}"))
    return said


def measurements(options):
    return [
        Measurement("packages", "tools/check.sh --all --deps"),
        Measurement("release", "cmake --preset release && cmake --build --preset release && "
                    "ctest --preset release -LE slow", [
                        Promise("every test passes in g++'s optimised build; what the README quotes is "
                                "as it says", PASSED, "all"),
                    ]),
        Measurement("tidy", "tools/check_tidy.sh build/release && echo nothing", [
            Promise("clang-tidy (bugprone, cert, cppcoreguidelines) says", r"^(nothing)$", "nothing"),
        ]),
        Measurement("no_heap", "ctest --preset release -R 'rails.(symbols|links_alone|planted.uses_new|"
                    "planted.link_with_new)'", [
                        Promise("no heap: core and hal need four functions of memory and nothing else, "
                                "and link alone; planted uses of new are found", PASSED, "all"),
                    ]),
        Measurement("memory", "build/release/test/docs/memory_doc", [
            Promise("memory of everything on board, fixed at compile time",
                    r"\| `VehicleLoop` \| (\d+) \|", "8,650,752 bytes", "{} bytes"),
            Promise("of planning", r"takes (\d+ of its \d+ bytes)", "6 MiB"),
        ]),
        Measurement("same_bits", "tools/decision_hash.sh --all", [
            Promise("the same decisions by every compiler, option and processor",
                    r"^decision_hash: (all equal)$", "7 builds"),
        ]),
        Measurement("clang", "cmake --preset release-clang -DHARDPACK_COUNT_LOOPS=ONLY && "
                    "cmake --build --preset release-clang && "
                    "ctest --preset release-clang -LE slow", [
                        Promise("every test passes in clang++'s build, and in those of core and hal no "
                                "loop runs more often than its record says", PASSED, "all")]),
        Measurement("sanitizers", "cmake --preset asan && cmake --build --preset asan && "
                    "ctest --preset asan -LE slow", [
                        Promise("every test passes with address and undefined-behaviour sanitizers",
                                PASSED, "all")]),
        Measurement("aarch64", "cmake --preset aarch64 && cmake --build --preset aarch64 && "
                    "ctest --preset aarch64 -V", [
                        Promise("the aarch64 build: missions to the same bits, one of them on the bare "
                                "processor; hardpackd on an arm64 kernel with a vcan", PASSED, "all"),
                        *bounds("aarch64", "aarch64")]),
        Measurement("schedule", "tools/wcet/timing.py --schedule --measured "
                    "build/aarch64/test/bare_metal/mission.measured "
                    "build/aarch64/test/bare_metal/replay_tape", [
                        Promise(f"estimate, Cortex-A72 at 1.5 GHz: {name}", f"^{pattern}\\s{{2,}}(.*)$",
                                "none")
                        for name, pattern in (
                            ("tick period", "tick period"),
                            ("a tick without planning, by the bounds", "a tick without planning"),
                            ("the worst tick, by the bounds, as counted", "the worst tick"),
                            ("ticks for a whole plan, the same", "ticks for a whole plan"),
                            ("from a return's light to a frame, the same",
                             "from a return's light to a frame"),
                            ("reaction radius, the same", "reaction radius at 5 m/s"))]),
        Measurement("cortex_m7", "cmake --preset cortex-m7 && cmake --build --preset cortex-m7 && "
                    "ctest --preset cortex-m7 -V", [
                        Promise("the Cortex-M7 build: a mission from bytes to frames, the same hash in "
                                "every tick", r"(decision hash [0-9a-f]{16})", "the host's"),
                        *bounds("Cortex-M7", "cortex_m7"),
                        Promise("static bound of the stack of a tick",
                                r"(\d+)  hardpack::VehicleLoop::Tick", "16,384 bytes", "{} bytes"),
                        Promise("of it taken, painted, the program around it included",
                                r"the mission took (\d+ of at most \d+ bytes)", "the bound"),
                    ]),
        Measurement("slow", "ctest --preset release -L slow", [
            Promise("worlds (five seeds each) end as they should; each fault on a real vcan stops the "
                    "vehicle within its limit", PASSED, "all")]),
        Measurement("coverage", "tools/coverage.py", [
            Promise("lines of core and hal that the tests run", r"core and hal\s.*?([\d.]+) %$",
                    "95 %", "{} %")]),
        Measurement("fuzz", f"tools/fuzz.sh --minutes {options.fuzz_minutes}", [
            Promise("fuzzing finds nothing: targets", r"^(\S+)\s+fine ", "all", "{} fine", "count")]),
        Measurement("mutation", f"tools/mutate.py --mutants {options.mutants}", [
            Promise("planted faults that the tests notice", r"noticed (\d+ of \d+ \([\d.]+ %\))",
                    "90 %")]),
    ]


def revision():
    """Of the sources; ends with -dirty where they are not as they were committed."""
    return subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True,
                          text=True, check=False).stdout.strip()


def environment():
    """Every build shares what any of them has compiled. Asked for each command: the first installs
    packages."""
    if not shutil.which("ccache"):
        return dict(os.environ)
    return {"CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CCACHE_DIR": str(ROOT / "build" / "ccache"),
            "CCACHE_SLOPPINESS": "pch_defines,time_macros", **os.environ}


def run(measurement):
    begun = time.monotonic()
    log = LOGS / f"{measurement.name}.log"
    record_of(measurement).unlink(missing_ok=True)
    with open(log, "w", encoding="utf-8") as file:
        code = subprocess.run(["bash", "-c", "set -o pipefail; " + measurement.command], cwd=ROOT,
                              env=environment(), stdin=subprocess.DEVNULL, stdout=file,
                              stderr=subprocess.STDOUT, check=False).returncode
    outcome = Outcome(code == 0, log.read_text("utf-8", errors="replace"), time.monotonic() - begun)
    if outcome.succeeded:
        record_of(measurement).write_text(json.dumps(
            {"revision": revision(), "command": measurement.command, "seconds": outcome.seconds}), "utf-8")
    return outcome


def record_of(measurement):
    return LOGS / f"{measurement.name}.json"


def done_before(measurement):
    """What an earlier run of this command on these sources has left; None where there is none."""
    now = revision()
    try:
        record = json.loads(record_of(measurement).read_text("utf-8"))
        output = (LOGS / f"{measurement.name}.log").read_text("utf-8", errors="replace")
    except (OSError, ValueError):
        return None
    if now.endswith("-dirty") or (record["revision"], record["command"]) != (now, measurement.command):
        return None
    return Outcome(True, output, record["seconds"])


def figure_of(promise, output):
    found = re.findall(promise.figure, output, re.MULTILINE)
    if not found:
        return None
    if promise.times == "count":
        return promise.form.format(len(found))
    groups = found[-1] if isinstance(found[-1], tuple) else (found[-1],)
    figure = promise.form.format(*(re.sub(r"\s+", " ", group) for group in groups))
    skipped = len(SKIPPED.findall(output)) if promise.figure == PASSED else 0
    return f"{figure}; {skipped} of them skipped" if skipped else figure


def lines_of(measurement, outcome):
    """[(whether it is kept, its line of the page)] of each promise."""
    lines = []
    for promise in measurement.promises:
        figure = figure_of(promise, outcome.output)
        kept = outcome.succeeded and figure is not None
        command = measurement.command.replace("|", "\\|")
        lines.append((kept, f"| {promise.what} | {figure or '-'} | {promise.budget} | "
                      f"{'kept' if kept else '**NOT KEPT**'} | `{command}` |"))
    if not measurement.promises and not outcome.succeeded:
        lines.append((False, f"| {measurement.name} | - | | **NOT KEPT** | `{measurement.command}` |"))
    return lines


def write_page(path, lines, times):
    """times: [(name of a command, its seconds)]"""
    day = datetime.date.today().isoformat()
    kept = sum(1 for is_kept, _ in lines if is_kept)
    whole_s = sum(seconds for _, seconds in times)
    text = [f"# Assurance\n\nRevision {revision()}, {day}, {platform.machine()}, {os.cpu_count()} "
            f"processors. {kept} of {len(lines)} promises kept. Outputs are in `build/assure`. Written "
            "by `tools/assure.sh`.\n",
            "| promise | measured | budget | | command |", "|---|---|---|---|---|",
            *(line for _, line in lines),
            f"\n{whole_s / 60:.0f} minutes: " +
            ", ".join(f"{name} {seconds:.0f} s" for name, seconds in times) + "."]
    path.write_text("\n".join(text) + "\n", "utf-8")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--fuzz-minutes", type=float, default=30)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "assurance.md")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args(arguments)
    every = measurements(options)
    unknown = set(options.only) - {m.name for m in every}
    if unknown:
        print(f"assure: unknown: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    if options.list:
        for measurement in every:
            print(f"{measurement.name:12} {measurement.command}")
        return 0
    LOGS.mkdir(parents=True, exist_ok=True)
    lines = []
    times = []
    for measurement in every:
        if options.only and measurement.name not in options.only:
            continue
        print(f"{measurement.name}: {measurement.command}", flush=True)
        outcome = done_before(measurement) if options.resume else None
        word = "done before"
        if outcome is None:
            outcome = run(measurement)
            word = "done" if outcome.succeeded else "FAILED"
        print(f"  {word}, {outcome.seconds:.0f} s", flush=True)
        times.append((measurement.name, outcome.seconds))
        lines += lines_of(measurement, outcome)
        write_page(options.out, lines, times)
    return 0 if all(kept for kept, _ in lines) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
