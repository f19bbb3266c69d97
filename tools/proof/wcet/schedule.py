# SPDX-License-Identifier: Apache-2.0
"""What the bounds of a tick mean in time on one processor: an estimate, by the cost model that
config/timing.toml states ([schedule]). Instructions are bounded; cycles are not.

A tick begins every period, or when the one before has ended. So what the lidar's light tells waits for
the rest of its packet, for the directions beside its own that its class depends on, for the tick that
has just begun, and for the tick that decides; then for the frames before its own on the bus. The
reaction radius is the way driven meanwhile (docs/safety.md). Neither is bounded where more columns come
in the longest tick than it takes: what they tell is lost.
"""

import math


class Schedule:
    def __init__(self, facts, tick, bounds):
        """tick: the configuration's [tick]. bounds: {name: instructions} with it."""
        self.of = {**facts.table["schedule"], **tick}
        self.bounds = bounds
        self.constants = facts.table["constants"]

    def ms(self, instructions):
        cycles = instructions * self.of["cycles_of_10_instructions"] / 10
        return cycles / (self.of["clock_mhz"] * 1000)

    def plan_ticks(self, units, transitions):
        """Ticks that so many units take, when each stage may leave most of its last portion unused."""
        portion = self.constants["portion_units"]
        portions = -(-units // portion) + transitions
        return -(-portions // -(-self.of["planning_units"] // portion))

    def latency_ms(self, tick_ms):
        """From a return's light to the frame on the bus, when no tick takes longer."""
        lidar = (self.of["packet_columns"] + self.of["waited_columns"]) / self.of["columns_per_s"]
        waiting = max(tick_ms, self.of["period_ms"])
        return 1000 * lidar + waiting + tick_ms + self.of["bus_us"] / 1000

    def lost(self, tick_ms):
        """Which of the columns that come while a tick lasts it does not take, as text; None: it takes
        them all."""
        come = math.ceil(self.of["columns_per_s"] * max(tick_ms, self.of["period_ms"]) / 1000)
        more = come - self.of["directions"]
        return f"none: {more} columns of {come} are lost in a tick" if more > 0 else None

    def radius_m(self, latency_ms):
        return self.of["speed_mmps"] / 1000 * latency_ms / 1000

    def lines(self, measured):
        """(what, by the bounds, as counted) as text. measured: {name: number}."""
        worst = self.ms(self.bounds["the worst tick"])
        counted = measured.get("instructions_worst_tick")
        mean = measured.get("instructions_mean_tick")
        counted_ms = self.ms(counted) if counted else None
        rounds = measured.get("rounds_of_planning")

        def text(value, unit, form=".1f"):
            return "-" if value is None else f"{format(value, form)} {unit}"

        def reaction(tick_ms):
            """Latency and radius."""
            if tick_ms is None:
                return "-", "-"
            latency = self.latency_ms(tick_ms)
            lost = self.lost(tick_ms)
            return lost or text(latency, "ms"), lost or text(self.radius_m(latency), "m", ".2f")
        latency, radius = reaction(worst)
        counted_latency, counted_radius = reaction(counted_ms)
        return [
            ("tick period", text(self.of["period_ms"], "ms", "d"), ""),
            ("units of planning in a tick", str(self.of["planning_units"]), ""),
            ("a tick without planning", text(self.ms(self.bounds["a tick without planning"]), "ms"), "-"),
            ("a tick, mean", "", text(self.ms(mean) if mean else None, "ms")),
            ("the worst tick", text(worst, "ms"), text(counted_ms, "ms")),
            ("ticks for a whole plan", str(self.plan_ticks(self.constants["plan_units"],
                                                           self.constants["plan_transitions"])),
             text(measured["ticks"] / rounds if rounds else None, "(mean)")),
            ("from a return's light to a frame", latency, counted_latency),
            (f"reaction radius at {self.of['speed_mmps'] / 1000:g} m/s", radius, counted_radius),
        ]


def print_schedule(schedule, measured):
    print(f"an estimate: {schedule.of['processor']}, "
          f"{schedule.of['cycles_of_10_instructions'] / 10} cycles an instruction")
    print(f"{'':36} {'by the bounds':>14} {'as counted':>12}")
    for what, bound, counted in schedule.lines(measured):
        print(f"{what:36} {bound:>14} {counted:>12}")
