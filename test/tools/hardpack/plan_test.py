#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `hardpack plan` and its siblings write and print when all is well, and when there is no way."""

import json
import math
import os
import pathlib
import re
import struct
import unittest

from command_line import CommandTest, png_size

DOCUMENT = pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "docs" / "plan_json.md"


def keys_of(value, path=""):
    """Paths of all keys; a group of parameters and an array count as one."""
    if not isinstance(value, dict) or re.fullmatch(r"parameters\.\w+", path):
        return {path}
    return set().union(*(keys_of(part, f"{path}.{key}" if path else key)
                         for key, part in value.items()))


def documented_keys():
    """Those of each kind of input, by kind."""
    text = DOCUMENT.read_text()
    common, lidar, points, occupancy = re.split(r"^With `--(?:lidar|points|map)`:$", text, flags=re.M)
    rows = [re.findall(r"`([\w.]+)`", line.split("|")[1])
            for line in common.splitlines() if line.startswith("| `")]
    keys = {key for row in rows for key in row}
    by_kind = {}
    for kind, part in (("lidar", lidar), ("points", points), ("map", occupancy)):
        more = re.findall(r"`(input\.\w+)`", part)
        by_kind[kind] = keys | set(more)
    return by_kind


class PlanOnARecording(CommandTest):
    def test_says_so_in_one_line_and_writes_its_files(self):
        stdout = self.expect_done(self.lidar())
        self.assertRegex(stdout, r"^ok: \d+\.\d m, \d+\.\d s, clearance \d\.\d\d m -> .*plan\.png\n$")
        for name in ("plan.png", "costmap.png", "classes.png", "terrain.png"):
            width, height = png_size(self.out / name)
            self.assertGreater(min(width, height), 800)
        self.assertTrue(json.loads((self.out / "plan.json").read_text())["usable"])

    def test_prints_with_json_what_it_writes(self):
        printed = json.loads(self.expect_done(self.lidar() + ["--json"]))
        self.assertEqual(printed, json.loads((self.out / "plan.json").read_text()))

    def test_keys_are_those_of_the_document(self):
        self.expect_done(self.lidar())
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertEqual(keys_of(plan), documented_keys()["lidar"])

    def test_arrays_agree_with_one_another(self):
        self.expect_done(self.lidar())
        plan = json.loads((self.out / "plan.json").read_text())
        n = len(plan["x_m"])
        self.assertGreater(n, 10)
        for name, length in (("y_m", n), ("theta_rad", n), ("v_mps", n), ("phi_rad", n - 1),
                             ("dr_m", n - 1)):
            self.assertEqual(len(plan[name]), length, name)
        # Driving the steps from the start leads through the points.
        x, y, theta = plan["x_m"][0], plan["y_m"][0], plan["theta_rad"][0]
        for i, (phi, dr) in enumerate(zip(plan["phi_rad"], plan["dr_m"])):
            x, y, theta = x + math.cos(theta) * dr, y + math.sin(theta) * dr, theta + phi
            self.assertLess(math.hypot(x - plan["x_m"][i + 1], y - plan["y_m"][i + 1]), 0.01)
        self.assertLess(math.hypot(x - 22, y - 4), 0.3)
        self.assertAlmostEqual(sum(map(abs, plan["dr_m"])), plan["length_m"], places=2)
        self.assertLessEqual(plan["cost"]["after"]["total"], plan["cost"]["before"]["total"])

    def test_without_labels_still_finds_the_gap(self):
        self.expect_done(self.lidar(labels=None))
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertIsNone(plan["input"]["labels"])
        crossing = [y for x, y in zip(plan["x_m"], plan["y_m"]) if abs(x - 13) < 0.3]
        self.assertTrue(crossing and all(2.2 < y < 6.0 for y in crossing), crossing)

    def test_says_that_a_goal_was_moved_and_succeeds(self):
        stdout = self.expect_done(self.lidar(goal="13,-2"))
        self.assertRegex(stdout, r"^\w+: .*clearance")
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertTrue(plan["search"]["goal_moved"])

    # SR-GEO06: a goal where the vehicle stands is arrival
    def test_a_goal_where_the_vehicle_stands_is_arrival(self):
        stdout = self.expect_done(self.lidar(goal="0,0"))
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertLess(plan["length_m"], 0.01, stdout)
        self.assertEqual(max(plan["v_mps"], default=0.0), 0.0)

    def test_parameters_arrive(self):
        self.expect_done(self.lidar() + ["--param", "speed.max_speed_mps=3",
                                         "--param", "costmap.halo_m=1.5"])
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertEqual(plan["parameters"]["speed"]["max_speed_mps"], 3)
        self.assertEqual(plan["parameters"]["costmap"]["halo_m"], 1.5)
        self.assertLessEqual(max(plan["v_mps"]), 3)

    def test_the_same_input_gives_the_same_plan(self):
        plans = [json.loads(self.expect_done(self.lidar() + ["--json"])) for _ in range(2)]
        for plan in plans:
            del plan["stage_us"]
        self.assertEqual(*plans)


def fence_with_gap(beams):
    """(x, y, z, ring) of a scan from 1.284 m above level ground: a fence 13 m ahead, 2 m high, that is
    open from y = 2 to 6 m."""
    points = []
    for ring in range(beams):
        elevation = math.radians(15 - 30 * ring / (beams - 1))
        for step in range(0, 3600, 3):
            azimuth = math.radians(step / 10)
            x, y, z = (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth),
                       math.sin(elevation))
            ranges = [-1.284 / z] if z < 0 else []
            if x > 0:
                to_fence = 13 / x
                if not 2 < y * to_fence < 6 and z * to_fence < 2 - 1.284:
                    ranges.append(to_fence)
            if ranges and min(ranges) < 80:
                points.append((x * min(ranges), y * min(ranges), z * min(ranges), ring))
    return points


