#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with the input or the usage: one line that names it, exit code 2, no crash."""

import unittest

from command_line import CommandTest


class BadCapture(CommandTest):
    def test_missing(self):
        self.expect_bad_input(self.lidar(lidar=self.folder / "absent.pcap"), "absent.pcap")

    def test_not_a_pcap(self):
        path = self.write("text.pcap", "this is no capture\n" * 50)
        self.expect_bad_input(self.lidar(lidar=path), "text.pcap")

    def test_empty(self):
        self.expect_bad_input(self.lidar(lidar=self.write("empty.pcap", b"")), "empty.pcap")

    def test_truncated_before_a_packet_is_whole(self):
        whole = (self.scene / "scan.pcap").read_bytes()
        for length in (10, 24, 30, 5000):
            path = self.write(f"cut_{length}.pcap", whole[:length])
            self.expect_bad_input(self.lidar(lidar=path), path.name)

    def test_a_folder(self):
        self.expect_bad_input(self.lidar(lidar=self.folder), self.folder)

    def test_corrupted_bytes_do_not_crash(self):
        whole = bytearray((self.scene / "scan.pcap").read_bytes())
        for i in range(24, len(whole), 997):
            whole[i] ^= 0xA5
        path = self.write("corrupted.pcap", bytes(whole))
        result = self.run_command(*self.lidar(lidar=path))
        self.assertIn(result.returncode, (0, 1, 2))
        self.assertNotIn("Sanitizer", result.stderr)


