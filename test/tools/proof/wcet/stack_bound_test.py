#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static stack bound (tools/proof/wcet/stack_bound.py) of functions whose frames g++ says, and all
that it must refuse. HARDPACK_SOURCE: the source tree."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

COMPILER = "arm-none-eabi-g++"
TOOL = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "proof", "wcet", "stack_bound.py")

# Each function keeps an array of its own that the one below fills.
CHAIN = """
void Fill(int*);
[[gnu::noinline]] void Low() { int a[20]; Fill(a); }
[[gnu::noinline]] void Other() { int a[10]; Fill(a); }
[[gnu::noinline]] void Middle(bool low) {
  int a[30];
  Fill(a);
  if (low) Low(); else Other();
  Fill(a);
}
void Top() { int a[40]; Fill(a); Middle(true); Fill(a); }
"""


class StackBound(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def compile(self, text, name="a"):
        source = os.path.join(self.folder, name + ".cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run([COMPILER, "-mcpu=cortex-m7", "-mthumb", "-O2", "-fstack-usage",
                        "-fcallgraph-info=su,da", "-c", source, "-o",
                        os.path.join(self.folder, name + ".o")], check=True, cwd=self.folder)

    def run_tool(self, *arguments):
        return subprocess.run([sys.executable, TOOL, *arguments[:-1], self.folder, arguments[-1]],
                              capture_output=True, text=True, check=False)

    def frame(self, function):
        """As g++ says it, in the .su file."""
        with open(os.path.join(self.folder, "a.su"), encoding="utf-8") as file:
            return int(re.search(rf"{function}\(.*\)\t(\d+)\tstatic", file.read()).group(1))

    def expect_refused(self, words, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn(words, done.stderr)

    def test_adds_up_the_dearest_way(self):
        self.compile(CHAIN)
        done = self.run_tool("--frame", "Fill=100", "--path", "Top")
        self.assertEqual(done.returncode, 0, done.stderr)
        wanted = self.frame("Top") + self.frame("Middle") + self.frame("Low") + 100
        self.assertEqual(int(done.stdout.split()[0]), wanted)
        self.assertGreater(self.frame("Low"), self.frame("Other"))
        self.assertRegex(done.stdout, r"(?s)Top.*Middle.*Low.*Fill")
        self.assertNotIn("Other", done.stdout)

    def test_follows_calls_into_other_units(self):
        self.compile(CHAIN)
        self.compile("void Fill(int* a) { volatile int b[50]; for (int& i : *(int(*)[4])a) "
                     "i = b[i]; }", "b")
        done = self.run_tool("Top")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreaterEqual(int(done.stdout.split()[0]),
                                self.frame("Top") + self.frame("Middle") + self.frame("Low") + 200)

    def test_follows_calls_into_the_instances_of_templates(self):
        self.compile("template <int n> struct Of { static void Low(); }; extern template struct "
                     "Of<9>; void Fill(int*); void Top() { int a[40]; Fill(a); Of<9>::Low(); "
                     "Fill(a); }")
        self.compile("void Fill(int*); template <int n> struct Of { static void Low() { int a[n]; "
                     "Fill(a); } }; template struct Of<9>; void Near() { Of<9>::Low(); }", "b")
        done = self.run_tool("--frame", "Fill=100", "Top")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreaterEqual(int(done.stdout.split()[0]), self.frame("Top") + 36 + 100)

    def test_does_not_count_what_does_not_return(self):
        self.compile("[[noreturn]] void Fail(); void Top(bool b) { if (b) Fail(); }")
        self.assertEqual(self.run_tool("--stops", "Fail", "Top").stdout.split()[1], "Top")

    def test_holds_to_a_budget(self):
        self.compile(CHAIN)
        taken = int(self.run_tool("--frame", "Fill=8", "Low").stdout.split()[0])
        done = self.run_tool("--frame", "Fill=8", "--most", str(taken), "Low")
        self.assertEqual(done.returncode, 0)
        done = self.run_tool("--frame", "Fill=8", "--most", str(taken - 1), "Low")
        self.assertEqual(done.returncode, 1)
        self.assertIn("more than", done.stderr)

    def test_refuses_what_it_does_not_know(self):
        self.compile(CHAIN)
        self.expect_refused("there is no call graph of void Fill(int*), which void Low() calls",
                            "Low")

    def test_refuses_recursion(self):
        self.compile("void Use(int*); void B(int);"
                     "void A(int n) { int a[9]; Use(a); if (n) B(n - 1); Use(a); }"
                     "void B(int n) { int a[5]; Use(a); A(n); Use(a); }")
        self.expect_refused("recursion: ", "--frame", "Use=0", "A")

    def test_refuses_calls_through_pointers(self):
        self.compile("void Top(void (*f)()) { f(); f(); }")
        self.expect_refused("calls through a pointer", "Top")

    def test_refuses_frames_that_depend_on_data(self):
        self.compile("void Use(int*); void Top(int n) { int a[n]; Use(a); }")
        self.expect_refused("depends on data", "--frame", "Use=0", "Top")

    def test_bad_input(self):
        self.compile(CHAIN)
        self.expect_refused("0 functions are called Nobody", "Nobody")
        empty = subprocess.run([sys.executable, TOOL, "/nowhere", "Top"], capture_output=True,
                               text=True, check=False)
        self.assertEqual(empty.returncode, 2)
        self.assertIn("there are no call graphs", empty.stderr)


if __name__ == "__main__":
    if shutil.which(COMPILER) is None:
        print(f"skipped: there is no {COMPILER}")
        sys.exit(77)
    unittest.main()
