#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static timing analyser (tools/wcet) on functions whose bound is known by hand, and on every
kind that it must refuse. Written in assembly, so that what is counted is what stands here; for
Thumb-2 and for A64.

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

    def analysis(self, text, stops=(), **options):
        """Of the program that the text, the functions of one file, makes."""
        source, made = os.path.join(self.folder, "a.s"), os.path.join(self.folder, "a")
        with open(source, "w", encoding="utf-8") as file:
            file.write(self.macros + text)
        subprocess.run([self.prefix + "as", *self.flags, source, "-o", made + ".o"], check=True)
        subprocess.run([self.prefix + "ld", "-Ttext=0x8000", "-e0x8000", made + ".o", "-o", made],
                       check=True)
        return bound.Analysis(image.Image(made, stops), **options)

    def expect_refused(self, text, words, name="f"):
        with self.assertRaises(image.Refused) as caught:
            self.analysis(text).bound(name)
        self.assertIn(words, str(caught.exception))


class Thumb(Processor):
    prefix = "arm-none-eabi-"
    flags = ("-mcpu=cortex-m7", "-mthumb")
    macros = ".syntax unified\n" + MACROS.format(word=".long", thumb=".thumb_func")

    def test_straight_line(self):
        self.assertEqual(self.analysis("function f\n movs r0, #1\n adds r0, #2\n bx lr\ndone f\n")
                         .bound("f"), 3)

    def test_longer_branch(self):
        # cmp, beq, then either nop nop b (3) or nop (1); bx
        text = """
function f
  cmp r0, #0
  beq 1f
  nop
  nop
  b 2f
1: nop
2: bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 2 + 3 + 1)

    def test_loop(self):
        # movs; 10 times adds, subs, bne; bx. The header runs once more than its back edge.
        text = """
function f
  movs r1, #10
  record 9
1: adds r0, #1
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 1 + 10 * 3 + 1)

    def test_nested_loops(self):
        # Outer body: 2 before the inner loop, inner 3, and 2 behind it.
        text = """
function f
  record 4
1: movs r2, #7
  nop
  record 6
2: adds r0, #1
  subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 5 * (2 + 7 * 3 + 2) + 1)

    def test_inner_loop_with_a_bound_over_all_iterations(self):
        # The inner loop's 3 are gone through once each iteration, and 6 times more in all of them
        # rather than in each.
        text = """
function f
  {}
1: movs r2, #7
  nop
  record 6
2: adds r0, #1
  subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        analysis = self.analysis(text.format("record_inner 4, 6"))
        self.assertEqual(analysis.bound("f"), 5 * (2 + 3 + 2) + 6 * 3 + 1)
        # Entered twice, the outer loop has them twice.
        outer = """
function f
  record 1
0: movs r1, #4
""" + text.format("record_inner 4, 6").split("function f")[1].replace(
            "  bx lr", "  subs r3, #1\n  bne 0b\n  bx lr")
        self.assertEqual(self.analysis(outer).bound("f"),
                         2 * (1 + 5 * (2 + 3 + 2) + 6 * 3 + 2) + 1)

    def test_bound_over_all_iterations_is_not_for_loops_further_inside(self):
        text = """
function f
  record_inner 4, 6
1: movs r2, #7
  record 6
2: movs r3, #3
  record 2
3: adds r0, #1
  subs r3, #1
  bne 3b
  subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        # The second one has 5 + 6 iterations in all, the third 3 in each of them.
        self.assertEqual(self.analysis(text).bound("f"), 5 * (1 + 2) + 11 * (1 + 3 * 3 + 2) + 1)

    def test_loop_tested_at_its_top(self):
        text = """
function f
  record 8
1: cmp r0, r1
  bge 2f
  adds r0, #1
  b 1b
