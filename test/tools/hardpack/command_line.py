# SPDX-License-Identifier: Apache-2.0
"""Runs the hardpack command as a user does, and makes small inputs for it."""

import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

COMMAND = os.environ["HARDPACK_COMMAND"]
SKIPPED = 77  # what CTest takes as "skipped"


class CommandTest(unittest.TestCase):
    """A test with a folder of its own and a recording made once for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="hardpack_cli_"))
        cls.scene = cls.shared / "scene"
        subprocess.run([COMMAND, "scene", "--out", cls.scene], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.shared))
        self.out = self.folder / "out"

    def run_command(self, *arguments):
        return subprocess.run([COMMAND, *map(str, arguments)], capture_output=True, text=True,
                              timeout=100)

    def lidar(self, **changed):
        """The arguments of a plan on the recording, some of them changed or (None) left out."""
        options = {"lidar": self.scene / "scan.pcap", "metadata": self.scene / "scan.json",
                   "labels": self.scene / "labels.csv", "goal": "22,4", "out": self.out}
        options.update(changed)
        return ["plan"] + [word for name, value in options.items() if value is not None
                           for word in (f"--{name}", value)]

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def map_file(self, pixels=None, width=100, height=100, **changed):
        """A map of 20 x 20 m that is free, or of the given grey values."""
        pixels = bytes([254]) * (width * height) if pixels is None else pixels
        self.write("map.pgm", b"P5\n%d %d\n255\n" % (width, height) + pixels)
        keys = {"image": "map.pgm", "resolution": "0.2", "origin": "[0, 0, 0]", "negate": "0",
                "occupied_thresh": "0.65", "free_thresh": "0.196"}
        keys.update(changed)
        return self.write("map.yaml", "".join(f"{key}: {value}\n" for key, value in keys.items()
                                              if value is not None))

    def expect_bad_input(self, arguments, *parts):
        """Exit code 2, nothing on stdout, one line on stderr that has each of the parts."""
        result = self.run_command(*arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for part in parts:
            self.assertIn(str(part), result.stderr)

    def expect_done(self, arguments):
        result = self.run_command(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        return result.stdout


def png_size(path):
    """Width and height of a PNG, after its signature was checked."""
    head = pathlib.Path(path).read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n", path
    return struct.unpack(">II", head[16:24])
