# SPDX-License-Identifier: Apache-2.0
"""Functions in assembly for the tests of the static timing analyser (tools/wcet): what is counted is
what stands there.

HARDPACK_SOURCE: the source tree. Cases of a processor whose assembler is not installed are
skipped.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "wcet"))

import bound  # noqa: E402
import image  # noqa: E402

# A record as HP_LOOP_BOUND writes it (core/base/loop_bound.h), and a function.
MACROS = """
.macro record n
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n
  .popsection
.endm
.macro record_inner n, m
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n
  .popsection
  .pushsection .note.hardpack.inner,"",%note
  {word} 771b, \\m
  .popsection
.endm
.macro record_beams n, capacity
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n
  .popsection
  .pushsection .note.hardpack.beams,"",%note
  {word} 771b, \\capacity
  .popsection
.endm
.macro function name
  .p2align 2
  .globl \\name
  .type \\name, %function
  {thumb}
\\name:
.endm
.macro done name
  .size \\name, . - \\name
.endm
"""


class Processor(unittest.TestCase):
    prefix = ""
    flags = ()
    macros = ""

    @classmethod
    def setUpClass(cls):
        if not cls.prefix:
            raise unittest.SkipTest("what the processors have in common")
        if shutil.which(cls.prefix + "as") is None:
            raise unittest.SkipTest(f"there is no {cls.prefix}as")
        cls.folder = tempfile.mkdtemp()

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def analysis(self, text, stops=(), beams=None, **options):
        """Of the program that the text, the functions of one file, makes."""
        source, made = os.path.join(self.folder, "a.s"), os.path.join(self.folder, "a")
        with open(source, "w", encoding="utf-8") as file:
            file.write(self.macros + text)
        subprocess.run([self.prefix + "as", *self.flags, source, "-o", made + ".o"], check=True)
        subprocess.run([self.prefix + "ld", "-Ttext=0x8000", "-e0x8000", made + ".o", "-o", made],
                       check=True)
        return bound.Analysis(image.Image(made, stops, beams), **options)

    def expect_refused(self, text, words, name="f"):
        with self.assertRaises(image.Refused) as caught:
            self.analysis(text).bound(name)
        self.assertIn(words, str(caught.exception))


class OfThumb(Processor):
    prefix = "arm-none-eabi-"
    flags = ("-mcpu=cortex-m7", "-mthumb")
    macros = ".syntax unified\n" + MACROS.format(word=".long", thumb=".thumb_func")


class OfA64(Processor):
    prefix = "aarch64-linux-gnu-"
    macros = MACROS.format(word=".quad", thumb="")
