#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows that tools/proof/check_layers.py can fail: one planted violation a rule, in a small tree."""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "proof"))
import check_layers  # noqa: E402

SPDX = "// SPDX-License-Identifier: Apache-2.0\n"
HEADER = SPDX + "#pragma once\n"
CLEAN_TREE = {
    "core/CMakeLists.txt": "hp_stage(core base)\n"
                           "hp_stage(core map DEPENDS base)\n"
                           "# hp_stage(core map DEPENDS base late)\n"
                           "hp_stage(core search DEPENDS map)\n"
                           "hp_stage(core odometry DEPENDS base)\n"
                           "hp_stage(core late DEPENDS base)\n",
    "hal/CMakeLists.txt": "hp_stage(hal lidar DEPENDS base)\n",
    "core/base/base.h": HEADER,
    "core/map/map.h": HEADER + '#include "core/base/base.h"\n',
    "core/search/search.h": HEADER,
    "core/late/late.h": HEADER,
    "hal/lidar/lidar.h": HEADER + '#include "core/base/base.h"\n',
    "port_linux/run.h": HEADER + '#include "hal/lidar/lidar.h"\n',
    "config/values.h": HEADER,
    "tools/command.h": HEADER,
}


def findings(extra):
    """(path, line, rule) of everything found in the clean tree plus the files given."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**CLEAN_TREE, **extra}.items():
            file = pathlib.Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        found, _ = check_layers.check_tree(folder)
        return [(f.path, f.line, f.rule) for f in found]


class CheckLayers(unittest.TestCase):
    def assert_only(self, path, line, rule, text):
        # An include against the layers closes a circle, too.
        found = [f for f in findings({path: text}) if f[2] != "circle"]
        self.assertEqual(found, [(path, line, rule)])

    def test_clean_tree_has_no_findings(self):
        self.assertEqual(findings({}), [])

    def test_folders_that_use_each_other(self):
        extra = {"tools/a/a.h": HEADER + '#include "tools/b/b.h"\n',
                 "tools/b/b.h": HEADER + '#include "tools/c/c.h"\n',
                 "tools/c/c.h": HEADER + '#include "tools/d/d.h"\n',
                 "tools/d/d.h": HEADER}
        self.assertEqual(findings(extra), [])
        extra["tools/c/c.h"] = HEADER + '#include "tools/a/a.h"\n'
        self.assertEqual([(path, rule) for path, _, rule in findings(extra)],
                         [("tools/a/a.h", "circle"), ("tools/b/b.h", "circle"),
                          ("tools/c/c.h", "circle")])

    def test_includes_against_the_layers(self):
        for path, include in [("core/map/a.h", "hal/lidar/lidar.h"),
                              ("core/map/a.h", "tools/command.h"),
                              ("hal/lidar/a.h", "port_linux/run.h"),
                              ("config/a.h", "core/base/base.h"),
                              ("config/a.h", "hal/lidar/lidar.h"),
                              ("port_linux/a.h", "tools/command.h")]:
            with self.subTest(path=path, include=include):
                self.assert_only(path, 3, "layer", HEADER + f'#include "{include}"\n')

    def test_includes_against_the_stages(self):
        for path, include in [("core/base/a.h", "core/map/map.h"),
                              ("core/map/a.h", "core/late/late.h"),
                              ("hal/lidar/a.h", "core/map/map.h")]:
            with self.subTest(path=path, include=include):
                self.assert_only(path, 3, "stage", HEADER + f'#include "{include}"\n')

    def test_a_dependency_of_a_dependency_is_allowed(self):
        self.assertEqual(findings({"core/search/a.h": HEADER + '#include "core/base/base.h"\n'}), [])

    def test_a_folder_that_is_no_stage(self):
        self.assert_only("core/stray/a.h", 1, "stage", HEADER)

    def test_includes_from_somewhere_else_than_the_root(self):
        for include in ("map.h", "../map/map.h", "core/map/missing.h"):
            with self.subTest(include=include):
                self.assert_only("core/map/a.h", 3, "include-home",
                                 HEADER + f'#include "{include}"\n')

    def test_std_headers_beyond_the_list(self):
        for header in ("vector", "cmath", "algorithm", "stdio.h"):
            with self.subTest(header=header):
                self.assert_only("hal/lidar/a.h", 3, "std-header", HEADER + f"#include <{header}>\n")

    def test_eigen_outside_the_sources_of_odometry(self):
        self.assertEqual(findings({"core/odometry/a.cpp": SPDX + "#include <Eigen/Core>\n"}), [])
        self.assert_only("core/odometry/a.h", 3, "eigen", HEADER + "#include <Eigen/Core>\n")
        self.assert_only("core/map/a.cpp", 2, "eigen", SPDX + "#include <Eigen/Core>\n")

    def test_toml_outside_of_its_header(self):
        line = "#include <toml++/toml.h>\n"
        for path in ("port_linux/read.h", "tools/read.h", "test/read.h", "core/map/read.h"):
            self.assert_only(path, 3, "toml", HEADER + line)
        self.assertEqual(findings({"port_linux/files/toml_parser.h": HEADER + line}), [])

    def test_forbidden_words(self):
        for rule, code in [
                ("heap", "int* p = new int;"),
                ("heap", "void F(int* p) { delete p; }"),
                ("heap", "void* p = malloc(4);"),
                ("heap", "void F(void* p) { free(p); }"),
                ("exceptions", "void F() { throw 1; }"),
                ("container", "std::vector<int> v;"),
                ("container", "std::optional<int> v;"),
                ("container", "std::function<void()> f;"),
                ("libm", "float y = std::floor(1.5f);"),
                ("libm", "float y = sinf(1.5f);"),
                ("libm", "float y = std::hypot(1.0f, 2.0f);"),
                ("libm", "float y = ::sqrt(1.5f);"),
                ("rtti", "auto* d = dynamic_cast<D*>(b);"),
                ("virtual-destructor", "struct A { virtual ~A(); };"),
                ("cast", "auto* p = reinterpret_cast<char*>(q);"),
                ("union", "union U { int i; float f; };"),
                ("goto", "void F() { goto end; }"),
                ("thread", "thread_local int t;"),
                ("double", "double d = 1.0;"),
                ("at", "int x = v.at(3);"),
                ("at", "int x = v->at(f(1, 2));"),
                ("assert", "void F() { assert(true); }"),
                ("builtin", "float y = __builtin_sinf(1.0f);")]:
            with self.subTest(code=code):
                self.assert_only("core/map/a.cpp", 2, rule, SPDX + code + "\n")

    def test_words_in_comments_strings_and_longer_names_are_free(self):
        for code in ["// a new try, do not throw", "/* malloc(1)\n double */", 'auto* s = "new do";',
                     "int renewed; int doubles; int undo;", "A(const A&) = delete;",
                     "int x = ring.at(slot, row);", "float y = Sqrt(2.0f) + Sin(1.0f);",
                     "int n = 1'000'000; int m = 2'0;", "float d = path.floor_m;"]:
            with self.subTest(code=code):
                self.assertEqual(findings({"core/map/a.cpp": SPDX + code + "\n"}), [])

    def test_the_port_may_use_what_core_may_not(self):
        self.assertEqual(findings({"port_linux/a.cpp": SPDX + "#include <vector>\n"
                                                              "std::vector<int> v;\n"}), [])

    def test_loops_and_their_bounds(self):
        bounded = SPDX + "void F() {\n  HP_LOOP_BOUND(3)\n  for (;;) {\n  }\n}\n"
        self.assertEqual(findings({"core/map/a.cpp": bounded}), [])
        for bound in ("HP_LOOP_BOUND_INNER(3, 4)", "HP_LOOP_BOUND_BEAMS(3)",
                      "HP_LOOP_BOUND_INNER_BEAMS(3, 4)"):
            code = bounded.replace("HP_LOOP_BOUND(3)", bound)
            self.assertEqual(findings({"core/map/a.cpp": code}), [])
        nested = (SPDX + "void F() {\n  HP_LOOP_BOUND(G(3) *\n                4)\n  while (a) {\n"
                         "    HP_LOOP_BOUND(2)\n    for (;;) {\n    }\n  }\n}\n")
        self.assertEqual(findings({"core/map/a.cpp": nested}), [])
        for line, code in [(3, "void F() {\n  for (;;) {\n  }\n}\n"),
                           (3, "void F() {\n  while (a) {\n  }\n}\n"),
                           (5, "void F() {\n  HP_LOOP_BOUND(3)\n  int i = 0;\n  x;\n}\n"),
                           (4, "void F() {\n  if (a)\n    HP_LOOP_BOUND(3)\n    for (;;) {\n    }\n}\n"),
                           (3, "void F() {\n  HP_LOOP_BOUND(3) for (;;) {\n  }\n}\n")]:
            with self.subTest(code=code):
                found = findings({"core/map/a.cpp": SPDX + code})
                self.assertEqual({rule for _, _, rule in found}, {"loop-bound"})
        self.assert_only("core/map/a.cpp", 3, "do-loop",
                         SPDX + "void F() {\n  do {\n  } \n}\n")

    def test_length_of_functions_and_files(self):
        def function(lines):
            return SPDX + "int F(int a) {\n" + "  a += 1;\n" * (lines - 2) + "}\n"
        self.assertEqual(findings({"core/map/a.cpp": function(60)}), [])
        self.assert_only("core/map/a.cpp", 2, "function-length", function(61))
        method = HEADER + "class A {\n" + function(61)[len(SPDX):] + "};\n"
        self.assert_only("core/map/a.h", 4, "function-length", method)
        self.assertEqual(findings({"core/map/a.cpp": SPDX + "int a;\n" * 499}), [])
        self.assert_only("core/map/a.cpp", 501, "file-length", SPDX + "int a;\n" * 500)

    def test_first_lines(self):
        self.assert_only("test/a.cpp", 1, "spdx", "int a;\n")
        self.assert_only("core/map/a.h", 1, "pragma-once", SPDX)


if __name__ == "__main__":
    unittest.main()
