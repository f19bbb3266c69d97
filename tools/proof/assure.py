#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures hardpack's promises and writes assurance.md.

usage: tools/proof/assure.sh [--fuzz-minutes N] [--mutants N] [--only NAME]... [--resume] [--out FILE]
                       [--list]

Runs on a machine with nothing but Debian and this checkout: it installs packages, builds everything in
build/, and runs each command below, one after the other, with its output kept in build/assure. The page
has a section for each command, with its duration and a line for each promise that it shows: the
measured figure and its budget. Broken promises are named at its top.

  --fuzz-minutes N  total for all targets (default 30)
  --mutants N       faults to plant (default 300)
  --only NAME       only these commands (--list prints their names); the page then has their sections
  --resume          commands that succeeded on this very commit are not run again, but read from their
                    output; nothing is resumed if sources have changed since the commit
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

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOGS = ROOT / "build" / "assure"


@dataclass
class Promise:
    what: str
    figure: str  # a regular expression of what the command prints; the last match counts
    budget: str = ""  # in words, where no number is held
    form: str = "{}"  # of the expression's groups
    group: int = 0  # the group whose number is held to ...
    at_most: float | None = None
    at_least: float | None = None
    times: int | None = None  # the group that tells how many times the bound is what was counted
    ran: tuple = ()  # tests that must have passed by name: one that is left out keeps nothing
    may_skip: str = "$."  # names of tests that cannot run there

    def limit(self):
        if self.at_most is not None:
            return f"at most {self.at_most:,}" + (f", {RATIO:g} times" if self.times is not None else "")
        return f"at least {self.at_least:,}" if self.at_least is not None else self.budget

    def holds(self, groups):
        def number(group):
            return float(groups[group].replace(",", ""))
        return ((self.at_most is None or number(self.group) <= self.at_most) and
                (self.at_least is None or number(self.group) >= self.at_least) and
                (self.times is None or number(self.times) <= RATIO))


@dataclass
class Measurement:
    name: str
    title: str
    command: str
    promises: list = field(default_factory=list)


@dataclass
class Outcome:
    succeeded: bool
    output: str
    seconds: float


NONE = "none"  # a budget: the figure is only told
PASSED = r"(100% tests passed, 0 tests failed out of \d+)"
SKIPPED = re.compile(r"^\s*\d+ - (.*) \(Skipped\)$", re.MULTILINE)
# Of stages: what is counted is the worst of adversarial inputs, so that the bound may be this far off.
RATIO = 3.0
MIB = 1024 * 1024


def bounds(column):
    """A promise for each bound of config/timing.toml, whose budgets of a processor are in a column;
    of stages that are counted also for how many times the count it is."""
    with open(ROOT / "config" / "timing.toml", "rb") as file:
        entries = tomllib.load(file)["bounds"]
    said = []
    for entry in entries:
        counted = "measured" in entry
        columns = r"\s{2,}([\d,]+)\s+[\d,]+\s+" + (r"([\d,]+)\s+([\d.]+)" if counted else "-")
        of_stage = counted and not entry["measured"].startswith("instructions_")
        said.append(Promise(f"static bound of the instructions of: {entry['name']}",
                            r"\b" + re.escape(entry["name"]) + columns,
                            form="{0}, {2} times the {1} counted" if counted else "{}",
                            at_most=entry[column], times=2 if of_stage else None))
    return said


def fuzz_targets():
    return sorted(path.name.removesuffix("_fuzz.cpp")
                  for path in (ROOT / "test" / "fuzz").glob("*_fuzz.cpp"))


