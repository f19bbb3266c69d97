#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Drives the worlds' missions over many seeds and writes one table of the results.

usage: tools/sim/worlds.py [--out DIR] [--worlds A,B] [--share S] [--jobs N] [--hardpack BINARY]
                       [--against BINARY] [--fault-free HOURS] [-- OPTION...]

Runs `hardpack experiment` for each world, each in its own folder under --out. If called again with
the same --out and the same build, it continues where it was stopped.

  --out DIR          folder to write to (default build/worlds): worlds.md, worlds.json, and runs/
  --worlds A,B       only these worlds (--help lists all of them at its end)
  --share S          share of each world's seeds to drive, but at least 3 of them (default 1)
  --jobs N           missions in parallel (default: number of cores)
  --hardpack BINARY  the build to drive with (default build/release/tools/hardpack)
  --against BINARY   another build, which drives the same seeds: its figures are shown beside, with
                     the time ratio (this build's over the other's) over the seeds in which both
                     reached the goal. "-" where it lacks an option or a world
  --fault-free HOURS instead of the table: drives worlds without faults, without and with rain, dust
                     and lost packets, for that many simulated hours in total, and counts the alarms
                     that indicate a fault; writes fault_free.md, fault_free.json
  OPTION...          options of `hardpack experiment` for all runs (--lidar-columns 512)

