#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plans on a real, labelled scan, judged by the labelled points themselves.

Nothing of the map or of the library's check is used: the vehicle's rectangle is swept along the
poses of plan.json, and no hard return from 0.5 m to 2 m above the local ground may lie in it.
"""

import csv
import json
import math
import os
import pathlib
import sys
import unittest

from command_line import SKIPPED, CommandTest

DATA = pathlib.Path(os.environ.get("HARDPACK_DATA", "")) / "rellis"
CAPTURE = DATA / "rellis_000104_os1-64_2048x10_legacy_reencoded.pcap"
LABELS = DATA / "rellis_000104_labelled.csv"

GROUND = {1, 3, 10, 23}
HARD = {4, 5, 6, 8, 9, 12, 15, 17, 18, 27, 34}
VEHICLE = 0  # void: the vehicle itself
BEHIND_M = 2.7  # what the recorded vehicle carries behind itself reaches so far
HALF_LENGTH_M = 1.52 / 2
HALF_WIDTH_M = 1.38 / 2
GROUND_RADIUS_M = 1.5
BUCKET_M = 1.5


class Points:
    """Points of the plane in square buckets."""

    def __init__(self, points):
        self.buckets = {}
        for point in points:
            self.buckets.setdefault(self.bucket(point[0], point[1]), []).append(point)

    @staticmethod
    def bucket(x, y):
        return math.floor(x / BUCKET_M), math.floor(y / BUCKET_M)

    def near(self, x, y, radius):
        """Those within the radius, which is at most a bucket's side."""
        column, row = self.bucket(x, y)
        for i in (column - 1, column, column + 1):
            for j in (row - 1, row, row + 1):
                for point in self.buckets.get((i, j), ()):
                    if math.hypot(point[0] - x, point[1] - y) <= radius:
                        yield point


def obstacles_of(path):
    """Hard returns from 0.5 m to 2 m above the lowest ground return within 1.5 m, or, where there
    is none, the lowest return of any class."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))[1:]
    returns = [(float(r[0]), float(r[1]), float(r[2]), int(r[9])) for r in rows]
    returns = [r for r in returns if r[3] != VEHICLE]
    everything = Points(returns)
    ground = Points([r for r in returns if r[3] in GROUND])
    obstacles = []
    for x, y, z, label in returns:
        if label not in HARD:
            continue
        below = [p[2] for p in ground.near(x, y, GROUND_RADIUS_M)]
        below = below or [p[2] for p in everything.near(x, y, GROUND_RADIUS_M)]
        if 0.5 <= z - min(below) <= 2.0:
            obstacles.append((x, y))
    return Points(obstacles)


def swept_poses(plan):
    """Poses along the path, at most 5 cm and 0.05 rad apart, turns on the spot included."""
    poses = list(zip(plan["x_m"], plan["y_m"], plan["theta_rad"]))
    for (x0, y0, t0), (x1, y1, t1) in zip(poses, poses[1:]):
        turn = math.remainder(t1 - t0, 2 * math.pi)
        pieces = 1 + math.ceil(max(math.hypot(x1 - x0, y1 - y0) / 0.05, abs(turn) / 0.05))
        for k in range(pieces + 1):
            share = k / pieces
            yield x0 + share * (x1 - x0), y0 + share * (y1 - y0), t0 + share * turn


def touched(plan, obstacles):
    """The first pose and point that touch, or None."""
    reach = math.hypot(HALF_LENGTH_M, HALF_WIDTH_M)
    for x, y, theta in swept_poses(plan):
        cosine, sine = math.cos(theta), math.sin(theta)
        for px, py in obstacles.near(x, y, reach):
            ahead = cosine * (px - x) + sine * (py - y)
            left = -sine * (px - x) + cosine * (py - y)
            if abs(ahead) <= HALF_LENGTH_M and abs(left) <= HALF_WIDTH_M:
                return (x, y, theta), (px, py)
    return None


class PlanOnRellis(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.obstacles = obstacles_of(LABELS)

    def plan_to(self, goal):
        self.expect_done(self.lidar(lidar=CAPTURE, metadata=CAPTURE.with_suffix(".json"),
                                    labels=LABELS, goal=goal,
                                    param=f"mount.self_min_x_m=-{BEHIND_M}"))
        return json.loads((self.out / "plan.json").read_text())

    def test_the_check_itself_sees_a_collision(self):
        # The person at about (10.4, 2.0) is driven through on purpose.
        plan = {"x_m": [8.0, 12.0], "y_m": [2.0, 2.0], "theta_rad": [0.0, 0.0]}
        self.assertIsNotNone(touched(plan, self.obstacles))

    def test_the_goals_ahead(self):
        for goal in ("12,12", "10,15", "28,2"):
            with self.subTest(goal=goal):
                self.expect_clear_way(goal, pivots_first=False)

    def test_the_goals_behind_begin_with_a_turn_on_the_spot(self):
        for goal in ("-12,-12", "-15,0"):
            with self.subTest(goal=goal):
                self.expect_clear_way(goal, pivots_first=True)

    def test_where_that_would_sweep_what_stands_beside_it_drives_off_first(self):
        # What is labelled void stands 0.8 m from the left flank: a label does not clear it away.
        self.expect_clear_way("-12,12", pivots_first=False)

    def expect_clear_way(self, goal, pivots_first):
        plan = self.plan_to(goal)
        self.assertIsNone(touched(plan, self.obstacles))
        self.assertEqual(plan["pivots_first"], pivots_first)
        x, y = map(float, goal.split(","))
        self.assertLess(math.hypot(plan["x_m"][-1] - x, plan["y_m"][-1] - y), 1.0)


if __name__ == "__main__":
    if not (CAPTURE.exists() and LABELS.exists()):
        print(f"skipped: {DATA} is not there (set HARDPACK_DATA)")
        sys.exit(SKIPPED)
    unittest.main()
