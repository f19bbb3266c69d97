# SPDX-License-Identifier: Apache-2.0
"""What goes wrong on the bus while the vehicle drives, or before it may: the wheels come to rest in
a stated time, and the status says why."""

import pathlib
import subprocess
import unittest

from onboard_case import CAN, OnboardCase, wall, wait_until

# Until it is noticed, at most: drive.heartbeat_timeout_ms, and drive.feedback_timeout_ms of
# onboard_case.py. The drives' own time-out, where they stop by themselves, is 0.2 s.
NOTICED_S = 0.3
TICKS_S = 0.05


class WhileDriving(OnboardCase):
    """The vehicle drives when it happens, with a wall ahead: who does not stop drives into it."""

    def setUp(self):
        self.start("--world", "open", *wall(25.0))
        self.drive_off(speed_mps=2.0)

    def assert_stops(self, event_s, noticed_s=NOTICED_S):
        """Zero to both drives once it is noticed; then by their dead time and lag."""
        self.assert_rest_within(event_s, noticed_s + TICKS_S + self.coasting_s(event_s))

    # SR-DRV01
    def test_a_drive_falls_silent(self):
        event_s = self.vehicle.do("drive-silent left on")
        self.status("vehicle", mode="fault", stop_reason="drives")
        self.status("left_drive", state=("fault", "silent"), fault="silent")
        self.assertEqual(self.watch.now["right_drive"]["fault"], "none")
        self.assert_stops(event_s)
        self.assertNotEqual(self.ctl("arm").returncode, 0)
        self.vehicle.do("drive-silent left off")
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV02
    def test_a_drive_reboots(self):
        event_s = self.vehicle.do("reboot right")
        self.status("vehicle", mode="fault", stop_reason="drives")
        # Booting takes as long as a missing heartbeat is put up with: either may be noticed first.
        self.status("right_drive", fault=("rebooted", "silent"), reboots=1)
        self.assert_stops(event_s)
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV02
    def test_a_drive_reports_an_emergency(self):
        event_s = self.vehicle.do("emcy left 0x3210 0x05 0x4581")
        self.status("vehicle", mode="fault", stop_reason="drives")
        report = self.status("left_drive", fault="emergency", emergencies=1)
        self.assertEqual(report["left_drive"]["emergency_code"], "0x3210")
        self.assert_stops(event_s)
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV02
    def test_a_drive_has_a_fault(self):
        event_s = self.vehicle.do("fault right 0x2310 0x03")
        self.status("vehicle", mode="fault", stop_reason="drives")
        self.status("right_drive", fault=("emergency", "status_fault"))
        self.assert_stops(event_s)
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV07
    def test_the_controller_goes_bus_off(self):
        event_s = self.vehicle.do("bus-error bus-off")
        report = self.status("can", bus_offs=1)
        self.status("vehicle", mode=("fault", "safe_stop", "standby", "armed"))
        self.assert_stops(event_s)
        report = self.status("can", state="active")  # the interface was restarted
        self.assertGreaterEqual(report["can"]["restarts"], 1)
        self.assertIn(report["vehicle"]["last_stop"], ("bus", "drives"))
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV04
    def test_another_node_sends_with_our_identifiers(self):
        # Full speed ahead, as the left drive's command: the drive obeys whoever speaks last.
        event_s = self.vehicle.do("can-frame 202#0F00E8030000E803 0.02 50")
        self.status("vehicle", mode="fault", stop_reason="foreign_sender")
        self.assertGreater(self.status("left_drive", fault="foreign_sender")["can"]
                           ["foreign_frames"], 0)
        # It is obeyed for as long as it sends.
        self.assert_stops(event_s, 1.0)
        self.vehicle.do("can-frame 701#05 0.5 20")  # a master's heartbeat, for two commands at least
        self.command("disarm")
        refused = self.ctl("arm")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("foreign_sender", refused.stdout + refused.stderr)
        # Once nobody has been heard for a while, the operator may try again.
        wait_until(lambda: self.ctl("arm").returncode == 0, "arming without another master")
        self.drive_off(self.vehicle.now["x"] + 10.0, 0.5)
        self.end_hardpackd()

    # SR-DRV03, SR-DRV07
    def test_the_interface_goes_down_and_up(self):
        before_s = self.vehicle.now["t"]
        subprocess.run(["ip", "link", "set", CAN, "down"], check=True)
        self.addCleanup(subprocess.run, ["ip", "link", "set", CAN, "up"], check=True)
        self.status("can", state="down")
        self.status("vehicle", mode="fault")
        self.assertIn(self.watch.now["vehicle"]["stop_reason"], ("bus", "drives"))
        # By the drives' own time-out.
        self.assert_stops(self.last_command_s(before_s))
        subprocess.run(["ip", "link", "set", CAN, "up"], check=True)
        self.status("can", state="active")
        self.recover_and_drive()
        self.end_hardpackd()

    # SR-DRV03, SR-DRV08
    def test_the_queue_is_full(self):
        # A bus that takes nothing: the kernel's queue holds a few frames, and all later ones are
        # refused.
        self.load_netem()
        self.addCleanup(subprocess.run, ["tc", "qdisc", "del", "dev", CAN, "root"],
                        check=False, stderr=subprocess.DEVNULL)
        before_s = self.vehicle.now["t"]
        subprocess.run(["tc", "qdisc", "add", "dev", CAN, "root", "netem", "delay", "100s", "limit",
                        "4"], check=True)
        self.assert_stops(self.last_command_s(before_s))
        report = self.status("vehicle", mode="fault")
        counters = report["can"]
        self.assertGreater(counters["expired"] + counters["refused"], 0)
        subprocess.run(["tc", "qdisc", "del", "dev", CAN, "root"], check=True)
        self.recover_and_drive()
        self.end_hardpackd()

    def load_netem(self):
        """The User-Mode Linux machine does not load modules by itself."""
        release = pathlib.Path("/proc/sys/kernel/osrelease").read_text().strip()
        module = pathlib.Path("/usr/lib/uml/modules") / release / "kernel/net/sched/sch_netem.ko"
        if module.exists() and "sch_netem" not in pathlib.Path("/proc/modules").read_text():
            subprocess.run(["insmod", module], check=True)