Exit code: 0 done, 1 there was an alarm (--fault-free), 2 bad usage or a run that cannot be started.
"""

import argparse
import collections
import hashlib
import json
import math
import pathlib
import statistics
import subprocess
import sys
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEAST_RUNS = 3
SHOWN_SEEDS = 12
FAR_M = 50.0  # Contact::kFar_m: nothing hard is nearer


@dataclass(frozen=True)
class World:
    name: str
    runs: int
    options: tuple = ()


WORLDS = (
    World("thicket", 300), World("gap", 100), World("forest", 100), World("low", 100),
    World("low_bare", 100), World("tight_start", 100), World("back_out", 40),
    World("hill", 20), World("rock_pile", 20),
    World("open", 20), World("corridor", 20), World("dead_end", 20), World("ditch", 24),
    World("corner", 40), World("corner_ditch", 40),
    # Who is a person is told by a segmentation computer, and by nobody else.
    World("crossing", 40, ("--labels", "100")),
    World("blind", 20), World("blind_lost", 20), World("blind_invalid", 20),
    World("blind_dark", 20), World("blind_covered", 20), World("blind_frozen", 20),
    World("blind_turned", 20),
)

FAULT_FREE_WORLDS = ("open", "hill", "forest", "gap", "corridor", "thicket", "low")
# Of each of them in the first round; how many more it takes is reckoned from that.
FIRST_RUNS = 2
# What the air and the network do to a lidar that works (tools/sim/script/script.h). For drops and for dust
# that blows ahead the vehicle may stop, as for any return in its way, but nothing is to take the
# lidar for a faulty one.
SCRIPTS = {
    "none": "",
    "drizzle": "at 0 lidar-rain 1\n",
    "rain": "at 0 lidar-rain 10\n",
    "dust": "at 0 lidar-dust 110 -110 6 300\n",
    "gust": "at 4 lidar-dust -45 45 6 20\nat 6 lidar-dust -45 45 6 0\n",
    "loss": "at 0 lidar-loss 100\n",
}

# IsFaultAlarm of tools/sim/experiment/summary.cpp.
FAULT_ALARMS = frozenset((
    "lidar_old", "odometry_old", "ins_old", "blind_ahead", "lidar_covered", "lidar_frozen",
    "lidar_turned", "wheel_spin", "drives", "runaway", "wrong_turn", "stuck", "bad_command", "bus",
    "foreign_sender", "stop_too_long"))


class CannotRun(Exception):
    """An experiment that this build does not make; the message says why."""


def read_runs(path, most_seed=None):
    """The lines of runs.jsonl by seed, those beyond most_seed left out."""
    runs = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    return {run["seed"]: run for run in runs if most_seed is None or run["seed"] <= most_seed}


class Build:
    """A hardpack that drives, and the folder that it writes to."""

    def __init__(self, binary, folder, options):
        self.binary = binary.resolve()
        self.folder = folder
        self.jobs = options.jobs
        self.more = options.more
        if not self.binary.is_file():
            raise CannotRun(f"{binary}: there is no such program")
        self.take_folder()

    def take_folder(self):
        """Runs of two builds are not mixed in one folder."""
        stamp = self.folder / "build.sha256"
        digest = hashlib.sha256(self.binary.read_bytes()).hexdigest()
        if stamp.exists() and stamp.read_text("utf-8") != digest:
            raise CannotRun(f"{self.folder}: was written by another build; take another --out")
        self.folder.mkdir(parents=True, exist_ok=True)
        stamp.write_text(digest, "utf-8")

    def experiment(self, name, world, runs, options=()):
        """Runs by seed, 1 to `runs`. What is in the folder already is not driven again."""
        out = self.folder / name
        command = [str(self.binary), "experiment", world, "--runs", str(runs), "--out", str(out),
                   "--resume", "--no-replay", "--pictures", "none", *options, *self.more]
        if self.jobs:
            command += ["--jobs", str(self.jobs)]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            said = (result.stderr or result.stdout).strip().splitlines()
            said = said or [f"exit code {result.returncode}"]
            raise CannotRun(f"{name}: {said[-1]}")
        return read_runs(out / "runs.jsonl", runs)


def alarms_of(run):
    """How often each alarm began; None where the build did not count them yet."""
    if "reasons" not in run:
        return None
    return {reason: times for reason, times in run["reasons"].items() if reason in FAULT_ALARMS}


def sum_of_alarms(runs):
    if any("reasons" not in run for run in runs.values()):
        return None
    return sum(sum(alarms_of(run).values()) for run in runs.values())


def has_reached(run):
    return run["outcome"] == "reached"


def figures_of(runs):
    """What the table says of one world's runs. None: there is no such figure."""
    reached = [run for run in runs.values() if has_reached(run)]
    nearest = min(runs.values(), key=lambda run: (run["clearance_m"], run["seed"]), default=None)
    if nearest and nearest["clearance_m"] >= FAR_M:
        nearest = None
    failed = [{"seed": run["seed"], "outcome": run["outcome"], "reason": run["reason"]}
              for _, run in sorted(runs.items()) if not run["success"]]
    return {
        "runs": len(runs),
        "successes": sum(run["success"] for run in runs.values()),
        "reached": len(reached),
        "contacts": sum(run["outcome"] in ("contact", "person") for run in runs.values()),
        "clearance_m": nearest["clearance_m"] if nearest else None,
        "clearance_seed": nearest["seed"] if nearest else None,
        "mean_time_s": statistics.fmean(run["time_s"] for run in reached) if reached else None,
        "median_speed_mps": statistics.median(run["driven_m"] / run["time_s"] for run in reached
                                              if run["time_s"] > 0) if reached else None,
        "fault_alarms": sum_of_alarms(runs),
        "failed": failed,
    }


def time_ratio(runs, other):
    """Time of these over that of the others, of the seeds in which both reached the goal, and how
    many those are."""
    both = [seed for seed, run in runs.items()
            if seed in other and has_reached(run) and has_reached(other[seed])]
    others_s = sum(other[seed]["time_s"] for seed in both)
    if others_s <= 0.0:
        return None, len(both)
    return sum(runs[seed]["time_s"] for seed in both) / others_s, len(both)


def number(value, decimals=0):
    return "-" if value is None else f"{value:.{decimals}f}"


