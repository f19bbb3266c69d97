#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What tools/proof/assure.py writes of commands that succeed, fail, or print no figure, and what it resumes."""

import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "tools" / "proof"))
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
        assure.measurements = lambda _: [assure.Measurement("one", "The one", command, [promise])]
        with contextlib.redirect_stdout(io.StringIO()):
            code = assure.main(["--out", str(self.folder / "page.md"), *options])
        return code, (self.folder / "page.md").read_text("utf-8")

    def runs(self):
        return (self.folder / "runs").read_text("utf-8").count("run")

    def test_a_kept_promise_has_its_figure_and_command(self):
        code, page = self.assure("echo took 12 of 16", assure.Promise("little", r"took (\d+)", "16"))
        self.assertEqual(code, 0)
        self.assertIn("| little | 12 | 16 | kept |", page)
        self.assertIn("## The one\n\n`echo took 12 of 16`: 0 s, `build/assure/one.log`\n", page)
        self.assertIn("1 of 1 promises kept", page)
        self.assertNotIn("Not kept", page)

    def test_what_is_not_kept_is_named_at_the_top(self):
        _, page = self.assure("echo took 17", assure.Promise("little", r"took (\d+)", at_most=16))
        self.assertLess(page.index("Not kept:\n\n- The one: little: 17\n"), page.index("## The one"))
        self.assertIn("0 of 1 promises kept", page)

    def test_a_figure_without_a_budget_is_told_and_no_promise(self):
        promise = assure.Promise("little", r"took (\d+)", assure.NONE)
        code, page = self.assure("echo took 12", promise)
        self.assertEqual(code, 0)
        self.assertIn("| little | 12 | none | told |", page)
        self.assertIn("0 of 0 promises kept", page)
        code, page = self.assure("echo nothing", promise)
        self.assertEqual(code, 1)
        self.assertIn("| little | - | none | **NOT KEPT** |", page)

    def test_a_bound_that_is_too_many_times_what_was_counted_is_not_kept(self):
        for times, kept in (("2.99", 0), ("3.01", 1)):
            code, page = self.assure(f"echo took 12 4 {times}",
                                     assure.Promise("stage", r"took (\d+) (\d+) (.*)", at_most=16,
                                                    form="{0}, {2} times the {1} counted",
                                                    times=2))
            self.assertEqual(code, kept)
            self.assertIn(f"| stage | 12, {times} times the 4 counted | at most 16, 3 times |", page)

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

    def test_skipped_tests_are_told_and_none_where_there_are_recordings(self):
        assure.has_recordings = lambda: False
        command = ("echo '100% tests passed, 0 tests failed out of 7'; echo 'did not run:'; "
                   "echo '  3 - core/a.B (Skipped)'; echo '  5 - core/a.C (Skipped)'")
        _, page = self.assure(command, assure.Promise("all", assure.PASSED, "all"))
        self.assertIn("out of 7; skipped: core/a.B, core/a.C", page)
        assure.has_recordings = lambda: True
        code, page = self.assure(command, assure.Promise("all", assure.PASSED, "all"))
        self.assertEqual(code, 1)
        self.assertIn("**NOT KEPT**", page)
        code, _ = self.assure(command, assure.Promise("all", assure.PASSED, "all", may_skip="a.[BC]"))
        self.assertEqual(code, 0)

    def test_a_number_beyond_its_budget_is_not_kept(self):
        for number, kept in ((16, 0), (17, 1)):
            code, page = self.assure(f"echo took {number},000",
                                     assure.Promise("little", r"took ([\d,]+)", at_most=16000))
            self.assertEqual(code, kept)
            self.assertIn(f"| {number},000 | at most 16,000 |", page)
        for number, kept in ((95, 0), (94.9, 1)):
            code, page = self.assure(f"echo {number} %",
                                     assure.Promise("much", r"([\d.]+) %", at_least=95))
            self.assertEqual(code, kept)

    def test_a_test_that_has_to_run_has_passed_by_its_name(self):
        passed = "echo '100% tests passed, 0 tests failed out of 1'; "
        promise = assure.Promise("all", assure.PASSED, "all", ran=("onboard.faults",))
        line = "1/1 Test #17: onboard.faults .....   {} 60.22 sec"
        for said, kept in (("Passed", 0), ("***Skipped", 1)):
            code, _ = self.assure(passed + f"echo '{line.format(said)}'", promise)
            self.assertEqual(code, kept)
        code, page = self.assure(passed + "echo '1/1 Test #17: onboard.faults_of_others ..   Passed'",
                                 promise)
        self.assertEqual(code, 1)
        self.assertIn("did not run: onboard.faults", page)

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

    def test_resume_trusts_no_uncommitted_sources_and_no_unknown_ones(self):
        promise = assure.Promise("little", r"took (\d+)", "16")
        for runs, revision in ((2, "abc-dirty"), (4, "")):
            assure.revision = lambda said=revision: said
            self.assure(COUNT + "echo took 12", promise)
            self.assure(COUNT + "echo took 12", promise, "--resume")
            self.assertEqual(self.runs(), runs)

    def test_a_name_that_is_not_known_is_bad_usage(self):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(assure.main(["--only", "nonsense"]), 2)
        self.assertIn("nonsense", said.getvalue())


if __name__ == "__main__":
    unittest.main()
