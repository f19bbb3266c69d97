# SPDX-License-Identifier: Apache-2.0
"""hardpackd as it is built for the vehicle's computer, with a simulated vehicle on the other side of
its sockets and of its CAN bus, drives a mission in an emulated machine with Debian's arm64 kernel
and a vcan of its own. candump's log is then checked frame by frame, and the flight log replayed on
this machine's own processor, where `hardpack` is built, and on the other one.

The machine's clock is what it has computed (tools/arm64_vcan.sh --own-clock): a second of it takes
several of ours, and nothing in it is late because this machine is busy. Its one core has to do the
vehicle's part as well, so the lidar turns at 5 Hz and a tick plans less than usual."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "test" / "onboard"))
import bus_log  # noqa: E402

WORLD, GOAL_M = "open", (12.0, 0.0)
PROGRAMS = [pathlib.Path(os.environ[name])
            for name in ("HARDPACKD", "SCRIPTED_VEHICLE", "HARDPACKCTL")]
STRIP = os.environ["STRIP"]
REPLAY_LOG = ["qemu-aarch64", os.environ["REPLAY_LOG"]]
HOST_COMMAND = pathlib.Path(os.environ["HOST_COMMAND"])
NOT_THERE = 125  # says arm64_vcan.sh; CTest takes it for skipped
LIMIT_S = 560


class HardwareInTheLoop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = pathlib.Path(tempfile.mkdtemp(prefix="hil_"))
        cls.addClassCleanup(shutil.rmtree, cls.scratch)
        folder = cls.scratch / "machine"
        shutil.copytree(SOURCE / "test" / "aarch64" / "machine", folder)
        for program in PROGRAMS:
            subprocess.run([STRIP, "-o", folder / program.name, program], check=True)
        cls.out = cls.scratch / "out"
        begun = time.monotonic()
        result = subprocess.run(
            [SOURCE / "tools" / "arm64_vcan.sh", "--own-clock", "--memory", "2G", "--timeout",
             str(LIMIT_S), "--bring-back", cls.out, folder, "sh", "mission.sh", WORLD,
             *map(str, GOAL_M)], capture_output=True, text=True, check=False)
        took_s = time.monotonic() - begun
        print(result.stdout + result.stderr, f"{took_s:.0f} s of this machine's time")
        if result.returncode == NOT_THERE:
            os._exit(NOT_THERE)
        if result.returncode != 0:
            for name in ("hardpackd.err", "vehicle.out", "status.txt"):
                if (cls.out / name).exists():
                    print(f"--- {name}\n" + (cls.out / name).read_text(errors="replace")[-6000:])
            raise AssertionError(f"the mission ended with {result.returncode}")
        uptime_s = float(re.findall(r"^([0-9.]+) ", result.stdout, re.MULTILINE)[-1])
        print(f"{uptime_s:.1f} s of the emulated machine's")

    def test_the_vehicle_has_arrived_untouched(self):
        summary = json.loads((self.out / "vehicle.out").read_text().splitlines()[-1])
        off_m = ((summary["x"] - GOAL_M[0]) ** 2 + (summary["y"] - GOAL_M[1]) ** 2) ** 0.5
        print(f"{off_m:.2f} m from its goal, {summary['max_speed']:.2f} m/s at most")
        self.assertLess(off_m, 0.6)
        self.assertFalse(summary["collided"])
        self.assertEqual(summary["can"]["failed"], 0)

    def test_hardpackd_was_punctual_and_ended_as_told(self):
        self.assertEqual((self.out / "hardpackd.status").read_text().strip(), "0")
        status = json.loads((self.out / "status.json").read_text())
        told = {key: status["program"][key] for key in
                ("missed_ticks", "heap_allocations", "realtime_scheduled", "memory_locked",
                 "worst_tick_ns", "worst_late_ns")}
        print(told)
        self.assertEqual(told["missed_ticks"], 0)
        self.assertEqual(told["heap_allocations"], 0)
        self.assertTrue(told["realtime_scheduled"])
        self.assertEqual(status["recorder"]["dropped"], 0)

    def test_every_frame_on_the_bus_is_as_documented(self):
        log = bus_log.BusLog(self, self.out / "candump.log")
        log.check()
        print(f"{len(log.frames)} frames", *log.told, sep="\n")

    def test_the_log_replays_on_both_processors(self):
        logs = sorted((self.out / "log").glob("*.pcap"))
        self.assertEqual(len(logs), 1)
        hashes = set()
        there = subprocess.run([*REPLAY_LOG, *logs], capture_output=True, text=True, check=False)
        print("aarch64:", there.stdout + there.stderr)
        self.assertEqual(there.returncode, 0)
        hashes.add(re.search(r"decision hash ([0-9a-f]{16})", there.stdout)[1])
        if HOST_COMMAND.exists():
            here = subprocess.run([HOST_COMMAND, "replay", "--json", *logs], capture_output=True,
                                  text=True, check=False)
            print("here:", here.stdout[:300] + here.stderr)
            self.assertEqual(here.returncode, 0)
            hashes.add(f"{int(json.loads(here.stdout)['decision_hash'], 16):016x}")
        else:
            print(f"not replayed on this machine's processor: there is no {HOST_COMMAND}")
        self.assertEqual(len(hashes), 1, hashes)


if __name__ == "__main__":
    unittest.main()