2: bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 8 * 4 + 2 + 1)

    def test_loop_entered_by_two_ways_has_the_larger_of_their_bounds(self):
        text = """
function f
  cmp r1, #0
  beq 1f
  record 5
  nop
  b 2f
1: record 3
  nop
2: subs r1, #1
  bne 2b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 2 + 2 + 6 * 2 + 1)

    def test_inner_loop_at_the_same_instruction(self):
        # The outer loop's first instruction is the inner's: 2 records, one header.
        text = """
function f
  nop
  record 4
  nop
1: record 6
2: subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        self.assertGreaterEqual(self.analysis(text).bound("f"), 2 + 5 * (7 * 2 + 2) + 1)

    def test_split_loop_shares_its_record(self):
        # As a vectorised loop and what it leaves over: one line of the source.
        text = """
.file 1 "core/split.cpp"
function f
  .loc 1 7
  record 20
  nop
1: subs r1, #4
  bgt 1b
2: subs r1, #1
  bgt 2b
  bx lr
done f
"""
        # Together 20 back edges, and each loop once without: 22 times two instructions.
        self.assertEqual(self.analysis(text).bound("f"), 1 + 22 * 2 + 1)

    def test_copying_loop_is_counted(self):
        # 48 bytes by 16, the end and the pointer both from sp.
        text = """
function f
  sub sp, #96
  add.w r8, sp, #24
  add.w sl, sp, #72
  mov r9, r8
1: mov lr, r9
  add.w r9, r9, #16
  ldmia lr!, {r0, r1, r2, r3}
  cmp lr, sl
  str.w r0, [ip, #-16]
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 4 + 3 * 6 + 1)
        # Neither where the step does not lead to the end, nor where the end is not known.
        self.expect_refused(text.replace("sp, #72", "sp, #70"), "has no record")
        self.expect_refused(text.replace("add.w sl, sp, #72", "ldr.w sl, [sp, #72]"),
                            "has no record")
        self.expect_refused(text.replace("str.w r0", "ldr.w sl"), "has no record")
        self.expect_refused(text.replace("str.w r0, [ip, #-16]", "tst r0, r1"), "has no record")
        self.expect_refused(text.replace("add.w r9, r9, #16", "add.w r9, r9, r0"), "has no record")

    def test_call_and_tail_call(self):
        text = """
function g
  nop
  bx lr
done g
function h
  nop
  nop
  bx lr
