#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""hardpack experiment: short missions, their table, shards, going on, and one line for bad input."""

import json
import unittest

from command_line import CommandTest, png_size

# Few columns and a short time: what is looked at is the table, not the driving.
SHORT = ("--lidar-columns", 512, "--limit", 3, "--typical")


class Experiment(CommandTest):
    def experiment(self, out, *more):
        return self.expect_done(["experiment", "open", *SHORT, "--out", out, *more])

    def test_the_table_does_not_depend_on_shards_and_jobs(self):
        whole, one, other = (self.folder / name for name in ("whole", "one", "other"))
        printed = self.experiment(whole, "--runs", 2, "--jobs", 2)
        self.assertIn("| open |", printed)
        self.assertEqual(printed, (whole / "table.md").read_text())
        runs = [json.loads(line) for line in (whole / "runs.jsonl").read_text().splitlines()]
        self.assertEqual([run["seed"] for run in runs], [1, 2])
        self.assertTrue(all(run["replayed"] for run in runs))
        self.assertNotEqual(runs[0]["decision_hash"], runs[1]["decision_hash"])
        self.assertGreater(png_size(whole / "pictures" / "open_1.png")[0], 500)
        self.assertFalse((whole / "pictures" / "open_2.png").exists())
        self.assertEqual(list(whole.glob("*.pcap")), [])

        self.experiment(one, "--runs", 2, "--shard", "1/2", "--pictures", "none", "--jobs", 1)
        self.experiment(other, "--runs", 2, "--shard", "2/2", "--pictures", "none", "--jobs", 1)
        self.expect_done(["experiment", "merge", one, other, "--out", self.out])
        for name in ("runs.jsonl", "table.json", "table.md"):
            self.assertEqual((self.out / name).read_bytes(), (whole / name).read_bytes(), name)
        row = json.loads((self.out / "table.json").read_text())["rows"][0]
        self.assertEqual((row["runs"], row["replayed"]), (2, 2))

    def test_goes_on_where_it_was_stopped(self):
        more = ("--pictures", "none", "--no-replay")
        self.experiment(self.out, "--runs", 2, *more)
        whole = (self.out / "runs.jsonl").read_bytes()
        # Stopped in the middle of the second line.
        (self.out / "runs.jsonl").write_bytes(whole[:whole.index(b"\n") + 40])
        self.expect_bad_input(["experiment", "open", *SHORT, "--out", self.out, "--runs", 2, *more],
                              "runs.jsonl", "--resume")
        self.expect_bad_input(["experiment", "open", *SHORT, "--out", self.out, "--runs", 2, *more,
                               "--resume", "--max-speed", 2], "other options")
        self.experiment(self.out, "--runs", 2, "--resume", *more)
        self.assertEqual((self.out / "runs.jsonl").read_bytes(), whole)

    def test_every_run_has_the_script(self):
        more = ("--pictures", "none", "--no-replay", "--runs", 1)
        script = self.write("loss.txt", "at 1 lidar off\nat 1.8 lidar on\n")
        other = self.write("other.txt", "at 1 lidar off\nat 1.7 lidar on\n")
        with_script, without = self.folder / "with", self.folder / "without"
        self.experiment(with_script, "--script", script, *more)
        self.experiment(without, *more)
        run = json.loads((with_script / "runs.jsonl").read_text())
        plain = json.loads((without / "runs.jsonl").read_text())
        self.assertEqual(run["reasons"].get("lidar_old"), 1, run["reasons"])
        self.assertNotIn("lidar_old", plain["reasons"])
        row = json.loads((with_script / "table.json").read_text())["rows"][0]
        self.assertEqual(row["fault_alarms"], 1)
        self.assertAlmostEqual(row["hours"], run["time_s"] / 3600.0)
        sim = self.run_command("sim", "--world", "open", *SHORT, "--script", script, "--json")
        self.assertEqual(json.loads(sim.stdout)["decision_hash"], run["decision_hash"])

        # Runs of another script, or of none, are none of these.
        self.assertNotEqual(run["settings"], plain["settings"])
        for options in (("--script", other), ()):
            self.expect_bad_input(["experiment", "open", *SHORT, "--out", with_script, "--resume",
                                   *options, *more], "other options")
        self.expect_bad_input(["experiment", "merge", with_script, without, "--out", self.out],
                              "settings")

    def test_a_failed_mission_is_a_result_unless_success_is_required(self):
        result = self.run_command("experiment", "open", *SHORT, "--runs", 1, "--no-replay",
                                  "--pictures", "failed", "--require-success", 1,
                                  "--out", self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("0 of 1", result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        run = json.loads((self.out / "runs.jsonl").read_text())
        self.assertEqual(run["outcome"], "time_out")
        self.assertTrue((self.out / "pictures" / "open_1.png").exists())

    def test_names_what_is_wrong(self):
        out = ("--out", self.out)
        self.expect_bad_input(["experiment", "moon", *out], "moon", "rock_pile")
        self.expect_bad_input(["experiment", *out], "world")
        self.expect_bad_input(["experiment", "open"], "--out")
        self.expect_bad_input(["experiment", "open", *out, "--shard", "3/2"], "3/2")
        self.expect_bad_input(["experiment", "open", *out, "--runs", 0], "--runs")
        self.expect_bad_input(["experiment", "open", *out, "--jobs", "-1"], "--jobs")
        self.expect_bad_input(["experiment", "open", *out, "--labels", "soon"], "--labels")
        self.expect_bad_input(["experiment", "open", *out, "--pictures", "some"], "--pictures")
        self.expect_bad_input(["experiment", "open", *out, "--vehicle", "tank"], "tank")
        self.expect_bad_input(["experiment", "open", *out, "--planner", "rrt"], "rrt")
        bad = self.write("bad.txt", "at 1 lidar on\nat 2 explode\n")
        self.expect_bad_input(["experiment", "open", *out, "--script", bad], f"{bad}:2", "explode")
        self.expect_bad_input(["experiment", "open", *out, "--script", self.folder / "none.txt"],
                              "none.txt")
        self.expect_bad_input(["experiment", "merge", self.folder, *out], "runs.jsonl")


if __name__ == "__main__":
    unittest.main()
