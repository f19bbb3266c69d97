#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static timing analyser (tools/wcet) on Thumb-2 functions whose bound is known by hand, and on
every kind that it must refuse."""

import unittest

from assembled import OfThumb, bound, image


class Thumb(OfThumb):

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

    # --- whose record it is -----------------------------------------------------------------------
    # At the outer header stands the inner loop's record: its body begins with that loop.
    def test_record_of_an_inner_loop_at_the_header(self):
        text = """
function f
  record 1000
  movs r1, #0
1: record 3
  movs r2, #3
2: subs r2, #1
  bne 2b
  adds r1, #1
  cmp r1, r5
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 1 + 1001 * (1 + 4 * 2 + 3) + 1)
        vanished = text.replace("2: subs r2, #1\n  bne 2b\n", "")
        self.assertEqual(self.analysis(vanished).bound("f"), 1 + 1001 * 4 + 1)

    # Without lines any of them can be its own, with lines it is the one before its line.
    def test_lines_tell_which_record_it_is(self):
        text = """
.file 1 "core/outer.cpp"
function f
  record 10, 6
  movs r1, #0
1: record 30, 8
  movs r2, #3
  adds r1, #1
  cmp r1, r5
  .loc 1 {}
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text.format(7)).bound("f"), 1 + 11 * 4 + 1)
        self.assertEqual(self.analysis(text.format(9)).bound("f"), 1 + 31 * 4 + 1)
        for line in (6, 8, 10):
            self.expect_refused(text.format(line), "has no record")
        # One in a loop of another loop's line is that other one's.
        within = text.format(7).replace(" cmp r1, r5", "2: subs r2, #1\n bne 2b\n cmp r1, r5")
        self.expect_refused(within.replace("  .loc 1 7\n", "").replace("2:", ".loc 1 7\n2:"),
                            "has no record")

    # The first iteration's condition, with the record of a loop in it, stands before the loop.
    def test_own_record_behind_one_of_a_copied_condition(self):
        text = """
.file 1 "core/until.cpp"
function f
  record 1000, 6
  nop
  record 3, 2
  nop
1: record 3, 2
  nop
  .loc 1 7
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 2 + 1001 * 2 + 1)

    def test_loops_of_one_header_with_records_before(self):
        text = """
function f
  record 4
  record 6
  nop
1: subs r2, #1
  bne 1b
  movs r2, #7
  record 6
  nop
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        self.assertGreaterEqual(self.analysis(text).bound("f"), 1 + 5 * (7 * 2 + 4) + 1)

    # Closed by an `if` of its body: another of its jumps is of its head.
    def test_loop_closed_from_its_body(self):
        text = """
.file 1 "core/body.cpp"
function f
  record 5, 6
  movs r2, #3
1: cmp r1, r2
  .loc 1 7
  beq 2f
  adds r1, #1
  cmp r0, r1
  .loc 1 9
  bne 1b
2: bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 1 + 6 * 5 + 1)
        # Lines of what is elsewhere tell nothing.
        self.expect_refused(text.replace("core/body", "lib/body"), "has no record")

    # The second one's is of the first line that is a loop's head: one in the other.
    def test_two_loops_of_one_header_by_their_lines(self):
        text = """
.file 1 "core/nested.cpp"
function f
  record 4, 6
  nop
1: record 6, 8
  subs r2, #1
  .loc 1 9
  bne 1b
  subs r1, #1
  .loc 1 7
  bne 1b
  bx lr
done f
"""
        # 5 times 7 trips, all as dear as the longer one.
        self.assertEqual(self.analysis(text).bound("f"), 1 + (5 * 7 + 1) * 4 + 1)

    def nested(self, body="", inner=100):
        return f"""
.file 1 "core/shared.cpp"
function f
  record_inner 32, 32, 2
  nop
1: subs r0, #1
  {body}
  record {inner}, 7
  nop
2: subs r2, #1
  .loc 1 8
  bne 2b
  subs r1, #1
  .loc 1 3
  bne 1b
  bx lr
done f
"""

    # A loop between the two that has vanished has left its record.
    def test_shared_work_is_of_loops_directly_inside(self):
        self.assertEqual(self.analysis(self.nested()).bound("f"), 1 + 33 * (2 + 2 + 2) + 32 * 2 + 1)
        between = self.analysis(self.nested("record 1, 5\n nop"))
        self.assertEqual(between.bound("f"), 1 + 33 * (3 + 101 * 2 + 2) + 1)
        # That of a loop beside it is none between.
        beside = self.analysis(self.nested("record 1, 5\n3: subs r3, #1\n .loc 1 6\n bne 3b"))
        self.assertEqual(beside.bound("f"), 1 + 33 * (2 + 2 + 2 + 2) + 2 * 32 * 2 + 1)

    NESTED = """
int Nested(const short* p, int rows, int cols) {
  int sum = 0;
  HP_LOOP_BOUND(1000)
  for (int r = 0; r < rows; ++r) {
    HP_LOOP_BOUND(3)
    for (int k = 0; k < cols; ++k) sum = (sum ^ p[k]) * 3;
    p += 5;
  }
  return sum;
}
"""

    # What they took on the processor.
    def test_compiled_loops_bound_what_they_took(self):
        for text, name, taken in (
                (self.NESTED, "Nested", 22011),
                ("""
unsigned Shared(const unsigned char* p, unsigned mask) {
  unsigned sum = 0;
  HP_LOOP_BOUND_INNER(32, 32)
  while (mask != 0) {
    mask &= mask - 1;
    HP_LOOP_BOUND(1)
    for (int once = 0; once < 1; ++once) {
      HP_LOOP_BOUND(100)
      for (int k = 0; k < p[0]; ++k) sum = (sum ^ p[k]) * 3;
    }
    ++p;
  }
  return sum;
}
""", "Shared", 16293)):
            with self.subTest(name):
                found = self.compiled(text).bound(name)
                self.assertGreaterEqual(found, taken)
                self.assertLess(found, 1.5 * taken)

    # Two loops that each do all of one's iterations would share its bound.
    def test_no_loop_is_distributed(self):
        text = """
float a[1024], b[1024], c[1024], d[1024];
void Distributed(int n) {
  HP_LOOP_BOUND(1000)
  for (int i = 1; i < n; ++i) {
    a[i] = a[i - 1] * 0.5f + b[i];
    c[i] = d[i] + 1.0f;
  }
}
"""
        # At least two loads, two sums, a product, two stores, a comparison and a jump each.
        self.assertGreaterEqual(self.compiled(text).bound("Distributed"), 1000 * 9)

    def test_split_loop_shares_its_record(self):
        # As a vectorised loop and what it leaves over: one line of the source.
        text = """
.file 1 "core/split.cpp"
function f
  .loc 1 7
  record 20, 6
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

    def test_refuses_copying_loop_whose_way_is_not_known(self):
        text = """
