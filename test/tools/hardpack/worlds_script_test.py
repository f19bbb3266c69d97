#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/sim/worlds.py: its figures from runs that are made up, and itself on short missions."""

import contextlib
import io
import json
import os
import pathlib
import re
import stat
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["HARDPACK_SOURCE"])
COMMAND = os.environ["HARDPACK_COMMAND"]
sys.path.insert(0, str(SOURCE / "tools" / "sim"))
import worlds  # noqa: E402

# A few columns and a short time: what is looked at is the table, not the driving.
SHORT = ("--", "--lidar-columns", "512", "--limit", "4", "--typical")

# A build of which an experiment has these runs at once, or which has no such option.
FAKE = """#!{python}
import pathlib, sys
if "{refused}" in sys.argv:
    sys.exit("hardpack: no such option: {refused}")
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir(parents=True, exist_ok=True)
with open(out / "calls", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
(out / "runs.jsonl").write_text({runs!r})
"""


def run(seed, outcome="reached", reasons=(), **changed):
    made = {"seed": seed, "outcome": outcome, "success": outcome == "reached", "reason": "none",
            "time_s": 10.0, "driven_m": 40.0, "clearance_m": 0.5, "reasons": dict(reasons)}
    return made | changed


def by_seed(*runs):
    return {one["seed"]: one for one in runs}


class Figures(unittest.TestCase):

    def test_times_and_speeds_are_of_those_that_reach(self):
        figures = worlds.figures_of(by_seed(
            run(1, time_s=10.0, driven_m=40.0), run(2, time_s=20.0, driven_m=20.0),
            run(3, time_s=30.0, driven_m=90.0), run(4, "said", time_s=1.0, driven_m=0.0)))
        self.assertEqual((figures["runs"], figures["reached"], figures["successes"]), (4, 3, 3))
        self.assertAlmostEqual(figures["mean_time_s"], 20.0)
        self.assertAlmostEqual(figures["median_speed_mps"], 3.0)

    def test_contacts_are_with_things_and_people(self):
        figures = worlds.figures_of(by_seed(
            run(1, "contact", clearance_m=0.0), run(2, "person"), run(3, "stuck"), run(4)))
        self.assertEqual(figures["contacts"], 2)
        self.assertEqual([one["seed"] for one in figures["failed"]], [1, 2, 3])

    def test_the_least_clearance_has_its_seed_and_open_ground_has_none(self):
        figures = worlds.figures_of(by_seed(run(1), run(7, clearance_m=0.25), run(9)))
        self.assertEqual((figures["clearance_m"], figures["clearance_seed"]), (0.25, 7))
        contact_h = (SOURCE / "tools" / "sim" / "world" / "contact.h").read_text("utf-8")
        far_m = float(re.search(r"kFar_m = ([\d.]+);", contact_h).group(1))
        figures = worlds.figures_of(by_seed(run(1, clearance_m=far_m)))
        self.assertIsNone(figures["clearance_m"])

    def test_where_nothing_reaches_there_is_no_time(self):
        figures = worlds.figures_of(by_seed(run(1, "said", success=True)))
        self.assertEqual((figures["successes"], figures["reached"]), (1, 0))
        self.assertIsNone(figures["mean_time_s"])
        self.assertEqual(worlds.figure_cells(figures)[4:6], ["-", "-"])

    def test_alarms_are_of_faults_and_not_of_the_world(self):
        runs = by_seed(run(1, reasons={"obstacle": 4, "lidar_covered": 2}),
                       run(2, reasons={"drives": 1, "no_plan": 1}))
        self.assertEqual(worlds.figures_of(runs)["fault_alarms"], 3)
        older = run(3)
        del older["reasons"]
        self.assertIsNone(worlds.figures_of(runs | by_seed(older))["fault_alarms"])

    def test_the_alarms_are_those_of_the_table_of_an_experiment(self):
        source = (SOURCE / "tools" / "sim" / "experiment" / "summary.cpp").read_text("utf-8")
        listed = re.search(r"kFaultAlarms\[\] = \{(.*?)\};", source, re.DOTALL).group(1)
        self.assertEqual(set(re.findall(r'"(\w+)"', listed)), worlds.FAULT_ALARMS)

    def test_the_time_ratio_is_over_the_seeds_that_both_reach(self):
        own = by_seed(run(1, time_s=10.0), run(2, time_s=30.0), run(3, "said", time_s=5.0), run(4))
        other = by_seed(run(1, time_s=20.0), run(2, time_s=20.0), run(3, time_s=1.0),
                        run(4, "contact"))
        self.assertEqual(worlds.time_ratio(own, other), (1.0, 2))
        self.assertEqual(worlds.time_ratio(own, by_seed(run(8))), (None, 0))

    def test_failed_seeds_say_why_and_a_long_list_is_cut(self):
        figures = worlds.figures_of(by_seed(
            run(8, "contact"), run(3, "said", reason="no_way"), run(5)))
        self.assertEqual(worlds.failed_text(figures["failed"]), "3 said: no_way, 8 contact")
        many = worlds.figures_of(by_seed(*(run(seed, "stuck") for seed in range(1, 21))))
        self.assertTrue(worlds.failed_text(many["failed"]).endswith("12 stuck, ..."))

    def test_a_share_leaves_three_runs_at_least(self):
        thicket, hill = worlds.WORLDS[0], worlds.World("hill", 20)
        self.assertEqual(worlds.runs_of(thicket, 1.0), 300)
        self.assertEqual(worlds.runs_of(thicket, 0.1), 30)
        self.assertEqual(worlds.runs_of(hill, 0.01), 3)


