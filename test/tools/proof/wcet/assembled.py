# SPDX-License-Identifier: Apache-2.0
"""Functions in assembly for the tests of the static timing analyser (tools/proof/wcet): what is counted is
what stands there. And in C++, for what compilers make of loops.

HARDPACK_SOURCE: the source tree. Cases of a processor whose assembler is not installed are
skipped.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "proof", "wcet"))

import bound  # noqa: E402
import image  # noqa: E402

# A record as HP_LOOP_BOUND writes it (core/base/loop_bound.h), of a line where that matters, and a
# function.
MACROS = """
.macro record n, line=0
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n, \\line
  .popsection
.endm
.macro record_inner n, m, line=0
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n, \\line
  .popsection
  .pushsection .note.hardpack.inner,"",%note
  {word} 771b, \\m, \\line
  .popsection
.endm
.macro record_beams n, capacity, line=0
771: .pushsection .note.hardpack.loops,"",%note
  {word} 771b, \\n, \\line
  .popsection
  .pushsection .note.hardpack.beams,"",%note
  {word} 771b, \\capacity, \\line
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


SOURCE = os.environ["HARDPACK_SOURCE"]


def analysable_flags():
    """HARDPACK_ANALYSABLE_FLAGS, with which everything is compiled that is to be bounded."""
    path = os.path.join(SOURCE, "tools", "cmake", "analysable_flags.cmake")
    with open(path, encoding="utf-8") as file:
        return re.search(r"set\(HARDPACK_ANALYSABLE_FLAGS ([^)]*)\)", file.read()).group(1).split()


class Processor(unittest.TestCase):
    prefix = ""
    flags = ()
    compile_flags = ()
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
        return self._linked(made, stops, beams, **options)

    def compiled(self, text, **options):
        """Of functions in C++, compiled as core is. They are to be called as in C."""
        if shutil.which(self.prefix + "g++") is None:
            self.skipTest(f"there is no {self.prefix}g++")
        os.makedirs(os.path.join(self.folder, "core"), exist_ok=True)
        source, made = os.path.join(self.folder, "core", "a.cpp"), os.path.join(self.folder, "a")
        with open(source, "w", encoding="utf-8") as file:
            file.write(f'#include "core/base/loop_bound.h"\nextern "C" {{{text}}}\n')
        subprocess.run([self.prefix + "g++", *self.compile_flags, *analysable_flags(), "-std=c++20",
                        "-O3", "-ffp-contract=off", "-I", SOURCE, "-c", source, "-o", made + ".o"],
                       check=True)
        return self._linked(made, (), None, **options)

    def _linked(self, made, stops, beams, **options):
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
    compile_flags = (*flags, "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard")
    macros = ".syntax unified\n" + MACROS.format(word=".long", thumb=".thumb_func")

    # One instruction, a loop of two for each byte, and one.
    MEMSET = """
function memset
  add r3, r0, r2
1: strb r1, [r0], #1
  cmp r0, r3
  bne 1b
  bx lr
done memset
"""


class OfA64(Processor):
    prefix = "aarch64-linux-gnu-"
    macros = MACROS.format(word=".quad", thumb="")
