#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants single-token faults in core and hal, and counts how many of them the tests detect.

usage: tools/proof/mutate.py [--mutants N] [--seed N] [--jobs N | --shard K/N] [--only REGEX]
                       [--build DIR] [--out FILE] [--again FILE]

In a copy of the sources under --build (default build/mutate) one token at a time is changed: a
comparison, a sign, a logical operator, a number, a truth value. A fault that does not compile, or
does not change the object code, does not count, and another one is drawn. Then the tests that
cover the file run, the nearest first: those of its stage and, if none of these detects the fault,
those of the stages behind it, and its stage's with loops counted. Surviving faults are listed with
their place and change.

  --mutants N   faults to plant (default 300)
  --seed N      seed of the draw (default 1); the same seed and sources give the same faults
  --jobs N      shards in parallel (default: one per processor)
  --shard K/N   only every N-th fault, beginning with the K-th
  --only REGEX  only where path:line matches
  --out FILE    a line of JSON for each fault, as it is judged
  --again FILE  such a file of the same seed and sources: only the faults that survived then are
                planted again, to evaluate new tests; the count is of all faults in it, and those
                that --only leaves out still survive

Exit code: 0 at least 90 % are detected, 1 fewer, 2 bad usage or the tests fail without a fault.
"""

import argparse
import collections
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENOUGH = 0.90
# Of one program of tests: a loop without end is noticed. Of the processor's time, since others may
# work on the machine; so much longer by the clock, if it sleeps.
TIME_LIMIT_S = 240
CLOCK_LIMIT_S = 10 * TIME_LIMIT_S

# Tokens, and what is put in their place.
CHANGES = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==",
    "&&": "||", "||": "&&", "+": "-", "-": "+", "*": "/", "/": "*",
    "+=": "-=", "-=": "+=", "++": "--", "--": "++", "|": "&", "&": "|",
    "<<": ">>", ">>": "<<", "true": "false", "false": "true",
}
TOKEN = re.compile(r"""
    (?P<skip>//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|^[ \t]*\#[^\n]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<number>\d[\w.']*(?:[eE][-+]?\d+)?\w*)
  | (?P<operator><<=|>>=|<=>|->|::|\+\+|--|<=|>=|==|!=|&&|\|\||\+=|-=|\*=|/=|\|=|&=|<<|>>|[-+*/<>|&!])
""", re.VERBOSE | re.MULTILINE | re.DOTALL)
# Where a change is no fault of the program: what is checked or said rather than done.
NOT_IN = re.compile(r"\b(static_assert|HP_ASSERT|HP_LOOP_BOUND\w*|template|operator|"
                    r"using|namespace|static_cast|reinterpret_cast|std::span|std::array)\b")

# Programs of tests behind those of a file's own stage, what notices soonest first: `decision` and
# `decision_random`, whose output has to be as it is recorded, two whole drives, and all the rest.
# Behind a colon: a filter.
DECISION = "decision"
RANDOM = "decision_random"
RECORDED = {DECISION: "recorded.txt", RANDOM: "recorded_random.txt"}
DRIVES = "hal_onboard_vehicle_loop_test:VehicleLoop.DecidesAsRecorded"
BEHIND = [DECISION, DRIVES, RANDOM, "core_autonomy_test", "hal_onboard_vehicle_loop_test"]


def tokens_of(text):
    """(position, token, replacement) of all that may be changed."""
    found = []
    for match in TOKEN.finditer(text):
        token, kind = match.group(), match.lastgroup
        line = text[text.rfind("\n", 0, match.start()) + 1:
                    text.find("\n", match.end()) % (len(text) + 1)]
        if kind == "skip" or NOT_IN.search(line):
            continue
        if kind == "number":
            changed = changed_number(token)
            if changed is not None:
                found.append((match.start(), token, changed))
        elif token in CHANGES and is_binary(text, match, kind):
            found.append((match.start(), token, CHANGES[token]))
    return found


def is_binary(text, match, kind):
    """Whether an operator that could be of a type or a pointer is one between two values, which are
    written with a space on both sides, or the line's end behind it."""
    if kind == "name" or match.group() in ("++", "--"):
        return True
    return (text[match.start() - 1:match.start()] == " " and
            text[match.end():match.end() + 1] in (" ", "\n"))


def changed_number(token):
    """The next one; a float half as large again."""
    if re.fullmatch(r"\d+u?", token):
        digits = token.rstrip("u")
        return str(int(digits) + 1) + token[len(digits):]
    match = re.fullmatch(r"(\d+\.\d*)(f?)", token)
    if match is None:
        return None
    value = float(match.group(1))
    return f"{value * 1.5 if value else 1.0!r}{match.group(2)}"


class Tree:
    """A copy of the sources, built once, in which one file at a time is changed."""

    def __init__(self, folder):
        self.sources = folder / "sources"
        self.build = folder / "build"
        folder.mkdir(parents=True, exist_ok=True)
        if shutil.which("ccache"):  # what is mended is compiled again, and trees are alike
            os.environ.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
            os.environ.setdefault("CCACHE_DIR", str(folder.parent / "ccache"))
            os.environ.setdefault("CCACHE_SLOPPINESS", "pch_defines,time_macros")
            os.environ["CCACHE_BASEDIR"] = str(folder)
        files = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True,
                               text=True).stdout.split()
        for name in files:
            target = self.sources / name
            target.parent.mkdir(parents=True, exist_ok=True)
            text = (ROOT / name).read_bytes()
            if not target.exists() or target.read_bytes() != text:
                target.write_bytes(text)
        if not (self.build / "build.ninja").exists():
            subprocess.run(["cmake", "-S", self.sources, "-B", self.build, "-G", "Ninja",
                            "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG",
                            "-DHARDPACK_COUNT_LOOPS=ON", "-DCMAKE_CXX_COMPILER=g++"],
                           check=True, stdout=subprocess.DEVNULL)

    def ninja(self, *targets):
        return subprocess.run(["ninja", "-C", self.build, *targets], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)

    def object_of(self, name):
        """Of a source: core/astar/astar.cpp."""
        layer, *stage, file = name.split("/")
        target = "_".join(["hardpack", layer, *stage])
        return self.build.joinpath(layer, "CMakeFiles", f"{target}.dir", *stage, f"{file}.o")

    def programs_of(self, name):
        layer, *stage, _ = name.split("/")
        own = "_".join([layer, *stage, "test"])
        behind = [p for p in BEHIND if p != own]
        if layer == "hal" and stage[-1] != "vehicle_loop":
            behind = [DECISION, DRIVES, "hal_onboard_vehicle_loop_test"]
        known = self.ninja("-t", "targets", "all").stdout
        return [p for p in [own, *behind, f"counted_{own}"]
                if f"\n{target_of(p)}: " in known or f"/{target_of(p)}: " in known]

    def fails(self, program):
        """Why the tests of a program notice; None where they do not."""
        target, _, only = program.partition(":")
        folder = "test/loop_count" if target.startswith("counted_") else "test"
        binary = self.build / folder / target
        if program in RECORDED:
            binary = self.build / "test" / "decision" / program
        environment = {**os.environ, "GTEST_BRIEF": "1",
                       "HARDPACK_DATA": os.environ.get("HARDPACK_DATA", "")}
        try:
            run = subprocess.run([binary, "--gtest_fail_fast", f"--gtest_filter={only or '*'}"],
                                 cwd=self.build, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                 text=True, errors="replace", timeout=CLOCK_LIMIT_S,
                                 env=environment, check=False, preexec_fn=limit_time)
        except subprocess.TimeoutExpired:
            return f"{program}: no end"
        if run.returncode == -signal.SIGXCPU:
            return f"{program}: no end"
        if program in RECORDED and run.returncode == 0:
            recorded = (self.sources / "test" / "decision" / RECORDED[program]).read_text("utf-8")
            return None if run.stdout == recorded else f"{program}: not as recorded"
        if run.returncode == 0:
            return None
        match = re.search(r"\[  FAILED  \] (\S+)", run.stdout)
        return f"{program}: {match.group(1) if match else 'it ended with ' + str(run.returncode)}"


