#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Planted in a tree that is fine, what is newer than the version that it asks for is found."""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "proof"))
import check_cmake  # noqa: E402

FINE = {"CMakeLists.txt": "cmake_minimum_required(VERSION 3.22)\nproject(x)\n",
        "CMakePresets.json": '{"version": 3, "cmakeMinimumRequired": {"major": 3, "minor": 22}}'}


def findings(extra):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**FINE, **extra}.items():
            file = pathlib.Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return check_cmake.check_tree(pathlib.Path(folder))[0]


class CheckCmake(unittest.TestCase):
    def test_fine(self):
        self.assertEqual(findings({}), [])
        self.assertEqual(findings({"a.cmake": "# block() is newer\nset(x 1)\n"}), [])

    def test_newer(self):
        for line in ("block()", "return(PROPAGATE x)", "target_link_libraries(a $<LINK_GROUP:RESCAN,b>)",
                     "set_target_properties(a PROPERTIES COMPILE_WARNING_AS_ERROR ON)",
                     "target_sources(a PUBLIC FILE_SET HEADERS)",
                     "cmake_minimum_required(VERSION 3.25)"):
            with self.subTest(line=line):
                found = findings({"sub/CMakeLists.txt": f"set(x 1)\n{line}\n"})
                self.assertEqual([f.split(": ")[0] for f in found], ["sub/CMakeLists.txt:2"])

    def test_presets(self):
        text = FINE["CMakePresets.json"].replace('"version": 3', '"version": 6')
        self.assertEqual(len(findings({"CMakePresets.json": text})), 1)
        text = FINE["CMakePresets.json"].replace('"minor": 22', '"minor": 25')
        self.assertEqual(len(findings({"CMakePresets.json": text})), 1)


if __name__ == "__main__":
    unittest.main()
