# SPDX-License-Identifier: Apache-2.0
"""Reads what `candump -L` logged of the vehicle's bus, and checks it frame by frame against
docs/vehicle.md: who sends what, how often, in which order. Nodes 2 (left) and 3 (right), and 1 for
hardpackd; the configuration's default periods."""

import collections
import statistics
import struct

Frame = collections.namedtuple("Frame", "time_s identifier data")

MASTER = 1
NODES = {"left": 2, "right": 3}
SYNC = 0x080
SYNC_PERIOD_S = 0.02
COMMAND_PERIOD_S = 0.01
COMMAND_TIMEOUT_S = 0.2
FEEDBACK_TIMEOUT_S = 0.1
HEARTBEAT_PERIOD_S = 0.1
HEARTBEAT_TIMEOUT_S = 0.3

# Data bytes of each kind of frame, by the function code of its identifier.
LENGTHS = {0x000: 2, 0x080: 0, 0x180: 8, 0x200: 8, 0x580: 8, 0x600: 8, 0x700: 1}
EMCY_LENGTH = 8

ENABLED = 0x27  # statusword of CiA 402, under the mask
STATE_MASK = 0x6F
ENABLE_OPERATION = 0x0F  # controlword
OPERATIONAL = 0x05


def read(path):
    """Every frame of the log; ValueError for a line that is none."""
    frames = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        words = line.split()
        identifier, mark, data = words[2].partition("#") if len(words) >= 3 else ("", "", "")
        if mark != "#" or len(identifier) != 3:
            raise ValueError(f"{path}:{number}: no data frame with 11 bits: {line}")
        frames.append(Frame(float(words[0].strip("()")), int(identifier, 16), bytes.fromhex(data)))
    return frames


def of(frames, identifier):
    return [frame for frame in frames if frame.identifier == identifier]


def gaps_s(frames):
    return [after.time_s - before.time_s for before, after in zip(frames, frames[1:])]


def commands(frames, node):
    """(time, controlword, target rpm) of each command to a drive."""
    return [(frame.time_s, *struct.unpack_from("<Hi", frame.data))
            for frame in of(frames, 0x200 + node)]


