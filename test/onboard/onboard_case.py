# SPDX-License-Identifier: Apache-2.0
"""Runs hardpackd against a scripted vehicle on real sockets, and commands it with `hardpack ctl`.

To be run under tools/vcan.sh: needs vcan0 and a network of its own. CTest gives the programs in
HARDPACKD, HARDPACK_COMMAND and SCRIPTED_VEHICLE.
"""

import collections
import json
import math
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HARDPACKD = os.environ["HARDPACKD"]
HARDPACK = os.environ["HARDPACK_COMMAND"]
SCRIPTED_VEHICLE = os.environ["SCRIPTED_VEHICLE"]
CAN = "vcan0"
NODES = {"left": 2, "right": 3}
PATIENCE_S = 30.0  # for what is no matter of time
REST_MPS = 0.03
DEAD_TIME_S = 0.15  # of the simulated drives (tools/sim/vehicle/wheel_motor.h)
LAG_S = 0.48

# Written to by many small writes while the vehicle drives: in memory, not on a disk.
SCRATCH = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None

DEFAULTS = {
    "lidar": {"address": "127.0.0.1", "metadata": None},
    "ins": {"address": "127.0.0.1", "port": 7600},
    "can": {"interface": CAN},
    "drive": {"left_sign": 1, "right_sign": -1, "gear_ratio": 24.0, "login_user": 1,
              "login_password": 4660, "feedback_timeout_ms": 300},
    # In User-Mode Linux a tick that touches new memory may take 90 ms, and a drive reports on SYNC.
    # Nobody sits at a test's terminal, but where that is what it is about.
    "safety": {"max_odometry_age_s": 0.3, "operator_timeout_s": 0},
    "log": {"directory": None, "min_free_mb": 0, "max_total_mb": 800, "buffer_mb": 16},
    "control": {"socket": None},
    "process": {"abort_on_allocation": True},
    # The vehicle, its sensors and this program share the machine's only core.
    "tick": {"planning_units": 1000},
}
VEHICLE = ["--can", CAN, "--gear-ratio", "24", "--left-sign", "1", "--right-sign", "-1",
           "--max-wheel-speed", "17.5",
           # What spares the slow system calls of User-Mode Linux.
           "--lidar-columns", "512", "--turn-ms", "5"]
# Drives and sensors do not wait for a computer to have time for them.
AHEAD_OF_ALL = ["chrt", "--fifo", "60"]
if subprocess.run([*AHEAD_OF_ALL, "true"], capture_output=True, check=False).returncode != 0:
    AHEAD_OF_ALL = []


def read_ahead():
    """Programs and what they are linked with: all of a User-Mode Linux machine stands still while a
    page of them comes from a disk that is busy."""
    for program in (HARDPACKD, HARDPACK, SCRIPTED_VEHICLE, "chrt", "ip", "candump", "tcpdump"):
        path = shutil.which(program)
        if path is None:
            continue
        linked = subprocess.run(["ldd", path], capture_output=True, text=True, check=False).stdout
        for word in [path, *linked.split()]:
            if word.startswith("/") and os.path.isfile(word):
                pathlib.Path(word).read_bytes()


read_ahead()


def wall(front_m, size_m=6.0):
    """A scripted vehicle's arguments: a wall across the x axis, that near."""
    return ["--at", f"0 box {front_m + size_m / 2} 0 {size_m} 2"]


def toml(tables):
    def value(item):
        return json.dumps(item)  # texts, numbers and truth values are written alike

    return "".join(f"[{name}]\n" + "".join(f"{key} = {value(item)}\n"
                                           for key, item in keys.items())
                   for name, keys in tables.items())


def is_listened_to(interface):
    """Whether a candump listens on it. Where none does, the list has "(vcan0: no entry)"."""
    receivers = pathlib.Path("/proc/net/can/rcvlist_all").read_text()
    return re.search(rf"^ *{interface} ", receivers, re.MULTILINE) is not None


def wait_until(condition, what, patience_s=PATIENCE_S):
    """What the condition returns as soon as it is true."""
    end = time.monotonic() + patience_s
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"in {patience_s} s there was not: {what}")
        time.sleep(0.02)