class Commands(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="hardpack_worlds_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "out"

    def fake(self, name, runs, refused="--nothing"):
        path = self.folder / name
        lines = "".join(json.dumps(one) + "\n" for one in runs)
        path.write_text(FAKE.format(python=sys.executable, runs=lines, refused=refused), "utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def main(self, *arguments):
        """Exit code and standard output; what it said besides is in self.said."""
        with contextlib.redirect_stdout(io.StringIO()) as out:
            with contextlib.redirect_stderr(io.StringIO()) as said:
                code = worlds.main(["--out", str(self.out), *map(str, arguments)])
        self.said = said.getvalue()
        return code, out.getvalue()

    def test_drives_a_world_and_carries_on(self):
        arguments = ("--hardpack", COMMAND, "--worlds", "open", "--share", "0.01", *SHORT)
        code, table = self.main(*arguments)
        self.assertEqual(code, 0, self.said)
        self.assertEqual(table, (self.out / "worlds.md").read_text("utf-8"))
        row, = json.loads((self.out / "worlds.json").read_text("utf-8"))["rows"]
        self.assertEqual((row["world"], row["figures"]["runs"]), ("open", 3))
        self.assertEqual([one["outcome"] for one in row["figures"]["failed"]], ["time_out"] * 3)
        runs = self.out / "runs" / "open" / "runs.jsonl"
        before = runs.read_bytes()
        self.assertEqual(self.main(*arguments), (0, table))
        self.assertEqual(runs.read_bytes(), before)

    def test_fault_free_drives_under_each_script(self):
        code, table = self.main("--hardpack", COMMAND, "--worlds", "open", "--fault-free", "0.001",
                                *SHORT)
        self.assertEqual(code, 0, self.said + table)
        self.assertIn("\n0 fault alarms in 0.01 simulated hours\n", table)
        self.assertIn("| open | loss | 0/2 |", table)
        rows = json.loads((self.out / "fault_free.json").read_text("utf-8"))["rows"]
        self.assertEqual([row["script"] for row in rows], ["none", "drizzle", "rain", "dust", "gust", "loss"])
        hashes = {(self.out / "fault_free" / f"open_{script}" / "runs.jsonl").read_text("utf-8")
                  .split('"decision_hash":')[1][:18] for script in worlds.SCRIPTS}
        # The gust comes after the four seconds.
        self.assertEqual(len(hashes), len(worlds.SCRIPTS) - 1)

    def test_stands_the_other_build_beside(self):
        own = self.fake("own", [run(1, time_s=9.0), run(2, time_s=9.0), run(3)])
        other = self.fake("other", [run(1, time_s=10.0), run(2, time_s=10.0), run(3, "contact")])
        code, table = self.main("--hardpack", own, "--against", other, "--worlds", "hill",
                                "--share", "0.1")
        self.assertEqual(code, 0, self.said)
        row, = json.loads((self.out / "worlds.json").read_text("utf-8"))["rows"]
        self.assertAlmostEqual(row["time_ratio"], 0.9)
        self.assertEqual((row["time_ratio_seeds"], row["other"]["contacts"]), (2, 1))
        self.assertIn("| 0.900 (2) |", table)

    def test_what_the_other_build_does_not_have_is_left_open(self):
        own = self.fake("own", [run(1), run(2), run(3)])
        other = self.fake("other", [run(1)], refused="--labels")
        code, table = self.main("--hardpack", own, "--against", other, "--worlds",
                                "crossing,open", "--share", "0.1")
        self.assertEqual(code, 0, self.said)
        rows = {row["world"]: row
                for row in json.loads((self.out / "worlds.json").read_text("utf-8"))["rows"]}
        self.assertIsNone(rows["crossing"]["other"])
        self.assertEqual(rows["open"]["other"]["runs"], 1)
        self.assertIn("| " + "- | " * (len(worlds.COLUMNS) + 1), table)
        self.assertIn("no such option: --labels", self.said)
        calls = (self.out / "runs" / "crossing" / "calls").read_text("utf-8")
        self.assertIn("--labels 100", calls)

    def test_an_alarm_where_nothing_is_faulty_is_a_failure(self):
        runs = [run(1, time_s=1800.0),
                run(2, time_s=1800.0, reasons={"blind_ahead": 2, "person": 1})]
        own = self.fake("own", runs)
        code, table = self.main("--hardpack", own, "--worlds", "open", "--fault-free", "2")
        self.assertEqual(code, 1, self.said)
        self.assertIn("12 fault alarms in 6.00 simulated hours: blind_ahead 12\n", table)
        self.assertIn("| blind_ahead 2 (2) | person 1 |", table)

    def test_fault_free_takes_more_seeds_until_it_has_the_hours(self):
        runs = [run(seed, time_s=900.0) for seed in range(1, 9)]
        own = self.fake("own", runs)  # 2 seeds of 6 scripts are 3 hours
        code, table = self.main("--hardpack", own, "--worlds", "open", "--fault-free", "7.5")
        self.assertEqual(code, 0, self.said)
        self.assertIn("in 7.50 simulated hours", table)
        self.assertIn("| open | rain | 5/5 |", table)

    def test_names_what_is_wrong(self):
        own = self.fake("own", [run(1)])
        self.assertEqual(self.main("--hardpack", own, "--worlds", "moon")[0], 2)
        self.assertIn("moon", self.said)
        self.assertEqual(self.main("--hardpack", self.folder / "none", "--worlds", "open")[0], 2)
        self.assertIn("none", self.said)
        failing = self.fake("failing", [], refused="--runs")
        self.assertEqual(self.main("--hardpack", failing, "--worlds", "open")[0], 2)
        self.assertIn("no such option: --runs", self.said)
        # Another build's runs are not taken for this one's.
        self.assertEqual(self.main("--hardpack", own, "--worlds", "open")[0], 2)
        self.assertIn("another build", self.said)
        for share in ("0", "-1", "nan"):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
                worlds.main(["--share", share])


if __name__ == "__main__":
    unittest.main()
