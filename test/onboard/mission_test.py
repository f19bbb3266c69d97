# SPDX-License-Identifier: Apache-2.0
"""A whole run: the drives are brought up, the vehicle drives to a goal, stops and is switched off.
Its flight log replays, and other programs read it; so does a capture of the same run."""

import json
import os
import shutil
import signal
import statistics
import struct
import subprocess
import time
import unittest

import onboard_case
from onboard_case import CAN, HARDPACK, NODES, OnboardCase, is_listened_to, wait_until

GOAL_M = 12.0
COMMAND_PERIOD_S = 0.01
RPDO_TIMEOUT_S = 0.2


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          timeout=120, check=False)


def replay(files, *arguments):
    return run(HARDPACK, "replay", "--json", *arguments, *files)


class Frames:
    """A log of candump -l: (time, identifier, bytes)."""

    def __init__(self, path):
        self.all = []
        for line in path.read_text().splitlines():
            stamp, _, frame = line.split()[:3]
            identifier, _, data = frame.partition("#")
            self.all.append((float(stamp[1:-1]), int(identifier, 16), bytes.fromhex(data)))

    def commands(self, node):
        """(time, target velocity) of each command frame to a drive."""
        return [(stamp, struct.unpack_from("<i", data, 2)[0])
                for stamp, identifier, data in self.all if identifier == 0x200 + node]


class Mission(OnboardCase):
    """One drive of 12 m, watched by candump and tcpdump; then everything that reads what it left."""

    def setUp(self):
        # As on a real network: a lidar's datagram is nine fragments.
        subprocess.run(["ip", "link", "set", "lo", "mtu", "1500"], check=True)
        self.addCleanup(subprocess.run, ["ip", "link", "set", "lo", "mtu", "65536"], check=True)

    def start_candump(self):
        path = self.folder / "candump.log"
        program = self.start_program(onboard_case.Program, "candump",
                                     ["candump", "-L", "-t", "a", CAN])
        program.log = path
        wait_until(lambda: is_listened_to(CAN), "candump")
        return program

    def start_tcpdump(self):
        program = self.start_program(
            onboard_case.Program, "tcpdump",
            ["tcpdump", "-i", "any", "-s", "0", "-B", "65536", "--immediate-mode", "-w",
             self.folder / "capture.pcap"])
        wait_until(lambda: "listening on" in program.err, "tcpdump")
        return program

    def drive(self):
        self.start_vehicle("--world", "open")
        self.start_hardpackd()
        self.wait_ready()
        self.assertEqual(self.watch.now["vehicle"]["mode"], "standby")
        self.assertEqual(self.vehicle.now["v"], 0)
        self.command("arm")
        self.armed = time.time()
        self.command("goal", GOAL_M, 0)
        self.status("vehicle", mode="driving")
        self.status("vehicle", mode="armed")  # arrived
        self.arrived = time.time()
        wait_until(lambda: abs(self.vehicle.now["v"]) < onboard_case.REST_MPS, "wheels at rest")
        place = self.vehicle.now
        self.assertLess(((place["x"] - GOAL_M) ** 2 + place["y"] ** 2) ** 0.5, 0.6)
        self.command("disarm")
        self.status("left_drive", state="ready")
        self.status("right_drive", state="ready")

    # SR-LOG01, SR-STP07
    def test_drives_a_straight_line_and_everything_reads_what_it_left(self):
        candump = self.start_candump()
        tcpdump = self.start_tcpdump()
        self.drive()
        report = self.watch.now
        print(json.dumps({key: report[key] for key in ("program", "recorder", "can")}, indent=1))
        self.end_hardpackd()
        summary = self.vehicle.summary()
        print(json.dumps(summary))
        self.assertFalse(summary["collided"])
        self.assertLess(summary["driven_m"], GOAL_M + 1.0)
        self.assertEqual(tcpdump.end(signal.SIGINT), 0)
        candump.end(signal.SIGTERM)
        self.assertEqual(report["recorder"]["dropped"], 0)
        frames = Frames(candump.paths[0])
        with self.subTest("command frames"):
            self.check_commands(frames)
        logs = sorted((self.folder / "log").glob("*.pcap"))
        with self.subTest("the log replays"):
            self.check_replay(logs)
        with self.subTest("the capture replays"):
            self.check_capture()
        with self.subTest("tshark"):
            self.check_tshark(logs, frames)
        with self.subTest("tcpdump and capinfos"):
            self.check_readers(logs)

    # --- the bus, frame by frame ------------------------------------------------------------------

    def check_commands(self, frames):
        for node in NODES.values():
            commands = frames.commands(node)
            gaps = [b[0] - a[0] for a, b in zip(commands, commands[1:])]
            median = statistics.median(gaps)
            print(f"node {node}: {len(commands)} commands, median gap {1e3 * median:.2f} ms, "
                  f"longest {1e3 * max(gaps):.1f} ms")
            self.assertAlmostEqual(median, COMMAND_PERIOD_S, delta=0.1 * COMMAND_PERIOD_S)
            self.assertLess(max(gaps), RPDO_TIMEOUT_S)
            moving = [stamp for stamp, target in commands if target != 0]
            self.assertGreater(len(moving), 100)
            self.assertGreater(moving[0], self.armed)
            self.assertLess(moving[-1], self.arrived)

    # --- the log ----------------------------------------------------------------------------------

    def check_replay(self, logs):
        result = replay(logs)
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        print({key: report[key] for key in ("ticks", "decision_hash") if key in report})
        kept = os.environ.get("HARDPACK_KEEP_LOG")
        if kept:
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(self.folder / "log", kept)

    def check_capture(self):
        result = replay([self.folder / "capture.pcap"], "--config", self.folder / "onboard.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        print(json.dumps(report)[:1500])

    def check_tshark(self, logs, frames):
        result = run("tshark", "-r", logs[0], "-d", "can.subdissector,canopen", "-Y", "canopen")
        self.assertEqual(result.returncode, 0, result.stderr)
        # NMT commands, heartbeats, questions and answers, process data both ways.
        for name in ("NMT: ", "NMT Error Control: Operational [0x1]",
                     "NMT Error Control: Operational [0x2]", "Default-SDO (rx)",
                     "Default-SDO (tx)", "PDO1 (rx)", "PDO1 (tx)", "SYNC"):
            self.assertIn(name, result.stdout)
        self.assertNotIn("Malformed", result.stdout)

    def check_readers(self, logs):
        result = run("capinfos", "-M", "-c", "-E", logs[0])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("linux-sll2", result.stdout.lower())
        result = run("tcpdump", "-n", "-r", logs[0], "udp port 7502")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(result.stdout.count("127.0.0.1.7502"), 100)


if __name__ == "__main__":
    unittest.main()