def measurements(options):
    in_release = "cmake --build --preset release && "
    return [
        Measurement("packages", "Packages", "tools/check.sh --all --deps"),
        Measurement("release", "g++, every test but the slow ones",
                    "cmake --preset release && cmake --build --preset release && "
                    "ctest --preset release -LE slow", [
                        Promise("every test passes in g++'s optimised build; the README's programs "
                                "among them", PASSED, "all"),
                        Promise("a mission over UDP and a real vcan, and its log replays bit for bit",
                                PASSED, "all", ran=("onboard.mission", "onboard.program")),
                    ]),
        Measurement("slow", "The slow tests", in_release + "ctest --preset release -L slow", [
            Promise("worlds (five seeds each) end as they should", PASSED, "all"),
            Promise("each fault on a real vcan stops the vehicle within its limit", PASSED, "all",
                    ran=("onboard.faults", "onboard.bus_faults")),
            Promise("it drives without an allocation from the first tick on, beside a busy disk",
                    PASSED, "all", ran=("onboard.hil", "onboard.soak"))]),
        Measurement("tidy", "clang-tidy", "tools/proof/check_tidy.sh build/release && echo nothing", [
            Promise("clang-tidy (bugprone, cert; in the core the C++ Core Guidelines) says",
                    r"^(nothing)$", "nothing"),
        ]),
        Measurement("no_heap", "No heap, and the rules of the sources",
                    in_release + "ctest --preset release -R '^rails'", [
            Promise("no heap: core and hal need four functions of memory and nothing else, and link "
                    "alone; planted uses of new are found", PASSED, "all",
                    ran=("rails.symbols.core", "rails.symbols.core_and_hal", "rails.links_alone",
                         "rails.planted.uses_new", "rails.planted.link_with_new")),
            Promise("every rule of the sources and the objects is kept, and every check finds a planted "
                    "violation", PASSED, "all"),
        ]),
        Measurement("requirements", "Hazards, requirements and tests", "tools/proof/check_requirements.py", [
            Promise("every safety requirement has a test, every hazard a requirement or an assumption "
                    "that it puts on the user",
                    r"^check_requirements: \d+ hazards, (\d+) requirements, .*, 0 findings$", "all",
                    form="{} requirements"),
        ]),
        Measurement("memory", "Memory", in_release + "build/release/test/docs/memory_doc", [
            Promise("memory of everything on board, fixed at compile time",
                    r"\| `VehicleLoop` \| (\d+) \|", form="{} bytes", at_most=8650752),
            Promise("of planning", r"takes (\d+) of its \d+ bytes", form="{} bytes", at_most=6 * MIB),
            Promise("of perception", r"\| `Mapper` \| (\d+) \|", form="{} bytes", at_most=5 * MIB),
        ]),
        Measurement("same_bits", "The same bits everywhere", "tools/proof/decision_hash.sh --all", [
            Promise("the same decisions by every compiler, option and processor: builds that agree",
                    r"^decision_hash: all (\d+) equal$", at_least=7),
        ]),
        Measurement("clang", "clang++",
                    "cmake --preset core-clang && cmake --build --preset core-clang && "
                    "ctest --preset core-clang", [
                        Promise("core and hal as clang++ optimises them: they need what is allowed and "
                                "nothing else, and decide hundreds of random scenarios as recorded",
                                PASSED, "all", ran=("rails.symbols.core_and_hal",
                                                    "decision.random_as_recorded"))]),
        Measurement("sanitizers", "Sanitizers, every loop counted",
                    "cmake --build --preset release && cmake --preset asan && "
                    "cmake --build --preset asan && rm -f build/loops && "
                    "HARDPACK_LOOP_REPORT=$PWD/build/loops ctest --preset asan -LE slow", [
                        Promise("every test passes with address and undefined-behaviour sanitizers "
                                "(they own the allocator: allocations are not counted there), and no "
                                "loop of core and hal runs more often than its record says",
                                PASSED, "all", may_skip="Alloc"),
                        Promise("calls and rounds within a tick, which the bounds rest on, are no more "
                                "than is stated", PASSED, "all",
                                ran=("counted/facts.OfCallsAndRounds",))]),
        Measurement("loops", "Loops that the tests come to", "tools/proof/loop_report.py build/loops", [
            Promise("the tests come to every loop, and to the bound of many",
                    r"^loops: (\d+) have records, (\d+) were entered, (\d+) of them",
                    "all entered", form="{} loops, {} entered, {} of them gone round as often as they "
                    "may")]),
        Measurement("aarch64", "aarch64",
                    "cmake --preset aarch64 && cmake --build --preset aarch64 && "
                    "ctest --preset aarch64 -V", [
                        Promise("the aarch64 build: every test passes", PASSED, "all"),
                        Promise("logs of x86-64 replay bit for bit; a mission is the same, on the bare "
                                "processor too", PASSED, "all",
                                ran=("onboard.mission_log_replays", "onboard.mission_is_the_same",
                                     "bare_metal.mission_is_the_same",
                                     "bare_metal.crowd_is_the_same")),
                        Promise("hardpackd drives on an arm64 kernel with a vcan", PASSED, "all",
                                ran=("onboard.hardware_in_the_loop",)),
                        *bounds("aarch64")]),
        Measurement("schedule", "Schedule, an estimate",
                    "cmake --build --preset aarch64 && "
                    "tools/proof/wcet/timing.py --schedule --measured "
                    "build/aarch64/test/bare_metal/mission.measured "
                    "build/aarch64/test/bare_metal/replay_tape", [
                        Promise("Cortex-A72 at 1.5 GHz: tick period", r"^tick period\s{2,}(\d+ ms)", NONE),
                        *(Promise(f"{name}: by the bounds; as counted",
                                  rf"^{name}\s{{2,}}(.+?)(?:\s+(-|[\d.]+ (?:ms|m|\(mean\))))$", NONE,
                                  form="{}; {}")
                          for name in ("a tick without planning", "the worst tick",
                                       "ticks for a whole plan", "from a return's light to a frame",
                                       "reaction radius at 5 m/s"))]),
        Measurement("cortex_m7", "Cortex-M7",
                    "cmake --preset cortex-m7 && cmake --build --preset cortex-m7 && "
                    "ctest --preset cortex-m7 -V", [
                        Promise("the Cortex-M7 build: every test passes", PASSED, "all"),
                        Promise("a mission from bytes to frames on the bare processor, the host's hash "
                                "in every tick", r"(decision hash [0-9a-f]{16})", "the host's",
                                ran=("bare_metal.mission_is_the_same",
                                     "bare_metal.crowd_is_the_same")),
                        *bounds("cortex_m7"),
                        Promise("static bound of the stack of a tick",
                                r"(\d+)  hardpack::BasicVehicleLoop<hardpack::Warthog>::Tick", form="{} bytes", at_most=16384),
                        Promise("of it taken, painted, the program around it included",
                                r"mission and crowd took (\d+ of at most \d+ bytes)", "the bound"),
                    ]),
        Measurement("coverage", "Coverage", "tools/proof/coverage.py", [
            Promise("lines of core and hal that the tests run", r"core and hal\s.*?([\d.]+) %$",
                    form="{} %", at_least=95)]),
        Measurement("fuzz", "Fuzzing", f"tools/proof/fuzz.sh --minutes {options.fuzz_minutes}", [
            Promise(f"fuzzing finds nothing: {target}",
                    rf"^{target}\s+fine\s+(\d+) runs in (\d+) s, (\d+) edges",
                    form="{} runs in {} s, {} edges", at_least=1)
            for target in fuzz_targets()]),
        Measurement("mutation", "Planted faults", f"tools/proof/mutate.py --mutants {options.mutants}", [
            Promise(f"of {options.mutants} planted faults the tests notice",
                    r"noticed (\d+) of (\d+) \(([\d.]+) %\)", form="{} of {}: {} %", group=2,
                    at_least=90)]),
    ]


