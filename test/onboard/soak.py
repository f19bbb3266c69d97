# SPDX-License-Identifier: Apache-2.0
"""Drives to and fro for some minutes with the recorder on, then tells what was held (tools/soak.sh
says more). Runs where there is a vcan0."""

import argparse
import json
import pathlib
import subprocess
import sys
import time

import onboard_case
from onboard_case import HARDPACK, OnboardCase, wait_until

FAR_M = 20.0


def ms(time_ns):
    return f"{time_ns / 1e6:.1f} ms"


class Soak(OnboardCase):
    """One long run; `arguments` is the command line."""

    arguments = None

    def runTest(self):
        log = {"max_total_mb": self.arguments.log_mb, "file_size_mb": 128, "buffer_mb": 64}
        if self.arguments.log_directory:
            log["directory"] = str(self.arguments.log_directory)
        self.log_folder = pathlib.Path(log.get("directory", self.folder / "log"))
        self.misses = []
        self.stops = 0
        self.start("--world", "open", "--trace-period", "0.5", log=log,
                   process={"abort_on_allocation": False})
        self.drive(self.arguments.minutes * 60.0)
        self.command("disarm")
        self.status("vehicle", mode="standby")
        time.sleep(0.5)
        report = self.watch.now
        self.assertEqual(self.hardpackd.end(), 0)
        self.summary_of_vehicle = self.vehicle.summary()
        self.print_table(report, self.replay())
        self.assertEqual(report["program"]["heap_allocations"], 0)
        self.assertEqual(report["recorder"]["dropped"], 0)
        self.assertFalse(self.summary_of_vehicle["collided"])
        self.assertEqual(self.replayed, 0)
        self.assertLessEqual(report["program"]["missed_ticks"],
                             self.arguments.max_missed_share * report["program"]["tick_index"])

    def drive(self, seconds):
        """From one end to the other and back until the time is over."""
        end = time.monotonic() + seconds
        goals = [FAR_M, 0.0]
        turn = 0
        self.command("arm")
        asked = 0.0
        while time.monotonic() < end:
            self.assertTrue(self.hardpackd.runs(), "hardpackd ended")
            report = self.watch.now
            self.follow_misses(report)
            mode = report["vehicle"]["mode"]
            if mode in ("fault", "emergency_stop", "standby") and time.monotonic() - asked > 2.0:
                self.stops += mode == "fault"
                self.ctl("disarm")
                time.sleep(1.0)
                self.ctl("arm")
                asked = time.monotonic()
            elif mode == "armed" and time.monotonic() - asked > 2.0:
                self.ctl("goal", goals[turn % 2], 0)
                turn += 1
                asked = time.monotonic()
            time.sleep(0.2)
        self.goals = turn

    def follow_misses(self, report):
        program = report["program"]
        seen = self.misses[-1][1] if self.misses else 0
        if program["missed_ticks"] > seen:
            self.misses.append((program["last_missed_tick"], program["missed_ticks"],
                                program["last_miss_late_ns"], report["vehicle"]["mode"]))

    def replay(self):
        files = sorted(self.log_folder.glob("*.pcap"))
        result = subprocess.run([HARDPACK, "replay", "--from-image", *map(str, files)],
                                capture_output=True, text=True, check=False)
        self.replayed = result.returncode
        return (result.stdout or result.stderr).strip()

    def print_table(self, report, replayed):
        program, recorder = report["program"], report["recorder"]
        summary = self.summary_of_vehicle
        rows = [
            ("time", f"{program['uptime_ns'] / 6e10:.1f} min"),
            ("driven", f"{summary['driven_m']:.0f} m to {self.goals} goals, at most "
                       f"{summary['max_speed']:.1f} m/s"),
            ("stops by a fault", self.stops),
            ("ticks", program["tick_index"]),
            ("missed ticks", program["missed_ticks"]),
            ("latest tick", ms(program["worst_late_ns"])),
            ("longest tick", f"{ms(program['worst_tick_ns'])}, tick {program['worst_tick_index']}"),
            ("heap allocations", program["heap_allocations"]),
            ("real-time priority", program["realtime_scheduled"]),
            ("recorder", f"{recorder['bytes'] / 1e6:.0f} MB, {recorder['files']} files, "
                         f"{recorder['dropped']} dropped, {recorder['write_errors']} errors"),
            ("lidar datagrams", f"{report['lidar_socket']['received']}, "
                                f"{report['lidar_socket']['lost_in_kernel']} lost in the kernel"),
            ("CAN frames", f"{report['can']['accepted']} sent, {report['can']['received']} "
                           f"received, {report['can']['expired']} expired"),
            ("plans", report["replan"]["plans"]),
            ("vehicle's largest lag", f"{summary['worst_lag_ms']} ms"),
            ("replay", replayed),
        ]
        for name, value in rows:
            print(f"{name:24}{value}")
        print("missed ticks as they were seen: before tick, in all, the last one late by, mode")
        for tick, total, late_ns, mode in self.misses:
            print(f"{tick:10}{total:8}{ms(late_ns):>12}  {mode}")
        sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--log-directory", type=pathlib.Path)
    parser.add_argument("--log-mb", type=int, default=1500)
    parser.add_argument("--max-missed-share", type=float, default=1.0)
    Soak.arguments = parser.parse_args()
    # In a long run a machine that stands still is what is to be seen, in a short one it is all.
    Soak.attempts = 1 if Soak.arguments.minutes >= 1.0 else 3
    result = onboard_case.unittest.TextTestRunner().run(Soak())
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
