#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What config/timing.toml states of calls and rounds within a call holds when the code runs: in a
simulated mission through a gap, with labels and a keep-out area, and in ticks as dear as a test can
make them. Prints how near it comes. A fact that says too little is noticed.

usage: call_count_test.py COUNT_CALLS HARDPACK WRITE_TAPE WRITE_CROWDED_TAPE
"""

import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(os.environ["HARDPACK_SOURCE"])
sys.path.insert(0, str(ROOT / "tools" / "proof" / "wcet"))
from timing import FACTS, Facts, evaluate  # noqa: E402: it is found by the line above

# What no tape of seconds comes to.
RARE = {
    "hardpack::ReactionMeter::HalveBins",  # after 2^30 columns
    "hardpack::Mapper::Configure",         # a pause of the odometry
    "hardpack::AstarSearch::MoveLabels",   # paths so dear that their labels are moved
    "hardpack::PathCheck::LeaveCell",      # a start that touches: the check's own tests come to it
}
MISSION_TICKS = 600
# Beside the way, and large: its rows are more than a portion of planning closes.
KEEP_OUT = "keep_out odom\n-30 -40\n-10 -40\n-10 -20\n-30 -20\n"


def stated(facts):
    """{(kind, within, of): most}, without what is said of other vehicles than the tapes are of."""
    others = tuple(f"<hardpack::{other}>" for other in facts.table["vehicles"][1:])
    return {(kind, entry["within"], of): evaluate(entry["most"], facts.values)
            for kind in ("calls", "rounds") for entry in facts.table[kind] for of in entry["of"]
            if not any(other in entry["within"] for other in others)}


def tapes(folder, hardpack, write_tape, write_crowded_tape):
    areas = pathlib.Path(folder, "areas.txt")
    areas.write_text(KEEP_OUT)
    run = [hardpack, "sim", "--world", "gap", "--seed", "2", "--labels", "60", "--limit", "7",
           "--areas", areas, "--out", f"{folder}/run", "--json"]
    subprocess.run(run, check=False, capture_output=True)  # the mission need not end in time
    log, = pathlib.Path(folder, "run").glob("*.pcap")
    subprocess.run([write_tape, log, str(MISSION_TICKS), f"{folder}/mission"], check=True)
    subprocess.run([write_crowded_tape, f"{folder}/crowd"], check=True)
    return [f"{folder}/mission", f"{folder}/crowd"]


def count(program, facts, of_tapes):
    """{(kind, within, of): (most, calls of within)}."""
    asked = "".join(f"{' '.join(fact)}\n" for fact in facts)
    said = subprocess.run([program, *of_tapes], input=asked, text=True, check=True,
                          stdout=subprocess.PIPE).stdout
    counts = {}
    for line in said.splitlines():
        kind, within, of, most, entered = line.split()
        counts[kind, within, of] = int(most), int(entered)
    return counts


def wrong(facts, counts):
    found = []
    for (kind, within, of), most in facts.items():
        counted, entered = counts[kind, within, of]
        if counted > most:
            found.append(f"{within}: {counted} {kind} of {of}, {most} are stated")
        if (entered == 0 or counted == 0) and of not in RARE:
            found.append(f"{within}: no {kind} of {of} in {entered} calls, so nothing is shown")
    return found


def main(program, *makers):
    lacking = [maker for maker in makers if not os.access(maker, os.X_OK)]
    if lacking:
        print("no tapes without", *lacking)
        return 77
    facts = stated(Facts(FACTS))
    with tempfile.TemporaryDirectory() as folder:
        counts = count(program, facts, tapes(folder, *makers))
    for fact, most in facts.items():
        kind, within, of = (name.replace("hardpack::", "") for name in fact)
        print(f"{within:24} {kind:6} of {of:36} {counts[fact][0]:9} of {most:9}, "
              f"{counts[fact][1]} times")
    found = wrong(facts, counts)
    for line in found:
        print(line, file=sys.stderr)
    too_small = {fact: counts[fact][0] - 1 for fact in facts if fact[2] not in RARE}
    noticed = sum("are stated" in line for line in wrong(too_small, counts))
    assert noticed == len(too_small), f"{noticed} of {len(too_small)} facts that say too little"
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
