#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""usage: worlds_test.py WORLD

The experiment of one world over HARDPACK_SEEDS seeds (5): every run has a result, its log replays to
its decisions, no fewer runs succeed and no more touch something than the table says, and in worlds
of three kinds one run driven again is the same to the bit.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

COMMAND = os.environ["HARDPACK_COMMAND"]
SEEDS = int(os.environ.get("HARDPACK_SEEDS", "5"))

# Of five: successes at least, runs that touched something (a person while moving, an obstacle, a
# wheel in the ditch) at most. Wanted is (5, 0) everywhere; what is less was measured, and is to be
# raised with the driving. People who walk to and fro for ever may hold the vehicle for ever.
LIMITS = {
    "open": (5, 0),
    "hill": (5, 0),
    "rock_pile": (5, 0),
    "gap": (5, 0),
    "corridor": (5, 0),
    "forest": (5, 0),
    "crossing": (4, 0),
    "crossing_unlabelled": (4, 0),
    "dead_end": (5, 0),
    "ditch": (5, 0),
    "thicket": (5, 0),
    "tight_start": (5, 0),
    "back_out": (5, 0),
    "low": (5, 0),
    "corner": (5, 0),
    "corner_ditch": (5, 0),
    "downhill_stop": (5, 0),
    "crest": (5, 0),
    "gap_tilted": (5, 0),
}

# Who is a person is told by a segmentation computer, or without one by how they walk.
OPTIONS = {"crossing": ["--labels", "100"]}
WORLDS = {"crossing_unlabelled": "crossing", "gap_tilted": "gap:10"}
# Where it once crept up to what it touched, tick by tick, with the odometry 1 m off.
FIRST_SEEDS = {"gap_tilted": 57}
# What the simulator draws a run's noise and delays by is one code for all worlds; that the vehicle
# decides the same is what the replays say.
AGAIN = {"gap", "low", "crossing"}


def run(*arguments, codes=(0,)):
    result = subprocess.run([COMMAND, *map(str, arguments)], capture_output=True, text=True,
                            check=False)
    if result.returncode not in codes:
        sys.exit(f"exit code {result.returncode}: {result.stderr}{result.stdout}")
    return result.stdout


def check(name, out):
    failures = []
    world = WORLDS.get(name, name)
    options = OPTIONS.get(name, [])
    first = FIRST_SEEDS.get(name, 1)
    table = json.loads(run("experiment", world, "--runs", SEEDS, "--first-seed", first, "--jobs", 1,
                           "--pictures", "none", "--json", "--out", out, *options))
    row, = table["rows"]
    print((out / "table.md").read_text())
    runs = [json.loads(line) for line in (out / "runs.jsonl").read_text().splitlines()]
    if [one["seed"] for one in runs] != list(range(first, first + SEEDS)) or row["runs"] != SEEDS:
        failures.append("a run is missing")
    if row["replayed"] != SEEDS:
        failures.append(f"{row['replayed']} of {SEEDS} logs replay")
    # Where it finds no way at the start it never drives, and there is nothing to react to.
    if not all(one["time_s"] > 0 for one in runs):
        failures.append("a run has no time")
    if not all(one["reaction_s"]["bins"] for one in runs if one["driven_m"] > 0.5):
        failures.append("a run that drove has no reactions")
    if name in AGAIN:
        again = json.loads(run("sim", "--world", world, "--seed", 1, "--json", *options,
                               codes=(0, 1)))
        if again | {"replayed": True} != runs[0]:
            failures.append("seed 1 is not the same a second time")
    least, most_touches = LIMITS[name]
    # With fewer seeds: as many failures as there may be of five.
    if row["runs"] - row["successes"] > 5 - least:
        failures.append(f"{row['successes']} of {SEEDS} succeeded, wanted {least} of 5")
    touches = row["outcomes"]["contact"] + row["outcomes"]["person"]
    if touches > most_touches:
        failures.append(f"{touches} runs touched something, at most {most_touches} may")
    return failures


def main():
    with tempfile.TemporaryDirectory(prefix="hardpack_worlds_") as folder:
        failures = check(sys.argv[1], pathlib.Path(folder) / "out")
    for failure in failures:
        print(f"{sys.argv[1]}: {failure}", file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
