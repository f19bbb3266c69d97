#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every kind of function, record and fact that the static timing analyser (tools/proof/wcet) must refuse."""

import unittest

from assembled import OfThumb, bound, image


class Refusals(OfThumb):

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
