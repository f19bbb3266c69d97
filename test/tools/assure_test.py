#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What tools/assure.py writes of commands that succeed, fail, or print no figure, and what it resumes."""

import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "tools"))
import assure  # noqa: E402

COUNT = 'echo run >> "$RUNS"; '


class Assure(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        os.environ["RUNS"] = str(self.folder / "runs")
        assure.LOGS = self.folder / "logs"
        assure.revision = lambda: "abc"

    def assure(self, command, promise, *options):
        """(exit code, the page)"""
        assure.measurements = lambda _: [assure.Measurement("one", command, [promise])]
        with contextlib.redirect_stdout(io.StringIO()):
            code = assure.main(["--out", str(self.folder / "page.md"), *options])
        return code, (self.folder / "page.md").read_text("utf-8")

    def runs(self):
        return (self.folder / "runs").read_text("utf-8").count("run")

    def test_a_kept_promise_has_its_figure_and_command(self):
        code, page = self.assure("echo took 12 of 16", assure.Promise("little", r"took (\d+)", "16"))
        self.assertEqual(code, 0)
        self.assertIn("| little | 12 | 16 | kept | `echo took 12 of 16` |", page)
        self.assertIn("1 of 1 promises kept", page)

    def test_a_failed_command_keeps_nothing_whatever_it_printed(self):
        code, page = self.assure("echo took 12; false", assure.Promise("little", r"took (\d+)", "16"))
        self.assertEqual(code, 1)
        self.assertIn("| 12 | 16 | **NOT KEPT** |", page)

    def test_a_failure_within_a_pipe_counts(self):
        code, _ = self.assure("(echo took 12; false) | cat", assure.Promise("", r"took (\d+)", ""))
        self.assertEqual(code, 1)

    def test_a_figure_that_is_missing_is_not_kept(self):
        code, page = self.assure("echo nothing", assure.Promise("little", r"took (\d+)", "16"))
        self.assertEqual(code, 1)
        self.assertIn("| little | - | 16 | **NOT KEPT** |", page)

    def test_skipped_tests_are_told(self):
        command = ("echo '100% tests passed, 0 tests failed out of 7'; echo 'did not run:'; "
                   "echo '  3 - core/a.B (Skipped)'; echo '  5 - core/a.C (Skipped)'")
        _, page = self.assure(command, assure.Promise("all", assure.PASSED, "all"))
        self.assertIn("out of 7; 2 of them skipped", page)

    def test_resume_reads_what_has_succeeded(self):
        promise = assure.Promise("little", r"took (\d+)", "16")
        command = COUNT + "echo took 12"
        first = self.assure(command, promise)
        again = self.assure(command, promise, "--resume")
        self.assertEqual(self.runs(), 1)
        self.assertEqual(again[0], first[0])
        self.assertIn("| little | 12 | 16 | kept |", again[1])
        self.assure(command, promise)
        self.assertEqual(self.runs(), 2)

    def test_resume_runs_again_what_failed(self):
        promise = assure.Promise("little", r"took (\d+)", "16")
        self.assure(COUNT + "false", promise)
        self.assure(COUNT + "false", promise, "--resume")
        self.assertEqual(self.runs(), 2)

    def test_resume_runs_again_where_sources_or_command_differ(self):
        promise = assure.Promise("little", r"took (\d+)", "16")
        self.assure(COUNT + "echo took 12", promise)
        self.assure(COUNT + "echo took 13", promise, "--resume")
        self.assertEqual(self.runs(), 2)
        assure.revision = lambda: "def"
        self.assure(COUNT + "echo took 13", promise, "--resume")
        self.assertEqual(self.runs(), 3)

    def test_resume_trusts_no_uncommitted_sources(self):
        promise = assure.Promise("little", r"took (\d+)", "16")
        assure.revision = lambda: "abc-dirty"
        self.assure(COUNT + "echo took 12", promise)
        self.assure(COUNT + "echo took 12", promise, "--resume")
        self.assertEqual(self.runs(), 2)

    def test_a_name_that_is_not_known_is_bad_usage(self):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(assure.main(["--only", "nonsense"]), 2)
        self.assertIn("nonsense", said.getvalue())


if __name__ == "__main__":
    unittest.main()
