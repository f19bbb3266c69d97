#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `hardpack bench` measures, prints and refuses."""

import json
import unittest

from command_line import CommandTest

ON_OPEN = ("--scene", "open")


class Bench(CommandTest):
    def report(self, *arguments):
        return json.loads(self.expect_done(["bench", "--json", *arguments]))

    def test_every_stage_has_a_row_and_none_allocates(self):
        report = self.report("decode", "sample", "speed", "check", *ON_OPEN)
        self.assertEqual([row["stage"] for row in report["rows"]],
                         ["decode", "sample", "speed", "check"])
        for row in report["rows"]:
            self.assertEqual(row["allocations"], 0)
            self.assertLessEqual(row["median_us"], row["p99_us"])
            self.assertLessEqual(row["p99_us"], row["worst_us"])
            self.assertGreater(row["object_bytes"], 0)
            self.assertGreater(row["repetitions"], 10)
        speed = report["rows"][2]
        self.assertEqual((speed["scene"], speed["status"]), ("open", "ok"))
        self.assertAlmostEqual(speed["points"], 200, delta=10)

    def test_a_peer_stands_beside_the_stage_where_it_is_installed(self):
        report = self.report("costmap", "astar", *ON_OPEN)
        for stage, peer in (("costmap", "opencv"), ("astar", "boost")):
            row = next(row for row in report["rows"]
                       if (row["stage"], row["scene"]) == (stage, "open"))
            names = [figure["name"] for figure in row["peers"]]
            self.assertEqual(names, [peer] if peer in report["peers"] else [])
            for figure in row["peers"]:
                self.assertGreater(figure["median_us"], 0)
                self.assertGreater(figure["ratio"], 0)

    def test_what_is_promised_and_was_not_measured_is_neither_kept_nor_broken(self):
        report = self.report("speed", *ON_OPEN)
        met = {line["promise"].split(":")[0]: line["met"] for line in report["acceptance"]}
        self.assertIsNone(met["optimizer"])
        self.assertIn(met["speed"], (True, False))

    def test_a_map_without_a_way_still_has_its_costmap(self):
        report = self.report("costmap", "astar", "--scene", "full")
        self.assertEqual({(row["stage"], row["scene"]) for row in report["rows"]},
                         {("costmap", "revolution"), ("costmap", "full")})

    def test_a_narrow_map_is_searched_without_dilation_and_says_so(self):
        text = self.expect_done(["bench", "sample", "--scene", "comb", *ON_OPEN])
        self.assertIn("comb *", text)
        self.assertNotIn("open *", text)
        self.assertIn("not dilated", text)

    def test_prints_tables(self):
        text = self.expect_done(["bench", "speed", "--markdown", *ON_OPEN])
        tables = [line for line in text.splitlines() if line.startswith("|---")]
        self.assertEqual(len(tables), 2)
        self.assertIn("| speed | 1 |", text)

    def test_takes_movingai_maps_of_a_folder(self):
        folder = self.folder / "movingai"
        folder.mkdir()
        board = "type octile\nheight 40\nwidth 100\nmap\n" + (100 * "." + "\n") * 40
        (folder / "field.map").write_text(board)
        problem = "0\tfield.map\t100\t40\t10\t20\t90\t20\t80\n"
        (folder / "field.map.scen").write_text("version 1\n" + problem)
        report = self.report("astar", "--data", self.folder, "--scene", "field")
        row = report["rows"][0]
        self.assertEqual((row["scene"], row["status"], row["queries"]), ("field", "ok", 1))
        self.assertTrue(row["dilated"])
        self.assertEqual(report["data"], str(self.folder))

    def test_refuses_what_it_does_not_know(self):
        self.expect_bad_input(["bench", "--scene", "forrest"], "--scene", "'forest'")
        self.expect_bad_input(["bench", "--data", self.folder], "--data", self.folder)
        self.expect_bad_input(["bench", "--json", "--markdown"], "--markdown")


class Movingai(CommandTest):
    def test_tells_a_wrong_length_from_a_right_one(self):
        # 4 x 1 cells, all free: three straight steps.
        board = self.write("a.map", "type octile\nheight 1\nwidth 4\nmap\n....\n")
        line = "0\ta.map\t4\t1\t0\t0\t3\t0\t"
        right = self.write("right.scen", "version 1\n" + line + "3.00000000\n")
        wrong = self.write("wrong.scen", "version 1\n" + line + "4.00000000\n")
        report = json.loads(self.expect_done(["bench", "movingai", board, right, "--json"]))
        self.assertEqual((report["solved"], report["mismatches"]), (1, 0))
        result = self.run_command("bench", "movingai", board, wrong)
        self.assertEqual(result.returncode, 1)
        self.assertIn("1 mismatches", result.stderr)


if __name__ == "__main__":
    unittest.main()
