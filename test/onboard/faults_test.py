# SPDX-License-Identifier: Apache-2.0
"""What goes wrong with the sensors, their wires and the operator while the vehicle is at speed, with
something ahead that it must not touch. It comes to rest within a stated time, or goes on around what
stands in its way; docs/safety.md has the limits. The drives and their bus: bus_faults_test.py; the
death of hardpackd: program_test.py."""

import math
import unittest

import onboard_case
from onboard_case import OnboardCase, wall, wait_until

# A wall across the way, and a goal in front of it: who does not stop drives into it.
WALL_M = 24.0
GOAL_M = 18.0
FAST_MPS = 2.5

# A box in the way, and a goal behind it: who does not see or steer drives into it.
BOX_M = 9.0
BOX = ["--at", f"0 box {BOX_M} 0 1.5 1.5"]
BEHIND_M = 17.0

# Parameters' defaults (docs/parameters.md), but for the odometry's age (onboard_case.py).
LIDAR_AGE_S = 0.3
INS_AGE_S = 0.2
ODOMETRY_AGE_S = 0.3
FROZEN_S = 1.0
SPIN_S = 1.0
HARD_AGE_FACTOR = 3
MAX_DECELERATION_MPS2 = 2.0
REVOLUTION_S = 0.1
TICKS_S = 0.05  # a few ticks and turns of the simulated vehicle
PLAN_S = 0.5    # no plan takes longer: half of safety.max_plan_age_s


