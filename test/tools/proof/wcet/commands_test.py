#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The commands of tools/proof/wcet as processes."""

import os
import subprocess
import sys
import unittest

from assembled import OfThumb


class Command(OfThumb):
    """tools/proof/wcet/wcet.py as a process."""

    def run_wcet(self, *arguments):
        command = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "proof", "wcet", "wcet.py")
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
        self.assertIn("not a little-endian ELF file", self.run_wcet(__file__, "f").stderr)
        self.assertEqual(self.run_wcet("--help").returncode, 0)


FACTS = """
stops = []
[parameters]
directions = 4
planning_units = 640
beams = 128
with_g = 1
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
beams = 64
with_g = {with_g}
[[excluded]]
where = "with_g"
of = [{excluded}]
[idle]
within = "f"
of = [{idle}]
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


class Schedule(OfThumb):
    """tools/proof/wcet/timing.py --schedule, on numbers that can be followed by hand."""

    PROGRAM = """
function f
  record 1000
1: cmp r0, #0
  beq.n 2f
  nop
  b.n 1b
2: bx lr
done f
"""

    def schedule(self, period, measured="", program=PROGRAM, idle="", excluded="", with_g=0,
                 directions=400):
        self.analysis(program)
        configuration = os.path.join(self.folder, "tick.toml")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write(f"[tick]\nperiod_ms = {period}\ndirections = {directions}\n"
                       "planning_units = 128\n")
        facts = os.path.join(self.folder, "facts.toml")
        with open(facts, "w", encoding="utf-8") as file:
            file.write(FACTS.format(configuration=configuration, idle=idle,
                                    excluded=excluded, with_g=with_g))
        numbers = os.path.join(self.folder, "measured")
        with open(numbers, "w", encoding="utf-8") as file:
            file.write(measured)
        command = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "proof", "wcet", "timing.py")
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

    # 22 columns come in the 2.2 ms that a tick may last.
    def test_no_latency_where_columns_are_lost(self):
        lost = "none: 1 columns of 22 are lost in a tick"
        table = self.schedule(period=1, directions=21, measured="instructions_worst_tick 10\n")
        for name in ("from a return's light to a frame", "reaction radius at 5 m/s"):
            self.assertEqual(" ".join(table[name][:10]), lost)
        # As counted, it is 2 ms.
        self.assertEqual(table["from a return's light to a frame"][10:], ["7.5", "ms"])
        table = self.schedule(period=1, directions=22)
        self.assertEqual(table["from a return's light to a frame"], ["7.9", "ms", "-"])
        # And of a shorter tick, those of its period: 50.
        table = self.schedule(period=5, directions=49)
        self.assertIn("none: 1 columns of 50", " ".join(table["reaction radius at 5 m/s"]))

    def test_without_planning_its_functions_are_not_called(self):
        # A loop that looks at its units behind its first round.
        program = """
function g
  nop
  nop
  bx lr
done g
function f
  record 1000
1: bl g
  subs r0, #1
  bne.n 1b
  bx lr
done f
"""
        table = self.schedule(period=1, program=program)
        self.assertEqual(table["a tick without planning"][0], "1.4")  # 3 + 3 + 1
        table = self.schedule(period=1, program=program, idle='"g"')
        self.assertEqual(table["a tick without planning"][0], "0.8")
        self.assertEqual(table["the worst tick"][0], "2.6")
        # What the configuration never calls is in no tick at all.
        table = self.schedule(period=1, program=program, excluded='"g"')
        self.assertEqual(table["the worst tick"][0], "1.4")  # 2 * 3 + 1
        table = self.schedule(period=1, program=program, excluded='"g"', with_g=1)
        self.assertEqual(table["the worst tick"][0], "2.6")

    def test_as_counted(self):
        table = self.schedule(period=1, measured="ticks 70\nrounds_of_planning 20\n"
                              "instructions_mean_tick 5\ninstructions_worst_tick 50\n")
        self.assertEqual(table["a tick, mean"], ["1.0", "ms"])
        self.assertEqual(table["the worst tick"][-2:], ["10.0", "ms"])
        self.assertEqual(table["ticks for a whole plan"][-2:], ["3.5", "(mean)"])
        self.assertEqual(table["from a return's light to a frame"][-2:], ["23.5", "ms"])
        self.assertEqual(table["reaction radius at 5 m/s"][-2:], ["0.12", "m"])


class Timing(OfThumb):
    """tools/proof/wcet/timing.py on facts that are not as they should be."""

    CALLS = """
[[calls]]
within = "f"
because = "a test"
of = ["g"]
most = "{most}"
at_least = "{least}"
"""

    def timing(self, *arguments, most="3 * directions", least="12", measured=""):
        self.analysis("function g\n bx lr\ndone g\nfunction f\n record 1000\n1: bl g\n"
                      " subs r0, #1\n bne 1b\n bx lr\ndone f\n")
        facts, numbers = os.path.join(self.folder, "facts.toml"), os.path.join(self.folder, "counted")
        with open(facts, "w", encoding="utf-8") as file:
            file.write(FACTS.format(configuration="", idle="", excluded="", with_g=1))
            file.write(self.CALLS.format(most=most, least=least))
        with open(numbers, "w", encoding="utf-8") as file:
            file.write(measured)
        command = os.path.join(os.environ["HARDPACK_SOURCE"], "tools", "proof", "wcet", "timing.py")
        return subprocess.run([sys.executable, command, "--facts", facts, "--measured", numbers,
                               *arguments, os.path.join(self.folder, "a")], capture_output=True,
                              text=True, check=False)

    def expect_wrong(self, words, *arguments, **options):
        done = self.timing(*arguments, **options)
        self.assertEqual(done.returncode, 1)
        self.assertIn(words, done.stderr)

    def test_facts_as_they_should_be(self):
        self.assertEqual(self.timing().returncode, 0)
        self.assertEqual(self.timing("--set", "directions=5").returncode, 0)
        self.assertEqual(self.timing("--set", "directions").returncode, 2)

    def test_refuses_facts_that_it_does_not_know(self):
        self.expect_wrong("columns is not one of the parameters", "--set", "columns=5")
        for most in ("columns", "directions / 2", "1.5", "most(directions, 2)"):
            with self.subTest(most):
                self.expect_wrong(f"{most}: not understood", most=most)

    def test_refuses_fewer_than_the_reason_needs(self):
        self.expect_wrong("g: 3 * directions are 9, fewer than 12", "--set", "directions=3")

    def test_parameters_are_compared_with_the_defaults(self):
        constants = "constant portion_units 64\nconstant plan_units 6400\n" \
                    "constant plan_transitions 10\n"
        self.assertEqual(self.timing(measured=constants).returncode, 0)
        same, other = (f"{constants}constant directions {n}\n" for n in (4, 5))
        self.assertEqual(self.timing(measured=same).returncode, 0)
        self.expect_wrong("the parameter directions is 5 by default, not 4", measured=other)
        self.assertEqual(self.timing("--set", "directions=6", measured=other).returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=1)
