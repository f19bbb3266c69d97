# SPDX-License-Identifier: Apache-2.0
"""hardpackd as a process: how it ends, starts, logs, and whom it listens to."""

import grp
import json
import os
import signal
import subprocess
import unittest

import onboard_case
from onboard_case import HARDPACK, HARDPACKD, OnboardCase, wall, wait_until

FULL_SPEED_RADPS = 17.5
NOBODY = 65534
RPDO_TIMEOUT_S = 0.2  # the drives' own


class Ends(OnboardCase):
    """While it drives, with a wall ahead: who does not stop drives into it."""

    def setUp(self):
        self.start("--world", "open", *wall(25.0))
        self.drive_off(speed_mps=2.0)

    # SR-PGM01
    def test_by_sigterm_in_order(self):
        since_s = self.vehicle.now["t"]
        self.assertEqual(self.hardpackd.end(signal.SIGTERM), 0)
        self.assertIn("ended after", self.hardpackd.err)
        took_s = self.rest_after(since_s)
        print(f"{self.id()}: at rest {took_s:.2f} s after SIGTERM")
        self.assertLess(took_s, 5.0)
        samples = self.vehicle.samples(since_s)
        # The speed is taken down along a ramp, not switched off.
        fast = [one["left"]["command"] for one in samples]
        steps = [a - b for a, b in zip(fast, fast[1:])]
        self.assertLess(max(steps), 0.5 * FULL_SPEED_RADPS)
        # At rest first, then disabled.
        off = [one["t"] for one in self.vehicle.events("state")
               if one["from"] == "enabled" and one["t"] > since_s]
        self.assertEqual(len(off), 2)
        before = [abs(one["v"]) for one in samples if one["t"] < min(off)]
        self.assertLess(before[-1], 0.15)
        self.assertFalse(self.vehicle.events("emcy"))
        self.assertFalse(self.vehicle.events("collision"))
        self.assertFalse(self.socket.exists())

    def test_by_sighup_in_order_though_sigterm_comes_besides(self):
        # SR-STP03: as a service manager and a terminal that goes send them.
        since_s = self.vehicle.now["t"]
        self.hardpackd.process.send_signal(signal.SIGHUP)
        self.hardpackd.process.send_signal(signal.SIGTERM)
        self.hardpackd.process.send_signal(signal.SIGHUP)
        self.assertEqual(self.hardpackd.end(signal.SIGHUP), 0)
        self.assertIn("ended after", self.hardpackd.err)
        self.assertLess(self.rest_after(since_s), 5.0)
        self.assertFalse(self.vehicle.events("emcy"))

    def test_at_once_by_an_emergency_stop_while_it_ends(self):
        # SR-STP01
        since_s = self.vehicle.now["t"]
        self.hardpackd.process.send_signal(signal.SIGTERM)
        wait_until(lambda: self.watch.now["vehicle"]["mode"] == "safe_stop", "a safe stop")
        self.command("estop")
        self.rest_after(since_s)
        self.assertEqual(self.hardpackd.end(signal.SIGHUP), 0)

    # SR-DRV03
    def test_by_sigkill_and_the_drives_stop_by_themselves(self):
        since_s = self.vehicle.now["t"]
        self.assertEqual(self.hardpackd.end(signal.SIGKILL), -signal.SIGKILL)
        event_s = self.last_command_s(since_s)
        self.assert_rest_within(event_s, RPDO_TIMEOUT_S + self.coasting_s(event_s))
        self.assertTrue(self.vehicle.events("emcy"))  # the time-out of their commands
        # And it starts anew over what the dead one left: the socket, the log, faulty drives.
        self.start_hardpackd("hardpackd_again")
        self.assertEqual(self.watch.now["vehicle"]["mode"], "standby")
        self.wait_ready_to_reset()
        self.drive_off(self.vehicle.now["x"] + 10.0, 0.5)
        self.end_hardpackd()