done h
function f
  push {r4, lr}
  bl g
  pop {r4, lr}
  b.w h
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 4 + 2 + 3)

    def test_conditional_return_and_call_that_does_not_return(self):
        text = """
function fails
  udf #0
done fails
function f
  cmp r0, #0
  it eq
  bxeq lr
  nop
  bl fails
done f
"""
        self.assertEqual(self.analysis(text, stops=["fails"]).bound("f"), 3 + 2)
        self.expect_refused(text, "runs on behind its end")

    def test_given(self):
        text = "function g\n bx r3\ndone g\nfunction f\n push {lr}\n bl g\n pop {pc}\ndone f\n"
        self.assertEqual(self.analysis(text, given={"g": 100}).bound("f"), 103)

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

    def test_size_is_a_constant_before_the_call(self):
        for before in ("movs r2, #8", "movs r5, #9\n bl g\n subs r5, #1\n mov r2, r5",
                       "movw r2, #8\n cmp r0, #0\n bne 1f\n nop\n1:"[:11],
                       "movs r4, #100\n mov.w r2, #6\n adds r2, #2\n str.w r4, [r3], #4"):
            text = f"{self.MEMSET}function g\n bx lr\ndone g\n" \
                   f"function f\n push {{lr}}\n {before}\n bl memset\n pop {{pc}}\ndone f\n"
            lines = before.count("\n") + 1 + before.count("bl g")
            # 8 back edges are allowed, of 3 instructions each.
            self.assertEqual(self.analysis(text).bound("f"), 1 + lines + 1 + 1 + 9 * 3 + 1 + 1)

    def test_sized_loop_by_the_bytes_that_it_stores(self):
        # Words, then what is left by bytes: 20 bytes are 5 back edges of the first, 20 of the second.
        text = """
function f
  movs r2, #20
  bl memset
  bx lr
done f
function memset
1: str r1, [r0], #4
  subs r2, #4
  bhi 1b
2: strb r1, [r0], #1
  subs r2, #1
  bhi 2b
  bx lr
done memset
"""
        self.assertEqual(self.analysis(text).bound("f"), 3 + (5 + 1) * 3 + (20 + 1) * 3 + 1)

    def test_refuses_size_that_is_no_constant(self):
        for before in ("nop", "movs r2, #8\n bl g", "movs r2, #8\n lsls r2, r1",
                       "movs r2, #8\n it eq\n moveq r2, #9", "movs r2, #8\n ldm r0, {r1, r2}",
                       "movs r2, #8\n cmp r0, #0\n beq 1f\n adds r2, #1\n1:"):
            text = f"{self.MEMSET}function g\n bx lr\ndone g\n" \
                   f"function f\n push {{lr}}\n {before}\n bl memset\n pop {{pc}}\ndone f\n"
            self.expect_refused(text, "a size that is no constant")
            self.assertGreater(self.analysis(text, sizes={"f": 8}).bound("f"), 9 * 3)

    def test_tail_call_of_a_sized_function(self):
        text = self.MEMSET + "function f\n movs r2, #8\n b.w memset\ndone f\n"
        self.assertEqual(self.analysis(text).bound("f"), 2 + 1 + 9 * 3 + 1)

    def test_units(self):
        text = """
function f
  record 3
1: subs r0, #1
  bne 1b
  nop
  record 100000
2: adds r0, #1
  subs r1, #1
  bne 2b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text, units={"f": 9}).bound("f"), 4 * 2 + 1 + 9 * 3 + 1)
        self.assertEqual(self.analysis(text, units={"f": 0}).bound("f"), 4 * 2 + 1 + 3 + 1)
        at_its_top = """
function f
  record 100000
1: cmp r1, r0
  bge 2f
  adds r1, #1
  b 1b
2: bx lr
done f
"""
        self.assertEqual(self.analysis(at_its_top, units={"f": 9}).bound("f"), 9 * 4 + 2 + 1)
        with self.assertRaises(image.Refused):
            self.analysis(text.replace("100000", "3"), units={"f": 9}).bound("f")

    # What it must refuse.

    def test_calls_that_are_bounded_in_all(self):
        # f calls g in each of its 5 iterations, g calls h 4 times each: h runs 7 times in all.
        text = """
function f
  record 5
1: bl g
  subs r1, #1
  bne 1b
  bx lr
done f
function g
  bl h
  bl h
  bl h
  bl h
  bx lr
done g
function h
  nop
  nop
  bx lr
done h
"""
        plain = 6 * (1 + 2 + 4 + 1 + 4 * 3) + 1
        self.assertEqual(self.analysis(text).bound("f"), plain)
        counted = self.analysis(text, calls={"f": {"h": 7}})
        self.assertEqual(counted.bound("f"), plain - 6 * 4 * 3 + 7 * 3)
        self.assertEqual(counted.bound("g"), 4 + 1 + 4 * 3)  # by itself, as ever
        # What is counted further up is not counted again further down.
        twice = self.analysis(text, calls={"f": {"h": 7}, "g": {"h": 2}})
        self.assertEqual(twice.bound("f"), plain - 6 * 4 * 3 + 7 * 3)
        self.assertEqual(twice.bound("g"), 4 + 1 + 2 * 3)
        # And one counted callee does not count another one again.
        both = self.analysis(text, calls={"f": {"g": 2, "h": 7}})
        self.assertEqual(both.bound("f"), 6 * 3 + 1 + 2 * 5 + 7 * 3)

    def test_rounds_that_are_bounded_in_all(self):
        # f calls g 6 times, whose loop of 3 is gone round 10 times in all of them.
        text = """