class PlanOnPoints(CommandTest):
    def expect_way_through_the_gap(self, path, rows_from, points):
        self.expect_done(["plan", "--points", path, "--goal", "22,4", "--out", self.out])
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertTrue(plan["usable"])
        self.assertEqual(plan["input"]["rows_from"], rows_from)
        self.assertEqual(plan["input"]["rows"], len({ring for _, _, _, ring in points}))
        crossing = [y for x, y in zip(plan["x_m"], plan["y_m"]) if abs(x - 13) < 0.3]
        self.assertTrue(crossing and all(2.5 < y < 5.5 for y in crossing), crossing)
        return plan

    def test_csv_with_rings(self):
        points = fence_with_gap(32)
        path = self.write("cloud.csv", "x,y,z,ring\n" + "".join(
            f"{x:.4f},{y:.4f},{z:.4f},{ring}\n" for x, y, z, ring in points))
        plan = self.expect_way_through_the_gap(path, "ring", points)
        self.assertEqual(plan["input"]["returns"], len(points))
        self.assertEqual(keys_of(plan), documented_keys()["points"])
        for name in ("plan.png", "costmap.png", "classes.png", "terrain.png"):
            self.assertGreater(min(png_size(self.out / name)), 800)

    def test_binary_pcd_without_rings(self):
        points = fence_with_gap(64)
        header = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
                  f"COUNT 1 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
                  f"POINTS {len(points)}\nDATA binary\n")
        path = self.write("cloud.pcd", header.encode() + b"".join(
            struct.pack("<4f", x, y, z, 1.0) for x, y, z, _ in points))
        self.expect_way_through_the_gap(path, "elevation", points)

    def test_a_file_that_cannot_be_read_is_named(self):
        self.expect_bad_input(["plan", "--points", self.write("cloud.csv", "x,y,z\n1,2\n"),
                               "--goal", "3,4", "--out", self.out], "cloud.csv:2", "z")
        self.expect_bad_input(["plan", "--points", self.write("cloud.xyz", "1 2 3\n"),
                               "--goal", "3,4", "--out", self.out], "cloud.xyz", ".pcd")


class PlanOnAMap(CommandTest):
    def plan(self, yaml, start="3,10,0", goal="17,10", *more):
        return ["plan", "--map", yaml, "--start", start, "--goal", goal, "--out", self.out, *more]

    def walled(self, low, high):
        """A wall at x = 10 m, but for y = low .. high [cells of 0.2 m, from below]."""
        rows = [bytes(0 if column in (49, 50) and not low <= row < high else 254
                      for column in range(100)) for row in range(100)]
        return b"".join(reversed(rows))

    def test_keys_are_those_of_the_document(self):
        self.expect_done(self.plan(self.map_file()))
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertEqual(keys_of(plan), documented_keys()["map"])

    def test_goes_through_the_gap(self):
        self.expect_done(self.plan(self.map_file(self.walled(65, 90))))
        plan = json.loads((self.out / "plan.json").read_text())
        crossing = [y for x, y in zip(plan["x_m"], plan["y_m"]) if abs(x - 10) < 0.3]
        self.assertTrue(crossing and all(13.0 + 0.69 < y < 18.0 - 0.69 for y in crossing), crossing)

    def test_has_no_path_through_a_wall(self):
        result = self.run_command(*self.plan(self.map_file(self.walled(0, 0))))
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^hardpack plan: no_path: .*\n$")
        plan = json.loads((self.out / "plan.json").read_text())
        self.assertEqual((plan["status"], plan["usable"]), ("no_path", False))
        self.assertGreater(png_size(self.out / "plan.png")[0], 800)

    def test_turns_on_the_spot_when_the_goal_is_behind(self):
        self.expect_done(self.plan(self.map_file(), "17,10,0", "3,10"))
        self.assertTrue(json.loads((self.out / "plan.json").read_text())["pivots_first"])

    def test_unknown_is_closed_on_request(self):
        pixels = self.walled(0, 0).replace(b"\0", bytes([205]))
        yaml = self.map_file(pixels)
        self.expect_done(self.plan(yaml))
        self.assertEqual(self.run_command(*self.plan(yaml), "--unknown", "hard").returncode, 1)

    def test_goal_off_the_window_of_a_large_map_uses_the_nearest_cell(self):
        yaml = self.map_file(width=1000, height=100)  # 200 x 20 m
        stdout = self.expect_done(self.plan(yaml, "10,10,0", "190,10"))
        self.assertTrue(json.loads((self.out / "plan.json").read_text())["search"]
                        ["goal_outside_map"], stdout)


class OtherCommands(CommandTest):
    def test_every_command_has_help(self):
        for command in ([], ["plan"], ["figures"], ["bench"], ["bench", "movingai"], ["scene"]):
            stdout = self.expect_done(command + ["--help"])
            self.assertIn("Usage", stdout)
        self.assertIn("rad", self.expect_done(["plan", "--help"]))

    def test_figures_are_pictures(self):
        self.expect_done(["figures", "--out", self.out])
        for name in ("path_around_square", "perturbation", "costmap_panels"):
            self.assertGreater(png_size(self.out / f"{name}.png")[0], 1000)


if __name__ == "__main__":
    unittest.main()
