#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which record is a loop's own, and how often it is gone round (tools/proof/wcet), on Thumb-2 functions
whose bound is known by hand, and on what the compiler makes of loops."""

import unittest

from assembled import OfThumb, bound, image


class Loops(OfThumb):

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


if __name__ == "__main__":
    unittest.main(verbosity=1)
