#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The check of instruction counts sees what it is for: planted slow-downs among them."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "tools" / "proof"
sys.path.insert(0, str(TOOLS))

import check_instructions  # pylint: disable=wrong-import-position

# A valgrind that counts what the driver's lines say: "stage scene count".
FAKE_VALGRIND = """#!/usr/bin/env python3
import subprocess, sys
out = [a.split("=", 1)[1] for a in sys.argv if a.startswith("--callgrind-out-file=")][0]
lines = subprocess.run(sys.argv[-1], capture_output=True, text=True).stdout.splitlines()
print("\\n".join(lines[:2] + [line.rsplit(" ", 1)[0] for line in lines[2:]]))
for part, line in enumerate(lines[2:], 1):
    open(f"{out}.{part}", "w").write(f"events: Ir\\ntotals: {line.rsplit(' ', 1)[1]}\\n")
"""


class Compare(unittest.TestCase):
    def test_lets_small_changes_pass(self):
        self.assertEqual(check_instructions.compare({"astar maze": 1000}, {"astar maze": 1029}), [])
        self.assertEqual(check_instructions.compare({"astar maze": 1000}, {"astar maze": 901}), [])

    def test_sees_a_slow_down(self):
        faults = check_instructions.compare({"astar maze": 1000, "speed maze": 10},
                                            {"astar maze": 1031, "speed maze": 10})
        self.assertEqual(len(faults), 1)
        self.assertIn("astar maze: 1031", faults[0])
        self.assertIn("slow-down", faults[0])

    def test_asks_to_renew_what_has_become_useless(self):
        self.assertIn("--update", check_instructions.compare({"a b": 1000}, {"a b": 899})[0])
        self.assertIn("--update", check_instructions.compare({"a b": 1}, {"a b": 1, "c d": 1})[0])
        self.assertIn("--update", check_instructions.compare({"a b": 1, "c d": 1}, {"a b": 1})[0])


class Script(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.executable("valgrind", FAKE_VALGRIND)
        self.counts = self.folder / "counts.txt"

    def tearDown(self):
        self.temporary.cleanup()

    def executable(self, name, text):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return path

    def check(self, counts, *options, compiler="GNU-1", path=None):
        lines = [f"compiler {compiler}", "processor any"]
        lines += [f"stage{i} map {count}" for i, count in enumerate(counts)]
        driver = self.executable("driver", "#!/bin/sh\necho '" + "\n".join(lines) + "'\n")
        path = f"{self.folder}:{os.environ['PATH']}" if path is None else path
        return subprocess.run([sys.executable, TOOLS / "check_instructions.py", driver, "--counts",
                               self.counts, *options], capture_output=True, text=True,
                              env={**os.environ, "PATH": path})

    def test_writes_the_file_that_it_then_agrees_with(self):
        counts = list(range(1000, 1012))  # more than nine: parts are ordered by number
        self.assertEqual(self.check(counts, "--update").returncode, 0)
        self.assertIn("stage11 map 1011", self.counts.read_text())
        self.assertEqual(self.check(counts).returncode, 0)

    def test_fails_on_a_slow_down(self):
        self.check([1000, 2000], "--update")
        result = self.check([1000, 2100])
        self.assertEqual(result.returncode, 1)
        self.assertIn("stage1 map: 2100", result.stdout)

    def test_skips_what_is_not_comparable(self):
        self.check([1000], "--update")
        other = self.check([2000], compiler="GNU-2")
        self.assertEqual((other.returncode, "GNU-2" in other.stdout), (77, True))
        without = self.check([2000], path=str(self.folder / "nowhere"))
        self.assertEqual((without.returncode, "valgrind" in without.stdout), (77, True))


if __name__ == "__main__":
    unittest.main()