function f
  record 5
1: bl g
  subs r1, #1
  bne 1b
  bx lr
done f
function g
  record 3
1: nop
  nop
  subs r0, #1
  bne 1b
  bx lr
done g
"""
        plain = 6 * (1 + 4 * 4 + 1 + 2) + 1
        self.assertEqual(self.analysis(text).bound("f"), plain)
        counted = self.analysis(text, rounds={"f": {"g": 10}})
        self.assertEqual(counted.bound("f"), plain - 6 * 3 * 4 + 10 * 4)
        self.assertEqual(counted.bound("g"), 4 * 4 + 1)

    def test_refuses_loop_without_record(self):
        self.expect_refused("function f\n1: subs r0, #1\n bne 1b\n bx lr\ndone f\n",
                            "has no record")

    def test_refuses_inner_loop_without_record(self):
        self.expect_refused("""
function f
  record 4
  nop
1: movs r2, #7
2: subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
""", "has no record")

    def test_refuses_loop_with_a_way_around_its_record(self):
        self.expect_refused("""
function f
  cmp r1, #0
  beq 1f
  record 5
  nop
1: subs r1, #1
  bne 1b
  bx lr
done f
""", "has no record")

    def test_refuses_two_loops_for_one_record(self):
        self.expect_refused("""
.file 1 "core/two.cpp"
function f
  .loc 1 7
  record 20
  nop
1: subs r1, #4
  bgt 1b
  .loc 1 9
2: subs r2, #1
  bgt 2b
  bx lr
done f
""", "shares its record with one of another line")

    def test_refuses_loop_with_two_entries(self):
        self.expect_refused("""
function f
  cmp r0, #0
  record 5
  beq 2f
1: nop
2: subs r1, #1
  bne 1b
  bx lr
done f
""", "two entries")

    def test_refuses_indirect_call(self):
        self.expect_refused("function f\n push {lr}\n blx r3\n pop {pc}\ndone f\n", "indirect")

    def test_refuses_indirect_jump(self):
        self.expect_refused("function f\n bx r3\ndone f\n", "indirect")
        self.expect_refused("function f\n mov pc, r3\ndone f\n", "indirect")
        self.expect_refused("function f\n ldr pc, [r3]\ndone f\n", "indirect")

    def test_refuses_jump_table(self):
        self.expect_refused("function f\n tbb [pc, r0]\n bx lr\ndone f\n", "jump table")

    def test_refuses_recursion(self):
        self.expect_refused("""
function g
  push {lr}
  bl f
  pop {pc}
done g
function f
  push {lr}
  bl g
  pop {pc}
done f
""", "recursion: f > g > f")

    def test_refuses_call_of_what_is_no_function(self):
        self.expect_refused("function f\n push {lr}\n bl 1f\n pop {pc}\ndone f\n1: bx lr\n",
                            "where no function begins")

    def test_refuses_jump_into_the_middle_of_another_function(self):
        self.expect_refused("""
function g
  nop
1: bx lr
done g
function f
  b 1b
