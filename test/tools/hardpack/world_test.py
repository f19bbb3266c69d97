#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""hardpack world: each of the worlds and a map as a picture, and one line for what is none."""

import unittest

from command_line import CommandTest

NAMES = ("gap", "rock_pile", "hill", "forest", "corridor", "crossing", "dead_end", "ditch", "open",
         "thicket", "tight_start", "back_out", "low", "low_bare", "corner",
         "corner_ditch")


class World(CommandTest):
    def draw(self, *arguments):
        result = self.run_command("world", *arguments, "--out", self.out)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(result.stdout.startswith("ok: "), result.stdout)
        return (self.out / "world.png").read_bytes()

    def test_each(self):
        for name in NAMES:
            with self.subTest(name):
                self.assertTrue(self.draw(name).startswith(b"\x89PNG"))

    def test_with_slope(self):
        for name in ("side_slope", "downhill_stop:15", "gap:10"):
            with self.subTest(name):
                self.assertTrue(self.draw(name).startswith(b"\x89PNG"))

    def test_the_same_for_the_same_seed_only(self):
        first = self.draw("rock_pile", "--seed", 3)
        self.assertEqual(first, self.draw("rock_pile", "--seed", 3))
        self.assertNotEqual(first, self.draw("rock_pile", "--seed", 4))

    def test_a_map(self):
        pixels = bytearray([254]) * 10000
        pixels[5000:5050] = bytes(50)
        self.draw(self.map_file(bytes(pixels)), "--start", "5,5,0.5", "--goal", "15,15")

    def test_names_what_is_wrong(self):
        self.expect_bad_input(["world", "moon", "--out", self.out], "moon", "rock_pile")
        self.expect_bad_input(["world", "gap:99", "--out", self.out], "gap:99", "degrees")
        self.expect_bad_input(["world", "absent.yaml", "--out", self.out], "absent.yaml")
        self.expect_bad_input(["world", self.map_file(), "--start", "x", "--out", self.out],
                              "--start")
        self.expect_bad_input(["world", "gap"], "--out")
        self.expect_bad_input(["world", "gap", "--seed", "-1", "--out", self.out], "--seed")


if __name__ == "__main__":
    unittest.main()
