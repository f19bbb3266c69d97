#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `hardpack bench quality` prints and draws."""

import json
import unittest

from command_line import CommandTest, png_size

SOLVERS = ("astar", "paper", "paper_converged", "hardpack")
FEW = ("bench", "quality", "--problems", "2")


class Quality(CommandTest):
    def test_prints_a_table_and_the_comparison(self):
        stdout = self.expect_done(FEW)
        self.assertRegex(stdout, r"(?m)^A\* alone +mean( +-?\d+(\.\d+)?){12}$")
        self.assertRegex(stdout, r"(?m)^hardpack +mean( +-?\d+(\.\d+)?){12}$")
        self.assertRegex(stdout, r"(?m)^hardpack beside paper, converged: F equal or lower on "
                                 r"[012] of 2 ")

    def test_json_has_every_problem_and_solver(self):
        result = json.loads(self.expect_done(FEW + ("--json",)))
        self.assertEqual([problem["number"] for problem in result["problems"]], [1, 2])
        for problem in result["problems"]:
            for solver in SOLVERS:
                run = problem["solvers"][solver]
                self.assertTrue(run["usable"], solver)
                self.assertAlmostEqual(run["cost"], run["map_cost"] + run["path_cost"], places=3)
                self.assertGreater(run["length_m"], 40.0)
                self.assertEqual(run["allocations"], 0)
            seed_cost = problem["solvers"]["astar"]["cost"]
            self.assertLess(problem["solvers"]["hardpack"]["cost"], seed_cost)
        for solver in SOLVERS:
            self.assertEqual(result["summary"][solver]["collisions"],
                             sum(problem["solvers"][solver]["collides"]
                                 for problem in result["problems"]))

    def test_measures_do_not_depend_on_the_run(self):
        def measures():
            result = json.loads(self.expect_done(FEW + ("--json",)))
            for problem in result["problems"]:
                for solver in SOLVERS:
                    problem["solvers"][solver].pop("median_us")
            return [{solver: problem["solvers"][solver] for solver in SOLVERS}
                    for problem in result["problems"]]
        self.assertEqual(measures(), measures())

    def test_draws_pictures(self):
        self.expect_done(FEW + ("--out", self.out))
        names = sorted(path.name for path in self.out.iterdir())
        self.assertEqual(names, ["quality_001.png", "quality_002.png"])
        for name in names:
            self.assertGreater(min(png_size(self.out / name)), 1000)

    def test_takes_single_problems(self):
        result = json.loads(self.expect_done(("bench", "quality", "--problem", "42", "--json")))
        self.assertEqual([problem["number"] for problem in result["problems"]], [42])

    def test_bad_usage(self):
        self.expect_bad_input(("bench", "quality", "--problems", "0"), "--problems")
        self.expect_bad_input(("bench", "quality", "--seed", "x"), "--seed")
        self.expect_bad_input(FEW + ("--out", self.write("file", "")), "--out")


if __name__ == "__main__":
    unittest.main()