class BusLog:
    """The checks. `test` is the unittest.TestCase that fails where one does."""

    def __init__(self, test, path):
        self.test = test
        self.frames = read(path)
        self.told = []  # lines for the reader of the test's output

    def check(self):
        self.check_each_frame()
        self.check_rates()
        self.check_order()
        self.check_questions()
        for node in NODES.values():
            self.check_commands(node)

    def check_each_frame(self):
        """Identifiers, lengths, and times that do not run backwards."""
        self.test.assertGreater(len(self.frames), 100)
        allowed = {0x000, SYNC, 0x700 + MASTER}
        for node in NODES.values():
            allowed |= {base + node for base in (0x080, 0x180, 0x200, 0x580, 0x600, 0x700)}
        last_s = 0.0
        for frame in self.frames:
            self.test.assertIn(frame.identifier, allowed)
            self.test.assertGreaterEqual(frame.time_s, last_s)
            last_s = frame.time_s
            base = frame.identifier & 0x780
            emergency = base == 0x080 and frame.identifier != SYNC
            length = EMCY_LENGTH if emergency else LENGTHS[base]
            self.test.assertEqual(len(frame.data), length, hex(frame.identifier))
            self.test.assertFalse(emergency and frame.data[:2] != b"\0\0", "an emergency")

    def check_rate(self, name, frames, period_s, longest_s):
        gaps = gaps_s(frames)
        self.test.assertGreater(len(gaps), 10, name)
        median_s = statistics.median(gaps)
        self.told.append(f"{name}: {len(frames)} frames, median gap {1e3 * median_s:.2f} ms, "
                         f"longest {1e3 * max(gaps):.2f} ms of {1e3 * longest_s:.0f} ms")
        self.test.assertAlmostEqual(median_s, period_s, delta=0.05 * period_s, msg=name)
        self.test.assertLess(max(gaps), longest_s, name)

    def check_rates(self):
        """No gap is longer than the time-out of who waits for it."""
        self.check_rate("SYNC", of(self.frames, SYNC), SYNC_PERIOD_S, FEEDBACK_TIMEOUT_S)
        self.check_rate("our heartbeat", of(self.frames, 0x700 + MASTER), HEARTBEAT_PERIOD_S,
                        HEARTBEAT_TIMEOUT_S)
        for side, node in NODES.items():
            self.check_rate(f"commands, {side}", of(self.frames, 0x200 + node), COMMAND_PERIOD_S,
                            COMMAND_TIMEOUT_S)
            self.check_rate(f"reports, {side}", self.while_operational(node, 0x180 + node),
                            SYNC_PERIOD_S, FEEDBACK_TIMEOUT_S)
            self.check_rate(f"heartbeat, {side}", self.while_operational(node, 0x700 + node),
                            HEARTBEAT_PERIOD_S, HEARTBEAT_TIMEOUT_S)

    def while_operational(self, node, identifier):
        """From the drive's first operational heartbeat until the last frame of ours: who is gone is
        asked no more."""
        begin = next(frame.time_s for frame in of(self.frames, 0x700 + node)
                     if frame.data[0] == OPERATIONAL)
        end = of(self.frames, SYNC)[-1].time_s + FEEDBACK_TIMEOUT_S
        return [frame for frame in of(self.frames, identifier) if begin <= frame.time_s <= end]

    def check_order(self):
        """Left before right in every pair of commands, and after each SYNC one report of each drive
        before the next SYNC."""
        pair = [frame.identifier for frame in self.frames if frame.identifier in (0x202, 0x203)]
        first_of_both = max(pair.index(0x202), pair.index(0x203)) - 1
        pair = pair[first_of_both:]
        self.test.assertEqual(pair, [0x202, 0x203] * (len(pair) // 2))
        begin = max(self.while_operational(node, 0x180 + node)[0].time_s for node in NODES.values())
        end = of(self.frames, SYNC)[-1].time_s
        since = None  # the last SYNC, which reports came
        rounds = 0
        for frame in self.frames:
            if frame.time_s <= begin or frame.time_s > end:
                continue
            if frame.identifier == SYNC:
                if since is not None:
                    self.test.assertEqual(sorted(since), [0x182, 0x183], frame)
                    rounds += 1
                since = []
            elif frame.identifier in (0x182, 0x183) and since is not None:
                since.append(frame.identifier)
        self.test.assertGreater(rounds, 100)
        self.told.append(f"{rounds} SYNC, each with a report of both drives before the next; "
                         f"{len(pair) // 2} pairs of commands, left before right")

    def check_questions(self):
        """Each question is answered about the same object before the next one is asked; the one that
        a drive may leave unanswered is while it boots."""
        for side, node in NODES.items():
            unanswered = 0
            answered = 0
            asked = None
            for frame in self.frames:
                if frame.identifier == 0x600 + node:
                    unanswered += asked is not None
                    asked = frame
                elif frame.identifier == 0x580 + node:
                    self.test.assertIsNotNone(asked, f"{side}: an answer to nothing")
                    self.test.assertEqual(frame.data[1:4], asked.data[1:4], side)
                    answered += 1
                    asked = None
            self.told.append(f"questions, {side}: {answered} answered, {unanswered} asked again")
            self.test.assertGreater(answered, 10)
            self.test.assertLessEqual(unanswered, 2)

    def check_commands(self, node):
        """Speed is asked for only from a drive that has said that it is enabled, in a state that
        means it; nothing before, nothing behind."""
        reports = [(frame.time_s, struct.unpack_from("<H", frame.data)[0] & STATE_MASK)
                   for frame in of(self.frames, 0x180 + node)]
        moving = [one for one in commands(self.frames, node) if one[2] != 0]
        self.test.assertGreater(len(moving), 100)
        enabled_s = next(time_s for time_s, state in reports if state == ENABLED)
        for time_s, controlword, _ in moving:
            self.test.assertGreater(time_s, enabled_s)
            self.test.assertEqual(controlword & ENABLE_OPERATION, ENABLE_OPERATION)
        last = commands(self.frames, node)[-1]
        self.test.assertEqual(last[2], 0)
        self.test.assertNotEqual(last[1] & ENABLE_OPERATION, ENABLE_OPERATION)
        self.test.assertNotEqual(reports[-1][1], ENABLED)
