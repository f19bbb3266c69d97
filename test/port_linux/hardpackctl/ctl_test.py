#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `hardpackctl` and `hardpack ctl` send and show and how they end, against a small server of
docs/control.md."""

import json
import os
import pathlib
import pty
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest

COMMAND = os.environ["HARDPACKCTL"].split(" ")
STATUS = subprocess.run([os.environ["HARDPACK_STATUS_SAMPLE"]], check=True,
                        capture_output=True).stdout
ARM, DISARM, GOAL, STOP, ESTOP, ALIVE, PAUSE, RESUME, SKIP, AREA, CLEAR_AREAS = range(1, 12)
GET_STATUS, GET_PARAMETERS = 64, 65
DONE, STATUS_ANSWER, PARAMETERS = 128, 129, 130
OK = 0         # Status
LIDAR_OLD = 2  # StopReason
MOVING = 13


def status_code(name):
    """A code of core/base/status.h, counted by hand."""
    text = (pathlib.Path(os.environ["HARDPACK_SOURCE"]) / "core/base/status.h").read_text()
    number = -1
    for line in text[text.index("enum class"):].splitlines()[1:]:
        word = line.split("//")[0].strip().rstrip(",")
        if word == "};":
            break
        for entry in filter(None, (part.strip() for part in word.split(","))):
            if entry.startswith("kFirstFailure"):
                number = 31
                continue
            number += 1
            if entry.split(" ")[0] == name:
                return number
    raise KeyError(name)


def message(kind, sequence, body=b""):
    return b"HPCT" + struct.pack("<BBHI", 1, kind, 12 + len(body), sequence) + body


class Server:
    """Answers by a function (kind, sequence, body) -> packets; keeps what came."""

    def __init__(self, path, answer):
        self.answer, self.received, self.connections = answer, [], 0
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.bind(str(path))
        self.socket.listen(4)
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            try:
                client, _ = self.socket.accept()
            except OSError:
                return
            self.connections += 1
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        with client:
            while packet := client.recv(65536):
                magic, version, kind, size, sequence = struct.unpack("<4sBBHI", packet[:12])
                assert (magic, version, size) == (b"HPCT", 1, len(packet)), packet
                self.received.append((kind, packet[12:]))
                try:
                    for answer in self.answer(kind, sequence, packet[12:]):
                        client.send(answer)
                except OSError:
                    return

    def close(self):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()


def done(status=OK, reason=0):
    return lambda kind, sequence, body: [message(DONE, sequence, bytes([status, reason]))]


def status_answer(kind, sequence, body):
    return [STATUS[:8] + struct.pack("<I", sequence) + STATUS[12:]]


def hang_up(kind, sequence, body):
    raise OSError


class CtlTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="hardpack_ctl_"))
        self.path = self.folder / "control"
        self.addCleanup(shutil.rmtree, self.folder)

    def serve(self, answer):
        server = Server(self.path, answer)
        self.addCleanup(server.close)
        return server

    def arguments(self, *arguments):
        return [*COMMAND, *map(str, arguments), "--socket", str(self.path)]

    def run_ctl(self, *arguments):
        return subprocess.run(self.arguments(*arguments), capture_output=True, text=True,
                              timeout=60)

    def expect_done(self, *arguments):
        result = self.run_ctl(*arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout

    def expect_failure(self, code, arguments, *parts):
        result = self.run_ctl(*arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for part in parts:
            self.assertIn(str(part), result.stderr)
        return result.stdout


class Commands(CtlTest):
    def test_each_is_sent_and_done(self):
        server = self.serve(done())
        for name, kind in (("arm", ARM), ("disarm", DISARM), ("stop", STOP), ("estop", ESTOP),
                           ("pause", PAUSE), ("resume", RESUME), ("skip", SKIP)):
            self.assertEqual(self.expect_done(name), "done\n")
            self.assertEqual(server.received.pop(), (kind, b""))

    def test_alive_is_another_press_each_time(self):
        server = self.serve(done())
        presses = set()
        for _ in range(3):
            self.assertEqual(self.expect_done("alive"), "done\n")
            kind, press = server.received.pop()
            self.assertEqual((kind, len(press)), (ALIVE, 4))
            presses.add(press)
        self.assertEqual(len(presses), 3)

    def test_a_refusal_says_why(self):
        self.serve(done(status_code("kNotPermitted"), LIDAR_OLD))
        self.assertEqual(self.expect_failure(1, ["arm"], "refused: lidar_old: no lidar column"), "")
        text = self.expect_failure(1, ["arm", "--json"], "lidar_old")
        self.assertEqual(json.loads(text),
                         {"done": False, "status": "not_permitted", "reason": "lidar_old",
                          "text": "refused: lidar_old: no lidar column lately"})

    def test_a_refusal_without_a_reason_says_its_status(self):
        self.serve(done(status_code("kNotPermitted")))
        self.expect_failure(1, ["arm"], "refused: not_permitted: only the owner and the group")

    def test_json(self):
        self.serve(done())
        self.assertEqual(json.loads(self.expect_done("arm", "--json")),
                         {"done": True, "status": "ok", "reason": "none"})

    def test_late_answers_to_others_are_passed_over(self):
        self.serve(lambda kind, sequence, body: [
            message(DONE, sequence + 77, bytes([status_code("kNoPath"), 0])),
            message(DONE, sequence, bytes([OK, 0]))])
        self.expect_done("arm")


class Goals(CtlTest):
    def sent(self, *arguments):
        server = self.serve(done())
        self.expect_done(*arguments)
        (kind, body), = server.received
        self.assertEqual(kind, GOAL)
        return body

    def test_x_y(self):
        self.assertEqual(self.sent("goal", "12.5", "-3"),
                         bytes([1, 0, 0, 0]) + bytes(4) + bytes(4) +
                         struct.pack("<ff", 12.5, -3.0) + bytes(8))

    def test_both_negative_and_a_heading(self):
        self.assertEqual(self.sent("goal", "-1", "-2.5", "--heading", "-0.5"),
                         bytes([1, 1, 0, 0]) + struct.pack("<f", -0.5) + bytes(4) +
                         struct.pack("<ff", -1.0, -2.5) + bytes(8))

    def test_relative(self):
        self.assertEqual(self.sent("goal", "5", "0", "--relative", "--heading", "1"),
                         bytes([1, 1, 1, 0]) + struct.pack("<f", 1.0) + bytes([1, 0, 0, 0]) +
                         struct.pack("<ff", 5.0, 0.0) + bytes(8))

    def test_latitude_and_longitude_to_the_last_digit(self):
        self.assertEqual(self.sent("goal", "--lat", "30.617512345", "--lon", "-96.338912345"),
                         bytes([1, 0, 0, 0]) + bytes(4) + bytes([2, 0, 0, 0]) +
                         struct.pack("<qq", 30617512345, -96338912345))

    def test_waypoints_of_a_file(self):
        path = self.folder / "way.txt"
        path.write_text("# to the hut\n\nlatlon   # WGS 84\n30.6 -96.3\n"
                        "  30.600000001\t-96.300000001 # nearer\n")
        body = self.sent("waypoints", path)
        self.assertEqual(body[:8], bytes([2]) + bytes(7))
        self.assertEqual(struct.unpack("<I2qI2q", body[8:]),
                         (2, 30600000000, -96300000000, 2, 30600000001, -96300000001))

    def test_waypoints_that_are_stopped_at_and_limits_of_speed(self):
        path = self.folder / "way.txt"
        path.write_text("relative\n8 0 stop\n16 0 speed=1.5 stop=250\n24 0 speed=25.5\n32 0 stop\n")
        body = self.sent("waypoints", path)
        marks = [tuple(body[8 + 20 * i:12 + 20 * i]) for i in range(4)]
        self.assertEqual(marks, [(1, 1, 0, 0), (1, 1, 250, 15), (1, 0, 0, 255), (1, 1, 0, 0)])

    def test_a_goal_with_a_limit_of_speed(self):
        self.assertEqual(self.sent("goal", "5", "0", "--speed", "2"),
                         bytes([1, 0, 0, 0]) + bytes(4) + bytes([0, 0, 0, 20]) +
                         struct.pack("<ff", 5.0, 0.0) + bytes(8))

    def test_sixty_four_waypoints_and_no_more(self):
        path = self.folder / "way.txt"
        path.write_text("odom\n" + "".join(f"{i} {-i}\n" for i in range(64)))
        body = self.sent("waypoints", path)
        self.assertEqual(len(body), 8 + 64 * 20)
        self.assertEqual(struct.unpack_from("<Iff", body, 8 + 63 * 20), (0, 63.0, -63.0))
        path.write_text(path.read_text() + "64 64\n")
        self.expect_failure(2, ["waypoints", path], f"{path}:66", "more than 64")

    def test_areas_of_a_file_are_sent_in_order(self):
        path = self.folder / "areas.txt"
        path.write_text("# a pond\nkeep_out odom\n0 0\n4.5 0\n0 -4\n"
                        "speed_zone latlon 1.5\n30.6 -96.3\n30.601 -96.3\n30.6 -96.301\n")
        server = self.serve(done())
        self.expect_done("areas", path)
        (first, one), (second, two) = server.received
        self.assertEqual((first, second), (AREA, AREA))
        self.assertEqual(one[:12], bytes([0, 2, 0, 0, 3, 0, 0, 0]) + bytes(4))
        self.assertEqual(struct.unpack("<iiQiiQiiQ", one[12:]),
                         (0, 0, 0, 4500, 0, 0, 0, -4000, 0))
        self.assertEqual(two[:12], bytes([1, 2, 2, 1, 3, 0, 0, 0]) + struct.pack("<f", 1.5))
        self.assertEqual(struct.unpack("<6q", two[12:]),
                         (30600000000, -96300000000, 30601000000, -96300000000, 30600000000,
                          -96301000000))

    def test_areas_are_cleared(self):
        server = self.serve(done())
        self.expect_done("areas", "--clear")
        self.assertEqual(server.received, [(CLEAR_AREAS, b"")])

    def test_the_first_area_that_is_refused_ends_it(self):
        path = self.folder / "areas.txt"
        path.write_text(3 * "keep_out odom\n0 0\n4 0\n0 4\n")
        refused = done(status_code("kNotPermitted"), MOVING)
        server = self.serve(lambda *message: (done() if message[2][0] == 0 else refused)(*message))
        self.expect_failure(1, ["areas", path], "area 2 was refused", "moving")
        self.assertEqual([body[0] for _, body in server.received], [0, 1])

    def test_bad_area_files(self):
        path = self.folder / "areas.txt"
        path.write_text("keep_out odom\n0 0\n4 4\n4 0\n0 4\n")
        self.expect_failure(2, ["areas", path], f"{path}:1: ", "crosses itself")
        self.expect_failure(2, ["areas"], "a file or --clear")
        self.expect_failure(2, ["areas", path, "--clear"], "--clear")

    def test_bad_goals(self):
        for arguments, part in (((), "X Y"), (("1",), "position"), (("1", "x"), "'x'"),
                                (("nan", "1"), "nan"), (("1", "1e9"), "1e9"),
                                (("1", "2", "--heading", "4"), "--heading"),
                                (("1", "2", "--speed", "0.05"), "--speed"),
                                (("--lat", "1"), "--lon"),
                                (("1", "2", "--lat", "1", "--lon", "2"), "--lat"),
                                (("--lat", "1", "--lon", "2", "--relative"), "--relative"),
                                (("--lat", "90.000000001", "--lon", "0"), "within 90"),
                                (("--lat", "0", "--lon", "-180.1"), "within 180"),
                                (("--lat", "1.0000000001", "--lon", "0"), "nine decimals"),
                                (("--lat", "1e1", "--lon", "0"), "'1e1'"),
                                (("--lat", "1.", "--lon", "0"), "'1.'"),
                                (("--lat", ".5", "--lon", "0"), "'.5'"),
                                (("--lat", "99999999999999999999", "--lon", "0"), "within 90"),
                                (("--lat", "", "--lon", ""), "X Y")):
            with self.subTest(arguments):
                self.expect_failure(2, ["goal", *arguments], part)

    def test_bad_files(self):
        path = self.folder / "way.txt"
        for text, line, part in (("", 0, "no waypoint"), ("odom\n", 1, "no waypoint"),
                                 ("1 2\n", 1, "odom, relative or latlon"),
                                 ("# a\nodom\n1\n", 3, "x and y"),
                                 ("odom\n1 2 3\n", 2, "'3'"),
                                 ("odom\n1 2 stop=0\n3 4\n", 2, "1 to 255"),
                                 ("odom\n1 2 stop=256\n3 4\n", 2, "1 to 255"),
                                 ("odom\n1 2 stop=1.5\n3 4\n", 2, "1 to 255"),
                                 ("odom\n1 2 stop=\n3 4\n", 2, "1 to 255"),
                                 ("odom\n1 2 speed=0\n", 2, "0.1 to 25.5"),
                                 ("odom\n1 2 speed=25.6\n", 2, "0.1 to 25.5"),
                                 ("odom\n1 2 speed=1.25\n", 2, "0.1 to 25.5"),
                                 ("odom\n1 2 speed=-1\n", 2, "0.1 to 25.5"),
                                 ("odom\n1 2 speed=1.\n", 2, "0.1 to 25.5"), ("odom\n1 two\n", 2, "'two'"),
                                 ("relative\n1 inf\n", 2, "inf"),
                                 ("latlon\n91 0\n", 2, "latitude"),
                                 ("latlon\n1 2\n1 200\n", 3, "longitude")):
            with self.subTest(text):
                path.write_text(text)
                self.expect_failure(2, ["waypoints", path], f"{path}:{line}: ", part)
        path.write_text("odom\n1 2\n3 4 stop=5\n")
        self.expect_failure(2, ["waypoints", path], path, "last waypoint")
        self.expect_failure(2, ["waypoints", self.folder / "absent"], "absent")


class Status(CtlTest):
    def test_text_marks_what_is_wrong(self):
        self.serve(status_answer)
        text = self.expect_done("status")
        rows = {}
        for line in text.splitlines():
            for cell in (line[i:i + 48].rstrip() for i in range(0, len(line), 48)):
                words = cell[1:].split(maxsplit=1)
                if len(words) == 2:
                    rows.setdefault(words[0], []).append((cell[0], words[1]))
        for name, expected in (("mode", ("!", "safe_stop")), ("stop_reason", ("!", "lidar_old")),
                               ("last_stop", (" ", "none")), ("x_m", (" ", "12.300")),
                               ("lidar_age", ("!", "412.0 ms of 300.0 ms")),
                               ("ins_age", (" ", "12.0 ms of 200.0 ms")),
                               ("operator_age", (" ", "never")), ("missed_ticks", ("*", "3")),
                               ("missing", ("*", "17")), ("uptime", (" ", "1 h 02 min")),
                               ("worst_tick", (" ", "4.2 ms")), ("memory_locked", ("!", "no")),
                               ("realtime_scheduled", (" ", "yes")), ("status", ("!", "no_path")),
                               ("latitude", (" ", "30.617512345")),
                               ("longitude", (" ", "-96.038912345")),
                               ("fault", ("!", "emergency")), ("nmt_state", (" ", "operational")),
                               ("statusword", (" ", "0x0218")), ("state", ("!", "fault")),
                               ("state", (" ", "unknown (200)")), ("state", (" ", "active"))):
            self.assertIn(expected, rows[name], name)
        self.assertNotIn("wrong_sensor", rows)
        self.assertIn("wrong_sensor", self.expect_done("status", "--all"))
        self.assertNotIn("\033", text)

    def test_json_has_every_field_in_its_unit(self):
        self.serve(status_answer)
        report = json.loads(self.expect_done("status", "--json"))
        self.assertEqual(report["program"]["version"], "9.8.7")
        self.assertEqual(report["program"]["tick_index"], 2**64 - 1)
        self.assertEqual(report["program"]["decision_hash"], "0x0123456789abcdef")
        self.assertIs(report["program"]["realtime_scheduled"], True)
        self.assertEqual(report["vehicle"]["mode"], "safe_stop")
        self.assertEqual(report["vehicle"]["x_m"], 12.3)
        self.assertIsNone(report["vehicle"]["speed_mps"])
        self.assertEqual(report["inputs"]["lidar_age_ns"], 412000000)
        self.assertEqual(report["inputs"]["lidar_age_limit_ns"], 300000000)
        self.assertIsNone(report["inputs"]["operator_age_ns"])
        self.assertIsNone(report["inputs"]["operator_age_limit_ns"])
        self.assertEqual(report["ins"]["latitude_ndeg"], 30617512345)
        self.assertEqual(report["left_drive"]["fault"], "emergency")
        self.assertEqual(report["left_drive"]["heatsink_degC"], -7)
        # What the vehicle does not have is not shown, and that it has the rest goes without saying.
        self.assertNotIn("motion_controller", report)
        self.assertNotIn("pose_datagrams", report)
        self.assertNotIn("present", report["left_drive"])
        self.assertEqual(report["right_drive"]["state"], "unknown")
        self.assertEqual(report["lidar_clock"]["offset_ns"], -5)
        self.assertEqual(report["can"]["bus_offs"], 0)
        self.assertGreater(sum(len(group) for group in report.values()), 200)

    def test_watch_goes_on_and_ends_with_an_interrupt(self):
        server = self.serve(status_answer)
        process = subprocess.Popen(self.arguments("status", "--watch", "--interval", "0.05",
                                                  "--json"), stdout=subprocess.PIPE, text=True)
        lines = [process.stdout.readline() for _ in range(3)]
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 0)
        for line in lines:
            self.assertEqual(json.loads(line)["program"]["version"], "9.8.7")
        self.assertEqual(server.connections, 1)

    def test_watch_says_how_losses_grow_and_connects_again(self):
        asked = []

        def growing(kind, sequence, body):
            asked.append(kind)
            if len(asked) == 3:
                raise OSError  # ends the connection
            missed = struct.pack("<Q", 3 + 2 * len(asked))
            at = STATUS.index(struct.pack("<QQ", 2**64 - 1, 3)) + 8
            return [STATUS[:8] + struct.pack("<I", sequence) + STATUS[12:at] + missed +
                    STATUS[at + 8:]]

        server = self.serve(growing)
        process = subprocess.Popen(self.arguments("status", "--watch", "--interval", "0.05"),
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + 30
        while len(asked) < 5 and time.monotonic() < until:
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        output, errors = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 0)
        self.assertIn("7 (+2)", output)
        self.assertIn("trying again", errors)
        self.assertEqual(server.connections, 2)

    def test_of_another_version_is_said(self):
        self.serve(lambda kind, sequence, body: [
            STATUS[:8] + struct.pack("<I", sequence) + bytes(4) + STATUS[16:]])
        self.expect_failure(2, ["status"], "unsupported", "version")


class Parameters(CtlTest):
    TOML = "".join(f"[group{i}]\nkey = {i}\n" for i in range(600))

    def parts(self, kind, sequence, body):
        text = self.TOML.encode()
        offset, = struct.unpack("<I", body)
        return [message(PARAMETERS, sequence,
                        struct.pack("<II", offset, len(text)) + text[offset:offset + 4076])]

    def test_all_parts_in_order(self):
        server = self.serve(self.parts)
        self.assertEqual(self.expect_done("params"), self.TOML)
        self.assertGreater(len(server.received), 2)
        self.assertEqual(json.loads(self.expect_done("params", "--json")), {"toml": self.TOML})

    def test_another_part_than_asked_for(self):
        self.serve(lambda kind, sequence, body: [
            message(PARAMETERS, sequence, struct.pack("<II", 1, 9) + b"abc")])
        self.expect_failure(2, ["params"], "not the requested part")

    def test_a_refusal(self):
        self.serve(done(status_code("kNotStarted")))
        self.expect_failure(2, ["params"], "refused: not_started")


class Presence(CtlTest):
    """SR-STP06: each key that is pressed at the terminal is another press, and nothing else is."""

    def drive(self):
        keys, terminal = pty.openpty()
        self.addCleanup(os.close, keys)
        process = subprocess.Popen(self.arguments("drive"), stdin=terminal,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        os.close(terminal)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        self.assertIn("emergency stop", process.stdout.readline())
        return keys, process

    def received(self, server, count):
        until = time.monotonic() + 30
        while len(server.received) < count and time.monotonic() < until:
            time.sleep(0.01)
        return server.received

    # SR-STP06
    def test_each_key_is_a_press_of_its_own(self):
        server = self.serve(done())
        keys, process = self.drive()
        for pressed in range(1, 5):
            os.write(keys, b" ")
            self.received(server, pressed)
        time.sleep(0.3)  # nobody presses
        self.assertEqual([kind for kind, _ in server.received], [ALIVE] * 4)
        presses = {body for _, body in server.received}
        self.assertEqual(len(presses), 4)
        self.assertNotIn(bytes(4), presses)
        self.assertEqual(server.connections, 1)
        os.write(keys, b"q")
        self.assertEqual(process.wait(timeout=20), 0)

    def test_an_emergency_stop_among_other_keys(self):
        server = self.serve(done())
        keys, process = self.drive()
        os.write(keys, b" e  ")
        self.assertEqual(self.received(server, 1)[0][0], ESTOP)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=20), 0)

    def test_ends_when_hardpackd_does(self):
        self.serve(hang_up)
        keys, process = self.drive()
        os.write(keys, b" ")
        self.assertEqual(process.wait(timeout=20), 2)
        self.assertIn("closed", process.stderr.read())

    # SR-STP06
    def test_not_without_a_terminal(self):
        self.serve(done())
        self.expect_failure(2, ["drive"], "needs a terminal")

    # SR-STP06
    def test_alive_is_one_press(self):
        server = self.serve(done())
        self.expect_done("alive")
        self.expect_done("alive")
        self.assertEqual([kind for kind, _ in server.received], [ALIVE] * 2)
        self.assertNotEqual(server.received[0][1], server.received[1][1])


class NoServer(CtlTest):
    def test_no_socket(self):
        self.expect_failure(2, ["status"], self.path, "is hardpackd running?")

    def test_nobody_listens(self):
        dead = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        dead.bind(str(self.path))
        dead.close()
        self.expect_failure(2, ["arm"], self.path, "not running")

    def test_no_answer_in_time(self):
        self.serve(lambda kind, sequence, body: [])
        begin = time.monotonic()
        self.expect_failure(2, ["estop", "--timeout", "0.3"], "no answer in time")
        self.assertGreater(time.monotonic() - begin, 0.29)

    def test_rubbish_for_an_answer(self):
        for answer in (b"x", b"HPCT" + bytes(8), message(DONE, 1), message(DONE, 1, bytes(3))):
            with self.subTest(answer):
                server = Server(self.path, lambda kind, sequence, body: [answer])
                try:
                    self.expect_failure(2, ["arm"], self.path)
                finally:
                    server.close()
                    self.path.unlink()

    def test_bad_usage(self):
        for arguments in ((), ("jump",), ("status", "--interval", "1"),
                          ("status", "--watch", "--interval", "0"), ("alive", "--every", "1"),
                          ("arm", "--timeout", "nan"), ("arm", "extra")):
            with self.subTest(arguments):
                result = self.run_ctl(*arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)


if __name__ == "__main__":
    unittest.main()