def line(cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |\n"


def heading(cells):
    return line(cells) + line(["---"] * len(cells))


def failed_text(failed):
    """"3 said: no_way, 8 contact"."""
    texts = []
    for one in failed[:SHOWN_SEEDS]:
        why = "" if one["reason"] == "none" else f": {one['reason']}"
        texts.append(f"{one['seed']} {one['outcome']}{why}")
    return ", ".join(texts) + (", ..." if len(failed) > SHOWN_SEEDS else "")


COLUMNS = ("success", "reached", "contacts", "clearance m (seed)", "time s", "median m/s",
           "fault alarms")


def figure_cells(figures):
    """One for each of COLUMNS; figures None: the build cannot drive it."""
    if figures is None:
        return ["-"] * len(COLUMNS)
    clearance = number(figures["clearance_m"], 2)
    if figures["clearance_m"] is not None:
        clearance += f" ({figures['clearance_seed']})"
    return [f"{figures['successes']}/{figures['runs']}", figures["reached"], figures["contacts"],
            clearance, number(figures["mean_time_s"], 1), number(figures["median_speed_mps"], 2),
            number(figures["fault_alarms"])]


def table_of(rows, with_other):
    """Markdown. Of the other build's figures each column is named with "other"."""
    titles = ["world", *COLUMNS]
    if with_other:
        titles += [f"other: {title}" for title in COLUMNS] + ["time ratio (seeds)"]
    text = heading([*titles, "failed seeds"])
    for row in rows:
        cells = [row["world"], *figure_cells(row["figures"])]
        if with_other:
            ratio = number(row["time_ratio"], 3)
            if row["time_ratio"] is not None:
                ratio += f" ({row['time_ratio_seeds']})"
            cells += [*figure_cells(row["other"]), ratio]
        text += line([*cells, failed_text(row["figures"]["failed"])])
    return text


def runs_of(world, share):
    return max(LEAST_RUNS, round(world.runs * share))


def drive_row(world, runs, build, other):
    row = {"world": world.name, "options": list(world.options)}
    print(f"worlds: {world.name}, {runs} runs", file=sys.stderr)
    own = build.experiment(world.name, world.name, runs, world.options)
    row["figures"] = figures_of(own)
    if other is None:
        return row
    row.update({"other": None, "time_ratio": None, "time_ratio_seeds": 0})
    try:
        theirs = other.experiment(world.name, world.name, runs, world.options)
    except CannotRun as failure:
        print(f"worlds: the other build: {failure}", file=sys.stderr)
        return row
    row["other"] = figures_of(theirs)
    row["time_ratio"], row["time_ratio_seeds"] = time_ratio(own, theirs)
    return row


def write(folder, name, table, values):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.md").write_text(table, "utf-8")
    (folder / f"{name}.json").write_text(json.dumps(values, indent=1) + "\n", "utf-8")
    print(table, end="")


def drive_table(options, worlds):
    build = Build(options.hardpack, options.out / "runs", options)
    other = None
    if options.against:
        other = Build(options.against, options.out / "other", options)
    rows = [drive_row(world, runs_of(world, options.share), build, other) for world in worlds]
    write(options.out, "worlds", table_of(rows, other is not None), {"rows": rows})
    return 0


def fault_free_row(world, script, runs):
    """Of one world under one script; `alarms` and `stops` by their reasons, with the seeds."""
    row = {"world": world, "script": script, "runs": len(runs),
           "successes": sum(run["success"] for run in runs.values()),
           "hours": sum(run["time_s"] for run in runs.values()) / 3600.0, "alarms": {}, "stops": {}}
    for seed, run in sorted(runs.items()):
        if alarms_of(run) is None:
            raise CannotRun(f"{world}: this build does not count its alarms")
        for reason, times in sorted(run["reasons"].items()):
            kind = row["alarms" if reason in FAULT_ALARMS else "stops"]
            entry = kind.setdefault(reason, {"times": 0, "seeds": []})
            entry["times"] += times
            entry["seeds"].append(seed)
    return row


def reasons_text(reasons, with_seeds):
    texts = []
    for reason, entry in reasons.items():
        text = f"{reason} {entry['times']}"
        if with_seeds:
            seeds = ", ".join(map(str, entry["seeds"][:SHOWN_SEEDS]))
            text += f" ({seeds}{', ...' if len(entry['seeds']) > SHOWN_SEEDS else ''})"
        texts.append(text)
    return ", ".join(texts) or "none"


def fault_free_table(rows):
    text = heading(["world", "script", "success", "hours", "fault alarms (seeds)", "other stops"])
    for row in rows:
        text += line([row["world"], row["script"], f"{row['successes']}/{row['runs']}",
                      number(row["hours"], 3), reasons_text(row["alarms"], True),
                      reasons_text(row["stops"], False)])
    total = collections.Counter()
    for row in rows:
        for reason, entry in row["alarms"].items():
            total[reason] += entry["times"]
    named = ", ".join(f"{reason} {times}" for reason, times in sorted(total.items()))
    hours = sum(row["hours"] for row in rows)
    return (text + f"\n{sum(total.values())} fault alarms in {hours:.2f} simulated hours"
            + (f": {named}" if named else "") + "\n")


def write_scripts(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in SCRIPTS.items():
        (folder / f"{name}.txt").write_text(text, "utf-8")


def drive_fault_free(options, names):
    """As many seeds of each world and script as it takes to be that long on the way."""
    build = Build(options.hardpack, options.out / "fault_free", options)
    scripts = options.out / "scripts"
    write_scripts(scripts)
    runs = FIRST_RUNS
    while True:
        rows = []
        for name in names:
            for script in SCRIPTS:
                print(f"worlds: {name}, {script}, {runs} runs", file=sys.stderr)
                made = build.experiment(f"{name}_{script}", name, runs,
                                        ("--script", str(scripts / f"{script}.txt")))
                rows.append(fault_free_row(name, script, made))
        hours = sum(row["hours"] for row in rows)
        if hours >= options.fault_free:
            break
        # A thousandth of an hour at least: where nothing drives, this ends too.
        wanted = math.ceil(runs * options.fault_free / max(hours, 0.001))
        runs = max(runs + 1, min(wanted, 10 * runs))
    write(options.out, "fault_free", fault_free_table(rows), {"hours": hours, "rows": rows})
    return 1 if any(row["alarms"] for row in rows) else 0


def chosen(names, known):
    """Those of `known` that are named, all of them without names; ValueError names what is not."""
    if not names:
        return list(known)
    wanted = names.split(",")
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise ValueError(f"--worlds {unknown[0]}: not among {', '.join(known)}")
    return [name for name in known if name in wanted]


def read_share(text):
    share = float(text)
    if not 0.0 < share <= 10.0:
        raise argparse.ArgumentTypeError("more than 0, at most 10")
    return share


def read_hours(text):
    hours = float(text)
    if not 0.0 < hours <= 10000.0:
        raise argparse.ArgumentTypeError("more than 0, at most 10000")
    return hours


def parser_of():
    listed = ", ".join(" ".join((f"{world.name} {world.runs}", *world.options))
                       for world in WORLDS)
    parser = argparse.ArgumentParser(
        description=f"{__doc__}\nWorlds and their seeds: {listed}.\nFault-free: "
                    f"{', '.join(FAULT_FREE_WORLDS)}; scripts: {', '.join(SCRIPTS)}.\n",
        formatter_class=argparse.RawDescriptionHelpFormatter, usage=argparse.SUPPRESS)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / "worlds")
    parser.add_argument("--worlds", default="")
    parser.add_argument("--share", type=read_share, default=1.0)
    parser.add_argument("--jobs", type=int, default=0)
    parser.add_argument("--hardpack", type=pathlib.Path,
                        default=ROOT / "build" / "release" / "tools" / "hardpack")
    parser.add_argument("--against", type=pathlib.Path)
    parser.add_argument("--fault-free", type=read_hours)
    parser.add_argument("more", nargs="*")
    return parser


def main(arguments=None):
    options = parser_of().parse_args(arguments)
    try:
        if options.fault_free:
            return drive_fault_free(options, chosen(options.worlds, FAULT_FREE_WORLDS))
        known = {world.name: world for world in WORLDS}
        return drive_table(options, [known[name] for name in chosen(options.worlds, known)])
    except (CannotRun, ValueError, OSError) as failure:
        print(f"worlds: {failure}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
