#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What tools/proof/fuzz.sh makes of a target that is fine, and of ones that are not: scripts in their
place, and a cmake that builds nothing."""

import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["HARDPACK_SOURCE"])
# libFuzzer's words of a run, and of one over the seeds alone, in which labels are accepted.
FINE = """
if [ -n "${HARDPACK_FUZZ_ACCEPTED:-}" ]; then echo "labels 3" >"$HARDPACK_FUZZ_ACCEPTED"; exit 0; fi
echo '#9 DONE cov: 120 ft: 300 corp: 5/100b'
echo 'stat::number_of_executed_units: 900'
"""


class Fuzz(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.script("bin/cmake", "")

    def script(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("#!/bin/bash\n" + text)
        path.chmod(0o755)

    def fuzz(self, target, name="labels"):
        self.script(f"build/test/fuzz/{name}_fuzz", target)
        environment = dict(os.environ, PATH=f"{self.folder}/bin:{os.environ['PATH']}")
        done = subprocess.run(
            [SOURCE / "tools" / "proof" / "fuzz.sh", "--minutes", "0.1", "--build", self.folder / "build",
             "--data", self.folder / "none", name],
            env=environment, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    def test_one_that_runs_and_accepts_its_seeds_is_fine(self):
        code, said = self.fuzz(FINE)
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"labels +fine +900 runs in \d+ s, 120 edges, seeds of 1 kinds")

    def test_one_whose_seeds_are_all_recordings_needs_none(self):
        code, said = self.fuzz(FINE, "ouster")
        self.assertEqual(code, 0, said)
        self.assertIn("seeds of 0 kinds", said)

    def test_one_that_ends_with_a_failure_has_failed(self):
        code, said = self.fuzz(FINE + "exit 77\n")
        self.assertEqual(code, 1)
        self.assertRegex(said, r"labels +FAILED")

    def test_one_that_does_not_run_has_failed(self):
        for words in ("stat::number_of_executed_units", "DONE"):
            silent = "\n".join(line for line in FINE.splitlines() if words not in line)
            code, said = self.fuzz(silent)
            self.assertEqual(code, 1, words)
            self.assertRegex(said, r"labels +FAILED")
        self.assertEqual(self.fuzz(FINE.replace("units: 900", "units: 0"))[0], 1)

    def test_one_that_refuses_its_seeds_has_failed(self):
        for refusal in ("other 3", "labels 0"):
            code, said = self.fuzz(FINE.replace("labels 3", refusal))
            self.assertEqual(code, 1, refusal)
            self.assertIn("accepts none of its seeds of the kind labels", said)

    def test_seeds_of_a_run_before_are_not_tried(self):
        old = self.folder / "build" / "seeds" / "labels" / "old_0001"
        old.parent.mkdir(parents=True)
        old.write_bytes(b"x")
        self.assertEqual(self.fuzz(FINE)[0], 0)
        self.assertFalse(old.exists())


if __name__ == "__main__":
    unittest.main()
