#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""usage: blind_test.py WORLD

One of the worlds blind and blind_* over HARDPACK_SEEDS seeds (5): with a fault every vehicle that
drove at 3 m/s or more stands without having touched anything and says why; without it every one
reaches the goal.
"""

# SR-SEE01, SR-SEE02, SR-SEE03, SR-SEE04, SR-SEE05: at speed, on drawn vehicles.

import json
import os
import pathlib
import subprocess
import sys
import tempfile

COMMAND = os.environ["HARDPACK_COMMAND"]
SEEDS = int(os.environ.get("HARDPACK_SEEDS", "5"))
REASONS = {
    "blind": (),
    "blind_lost": ("blind_ahead",),
    "blind_invalid": ("blind_ahead",),
    "blind_dark": ("lidar_covered",),
    "blind_covered": ("lidar_covered",),
    "blind_frozen": ("lidar_frozen",),
    "blind_turned": ("lidar_turned", "lidar_covered"),
}


def main():
    world = sys.argv[1]
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        result = subprocess.run(
            [COMMAND, "experiment", world, "--runs", str(SEEDS), "--jobs", "1", "--no-replay",
             "--pictures", "none", "--out", str(out)], capture_output=True, text=True, check=False)
        if result.returncode != 0:
            sys.exit(result.stderr + result.stdout)
        runs = [json.loads(line) for line in (out / "runs.jsonl").read_text().splitlines()]
    if len(runs) != SEEDS:
        failures.append("a run is missing")
    for run in runs:
        name = f"{world}, seed {run['seed']}: {run['outcome']}, {run['reason']}"
        print(name)
        if not run["success"]:
            failures.append(name)
        if run["max_speed_mps"] < 3.0:
            failures.append(name + f": {run['max_speed_mps']} m/s only")
        if REASONS[world] and run["reason"] not in REASONS[world]:
            failures.append(name + ": another reason")
    for failure in failures:
        print("FAILED: " + failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