class BadMetadata(CommandTest):
    def test_missing(self):
        self.expect_bad_input(self.lidar(metadata=self.folder / "absent.json"), "absent.json")

    def test_not_given(self):
        self.expect_bad_input(self.lidar(metadata=None), "--metadata")

    def test_corrupted(self):
        whole = (self.scene / "scan.json").read_text()
        for name, text in (("cut.json", whole[: len(whole) // 2]), ("list.json", "[1, 2]"),
                           ("empty.json", ""), ("deep.json", "[" * 100000),
                           ("word.json", whole.replace("1024", '"many"'))):
            self.expect_bad_input(self.lidar(metadata=self.write(name, text)), name)

    def test_names_the_field(self):
        text = (self.scene / "scan.json").read_text().replace("beam_altitude_angles", "altitudes")
        path = self.write("renamed.json", text)
        self.expect_bad_input(self.lidar(metadata=path), "renamed.json", "beam_altitude_angles")


class BadLabels(CommandTest):
    def test_missing(self):
        self.expect_bad_input(self.lidar(labels=self.folder / "absent.csv"), "absent.csv")

    def test_corrupted(self):
        self.expect_bad_input(self.lidar(labels=self.write("words.csv", "a,b\nc,d\n")), "words.csv")
        text = "ring,meas_id,label\n0,0,4\n64,0,4\n"
        self.expect_bad_input(self.lidar(labels=self.write("ring.csv", text)), "ring.csv", "ring")


class BadGoalAndStart(CommandTest):
    def test_goal_that_is_no_point(self):
        for goal in ("nan,3", "3,inf", "3", "3,4,5,6", "a,b", "3,", ",3", "", "1e30,3", "3;4"):
            self.expect_bad_input(self.lidar(goal=goal), "--goal")

    def test_goal_missing(self):
        self.expect_bad_input(self.lidar(goal=None), "--goal")

    def test_start_that_is_no_pose(self):
        for start in ("1,2", "1,2,nan", "x,0,0"):
            self.expect_bad_input(self.lidar(start=start), "--start")

    def test_goal_in_an_obstacle_that_may_not_be_moved(self):
        self.expect_bad_input(
            self.lidar(goal="13,-2", param="astar.move_goal_out_of_obstacle=0"), "--goal",
            "goal_in_obstacle")


class BadMap(CommandTest):
    def plan(self, yaml, start="5,5,0", goal="15,5"):
        return ["plan", "--map", yaml, "--start", start, "--goal", goal, "--out", self.out]

    def test_missing_or_wrong_files(self):
        self.expect_bad_input(self.plan(self.folder / "absent.yaml"), "absent.yaml")
        self.expect_bad_input(self.plan(self.map_file(image="absent.pgm")), "absent.pgm", "map.yaml")
        self.expect_bad_input(self.plan(self.scene / "scan.pcap"), "scan.pcap")

    def test_wrong_size(self):
        self.expect_bad_input(self.plan(self.map_file(width=90, pixels=bytes(89 * 100))), "map.pgm",
                              "90 x 100")

    def test_wrong_type(self):
        yaml = self.map_file()
        self.write("map.pgm", b"P6\n1 1\n255\nabc")
        self.expect_bad_input(self.plan(yaml), "map.pgm")

    def test_names_the_key(self):
        for key, value in (("resolution", "0"), ("resolution", "-0.1"), ("resolution", ".nan"),
                           ("resolution", None), ("origin", "[0, 0, 1]"), ("origin", "[0]"),
                           ("negate", "maybe"), ("occupied_thresh", "7"), ("mode", "raw")):
            self.expect_bad_input(self.plan(self.map_file(**{key: value})), "map.yaml", key)

    def test_start_or_goal_off_the_map(self):
        yaml = self.map_file()
        self.expect_bad_input(self.plan(yaml, goal="25,5"), "--goal", "map.yaml")
        self.expect_bad_input(self.plan(yaml, start="-1,5,0"), "--start", "map.yaml")

    def test_start_missing(self):
        self.expect_bad_input(["plan", "--map", self.map_file(), "--goal", "3,4", "--out", self.out],
                              "--start")


class BadUsage(CommandTest):
    def test_unknown_options_and_commands(self):
        self.expect_bad_input(self.lidar() + ["--fast"], "--fast")
        self.expect_bad_input(["plam"], "'plam'", "'plan'")
        self.expect_bad_input(["--fast"], "--fast")
        self.expect_bad_input([])
        self.expect_bad_input(["bench", "costmaps"], "costmaps", "'costmap'")
        self.expect_bad_input(["figures"], "--out")
        self.expect_bad_input(["scene", "--out", self.out, "--seed", "many"], "--seed")

    def test_both_inputs_or_none(self):
        self.expect_bad_input(self.lidar(map=self.map_file()), "--map")
        self.expect_bad_input(["plan", "--goal", "3,4", "--out", self.out], "--lidar")

    def test_out_missing_or_in_the_way(self):
        self.expect_bad_input(self.lidar(out=None), "--out")
        file = self.write("file", "x")
        self.expect_bad_input(self.lidar(out=file), "--out", file)
        self.expect_bad_input(self.lidar(out=file / "below"), "--out", file)
        self.expect_bad_input(["figures", "--out", file / "below"], "--out")

    def test_out_that_takes_no_file(self):
        self.out.mkdir()
        (self.out / "plan.json").mkdir()
        self.expect_bad_input(self.lidar(), "plan.json")

    def test_parameters(self):
        for value, *parts in (("costmap.halo=1", "costmap.halo", "'costmap.halo_m'"),
                              ("halo_m", "GROUP.NAME=VALUE"),
                              ("costmap.halo_m=wide", "costmap.halo_m", "wide"),
                              ("costmap.halo_m=nan", "costmap.halo_m"),
                              ("costmap.halo_m=1000", "costmap.halo_m", "0 .. 3"),
                              ("optimizer.window_steps=2.5", "optimizer.window_steps", "whole"),
                              ("speed.min_speed_mps=5.5", "speed.min_speed_mps")):
            self.expect_bad_input(self.lidar(param=value), "--param", *parts)

    def test_movingai_files(self):
        self.expect_bad_input(["bench", "movingai", self.folder / "a.map", self.folder / "a.scen"],
                              "a.map")


if __name__ == "__main__":
    unittest.main()