done f
""", "where no function begins")

    def test_refuses_what_runs_on_behind_its_end(self):
        self.expect_refused("function f\n nop\ndone f\nfunction g\n bx lr\ndone g\n",
                            "runs on behind its end")

    def test_refuses_what_never_returns(self):
        self.expect_refused("function f\n nop\n record 5\n1: nop\n b 1b\ndone f\n",
                            "never returns")

    def test_refuses_unknown_name(self):
        self.expect_refused("function f\n bx lr\ndone f\n", "0 functions are called", name="g")


class Command(Processor):
    """tools/wcet/wcet.py as a process."""
    prefix = Thumb.prefix
    flags = Thumb.flags
    macros = Thumb.macros

    def run_wcet(self, *arguments):
        command = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "wcet", "wcet.py")
        return subprocess.run([sys.executable, command, *arguments], capture_output=True, text=True,
                              check=False)

    def test_says_bounds_and_reasons(self):
        self.analysis("function f\n bx lr\ndone f\nfunction g\n bx r3\ndone g\n")
        made = os.path.join(self.folder, "a")
        done = self.run_wcet(made, "f")
        self.assertEqual((done.returncode, done.stdout.split()), (0, ["1", "f"]))
        done = self.run_wcet(made, "f", "g")
        self.assertEqual((done.returncode, done.stdout.split()), (1, ["1", "f"]))
        self.assertIn("wcet: g: g: indirect", done.stderr)

    def test_bad_input(self):
        self.assertEqual(self.run_wcet("/nowhere", "f").returncode, 2)
        self.assertEqual(self.run_wcet().returncode, 2)
        self.assertIn("neither", self.run_wcet(sys.executable, "f").stderr)
        self.assertEqual(self.run_wcet("--help").returncode, 0)


FACTS = """
stops = []
[parameters]
directions = 4
planning_units = 640
[constants]
portion_units = 64
plan_units = 6400
plan_transitions = 10
[schedule]
processor = "a made one"
clock_mhz = 0.01
cycles_of_10_instructions = 20
configuration = "{configuration}"
columns_per_s = 10000
packet_columns = 10
waited_columns = 20
bus_us = 500
speed_mmps = 5000
[[units]]
of = ["f"]
most = "ceil(planning_units, portion_units)"
because = "a test"
[[bounds]]
name = "a tick without planning"
function = "f"
kind = "idle"
cortex_m7 = 1000
[[bounds]]
name = "the worst tick"
function = "f"
kind = "call"
cortex_m7 = 1000
"""


class Schedule(Processor):
    """tools/wcet/timing.py --schedule, on numbers that can be followed by hand."""
    prefix = Thumb.prefix
    flags = Thumb.flags
    macros = Thumb.macros

    def schedule(self, period, measured=""):
        self.analysis("""
function f
  record 1000
1: cmp r0, #0
  beq.n 2f
  nop
  b.n 1b
2: bx lr
done f
""")
        configuration = os.path.join(self.folder, "tick.toml")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write(f"[tick]\nperiod_ms = {period}\ndirections = 4\nplanning_units = 128\n")
        facts = os.path.join(self.folder, "facts.toml")
        with open(facts, "w", encoding="utf-8") as file:
            file.write(FACTS.format(configuration=configuration))
        numbers = os.path.join(self.folder, "measured")
        with open(numbers, "w", encoding="utf-8") as file:
            file.write(measured)
        command = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "wcet", "timing.py")
        done = subprocess.run([sys.executable, command, "--schedule", "--facts", facts, "--measured",
                               numbers, os.path.join(self.folder, "a")], capture_output=True,
                              text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return {line[:36].strip(): line[36:].split() for line in done.stdout.splitlines()[2:]}

    def test_by_the_bounds(self):
        table = self.schedule(period=1)
        # A tick has two rounds of 4 instructions and 3 at its end: 22 cycles of a tenth of a ms.
        self.assertEqual(table["the worst tick"], ["2.2", "ms", "-"])
        self.assertEqual(table["a tick without planning"], ["0.6", "ms", "-"])
        # 100 portions and 10 that are not full, two a tick.
        self.assertEqual(table["ticks for a whole plan"], ["55", "-"])
        # 30 columns are 3 ms; the tick that has begun, the one that decides, half a ms of bus.
        self.assertEqual(table["from a return's light to a frame"], ["7.9", "ms", "-"])
        self.assertEqual(table["reaction radius at 5 m/s"], ["0.04", "m", "-"])
        # A tick that ends before its period does is waited for until then.
        self.assertEqual(self.schedule(period=5)["from a return's light to a frame"],
                         ["10.7", "ms", "-"])

    def test_as_counted(self):
        table = self.schedule(period=1, measured="ticks 70\nrounds_of_planning 20\n"
                              "instructions_mean_tick 5\ninstructions_worst_tick 50\n")
        self.assertEqual(table["a tick, mean"], ["1.0", "ms"])
        self.assertEqual(table["the worst tick"][-2:], ["10.0", "ms"])
        self.assertEqual(table["ticks for a whole plan"][-2:], ["3.5", "(mean)"])
        self.assertEqual(table["from a return's light to a frame"][-2:], ["23.5", "ms"])
        self.assertEqual(table["reaction radius at 5 m/s"][-2:], ["0.12", "m"])


class A64(Processor):
    prefix = "aarch64-linux-gnu-"
    macros = MACROS.format(word=".quad", thumb="")

    def test_loop_with_call(self):
        text = """