function f
  {}
1: str r0, [r1], #4
  {}
  cmp r1, r3
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text.format("add.w r3, r1, #64", "nop")).bound("f"),
                         1 + 16 * 4 + 1)
        for before, inside in (("add.w r3, r1, #64\n bic r1, r1, #31", "nop"),
                               ("add.w r3, r1, #64", "it eq\n ldreq r2, [r1], #-4"),
                               ("add.w r3, r1, #64", "it eq\n streq r2, [r1, #-4]!"),
                               ("mov r1, pc\n mov r3, pc\n add.w r3, r3, #64", "nop")):
            with self.subTest(before + inside):
                self.expect_refused(text.format(before, inside), "has no record")

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

    def test_call_that_does_not_return_on_a_condition(self):
        text = """
function fails
  udf #0
done fails
function f
  cmp r0, #0
  it ne
  blne fails
  nop
  nop
  nop
  nop
  nop
  bx lr
done f
"""
        self.assertEqual(self.analysis(text, stops=["fails"]).bound("f"), 3 + 5 + 1)

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

    def test_refuses_size_that_something_else_writes(self):
        for before in ("bfi r2, r1, #4, #12", "bfc r2, #1, #2", "bic r2, r1, #1",
                       "umaal r1, r2, r3, r4", "smlald r1, r2, r3, r4", "smlsld r1, r2, r3, r4",
                       "smlalbb r1, r2, r3, r4", "umull r1, r2, r3, r4",
                       "it eq\n umulleq r1, r2, r3, r4", "it eq\n ldrdeq r1, r2, [r3]",
                       "it eq\n ldmiaeq r0!, {r1, r2}", "it eq\n popeq {r1, r2}",
                       "it eq\n bleq g"):
            with self.subTest(before):
                self.expect_refused(f"{self.MEMSET}function g\n bx lr\ndone g\n"
                                    f"function f\n push {{lr}}\n movs r2, #8\n {before}\n"
                                    " bl memset\n pop {pc}\ndone f\n",
                                    "a size that is no constant")

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

    # 9 rounds are begun, and a tenth as far as to where it asks for the units.
    def test_units_asked_for_in_the_middle(self):
        text = """
function f
  record 100000
1: nop
  nop
  cbz r3, 3f
  nop
3: cbz r1, 2f
  nop
  nop
  subs r1, #1
  b 1b
2: bx lr
done f
"""
        self.assertEqual(self.analysis(text, units={"f": 9}).bound("f"), 9 * 9 + 5 + 1)

    # What is left for where nothing returns does not ask for the units.
    def test_units_asked_for_at_the_bottom_behind_a_check(self):
        text = """
function fails
  udf #0
done fails
function f
  record 100000
1: nop
  cbz r3, 3f
  subs r1, #1
  bne 1b
  bx lr
3: bl fails
done f
"""
        self.assertEqual(self.analysis(text, stops=["fails"], units={"f": 9}).bound("f"), 9 * 4 + 1)

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

    # g's other way is dearer than its loop's first rounds.
    def test_rounds_beside_a_dear_way(self):
        text = """
function h
  record 50
1: subs r0, #1
  bne 1b
  bx lr
done h
function g
  cmp r1, #0
  beq 2f
  push {lr}
  bl h
  pop {pc}
2: nop
  record 100000
1: cmp r0, #0
  beq 3f
  subs r0, #1
  b 1b
3: bx lr
done g
function f
  push {lr}
  bl g
  pop {pc}
done f
"""
        counted = self.analysis(text, rounds={"f": {"g": 1000}})
        self.assertEqual(counted.round("g"), 4)
        self.assertEqual(counted.bound("f"), 3 + (5 + 51 * 2 + 1) + 1000 * 4)
        self.assertEqual(self.analysis(text, given={"g": 7}).round("g"), 0)

    # What it must refuse.

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
        # Not even where the outer one's stands at the header.
        self.expect_refused("""
function f
  record 4
1: movs r2, #100
2: subs r2, #1
  bne 2b
  subs r1, #1
  bne 1b
  bx lr
done f
""", "has no record")

    # A counted loop has its record for itself.
    def test_refuses_loop_with_the_record_of_a_counted_one(self):
        self.expect_refused("""
function f
  record 16
  add.w r3, r1, #64
1: str r0, [r1], #4
  cmp r1, r3
  bne 1b
2: subs r2, #1
  bne 2b
  bx lr
done f
""", "shares its record with another one")

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
  record 20, 6
  nop