def limit_time():
    resource.setrlimit(resource.RLIMIT_CPU, (TIME_LIMIT_S, TIME_LIMIT_S + 5))


def target_of(program):
    return program.partition(":")[0]


def judge(tree, name, text, place):
    """{"outcome": ...}: noticed, survived, or none (does not compile, same code)."""
    position, token, replacement = place
    source = tree.sources / name
    object_file = tree.object_of(name)
    before = object_file.read_bytes()
    source.write_text(text[:position] + replacement + text[position + len(token):], "utf-8")
    try:
        if tree.ninja(str(object_file.relative_to(tree.build))).returncode != 0:
            return {"outcome": "none", "by": "does not compile"}
        if object_file.read_bytes() == before:
            return {"outcome": "none", "by": "same code"}
        for program in tree.programs_of(name):
            if tree.ninja(target_of(program)).returncode != 0:
                return {"outcome": "none", "by": "does not compile"}
            noticed = tree.fails(program)
            if noticed:
                return {"outcome": "noticed", "by": noticed}
        return {"outcome": "survived", "by": ""}
    finally:
        source.write_text(text, "utf-8")
        tree.ninja(str(object_file.relative_to(tree.build)))


def draw(options):
    """Places in all sources, in the seed's order. A line's places come when they come, whatever the
    other lines are: a change of the sources is another draw only where it is."""
    places = []
    for layer in ("core", "hal"):
        for path in sorted((ROOT / layer).glob("*/**/*.cpp")):
            name = str(path.relative_to(ROOT))
            text = path.read_text("utf-8")
            seen = collections.Counter()
            for place in tokens_of(text):
                position, token, _ = place
                start = text.rfind("\n", 0, position) + 1
                line = text[start:text.find("\n", position)]
                what = f"{options.seed} {name} {position - start} {token} {line}"
                seen[what] += 1
                if is_chosen(options, name, line_of(name, place)):
                    order = hashlib.sha256(f"{what} {seen[what]}".encode()).digest()
                    places.append((order, name, place))
    return [(name, place) for _, name, place in sorted(places)]


