#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The filter in front of Doxygen, and what Doxygen then says: our comments are its comments, and one that
it cannot read is an error."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
sys.dont_write_bytecode = True
import doxygen_filter  # noqa: E402


def filtered(text):
    return doxygen_filter.filtered(text.splitlines())


class Filter(unittest.TestCase):
    def test_a_comment_before_the_namespace_is_the_files(self):
        self.assertEqual(
            filtered("#pragma once\n\n// A room.\n// Of ours.\n\nnamespace hardpack {"),
            ["#pragma once", r"/// \file", "/// A room.", "/// Of ours.", "", "namespace hardpack {"])

    def test_a_comment_above_is_of_what_follows(self):
        self.assertEqual(
            filtered("struct A {\n  // Of b.\n  int b;\n};"),
            ["struct A {", "  /// Of b.", "  int b;", "};"])

    def test_a_comment_behind_code_is_of_what_stands_before_it_and_goes_on_below(self):
        self.assertEqual(
            filtered("struct A {\n  int b;  // Of b,\n          // and more.\n  // Of c.\n  int c;\n};"),
            ["struct A {", "  int b;  ///< Of b,", "          ///< and more.", "  /// Of c.", "  int c;",
             "};"])

    def test_the_end_of_a_namespace_and_the_licence_are_not_documentation(self):
        self.assertEqual(
            filtered("// SPDX-License-Identifier: Apache-2.0\nnamespace a {\n}  // namespace a"),
            ["", "namespace a {", "}  // namespace a"])

    def test_what_doxygen_would_obey_is_escaped_but_not_in_code(self):
        self.assertEqual(
            filtered(r"struct A;" "\n" r"// a <b> \c @d `<e> \f`" "\nint g;"),
            ["struct A;", r"/// a \<b\> \\c \@d `<e> \f`", "int g;"])

    def test_a_drawing_is_shown_as_it_is(self):
        self.assertEqual(
            filtered("struct A;\n// Seen from above:\n//\n//    <--o\\\n//\n// x <= 1\nint b;"),
            ["struct A;", "/// Seen from above:", r"/// \code{.unparsed}", r"///    <--o\ \endcode",
             "/// ", r"/// x \<= 1", "int b;"])

    def test_lines_keep_their_numbers_in_every_header(self):
        headers = [path for folder in ("core", "hal", "config", "port_linux")
                   for path in (ROOT / folder).rglob("*.h")]
        self.assertGreater(len(headers), 100)
        for path in headers:
            lines = path.read_text(encoding="utf-8").splitlines()
            self.assertEqual(len(doxygen_filter.filtered(lines)), len(lines), path)


class Doxygen(unittest.TestCase):
    def run_on(self, text):
        """Doxygen's exit code and what it says of one header, with our settings."""
        with tempfile.TemporaryDirectory() as folder:
            header = pathlib.Path(folder) / "planted.h"
            header.write_text("\n".join(filtered(text)) + "\n", encoding="utf-8")
            settings = (ROOT / "tools/docs/Doxyfile").read_text(encoding="utf-8")
            settings += "INPUT = planted.h\nUSE_MDFILE_AS_MAINPAGE =\nHTML_EXTRA_STYLESHEET =\nIMAGE_PATH =\n"
            done = subprocess.run(["doxygen", "-"], input=settings, capture_output=True, text=True,
                                  cwd=folder, check=False)
            return done.returncode, done.stdout + done.stderr

    def test_a_comment_that_it_cannot_read_is_an_error(self):
        code, said = self.run_on("#pragma once\n/// \\param there_is_none of this\nvoid Planted(int a);\n")
        self.assertNotEqual(code, 0, said)
        self.assertIn("there_is_none", said)

    def test_ours_is_none(self):
        code, said = self.run_on("#pragma once\n\n// Takes <b> of \\ours.\nvoid Planted(int a);\n")
        self.assertEqual(code, 0, said)


if __name__ == "__main__":
    unittest.main()