class Program:
    """A process of ours; its output goes to files, which `told` reads."""

    def __init__(self, folder, name, command, **options):
        self.name = name
        self.paths = [folder / f"{name}.out", folder / f"{name}.err"]
        with open(self.paths[0], "w") as out, open(self.paths[1], "w") as err:
            self.process = subprocess.Popen([str(word) for word in command], stdout=out,
                                            stderr=err, **{"stdin": subprocess.DEVNULL, **options})

    @property
    def out(self):
        return self.paths[0].read_text(errors="replace")

    @property
    def err(self):
        return self.paths[1].read_text(errors="replace")

    def runs(self):
        return self.process.poll() is None

    def end(self, number=signal.SIGTERM, patience_s=PATIENCE_S):
        """The exit status that the signal leads to."""
        if self.runs():
            self.process.send_signal(number)
        try:
            return self.process.wait(patience_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise AssertionError(f"{self.name} did not end in {patience_s} s") from None

    def told(self):
        return "".join(f"--- {path.name}\n{path.read_text(errors='replace')[-6000:]}"
                       for path in self.paths)


class AtTerminal(Program):
    """A program at a terminal of its own, at which a key is pressed five times a second until
    `leave`; the program goes on."""

    def __init__(self, folder, name, command):
        self.keys, terminal = pty.openpty()
        super().__init__(folder, name, command, stdin=terminal)
        os.close(terminal)
        self.gone = threading.Event()
        self.thread = threading.Thread(target=self.press, daemon=True)
        self.thread.start()

    def press(self):
        while not self.gone.wait(0.2):
            os.write(self.keys, b" ")

    def leave(self):
        self.gone.set()
        self.thread.join()


class Traced(Program):
    """A simulated vehicle that tells in a file of JSON lines what happens to it."""

    def __init__(self, folder, name, command, **options):
        self.trace_path = folder / "trace.jsonl"
        self.lines = []
        self.offset = 0
        super().__init__(folder, name, [*AHEAD_OF_ALL, *command, "--trace", self.trace_path],
                         **options)

    def trace(self):
        """Everything traced so far."""
        with open(self.trace_path, "rb") as file:
            file.seek(self.offset)
            whole, newline, _ = file.read().rpartition(b"\n")
        self.offset += len(whole) + len(newline)
        self.lines += [json.loads(line) for line in whole.splitlines()]
        return self.lines

    def samples(self, since_s=0.0):
        return [line for line in self.trace() if "v" in line and line["t"] >= since_s]

    def events(self, name):
        return [line for line in self.trace() if line.get("event") == name]

    @property
    def now(self):
        """Its last sample."""
        return wait_until(self.samples, "a sample of the vehicle")[-1]


class Vehicle(Traced):
    """A scripted_vehicle; `do` makes one of its script's events happen now."""

    def __init__(self, folder, *arguments):
        self.metadata = folder / "lidar.json"
        super().__init__(folder, "scripted_vehicle",
                         [SCRIPTED_VEHICLE, *VEHICLE, "--metadata", self.metadata,
                          "--interactive", *arguments], stdin=subprocess.PIPE)
        wait_until(lambda: "ready" in self.out or not self.runs(), "a ready vehicle")
        if not self.runs():
            raise AssertionError(self.told())

    def do(self, event):
        """The vehicle's time at which it happened."""
        before = len(self.events("script"))
        self.process.stdin.write((event + "\n").encode())
        self.process.stdin.flush()
        wait_until(lambda: len(self.events("script")) > before or not self.runs(), event)
        if not self.runs():
            raise AssertionError(self.told())
        return self.events("script")[-1]["t"]

    def summary(self):
        self.end()
        return json.loads(self.out.splitlines()[-1])


class Watch:
    """Follows `hardpack ctl status --watch`; `now` is the newest report."""

    def __init__(self, folder, socket):
        self.reports = collections.deque(maxlen=100)  # of the last ten seconds
        self.error = open(folder / "watch.err", "w")
        self.process = subprocess.Popen(
            [HARDPACK, "ctl", "--socket", str(socket), "status", "--watch", "--json",
             "--interval", "0.1"], stdout=subprocess.PIPE, stderr=self.error,
            stdin=subprocess.DEVNULL)
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read(self):
        for line in self.process.stdout:
            self.reports.append(json.loads(line))

    @property
    def now(self):
        return wait_until(lambda: self.reports, "a status")[-1]

    def end(self):
        self.process.terminate()
        self.process.wait()
        self.thread.join()
        self.process.stdout.close()
        self.error.close()


class OnboardCase(unittest.TestCase):
    """A test with a folder, a vehicle and a hardpackd of its own. Ends only what it started; what
    they said is shown when it fails."""

    # A machine that stands still for longer than a time-out under test (a User-Mode Linux kernel
    # does while its host's disk is busy) makes another test of it. The vehicle, which has the
    # highest priority and hardly anything to do, tells of each time that it was woken late; only a
    # failure in a run in which it was is tried again.
    attempts = 3

    def run(self, result=None):
        result = result or self.defaultTestResult()
        for attempt in range(1, self.attempts + 1):
            own = unittest.TestResult()
            stalls = self.run_once(own)
            if own.wasSuccessful() or not stalls or attempt == self.attempts:
                break
            print(f"=== {self.id()}: attempt {attempt} tells nothing, the machine stood still: "
                  f"{stalls}", file=sys.stderr)
        result.testsRun += own.testsRun
        for kind in ("failures", "errors", "skipped"):
            getattr(result, kind).extend(getattr(own, kind))
        return result

    def run_once(self, result):
        """Runs the test; returns when (vehicle's time in s) and for how long (ms) the machine stood
        still meanwhile."""
        self.programs = []
        self.vehicle = self.watch = None
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="onboard_", dir=SCRATCH))
        self.folder.chmod(0o755)
        begun = time.monotonic()
        try:
            super().run(result)
            if not result.wasSuccessful():
                print(f"=== {self.id()}", *(text for _, text in result.failures + result.errors),
                      "".join(one.told() for one in self.programs), self.last_words(),
                      sep="\n", file=sys.stderr)
            traced = self.vehicle and self.vehicle.trace_path.exists()
            return [(one["t"], one["ms"]) for one in self.vehicle.events("late")] if traced else []
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)
            print(f"{self.id()}: {time.monotonic() - begun:.1f} s", file=sys.stderr)

    def last_words(self):
        words = ""
        if getattr(self, "vehicle", None):
            words += "".join(json.dumps(line) + "\n" for line in self.vehicle.trace()
                             if "event" in line)[-4000:]
            words += "".join(json.dumps(line) + "\n" for line in self.vehicle.samples()[-3:])
        if getattr(self, "watch", None) and self.watch.reports:
            words += json.dumps(self.watch.reports[-1], indent=1)
        return words

    def start_program(self, kind, *arguments, **options):
        program = kind(self.folder, *arguments, **options)
        self.programs.append(program)
        self.addCleanup(program.end, signal.SIGKILL)
        return program

    # --- starting ---------------------------------------------------------------------------------

    def configuration(self, name="onboard.toml", **changed):
        """Writes a configuration; `changed` gives keys of tables, None for one to be left out."""
        tables = {table: dict(keys) for table, keys in DEFAULTS.items()}
        tables["lidar"]["metadata"] = str(self.folder / "lidar.json")
        tables["log"]["directory"] = str(self.folder / "log")
        tables["control"]["socket"] = str(self.socket)
        for table, keys in changed.items():
            tables.setdefault(table, {}).update(keys)
        tables = {table: {key: item for key, item in keys.items() if item is not None}
                  for table, keys in tables.items()}
        path = self.folder / name
        path.write_text(toml(tables))
        return path

    @property
    def socket(self):
        return self.folder / "control.sock"

    def start_vehicle(self, *arguments):
        self.vehicle = self.start_program(Vehicle, *arguments)
        return self.vehicle

    def start_hardpackd(self, name="hardpackd", **changed):
        """A hardpackd whose status can be asked for."""
        self.hardpackd = self.start_program(
            Program, name, [HARDPACKD, "--config", self.configuration(**changed)])
        wait_until(lambda: "running" in self.hardpackd.err or not self.hardpackd.runs(),
                   "a running hardpackd")
        if not self.hardpackd.runs():
            raise AssertionError("hardpackd ended")
        self.watch = Watch(self.folder, self.socket)
        self.addCleanup(self.watch.end)
        return self.hardpackd

    def start(self, *arguments, **changed):
        """Both, with drives that are ready."""
        self.start_vehicle(*arguments)
        self.start_hardpackd(**changed)
        self.wait_ready()

    # --- commanding -------------------------------------------------------------------------------

    def ctl(self, *arguments, **options):
        return subprocess.run([HARDPACK, "ctl", "--socket", str(self.socket), "--timeout", "10",
                               *map(str, arguments)], capture_output=True, text=True, timeout=60,
                              check=False, **options)

    def command(self, *arguments):
        result = self.ctl(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)

    def status(self, group, **expected):
        """Waits for a status in which the group's fields are so, and returns it."""
        def as_expected():
            self.assertTrue(self.hardpackd.runs(), "hardpackd ended")
            return all(self.watch.now[group][key] in (item if isinstance(item, tuple) else (item,))
                       for key, item in expected.items()) and self.watch.now

        return wait_until(as_expected, f"status of {group} {expected}")

    def wait_ready(self):
        self.status("left_drive", state="ready")
        self.status("right_drive", state="ready")
        wait_until(lambda: self.watch.now["loop"]["lidar_datagrams"] > 64, "the lidar's datagrams")

    def drive_off(self, x_m=40.0, speed_mps=1.0):
        """Armed and under way along x."""
        self.command("arm")
        self.command("goal", x_m, 0)
        wait_until(lambda: self.vehicle.now["v"] > speed_mps, f"{speed_mps} m/s")

    # --- judging ----------------------------------------------------------------------------------

    def rest_after(self, event_s, patience_s=PATIENCE_S):
        """How long after the event the wheels have come to rest for good."""
        def at_rest():
            samples = self.vehicle.samples(event_s)
            if not samples:
                return False
            tail = [one for one in samples if one["t"] > samples[-1]["t"] - 0.3]
            return (samples[-1]["t"] - event_s > 0.5 and len(tail) > 3
                    and all(abs(one["v"]) < REST_MPS for one in tail))

        wait_until(at_rest, "wheels at rest", patience_s)
        moving = [one["t"] for one in self.vehicle.samples(event_s) if abs(one["v"]) >= REST_MPS]
        return (moving[-1] - event_s) if moving else 0.0

    def last_command_s(self, since_s):
        """When a drive took its last command: a program that cuts the bus takes a while to start
        (0.3 s were seen), which is not the vehicle's."""
        self.rest_after(since_s)
        samples = self.vehicle.samples(since_s)
        return max((after["t"] for before, after in zip(samples, samples[1:])
                    for side in ("left", "right") if after[side]["rpdos"] > before[side]["rpdos"]),
                   default=since_s)

    def coasting_s(self, event_s):
        """How long the drives take from the fastest speed after the event to rest once they are told
        to stop: their dead time and first-order lag (tools/sim/vehicle/wheel_motor.h), and 0.1 s."""
        self.rest_after(event_s)
        fastest_mps = max(abs(one["v"]) for one in self.vehicle.samples(event_s))
        return DEAD_TIME_S + LAG_S * math.log(max(fastest_mps / REST_MPS, 1.0)) + 0.1

    def assert_rest_within(self, event_s, most_s):
        took_s = self.rest_after(event_s)
        fastest_mps = max(abs(one["v"]) for one in self.vehicle.samples(event_s))
        print(f"{self.id()}: at rest {took_s:.2f} s after the event, limit {most_s:.2f} s, from "
              f"{fastest_mps:.1f} m/s at most", file=sys.stderr)
        self.assertLess(took_s, most_s, "time until the wheels were at rest")
        self.assertFalse(self.vehicle.events("collision"))

    def recover_and_drive(self, speed_mps=0.5):
        """A fault that has gone is left by the operator, who then drives on."""
        self.command("disarm")
        self.status("vehicle", mode="standby")
        self.wait_ready_to_reset()
        self.drive_off(self.vehicle.now["x"] + 10.0, speed_mps)

    def wait_ready_to_reset(self):
        """Each drive is ready, or has nothing but an old fault."""
        self.status("left_drive", state=("ready", "fault"))
        self.status("right_drive", state=("ready", "fault"))

    def end_hardpackd(self):
        """SIGTERM: clean, and nothing was allocated while it ran."""
        self.assertEqual(self.watch.now["program"]["heap_allocations"], 0)
        self.assertEqual(self.hardpackd.end(), 0)
        self.assertIn("ended after", self.hardpackd.err)
