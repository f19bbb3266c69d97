#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `hardpack fit` writes and prints, and what it refuses. How good its fits are is tested in
test/tools/fit."""

import json
import math
import random
import unittest

from command_line import CommandTest, png_size

HEADER = ("seg,step,t_s,cmd_left_radps,cmd_right_radps,meas_left_radps,meas_right_radps,"
          "icp_x,icp_y,icp_z,icp_roll,icp_pitch,icp_yaw\n")


def made_drive(runs):
    """A vehicle whose wheels are first-order lags, so that there is something to fit."""
    chance = random.Random(1)
    rows = [HEADER]
    for run in range(runs):
        left = right = x = y = yaw = 0.0
        for part in range(4):
            if part % 2 == 0:
                command = [round(chance.uniform(-12.0, 12.0), 6) for _ in range(2)]
            for step in range(40):
                rows.append(f"{10 * run + part},{step},{0.05 * step:.2f},{command[0]},{command[1]},"
                            f"{left:.6f},{right:.6f},{x:.6f},{y:.6f},0,0,0,"
                            f"{math.remainder(yaw, 2.0 * math.pi):.6f}\n")
                for _ in range(10):
                    left += 0.005 / 0.4 * (command[0] - left)
                    right += 0.005 / 0.4 * (command[1] - right)
                    yaw += 0.005 * 0.3 * (right - left) / 1.8
                    x += 0.005 * 0.15 * (left + right) * math.cos(yaw)
                    y += 0.005 * 0.15 * (left + right) * math.sin(yaw)
    return "".join(rows)


class Fit(CommandTest):
    def test_writes_its_files_and_prints_its_table(self):
        drive = self.write("drive.csv", made_drive(6))
        stdout = self.expect_done(["fit", "--drive", drive, "--seed", "4", "--out", self.out])
        self.assertIn("`hardpack fit --drive drive.csv --seed 4 --out DIR`", stdout)
        self.assertIn("| this model |", stdout)
        self.assertEqual(stdout, (self.out / "fit.md").read_text())
        report = json.loads((self.out / "fit.json").read_text())
        self.assertEqual(report["segments_fitted"] + report["segments_held_out"], 24)
        held_out = report["held_out"]
        self.assertLess(held_out["model"]["yaw_rate_rms_radps"],
                        0.5 * held_out["first_order_stock"]["yaw_rate_rms_radps"])
        self.assertLess(abs(report["params"]["skid_baseline_m"]["value"] - 1.8), 0.1)
        self.assertGreater(min(png_size(self.out / "fit.png")), 700)
        for name, limit in (("warthog_recorded", 13.4), ("warthog_paper", 17.5)):
            text = (self.out / f"{name}.toml").read_text()
            self.assertIn(f"wheel_limit_radps = {limit}", text)
            self.assertIn("--seed 4", text)

    def test_is_the_same_twice_and_prints_json(self):
        drive = self.write("drive.csv", made_drive(5))
        first = self.expect_done(["fit", "--drive", drive, "--json"])
        self.assertEqual(first, self.expect_done(["fit", "--drive", drive, "--json"]))
        self.assertEqual(json.loads(first)["seed"], 1)

    def test_refuses_what_it_cannot_fit(self):
        self.expect_bad_input(["fit"], "--drive")
        self.expect_bad_input(["fit", "--drive", self.folder / "none.csv"], "none.csv")
        self.expect_bad_input(["fit", "--drive", self.write("a.csv", "a,b\n1,2\n")], "a.csv:1")
        few = self.write("few.csv", made_drive(1))
        self.expect_bad_input(["fit", "--drive", few], "few.csv", "segments")
        bad = self.write("bad.csv", made_drive(5) + "99,0,0.0,nan,1,1,1,0,0,0,0,0,0\n")
        self.expect_bad_input(["fit", "--drive", bad], "bad.csv:802")
        self.expect_bad_input(["fit", "--drive", few, "--held-out", "1.5"], "--held-out")


if __name__ == "__main__":
    unittest.main()