def is_chosen(options, name, line):
    return re.search(options.only, f"{name}:{line}") is not None


def line_of(name, place):
    return (ROOT / name).read_text("utf-8").count("\n", 0, place[0]) + 1


def judged_before(options):
    """(how many were noticed, were none or are left out, where those are that survived)."""
    counts = {"noticed": 0, "survived": 0, "none": 0}
    survived = set()
    for line in options.again.read_text("utf-8").splitlines():
        fault = json.loads(line)
        if fault["outcome"] == "survived" and is_chosen(options, fault["file"], fault["line"]):
            survived.add((fault["file"], fault["at"], fault["line"]))
        else:
            counts[fault["outcome"]] += 1
    return counts, survived


def programs_of(tree, places):
    return sorted({p for name in {name for name, _ in places} for p in tree.programs_of(name)})


def built_tree(folder, places):
    """None where it does not build."""
    tree = Tree(folder)
    built = tree.ninja(*{target_of(program) for program in programs_of(tree, places)})
    if built.returncode != 0:
        print(built.stdout[-4000:], file=sys.stderr)
        return None
    return tree


def read_shard(text):
    first, _, count = text.partition("/")
    if not (first.isdigit() and count.isdigit() and 1 <= int(first) <= int(count)):
        raise argparse.ArgumentTypeError(f"{text} is not K/N")
    return int(first) - 1, int(count)