1: subs r1, #4
  bgt 1b
  .loc 1 9
2: subs r2, #1
  bgt 2b
  bx lr
done f
""", "has no record")

    def test_refuses_two_loops_for_one_record_without_lines(self):
        self.expect_refused("""
function f
  record 20
  nop
1: subs r1, #4
  bgt 1b
2: subs r2, #1
  bgt 2b
  bx lr
done f
""", "shares its record with another one")

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

    def test_refuses_jump_to_between_instructions(self):
        self.expect_refused("function f\n b.n 1f + 2\n1: movw r0, #0x1234\n bx lr\ndone f\n",
                            "a jump to between instructions")

    def test_refuses_function_of_data(self):
        self.expect_refused("function f\n .word 0\ndone f\n", "there are no instructions of it")

    # No record leads to it: loops that share one have others between them.
    def test_refuses_prices_with_which_a_cycle_gains(self):
        text = """
function f
  record 3
1: nop
  record 4
2: nop
  record 5
3: subs r0, #1
  bne 3b
  subs r1, #1
  bne 2b
  subs r2, #1
  bne 1b
  bx lr
done f
"""
        analysis = self.analysis(text)
        graph, bounds, costs = analysis._prepare(analysis.image.named("f").start, None)
        bound.Dearest(graph, bounds, costs).way()
        inner, middle, outer = (next(b for b in bounds if loop in b.loops) for loop in graph.loops)
        outer.loops += inner.loops
        outer.entered += inner.entered
        with self.assertRaises(image.Refused) as caught:
            bound.Dearest(graph, [outer, middle], costs).way()
        self.assertIn("a cycle gains", str(caught.exception))

    def test_refuses_half_a_record(self):
        for section in ("loops", "inner", "beams"):
            with self.assertRaises(image.Refused) as caught:
                self.analysis("function f\n bx lr\ndone f\n"
                              f'.section .note.hardpack.{section},"",%note\n.long 0x8000\n', beams=4)
            self.assertIn("ends in the middle of a record", str(caught.exception))

    def test_refuses_what_is_no_elf_file(self):
        with self.assertRaises(image.Refused) as caught:
            image.Image(__file__)
        self.assertIn("not a little-endian ELF file", str(caught.exception))

    def test_beams_that_the_lidar_lacks(self):
        text = """
function f
  movs r1, #10
  record_beams 130, 128
1: adds r0, #1
  subs r1, #1
  bne 1b
  bx lr
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 1 + 131 * 3 + 1)
        self.assertEqual(self.analysis(text, beams=128).bound("f"), 1 + 131 * 3 + 1)
        self.assertEqual(self.analysis(text, beams=64).bound("f"), 1 + 67 * 3 + 1)
        with self.assertRaises(image.Refused):
            self.analysis(text, beams=129)
        # Of two loops at one address nobody knows which one it is.
        both = text.replace("  record_beams", "  record 20\n  record_beams")
        self.assertEqual(self.analysis(both, beams=64).bound("f"), self.analysis(both).bound("f"))
        # But for their lines.
        lines = both.replace("130, 128", "130, 128, 8").replace("record 20", "record 20, 6")
        self.assertEqual(self.analysis(lines, beams=64).bound("f"), 1 + 67 * 3 + 1)

    def test_refuses_what_runs_on_behind_its_end(self):
        self.expect_refused("function f\n nop\ndone f\nfunction g\n bx lr\ndone g\n",
                            "runs on behind its end")

    def test_refuses_what_never_returns(self):
        self.expect_refused("function f\n nop\n record 5\n1: nop\n b 1b\ndone f\n",
                            "never returns")

    def test_refuses_unknown_name(self):
        self.expect_refused("function f\n bx lr\ndone f\n", "0 functions are called", name="g")


if __name__ == "__main__":
    unittest.main(verbosity=1)
