#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static timing analyser (tools/proof/wcet) on A64 functions whose bound is known by hand."""

import unittest

from assembled import OfA64


class A64(OfA64):

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

    # --- part of a row, several cells at a time ---------------------------------------------------
    def part_of(self, trips="lsr w3, w4, #2", end="add x3, x1, w3, uxtw #4", between="nop",
                step="#16", behind="and w9, w4, #0xfffffffc", record=100, rest="nop"):
        """A loop with 5 instructions of which the record's loop is one in four."""
        text = f"""
.file 1 "core/part.cpp"
function f
  .loc 1 7
  {trips}
  {end}
  {between}
  record {record}, 6
1: ldr q0, [x1], {step}
  fadd v0.4s, v0.4s, v1.4s
  str q0, [x2], #16
  cmp x3, x1
  b.ne 1b
  {behind}
  {rest}
  b.eq 2f
2: ret
done f
"""
        return self.analysis(text).bound("f")

    def trips_of(self, **options):
        """Trips round it: as often as its back edge, and once more."""
        rounds, rest = divmod(self.part_of(**options) - 3 - 4, 5)
        self.assertEqual(rest, 0)
        return rounds - 1

    def test_vector_loop_over_a_part_of_a_row_is_done_in_fewer_rounds(self):
        self.assertEqual(self.trips_of(), 25)
        self.assertEqual(self.trips_of(record=103), 25)
        self.assertEqual(self.trips_of(behind="tst x4, #0x3"), 25)
        self.assertEqual(self.trips_of(trips="lsr x3, x4, #3", end="add x3, x1, x3, lsl #4",
                                       behind="and x9, x4, #0xfffffffffffffff8"), 12)

    def test_what_vouches_for_the_lanes_has_to_be_there(self):
        for options in ({"behind": "nop"},  # nothing does
                        {"behind": "and w9, w5, #0xfffffffc"},  # another register
                        {"behind": "and w9, w4, #0xfffffff8"},  # other lanes
                        {"behind": "and w9, w4, #0x3c"},
                        {"behind": "mov w4, w5\n and w9, w4, #0xfffffffc"},
                        {"between": "mov w4, w5"},  # it is not what was shifted
                        {"between": "mov x1, x5"},  # it does not begin there
                        {"between": "add x3, x3, #16"},
                        {"end": "add x3, x1, w3, uxtw #3"},  # half of the step
                        {"end": "add x3, x1, w6, uxtw #4"},
                        {"step": "#8"},
                        {"trips": "asr w3, w4, #2"},
                        {"trips": "lsr w4, w4, #2", "end": "add x3, x1, w4, uxtw #4"}):
            with self.subTest(**options):
                extra = options.get("behind", "").count("\n")
                self.assertEqual(self.part_of(**options) - extra, 3 + 101 * 5 + 4)

    # A division that the source does by hand looks the same, but the rest is then another loop.
    def test_rest_has_to_be_of_the_same_loop(self):
        for rest in ("record 3, 8\n nop", ".loc 1 9\n nop", "nop\n record 3, 8"):
            with self.subTest(rest):
                self.assertEqual(self.trips_of(rest=rest), 100)

    def test_division_by_hand(self):
        bounds = self.compiled("""
void ByHand(const float* __restrict in, float* __restrict out, unsigned long cells) {
  const unsigned long whole = cells / 4;
  HP_LOOP_BOUND(100)
  for (unsigned long k = 0; k < whole; ++k) {
    out[4 * k] = in[4 * k] + 1.0f;
    out[4 * k + 1] = in[4 * k + 1] + 1.0f;
    out[4 * k + 2] = in[4 * k + 2] + 1.0f;
    out[4 * k + 3] = in[4 * k + 3] + 1.0f;
  }
  const unsigned long done = cells & ~3ul;
  HP_LOOP_BOUND(3)
  for (unsigned long i = done; i < cells; ++i) out[i] = in[i] + 1.0f;
}
""")
        self.assertGreaterEqual(bounds.bound("ByHand"), 633)  # of 403 cells

    # The jump that closes it is of its body's last line.
    def test_vector_loop_that_is_closed_from_its_body(self):
        text = """
.file 1 "core/body.cpp"
function f
  .loc 1 6
  record 10, 6
  .loc 1 7
  cbz x1, 2f
  .loc 1 9
1: sub x1, x1, #1
  cbnz x1, 1b
2: ret
  {}
done f
"""
        self.assertEqual(self.analysis(text.format("")).bound("f"), 1 + 11 * 2 + 1)
        # Another loop's record between the two: the line can be that loop's.
        self.expect_refused(text.format(".loc 1 8\n record 5, 8\n ret"), "has no record")

    # (n >> 1) at eight a round and n at sixteen are shifted by the same: what is done behind tells.
    def test_lanes_of_half_of_a_number_are_not_those_of_the_number(self):
        self.assertEqual(self.trips_of(trips="lsr w3, w4, #4", behind="and w9, w5, #0xfffffff8"), 100)

    def bytes_of(self, end="and x3, x4, #0xfffffff0", behind="tst x4, #0xf", first="mov x0, #0"):
        text = f"""
.file 1 "core/bytes.cpp"
function f
  .loc 1 7
  {end}
  {first}
  record 512, 6
1: ldr q0, [x1, x0]
  str q0, [x2, x0]
  add x0, x0, #16
  cmp x3, x0
  b.ne 1b
  {behind}
  b.eq 2f
2: ret
done f
"""
        return self.analysis(text).bound("f")

    def test_vector_loop_over_bytes(self):
        self.assertEqual(self.bytes_of(), 2 + 33 * 5 + 3)
        self.assertEqual(self.bytes_of(behind="and w5, w4, #0xfffffff0"), 2 + 33 * 5 + 3)
        for options in ({"behind": "tst x4, #0x7"}, {"behind": "tst x5, #0xf"}, {"behind": "nop"},
                        {"first": "mov x0, #16"}, {"first": "mov x0, x6"},
                        {"end": "and x3, x4, #0xfffffff8"}, {"end": "and x3, x4, #0xf0"}):
            with self.subTest(**options):
                self.assertEqual(self.bytes_of(**options), 2 + 513 * 5 + 3)

    # Shared out among the rounds of the loop around it, the rounds are as much fewer in all.
    def test_vector_loop_whose_work_is_shared(self):
        text = """
.file 1 "core/shared.cpp"
function f
  mov x7, #4
  record_inner 4, 512, 5
2: and x3, x4, #0xfffffff0
  mov x0, #0
  record 512, 7
  .loc 1 8
1: ldr q0, [x1, x0]
  str q0, [x2, x0]
  add x0, x0, #16
  cmp x3, x0
  b.ne 1b
  tst x4, #0xf
  b.eq 3f
3: subs x7, x7, #1
  .loc 1 6
  b.ne 2b
  ret
done f
"""
        self.assertEqual(self.analysis(text).bound("f"), 1 + 5 * (2 + 5 + 4) + 32 * 5 + 1)

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
