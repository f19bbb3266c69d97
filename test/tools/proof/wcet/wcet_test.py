#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static timing analyser (tools/proof/wcet) on Thumb-2 functions whose bound is known by hand."""

import unittest

from assembled import OfThumb, image


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

    def test_size_is_a_constant_before_the_call(self):
        for before in ("movs r2, #8", "movs r5, #9\n bl g\n subs r5, #1\n mov r2, r5",
                       "movw r2, #8\n cmp r0, #0\n bne 1f\n nop\n1:"[:11],
                       "movs r4, #100\n mov.w r2, #6\n adds r2, #2\n str.w r4, [r3], #4"):
            text = f"{self.MEMSET}function g\n bx lr\ndone g\n" \
                   f"function f\n push {{lr}}\n {before}\n bl memset\n pop {{pc}}\ndone f\n"
            lines = before.count("\n") + 1 + before.count("bl g")
            # 8 back edges are allowed, of 3 instructions each.
            self.assertEqual(self.analysis(text).bound("f"), 1 + lines + 1 + 1 + 9 * 3 + 1 + 1)

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


if __name__ == "__main__":
    unittest.main(verbosity=1)