class AtSpeed(OnboardCase):
    """Each limit is the time until it is noticed and the time that the vehicle then takes."""

    def along_path_s(self, event_s):
        """From the fastest speed after the event along a ramp to rest, which the drives follow with
        their lag: what is left of it when the ramp has ended, dies away."""
        fastest_mps = max(abs(one["v"]) for one in self.vehicle.samples(event_s))
        left_mps = MAX_DECELERATION_MPS2 * onboard_case.LAG_S
        return (fastest_mps / MAX_DECELERATION_MPS2 + onboard_case.DEAD_TIME_S
                + onboard_case.LAG_S * math.log(left_mps / onboard_case.REST_MPS) + 0.1)

    def old_input_s(self, event_s, age_s):
        """Along the path once the age is too old; zero at once when it is far too old."""
        self.rest_after(event_s)
        return TICKS_S + min(age_s + self.along_path_s(event_s),
                             HARD_AGE_FACTOR * age_s + self.coasting_s(event_s))

    def at_speed(self, *arguments, **changed):
        self.start("--world", "open", *wall(WALL_M), *arguments, **changed)
        self.drive_off(GOAL_M, FAST_MPS)

    def said(self, reason):
        """The reason of the last stop, once it is told."""
        self.status("vehicle", last_stop=reason)

    # --- silence ----------------------------------------------------------------------------------

    # SR-SUP05
    def test_lidar_silent(self):
        self.at_speed()
        event_s = self.vehicle.do("lidar off")
        self.assert_rest_within(event_s, self.old_input_s(event_s, LIDAR_AGE_S))
        self.said("lidar_old")
        self.end_hardpackd()

    # SR-SUP05
    def test_ins_silent(self):
        self.at_speed()
        event_s = self.vehicle.do("ins off")
        self.assert_rest_within(event_s, self.old_input_s(event_s, INS_AGE_S))
        self.said("ins_old")
        self.end_hardpackd()

    # SR-SUP05
    def test_datagrams_delayed(self):
        # The first of them leave a gap that is as long as a silence that is not put up with.
        self.at_speed()
        self.vehicle.do("lidar-delay 200")
        event_s = self.vehicle.do("ins-delay 200")
        self.rest_after(event_s)
        self.assert_rest_within(event_s, INS_AGE_S + TICKS_S + self.along_path_s(event_s))
        self.said("ins_old")
        self.end_hardpackd()

    # SR-OPR04
    def test_operator_gone(self):
        timeout_s = 1.0
        self.start("--world", "open", *wall(WALL_M), safety={"operator_timeout_s": timeout_s,
                                                             "max_odometry_age_s": ODOMETRY_AGE_S})
        # SR-STP06: the program is left over at its terminal, and nobody presses a key.
        program = self.start_program(onboard_case.AtTerminal, "drive",
                                     [onboard_case.HARDPACK, "ctl", "--socket", self.socket,
                                      "drive"])
        self.drive_off(GOAL_M, FAST_MPS)
        event_s = self.vehicle.now["t"]
        program.leave()
        self.assertTrue(program.runs())
        self.rest_after(event_s)
        self.assert_rest_within(event_s, timeout_s + TICKS_S + self.along_path_s(event_s))
        self.said("operator_silent")
        self.end_hardpackd()

    # --- wrong measurements -----------------------------------------------------------------------

    # SR-CMD04, SR-ODO02
    def test_wheel_feedback_frozen(self):
        # Of both sides: at the speed that is reported for ever nothing is in doubt but by what the
        # ground speed of the INS does, and the wall comes next.
        self.at_speed()
        event_s = self.vehicle.do("frozen both on")
        self.assert_rest_within(event_s, self.frozen_s(event_s))
        print(f"{self.id()}: {self.watch.now['vehicle']}")
        self.vehicle.do("frozen both off")  # else the drives are waited for to be at rest
        self.end_hardpackd()

    def frozen_s(self, event_s):
        """At the latest: it goes on at the speed that is reported until the ramp before the goal
        changes the real one; frozen is what does not change in a whole window of FROZEN_S in which
        the ground speed does by 1 m/s, the next but one; then the odometry is old. A drive that is
        told to brake and reports that it does not is noticed earlier."""
        self.rest_after(event_s)
        first = self.vehicle.samples(event_s)[0]
        to_ramp_s = (GOAL_M - first["x"]) / first["v"]
        return (to_ramp_s + 2 * FROZEN_S + HARD_AGE_FACTOR * ODOMETRY_AGE_S + TICKS_S
                + self.coasting_s(event_s))

    # --- the goal ---------------------------------------------------------------------------------

    # SR-SUP11
    def test_goal_in_an_obstacle_that_appears(self):
        self.at_speed(astar={"move_goal_out_of_obstacle": 0})
        # So small that what is seen of it is all around the goal.
        event_s = self.vehicle.do(f"box {GOAL_M} 0 0.5 1.5")
        self.rest_after(event_s)
        self.assert_rest_within(event_s, REVOLUTION_S + 2 * PLAN_S + self.along_path_s(event_s))
        self.status("vehicle", stop_reason="goal_in_obstacle")
        self.end_hardpackd()

    def test_goal_in_an_obstacle_is_moved_out_of_it(self):
        self.start("--world", "open", *BOX)
        self.drive_off(BOX_M, 1.0)
        event_s = self.vehicle.now["t"]
        # Until the box has been seen from another side its inside seems to be free.
        wait_until(lambda: self.watch.now["vehicle"]["mode"] == "armed", "the goal reached", 60.0)
        self.assert_untouched()
        place = self.vehicle.now
        print(f"{self.id()}: {place['t'] - event_s:.1f} s, at {place['x']:.2f} {place['y']:.2f}")
        # The nearest free place: half the box, the planning radius (at a corner of the box), and
        # two cells' diagonals; 1 m more; and what reaching a goal and the odometry may be off.
        self.assertLess(math.hypot(place["x"] - BOX_M, place["y"]), 0.75 + 0.94 + 0.57 + 1.0 + 0.8)
        self.end_hardpackd()

    # --- what does not stop it --------------------------------------------------------------------

    def assert_untouched(self):
        wait_until(lambda: abs(self.vehicle.now["v"]) < onboard_case.REST_MPS, "wheels at rest")
        self.assertFalse(self.vehicle.events("collision"))

    def reaches_goal_with(self, *events, vehicle=(), **changed):
        """Around the box to the goal; the events happen at speed, each 0.5 s after the one before."""
        self.start("--world", "open", *BOX, *vehicle, **changed)
        self.drive_off(BEHIND_M, 1.5)
        for event in events:
            event_s = self.vehicle.do(event)
            wait_until(lambda: self.vehicle.now["t"] > event_s + 0.5, "half a second")
        self.status("vehicle", mode="armed")
        self.assert_untouched()
        place = self.vehicle.now
        report = self.watch.now
        off_m = math.hypot(place["x"] - BEHIND_M, place["y"])
        print(f"{self.id()}: ended {off_m:.2f} m off the goal")
        self.assertLess(off_m, 1.0, report["vehicle"]["last_stop"])
        self.end_hardpackd()
        return report

    # SR-ODO04
    def test_ins_not_tracking(self):
        report = self.reaches_goal_with("ins-mode 1")
        self.assertNotEqual(report["ins"]["mode"], "tracking")

    # SR-ODO04
    def test_gnss_jumps(self):
        report = self.reaches_goal_with("ins-jump 8 -5")
        self.assertGreater(report["odometry"]["map_rejected"], 0)

    # SR-PER05
    def test_labels_gone(self):
        report = self.reaches_goal_with(
            "labels off", vehicle=["--labels-to", "127.0.0.1:7510"],
            labels={"address": "127.0.0.1", "port": 7510}, mapping={"use_labels": 1})
        self.assertGreater(report["mapper"]["folded_with_labels"], 0)
        self.assertGreater(report["mapper"]["folded_without_labels"], 0)

    # SR-PER08
    def test_datagrams_lost(self):
        report = self.reaches_goal_with("lidar-loss 100", "ins-loss 100")
        self.assertGreater(report["lidar_packets"]["missing"], 50)

    # SR-PER08
    def test_datagrams_reordered(self):
        report = self.reaches_goal_with("lidar-reorder 4", "ins-reorder 4")
        self.assertGreater(report["lidar_packets"]["out_of_order"], 50)

    # SR-INP01, SR-PER08
    def test_datagrams_duplicated(self):
        report = self.reaches_goal_with("lidar-duplicate on", "ins-duplicate on")
        self.assertGreater(report["lidar_packets"]["duplicates"], 50)

    def test_lidar_datagrams_delayed(self):
        self.reaches_goal_with("lidar-delay 200")

    def test_lidar_delay_grows(self):
        # SR-TIM01: 100 ms later in every second; a clock does not do that.
        self.at_speed()
        event_s = self.vehicle.do("lidar-delay-growth 100")
        growing_s = LIDAR_AGE_S / 0.1 * 1.2
        self.rest_after(event_s)
        self.assert_rest_within(event_s, growing_s + self.along_path_s(event_s))
        self.said("lidar_old")
        self.end_hardpackd()

    def test_wheels_slip(self):
        # SR-STP05: the vehicle goes a fifth of the way that its wheels turn.
        self.at_speed()
        event_s = self.vehicle.do("traction 200")
        self.assert_rest_within(event_s, SPIN_S + TICKS_S + 0.2 + self.coasting_s(event_s))
        self.said("wheel_spin")
        self.end_hardpackd()

    # SR-INP07
    def test_lidar_clock_jumps(self):
        report = self.reaches_goal_with("lidar-clock -2000", "lidar-clock 3000")
        self.assertEqual(report["lidar_clock"]["jumps"], 2)


if __name__ == "__main__":
    unittest.main()
