#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows that tools/proof/check_requirements.py can fail: one planted violation of each kind, in a small
tree whose log and tests fit together."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tools" / "proof" / "check_requirements.py"

HAZARDS = """# Hazard log
## Hazards
| HZ-01 | starts unasked |
| HZ-02 | falls into a ditch |
## Requirements
| SR-SUP01 | HZ-01 | stands for 1 s |
| SR-SUP02 | HZ-01 | stands for 2 s |
## What is not protected
| HZ-02 | narrow ones | AU-01 |
"""
MANUAL = "| AU-01 | no ditches |\n"
CPP = """// SR-SUP01: a few words
TEST(Supervisor, Stands) {}

TEST(Supervisor, Sits) {}
"""
PYTHON = ("class Faults:\n    # Whatever comes.\n    # SR-SUP02\n    @skip\n"
          "    def test_stands(self):\n        pass\n")
CLEAN = {"docs/hazards.md": HAZARDS, "docs/safety_manual.md": MANUAL, "test/a_test.cpp": CPP,
         "test/b_test.py": PYTHON}


def run(changed):
    """(exit code, what is printed) for the clean tree with some files changed."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**CLEAN, **changed}.items():
            file = pathlib.Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        result = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True,
                                check=False)
        return result.returncode, result.stdout + result.stderr


class CheckRequirements(unittest.TestCase):
    def assert_fails(self, changed, *said):
        code, output = run(changed)
        self.assertEqual(code, 1, output)
        for text in said:
            self.assertIn(text, output)
        self.assertIn(f"{len(said)} findings", output)

    def test_what_fits_together_is_printed_as_a_matrix(self):
        code, output = run({})
        self.assertEqual(code, 0, output)
        self.assertIn("SR-SUP01  HZ-01\n    Supervisor.Stands (test/a_test.cpp:2)\n", output)
        self.assertIn("SR-SUP02  HZ-01\n    test_stands (test/b_test.py:5)\n", output)
        self.assertIn("2 hazards, 2 requirements, 2 times shown by a test, 0 findings", output)

    def test_a_test_registered_with_cmake_counts(self):
        code, output = run({"test/b_test.py": "", "test/CMakeLists.txt":
                            "# SR-SUP02\nadd_test(NAME rails.symbols COMMAND check)\n"})
        self.assertEqual(code, 0, output)
        self.assertIn("    rails.symbols (test/CMakeLists.txt:2)\n", output)

    def test_a_comment_within_a_python_test_counts_and_within_another_function_does_not(self):
        code, output = run({"test/b_test.py": "def test_stands():\n    x = 1\n    # SR-SUP02\n"
                                              "    y = 2\n"})
        self.assertEqual(code, 0, output)
        self.assertIn("    test_stands (test/b_test.py:1)\n", output)
        self.assert_fails({"test/c_test.py": "def test_stands():\n    x = 1\n\n\ndef other():\n"
                                             "    # SR-SUP02\n    y = 2\n"},
                          "test/c_test.py:6: SR-SUP02 stands above no test that runs")

    def test_a_script_without_test_functions_is_a_test_itself(self):
        code, output = run({"test/b_test.py": "# SR-SUP02\nimport sys\nsys.exit(main())\n"})
        self.assertEqual(code, 0, output)
        self.assertIn("    b_test.py (test/b_test.py:1)\n", output)

    def test_a_requirement_without_a_test(self):
        self.assert_fails({"test/b_test.py": ""}, "docs/hazards.md:7: SR-SUP02 has no test")

    def test_a_requirement_whose_only_test_is_disabled(self):
        self.assert_fails({"test/a_test.cpp": CPP.replace("Stands", "DISABLED_Stands")},
                          "docs/hazards.md:6: SR-SUP01 has no test",
                          "test/a_test.cpp:1: SR-SUP01 stands above no test that runs")

    def test_a_test_of_a_requirement_that_there_is_not(self):
        for unknown in ("SR-SUP99", "SR-SUP1"):
            with self.subTest(unknown):
                self.assert_fails(
                    {"test/c_test.cpp": f"// {unknown}\nTEST(Supervisor, Lies) {{}}\n"},
                    f"test/c_test.cpp:2: Supervisor.Lies names {unknown}, which docs/hazards.md")

    def test_an_id_that_is_not_directly_above_a_test(self):
        self.assert_fails({"test/c_test.cpp": "// SR-SUP01\n\nTEST(Supervisor, Lies) {}\n"},
                          "test/c_test.cpp:1: SR-SUP01 stands above no test that runs")

    def test_a_hazard_with_neither_requirement_nor_assumption(self):
        self.assert_fails(
            {"docs/hazards.md": HAZARDS.replace("## Req", "| HZ-03 | overturns |\n## Req")},
            "docs/hazards.md:5: HZ-03 has no requirement and is not listed as not protected")

    def test_a_hazard_that_is_not_protected_without_an_assumption(self):
        self.assert_fails(
            {"docs/hazards.md": HAZARDS + "| HZ-01 | at the start | none |\n"},
            "HZ-01 is not protected against, and names no assumption")

    def test_a_requirement_against_no_hazard(self):
        self.assert_fails(
            {"docs/hazards.md": HAZARDS.replace("| SR-SUP02 | HZ-01 |", "| SR-SUP02 | |")},
            "docs/hazards.md:7: SR-SUP02 names no hazard")

    def test_what_is_mentioned_and_not_there(self):
        self.assert_fails({"docs/hazards.md": HAZARDS.replace("SUP02 | HZ-01", "SUP02 | HZ-09")},
                          "docs/hazards.md:7: there is no HZ-09")
        self.assert_fails({"docs/safety_manual.md": MANUAL + "See SR-SUP07.\n"},
                          "docs/safety_manual.md:2: there is no SR-SUP07")

    def test_an_id_given_twice(self):
        self.assert_fails({"docs/hazards.md": HAZARDS.replace("SR-SUP02", "SR-SUP01"),
                           "test/b_test.py": ""}, "docs/hazards.md:7: SR-SUP01 is there twice")

    def test_an_assumption_of_no_hazard(self):
        self.assert_fails({"docs/safety_manual.md": MANUAL + "| AU-02 | no rain |\n"},
                          "docs/safety_manual.md:2: AU-02 belongs to no hazard")

    def test_a_log_without_requirements_shows_nothing(self):
        code, output = run({"docs/hazards.md": "", "docs/safety_manual.md": "", "test/a_test.cpp":
                            "", "test/b_test.py": ""})
        self.assertEqual(code, 1, output)


if __name__ == "__main__":
    unittest.main()