function g
  cbz x0, 1f
  nop
1: ret
done g
function f
  record 4
1: bl g
  subs x1, x1, #1
  b.ne 1b
  tbz x2, #3, 2f
  nop
2: b g
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 5 * (3 + 3) + 2 + 1 + 3)

    def row_of(self, start="mov x0, #0", step="add x0, x0, #16", between="cmp x0, #0x200"):
        text = f"""
function f
  {start}
  record 512
1: ldr q0, [x1, x0]
  str q0, [x2, x0]
  {step}
  {between}
  b.ne 1b
  ret
done f
"""
        return self.analysis(text).bound("f")

    def test_vector_loop_over_a_whole_row_is_counted(self):
        self.assertEqual(self.row_of(), 1 + 32 * 5 + 1)
        self.assertEqual(self.row_of(between="cmp x0, #0x40"), 1 + 4 * 5 + 1)
        # A pointer and its end, which come from the same register.
        self.assertEqual(self.row_of(start="add x4, x0, #64", between="cmp x4, x0"), 1 + 4 * 5 + 1)

    def test_vector_loop_of_unknown_length_has_its_record(self):
        least = 1 + 513 * 5 + 1
        self.assertEqual(self.row_of(start="nop"), least)
        self.assertEqual(self.row_of(step="add x0, x0, x5"), least)
        self.assertEqual(self.row_of(step="add w0, w0, #16", start="mov w0, w6"), least)
        self.assertEqual(self.row_of(between="cmp x0, x7"), least)
        # Whose flags the branch looks at is another question.
        self.assertEqual(self.row_of(between="cmp x0, #0x200\n  tst x5, #1"), least + 513)
        # Never equal: 0x208 is no multiple of the step.
        self.assertEqual(self.row_of(between="cmp x0, #0x208"), least)

    def test_size_is_a_constant_before_the_call(self):
        memset = """
function memset
  add x3, x0, x2
1: strb w1, [x0], #1
  cmp x0, x3
  b.ne 1b
  ret
done memset
"""
        for before, lines in (("mov w2, #8", 1), ("mov x19, #8\n mov x2, x19", 2),
                              ("mov x2, #0\n movk x2, #8", 2), ("mov x2, xzr\n add x2, x2, #8", 2)):
            text = f"{memset}function f\n stp x29, x30, [sp, #-16]!\n {before}\n bl memset\n" \
                   " ldp x29, x30, [sp], #16\n ret\ndone f\n"
            self.assertEqual(self.analysis(text).bound("f"), 1 + lines + 1 + 1 + 9 * 3 + 1 + 2)
        self.expect_refused(f"{memset}function f\n ldr x2, [x1]\n b memset\ndone f\n",
                            "a size that is no constant")

    def test_refuses_indirect(self):
        self.expect_refused("function f\n blr x3\n ret\ndone f\n", "indirect")
        self.expect_refused("function f\n br x3\ndone f\n", "indirect")
        self.expect_refused("function f\n ret x3\ndone f\n", "indirect")


if __name__ == "__main__":
    unittest.main(verbosity=1)