def revision():
    """Of the sources; ends with -dirty where they are not as they were committed, files that are new
    and not ignored included. Empty where nobody knows."""
    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True,
                              check=False).stdout.strip()
    return git("describe", "--always") + ("-dirty" if git("status", "--porcelain") else "")


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
    if now == "" or now.endswith("-dirty"):
        return None
    try:
        record = json.loads(record_of(measurement).read_text("utf-8"))
        output = (LOGS / f"{measurement.name}.log").read_text("utf-8", errors="replace")
    except (OSError, ValueError):
        return None
    if (record["revision"], record["command"]) != (now, measurement.command):
        return None
    return Outcome(True, output, record["seconds"])


def has_recordings():
    return (ROOT / ".." / "shared" / "data").is_dir()


def left_out(promise, output):
    """Tests that a promise is of and that did not run. Those that need recordings are none where
    there are no recordings, but said."""
    missing = [name for name in promise.ran
               if not re.search(rf"#\d+: {re.escape(name)} \.+\s+Passed", output)]
    skipped = SKIPPED.findall(output) if promise.figure == PASSED and not promise.ran else []
    return missing, [name for name in skipped if not re.search(promise.may_skip, name)]


def judge(promise, outcome):
    """(whether it is kept, what the page says of it)"""
    found = re.findall(promise.figure, outcome.output, re.MULTILINE)
    if not found:
        return False, "-"
    groups = found[-1] if isinstance(found[-1], tuple) else (found[-1],)
    groups = [re.sub(r"\s+", " ", group) for group in groups]
    missing, skipped = left_out(promise, outcome.output)
    figure = promise.form.format(*groups)
    if promise.figure == PASSED and promise.ran:
        figure = "passed: " + (", ".join(name for name in promise.ran if name not in missing) or "none")
    if missing:
        figure += f"; did not run: {', '.join(missing)}"
    if skipped:
        figure += f"; skipped: {', '.join(skipped)}"
    kept = outcome.succeeded and promise.holds(groups) and not missing
    return kept and (not skipped or not has_recordings()), figure