def summarise(counts):
    """Prints what came out, and returns the exit code."""
    judged = counts["noticed"] + counts["survived"]
    share = counts["noticed"] / judged if judged else 0.0
    print(f"noticed {counts['noticed']} of {judged} ({100 * share:.1f} %); {counts['none']} were none",
          flush=True)
    return 0 if share >= ENOUGH else 1


def run_shards(options):
    """All shards as processes of this program, their survivors as they come, and the sum."""
    if shutil.which("ccache") and built_tree(options.build.resolve() / "0", draw(options)) is None:
        return 2  # with it, the other trees take what the first has compiled
    command = [sys.executable, __file__, "--mutants", str(options.mutants), "--seed",
               str(options.seed), "--only", options.only, "--build", str(options.build)]
    for name in ("out", "again"):
        if getattr(options, name):
            command += [f"--{name}", str(getattr(options, name))]
    shards = [subprocess.Popen([*command, "--shard", f"{k + 1}/{options.jobs}"],
                               stdout=subprocess.PIPE, text=True) for k in range(options.jobs)]
    counts = {"noticed": 0, "survived": 0, "none": 0, "shards": 0}
    threads = [threading.Thread(target=follow, args=(shard.stdout, counts)) for shard in shards]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    codes = [shard.wait() for shard in shards]
    if counts["shards"] != len(shards):
        print(f"mutate: not every shard came to its end: they exited with {codes}", file=sys.stderr)
        return 2
    return summarise(counts)


def follow(lines, counts):
    """Adds up what the shards print at their ends, and prints all else."""
    for line in lines:
        match = re.match(r"noticed (\d+) of (\d+) .*; (\d+) were none$", line)
        if match:
            noticed, judged, none = map(int, match.groups())
            counts["noticed"] += noticed
            counts["survived"] += judged - noticed
            counts["none"] += none
            counts["shards"] += 1
        else:
            print(line, end="", flush=True)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--shard", type=read_shard)
    parser.add_argument("--only", default="")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "mutate")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--again", type=pathlib.Path)
    options = parser.parse_args(arguments)
    if options.shard is None and options.jobs > 1:
        return run_shards(options)
    first, shards = options.shard or (0, 1)
    folder = options.build.resolve() / str(first)
    places = draw(options)
    counts = {"noticed": 0, "survived": 0, "none": 0}
    wanted = (options.mutants - first + shards - 1) // shards
    if options.again:
        before, survived = judged_before(options)
        places = [(name, place) for name, place in places
                  if (name, place[0], line_of(name, place)) in survived]
        if len(places) != len(survived):
            print("mutate: not all that survived are in these sources", file=sys.stderr)
            return 2
        counts = before if first == 0 else counts
        wanted = len(places) + sum(counts.values())
    tree = built_tree(folder, places)
    if tree is None:
        return 2
    for program in programs_of(tree, places)[first::shards]:  # the other shards' trees are alike
        why = tree.fails(program)
        if why:
            print(f"mutate: without a fault, {why}", file=sys.stderr)
            return 2
    places = places[first::shards]
    print(f"seed {options.seed}: {len(places)} places, {wanted} faults to plant", flush=True)
    for name, place in places:
        if counts["noticed"] + counts["survived"] >= wanted:
            break
        text = (ROOT / name).read_text("utf-8")
        begun = time.monotonic()
        result = judge(tree, name, text, place)
        counts[result["outcome"]] += 1
        line = line_of(name, place)
        result |= {"file": name, "line": line, "at": place[0], "from": place[1], "to": place[2],
                   "seconds": round(time.monotonic() - begun, 1)}
        if options.out:
            with open(options.out, "a", encoding="utf-8") as file:
                file.write(json.dumps(result) + "\n")
        if result["outcome"] == "survived":
            print(f"survived: {name}:{line}: {place[1]} -> {place[2]}", flush=True)
    return summarise(counts)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
