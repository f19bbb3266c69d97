#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What tools/proof/mutate.py plants where, and how it judges a fault, on a program of two files."""

import argparse
import contextlib
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "tools" / "proof"))
import mutate  # noqa: E402


def changes(text):
    return [(token, replacement) for _, token, replacement in mutate.tokens_of(text)]


class Tokens(unittest.TestCase):

    def test_operators_numbers_and_truth_values_are_changed(self):
        self.assertEqual(changes("if (a < 3 && b == c) return true;"),
                         [("<", "<="), ("3", "4"), ("&&", "||"), ("==", "!="), ("true", "false")])

    def test_operators_at_the_end_of_a_line_are_changed(self):
        self.assertEqual(changes("return a &&\n       b ||\n       c;"), [("&&", "||"), ("||", "&&")])

    def test_numbers_stay_of_their_type(self):
        for number, changed in (("0", "1"), ("7u", "8u"), ("0.5f", "0.75f"), ("0.0f", "1.0f"),
                                ("2.0", "3.0"), ("0x1F", None), ("1e-9f", None)):
            self.assertEqual(mutate.changed_number(number), changed, number)

    def test_what_does_nothing_is_left_alone(self):
        for text in ("// a < b", "/* 3 */", 'f("a < b");', "#if A < 3", "static_assert(a < 3);",
                     "  HP_LOOP_BOUND(4)", "std::array<int, 3> a;", "template <int N>"):
            self.assertEqual(changes(text), [], text)

    def test_arrows_pointers_and_references_are_no_operators(self):
        self.assertEqual(changes("f(const A& a, B* b, C&& c) { b->d(); }"), [])


class Draw(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = mutate.ROOT
        self.addCleanup(lambda: setattr(mutate, "ROOT", root))
        mutate.ROOT = pathlib.Path(folder.name)
        self.source = mutate.ROOT / "core" / "one" / "one.cpp"
        self.source.parent.mkdir(parents=True)
        self.lines = [f"int f{i}(int a) {{ return a < {i} ? a + {i} : a - {i}; }}" for i in range(20)]

    def draw(self, lines, seed=1):
        """The places of a draw, each as its line and its token."""
        self.source.write_text("\n".join(lines), "utf-8")
        text = "\n".join(lines)
        drawn = mutate.draw(argparse.Namespace(seed=seed, only=""))
        return [(lines[mutate.line_of(name, place) - 1], place[0] - text.rfind("\n", 0, place[0]),
                 place[1]) for name, place in drawn]

    def test_a_seed_is_a_draw_and_another_is_another(self):
        first = self.draw(self.lines)
        self.assertEqual(first, self.draw(self.lines))
        self.assertNotEqual(first, self.draw(self.lines, seed=2))
        self.assertEqual(sorted(first), sorted(self.draw(self.lines, seed=2)))

    def test_new_lines_leave_the_order_of_the_others(self):
        more = ["", "int g(int a) { return a * 7; }", *self.lines]
        self.assertEqual([place for place in self.draw(more) if place[0] != more[1]],
                         self.draw(self.lines))


class SmallTree:
    """As mutate.Tree, of one source and a program that tests it."""

    def __init__(self, folder):
        self.sources = folder
        self.build = folder

    def object_of(self, name):
        return self.build / f"{name}.o"

    def programs_of(self, name):
        return [name]

    def ninja(self, target):
        source = target.removesuffix(".o")
        command = ["g++", "-O2", "-c", source, "-o", f"{source}.o"]
        if not target.endswith(".o"):
            command = ["g++", "main.cpp", f"{target}.o", "-o", "main"]
        return subprocess.run(command, cwd=self.build, capture_output=True, check=False)

    def fails(self, program):
        ran = subprocess.run([self.build / "main"], check=False)
        return f"{program}: it ended with {ran.returncode}" if ran.returncode else None


class Judge(unittest.TestCase):
    SOURCE = """
int Clamp(int a) {
  if (a > 9) return 9;
  if (a == -1000) return 5;
  return a * 1;
}
"""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = SmallTree(pathlib.Path(folder.name))
        self.source = self.tree.sources / "clamp.cpp"
        self.source.write_text(self.SOURCE, "utf-8")
        (self.tree.sources / "main.cpp").write_text(
            "int Clamp(int a);\nint main() { return Clamp(20) == 9 && Clamp(4) == 4 ? 0 : 3; }\n", "utf-8")
        self.assertEqual(self.tree.ninja("clamp.cpp.o").returncode, 0)

    def judge(self, token, replacement, behind=""):
        position = self.SOURCE.index(token, self.SOURCE.index(behind))
        result = mutate.judge(self.tree, "clamp.cpp", self.SOURCE, (position, token, replacement))
        self.assertEqual(self.source.read_text("utf-8"), self.SOURCE)
        return result

    def test_a_fault_that_a_test_sees_is_noticed(self):
        self.assertEqual(self.judge("9", "8", "return"),
                         {"outcome": "noticed", "by": "clamp.cpp: it ended with 3"})

    def test_a_fault_that_none_sees_survives(self):
        self.assertEqual(self.judge("5", "6")["outcome"], "survived")

    def test_the_same_code_is_no_fault(self):
        self.assertEqual(self.judge("*", "/"), {"outcome": "none", "by": "same code"})

    def test_what_does_not_compile_is_no_fault(self):
        self.assertEqual(self.judge("==", "!==")["by"], "does not compile")


class Summary(unittest.TestCase):

    def code(self, noticed, survived):
        with contextlib.redirect_stdout(io.StringIO()):
            return mutate.summarise({"noticed": noticed, "survived": survived, "none": 5})

    def test_nine_of_ten_are_enough_and_fewer_are_not(self):
        self.assertEqual(self.code(270, 30), 0)
        self.assertEqual(self.code(269, 31), 1)
        self.assertEqual(self.code(0, 0), 1)

    def test_shards_that_come_to_no_end_are_a_failure(self):
        built_tree, executable = mutate.built_tree, sys.executable
        mutate.built_tree = lambda *_: "a tree"
        sys.executable = "false"
        try:
            with contextlib.redirect_stderr(io.StringIO()) as said:
                self.assertEqual(mutate.main(["--jobs", "2"]), 2)
        finally:
            mutate.built_tree, sys.executable = built_tree, executable
        self.assertIn("not every shard", said.getvalue())


if __name__ == "__main__":
    unittest.main()