@dataclass
class Section:
    """What the page says of one command."""
    measurement: Measurement
    seconds: float
    lines: list  # (whether it is kept, or None where there is no budget; the promise; its figure)

    def kept(self):
        return all(is_kept is not False for is_kept, _, _ in self.lines)


def section_of(measurement, outcome):
    lines = []
    for promise in measurement.promises or [Promise("it succeeds", "", form="it did")]:
        kept, figure = judge(promise, outcome)
        told = kept and promise.budget == NONE
        lines.append((None if told else kept, promise, figure))
    return Section(measurement, outcome.seconds, lines)


def text_of(section):
    of = section.measurement
    words = {True: "kept", False: "**NOT KEPT**", None: "told"}
    return [f"\n## {of.title}\n",
            f"`{of.command}`: {section.seconds:.0f} s, `build/assure/{of.name}.log`\n",
            "| promise | measured | budget | |", "|---|---|---|---|",
            *(f"| {promise.what} | {figure} | {promise.limit()} | {words[kept]} |"
              for kept, promise, figure in section.lines)]


def write_page(path, sections):
    lines = [line for section in sections for line in section.lines]
    promised = [kept for kept, _, _ in lines if kept is not None]
    minutes = sum(section.seconds for section in sections) / 60
    text = ["# Assurance\n",
            f"{sum(promised)} of {len(promised)} promises kept. Revision {revision()}, "
            f"{datetime.date.today().isoformat()}, {platform.machine()}, {os.cpu_count()} processors, "
            f"{minutes:.0f} minutes. Written by `tools/proof/assure.sh`."]
    broken = [f"- {section.measurement.title}: {promise.what}: {figure}"
              for section in sections for kept, promise, figure in section.lines if kept is False]
    text += ["\nNot kept:\n", *broken] if broken else []
    for section in sections:
        text += text_of(section)
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
    sections = []
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
        sections.append(section_of(measurement, outcome))
        write_page(options.out, sections)
    return 0 if all(section.kept() for section in sections) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