class BeforeDriving(OnboardCase):
    """The drives are not as they should be: the vehicle cannot be armed."""

    def expect_refused(self, *events, **fields):
        self.start_vehicle("--world", "open")
        for event in events:
            self.vehicle.do(event)
        self.start_hardpackd()
        self.status("left_drive", **fields)
        self.status("right_drive", state="ready")
        refused = self.ctl("arm")
        self.assertEqual(refused.returncode, 1, refused.stdout)
        self.assertRegex(refused.stderr, "drives|odometry_old")
        self.ctl("goal", 10, 0)
        self.assertEqual(self.watch.now["vehicle"]["mode"], "standby")
        self.assertEqual(max(abs(one["v"]) for one in self.vehicle.samples()), 0)
        self.assertFalse([one for one in self.vehicle.events("state") if one["to"] == "enabled"])
        self.end_hardpackd()

    # SR-DRV05
    def test_a_setting_is_aborted(self):
        self.expect_refused("sdo-abort left 0x5902 0x06010002", fault="sdo_abort",
                            sdo_abort_code="0x06010002", sdo_index="0x5902")

    # SR-DRV05
    def test_the_identity_is_wrong(self):
        self.expect_refused("object left 0x1018 1 99", fault="wrong_identity")

    # SR-DRV05
    def test_process_data_are_mapped_otherwise_and_cannot_be_changed(self):
        self.expect_refused("object left 0x1600 2 0x60710010", "sdo-keep left 0x1600 on",
                            fault=("wrong_mapping", "read_back"))


if __name__ == "__main__":
    unittest.main()