class Starts(OnboardCase):
    """Or does not."""

    def run_hardpackd(self, path):
        return subprocess.run([HARDPACKD, "--config", str(path)], capture_output=True, text=True,
                              timeout=60, check=False)

    # SR-CFG01
    def test_not_with_a_bad_configuration(self):
        path = self.configuration(drive={"left_sing": 1, "gear_ratio": -1.0})
        result = self.run_hardpackd(path)
        self.assertEqual(result.returncode, 2)
        lines = result.stderr.splitlines()
        self.assertGreaterEqual(len(lines), 2, result.stderr)
        self.assertTrue(all(line.startswith("hardpackd: ") for line in lines), result.stderr)
        self.assertRegex(result.stderr, r"left_sing.*left_sign")
        self.assertRegex(result.stderr, r"onboard\.toml:\d+.*gear_ratio")

    def test_not_without_its_bus(self):
        self.start_vehicle()
        result = self.run_hardpackd(self.configuration(can={"interface": "can7"}))
        self.assertEqual(result.returncode, 1)
        self.assertIn("can7", result.stderr)

    # SR-OPR06
    def test_not_a_second_time_and_the_first_goes_on(self):
        self.start("--world", "open")
        self.drive_off()
        before = self.watch.now["program"]
        result = self.run_hardpackd(self.configuration("second.toml"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("control", result.stderr)
        report = self.watch.now
        self.assertEqual(report["vehicle"]["mode"], "driving")
        self.assertGreater(report["program"]["tick_index"], before["tick_index"])
        self.assertEqual(report["can"]["foreign_frames"], 0)
        self.end_hardpackd()


class Logs(OnboardCase):
    """When the medium is full."""

    # SR-LOG02, SR-LOG03
    def test_drives_on_counts_and_says_what_is_missing(self):
        folder = self.folder / "small"
        folder.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=48m", "tmpfs", folder], check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", folder], check=True)
        ballast = folder / "ballast"
        ballast.write_bytes(bytes(30_000_000))
        self.start("--world", "open", log={"directory": str(folder / "log"), "buffer_mb": 4,
                                           "file_size_mb": 200})
        self.drive_off(60.0)
        report = wait_until(lambda: self.watch.now["recorder"]["dropped"] > 100 and self.watch.now,
                            "dropped records")
        self.assertGreater(report["recorder"]["write_errors"], 0)
        self.assertEqual(report["vehicle"]["mode"], "driving")
        ballast.unlink()  # room again
        seen = report["recorder"]["written_bytes"]
        wait_until(lambda: self.watch.now["recorder"]["written_bytes"] > seen + 6_000_000,
                   "a log that goes on")
        self.assertEqual(self.watch.now["vehicle"]["mode"], "driving")
        self.end_hardpackd()
        result = subprocess.run([HARDPACK, "replay", *sorted((folder / "log").glob("*.pcap"))],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertIn("not comparable", result.stderr)
        self.assertIn("records are missing", result.stderr)


class Listens(OnboardCase):
    """To its sensors and to those who may command."""

    # SR-INP05
    def test_not_to_datagrams_of_others(self):
        self.start("--world", "open")
        self.vehicle.do("lidar-foreign on")
        report = wait_until(lambda: self.watch.now["lidar_socket"]["foreign"] > 50
                            and self.watch.now, "foreign datagrams that are counted")
        taken = report["loop"]["lidar_datagrams"]
        wait_until(lambda: self.watch.now["lidar_socket"]["foreign"] > 200, "more of them")
        self.assertEqual(self.watch.now["loop"]["lidar_datagrams"], taken)
        refused = self.ctl("arm")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("lidar_old", refused.stderr)
        self.vehicle.do("ins-foreign on")
        wait_until(lambda: self.watch.now["ins_socket"]["foreign"] > 10, "the same of the INS")
        self.vehicle.do("lidar-foreign off")
        self.vehicle.do("ins-foreign off")
        wait_until(lambda: self.watch.now["loop"]["lidar_datagrams"] > taken + 50, "its own again")
        self.command("arm")
        self.end_hardpackd()

    def as_user(self, *arguments, groups=()):
        return self.ctl(*arguments, user=NOBODY, group=NOBODY, extra_groups=list(groups))

    # SR-OPR01
    @unittest.skipUnless(os.geteuid() == 0, "only root can become another user")
    def test_to_the_owner_and_the_group_alone(self):
        group = next(one for one in grp.getgrall() if one.gr_gid not in (0, NOBODY))
        self.start("--world", "open", control={"group": group.gr_name})
        os.chmod(self.socket.parent, 0o755)
        for arguments in (["arm"], ["estop"], ["goal", 5, 0]):
            result = self.as_user(*arguments)
            self.assertNotEqual(result.returncode, 0, arguments)
        self.assertEqual(self.watch.now["vehicle"]["mode"], "standby")
        result = self.as_user("arm", groups=[group.gr_gid])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.status("vehicle", mode="armed")
        # Who gets in because somebody opened the file to all may look, not command.
        os.chmod(self.socket, 0o777)
        result = self.as_user("status", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["vehicle"]["mode"], "armed")
        self.assertNotEqual(self.as_user("disarm").returncode, 0)
        self.status("control", not_permitted=1)
        self.assertEqual(self.watch.now["vehicle"]["mode"], "armed")
        self.end_hardpackd()


if __name__ == "__main__":
    unittest.main()
