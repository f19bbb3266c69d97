#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes small first inputs for the fuzz targets out of real recordings.

usage: test/fuzz/make_seeds.py OUT [DATA]

A folder a target under OUT; a seed is named KIND_NUMBER by what its target is to accept it as (see
test/fuzz/accepted.h; tools/proof/fuzz.sh holds the targets to it), any_NUMBER where that is open. DATA is
the folder of recordings (ouster/*.pcap and *.json, vectornav, ...); without it, what the sources
hold and what can be put together by hand is used.
"""

import json
import os.path
import pathlib
import re
import struct
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAX_BYTES = 25000  # of an input (tools/proof/fuzz.sh)
PROFILES = {"LEGACY": (0, "legacy"), "RNG19_RFL8_SIG16_NIR16": (1, "rng19"),
            "RNG15_RFL8_NIR8": (2, "rng15"), "RNG19_RFL8_SIG16_NIR16_DUAL": (3, "dual")}
IMU_BYTES = 48
FIRST_WITH_CRC = (3, 2, 0)  # port_linux/files/ouster_metadata.cpp
ETHERNET, CAN_SOCKETCAN, LINUX_SLL2 = 1, 227, 276  # link types


class Seeds:
    def __init__(self, out):
        self.out = out
        self.count = 0

    def add(self, target, kind, data):
        if len(data) > MAX_BYTES:
            raise ValueError(f"{target}: a seed of {len(data)} bytes is cut by libFuzzer")
        folder = self.out / target
        folder.mkdir(parents=True, exist_ok=True)
        self.count += 1
        (folder / f"{kind}_{self.count:04d}").write_bytes(data)


# --- captures -------------------------------------------------------------------------------------

def frames(capture, most):
    """The first `most` frames of a pcap file."""
    data = capture.read_bytes()
    order = "<" if data[:4] in (b"\xd4\xc3\xb2\xa1", b"\x4d\x3c\xb2\xa1") else ">"
    at, found = 24, []
    while at + 16 <= len(data) and len(found) < most:
        size, = struct.unpack_from(order + "I", data, at + 8)
        found.append(data[at + 16:at + 16 + size])
        at += 16 + size
    return found


def payload_of(frame):
    """Of an unfragmented datagram of UDP over IPv4 over Ethernet; else nothing."""
    if len(frame) < 42 or frame[12:14] != b"\x08\x00" or frame[23] != 17:
        return b""
    more_or_offset = struct.unpack_from(">H", frame, 20)[0] & 0x3fff
    header = (frame[14] & 15) * 4
    return frame[14 + header + 8:] if more_or_offset == 0 else b""


def pcap(link_type, packets):
    """A capture file, stamps in nanoseconds."""
    file = struct.pack("<IHHQII", 0xa1b23c4d, 2, 4, 0, 262144, link_type)
    for index, packet in enumerate(packets):
        file += struct.pack("<IIII", 1_700_000_000, 1000 * index, len(packet), len(packet)) + packet
    return file


def ipv4(source, destination, fragment, payload, identification=0):
    """A packet of UDP; fragment: flags and offset, as in the header."""
    return struct.pack(">BBHHHBBHII", 0x45, 0, 20 + len(payload), identification, fragment, 64, 17,
                       0, source, destination) + payload


def fragments_of(frame, most_bytes=1480):
    """The frame's datagram as it crosses an Ethernet: in several."""
    header = (frame[14] & 15) * 4
    source, destination = struct.unpack_from(">II", frame, 26)
    udp = frame[14 + header:]
    for at in range(0, len(udp), most_bytes):
        more = 0x2000 if at + most_bytes < len(udp) else 0
        yield frame[:14] + ipv4(source, destination, more | at // 8, udp[at:at + most_bytes], 7)


def can_frame(order, identifier, data):
    return struct.pack(order + "IBxxx", identifier, len(data)) + data.ljust(8, b"\0")


def cooked(protocol, hardware, outward, packet):
    return struct.pack(">HHIHBB8x", protocol, 0, 1, hardware, 4 if outward else 0, 0) + packet


def record(kind, body):
    """Of a flight log (hal/onboard/flight_log/records.h)."""
    payload = b"HPFL" + struct.pack("<BBH", 1, kind, 0) + body
    udp = struct.pack(">HHHH", 47100, 47100, 8 + len(payload), 0) + payload
    return cooked(0x0800, 772, False, ipv4(0x7f000001, 0x7f000001, 0x4000, udp))


def flight_log(datagrams):
    """A run of ticks with a datagram, a frame in and out, and a command each, of no vehicle."""
    version, configuration, metadata, begin, command, end, run_end = 1, 2, 3, 5, 6, 7, 9
    out = [record(version, struct.pack("<QIQQQ32s64s16s", 5, 0, 0, 0, 0, b"1", b"x", b"x86_64")),
           record(configuration, struct.pack("<II", 0, 4) + b"a=1\n"),
           record(metadata, struct.pack("<II", 0, 2) + b"{}")]
    for index, payload in enumerate(datagrams, 1):
        udp = struct.pack(">HHHH", 7502, 7502, 8 + len(payload), 0) + payload
        wishes = b"HPCT" + struct.pack("<BBHI", 1, 6, 12, index)
        out += [
            record(begin, struct.pack("<QQBHHHHH", index, index * 10**7, 1, 0, 0, 1, 1,
                                      len(wishes))),
            cooked(0x000c, 280, False, can_frame("<", 0x182, b"\x27\0\0\0\0\0\0\0")),
            cooked(0x0800, 1, False, ipv4(0x0a000002, 0x0a000001, 0x4000, udp)),
            record(command, struct.pack("<I", 1000) + wishes),
            cooked(0x000c, 280, True, can_frame("<", 0x202, b"\x0f\0\0\0\0\0\0\0")),
            record(end, struct.pack("<QBHHQQ", index, 0, 1, 0, 77, 1000)),
        ]
    return pcap(LINUX_SLL2, out + [record(run_end, b"")])


# --- what needs no recording ----------------------------------------------------------------------

def configurations(seeds):
    values = {"address": '"10.0.0.{}"', "metadata": '"os1.json"', "port": "5000", "left_sign": "1",
              "right_sign": "-1", "gear_ratio": "24.5"}
    count = 1

    def fill(line):
        nonlocal count
        count += 1
        return f"{line[1]} = {values[line[1]].format(count)}"

    text = (ROOT / "config" / "warthog.toml").read_text()
    filled = re.sub(r'^(\w+) = "TO BE FILLED IN"', fill, text, flags=re.M)
    filled = re.sub(r"^\s*(#.*)?\n", "", filled, flags=re.M)  # with its comments it is too long
    seeds.add("configuration", "configuration", b"\0" + filled.encode())
    seeds.add("configuration", "configuration", b"\1[speed]\nmax_speed_mps = 3.0\n")


def png(width, height, bits, rows):
    """Grey, `bits` a pixel, no filter."""
    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + \
            struct.pack(">I", zlib.crc32(name + body))
    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def maps(seeds):
    trinary = b"image: a.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n" \
        b"occupied_thresh: 0.65\nfree_thresh: 0.196\n\0"
    scale = b"image: a.pgm\nmode: scale\nresolution: 1\norigin: [-1, 2, 0]\nnegate: 1\n" \
        b"occupied_thresh: 0.9\nfree_thresh: 0.1\n\0"
    seeds.add("map", "pgm", trinary + b"P5\n4 2\n255\n" + bytes(range(0, 256, 32)))
    seeds.add("map", "pgm", scale + b"P2\n# x\n2 2\n15\n0 5 10 15\n")
    grey = [bytes((16 * x + 5 * y) % 256 for x in range(16)) for y in range(12)]
    seeds.add("map", "png", trinary + png(16, 12, 8, grey))
    seeds.add("map", "png", scale + png(16, 3, 1, [b"\xf0\x0f", b"\xff\xff", b"\x00\x81"]))


def point_files(seeds):
    header = b"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z ring\nSIZE 4 4 4 2\nTYPE F F F U\n" \
        b"COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA "
    seeds.add("points", "pcd", b"\0" + header + b"ascii\n1 2 -0.5 3\nnan nan nan 0\n")
    seeds.add("points", "pcd", b"\0" + header + b"binary\n" + struct.pack("<3fH", 5, -4, 1, 7) +
              struct.pack("<3fH", -2, 0.5, -1.3, 8))
    seeds.add("points", "csv", b"\1x,y,z,laser_id\n1,2,3,4\n-5,6,-1e1,15\n")
    seeds.add("points", "csv", b"\1" + b"1,2,3\n4,5,-1,9\n")


def label_datagrams(seeds):
    for columns, beams in ((16, 64), (1, 128), (64, 32)):
        codes = bytes((3 * i) % 35 for i in range(columns * beams))
        head = b"HPLB" + struct.pack("<BBHHHIQ", 1, beams, 7, 32, columns, 5, 10**9)
        datagram = head + codes + struct.pack("<I", zlib.crc32(head + codes))
        seeds.add("labels", "labels", bytes([2, beams - 1]) + datagram)


def pose_datagrams(seeds):
    def datagram(sequence, groups):
        data = struct.pack("<4sBBBBIIQQqq16f", b"HPPD", 1, groups, 2, 0x61, sequence, 0, 10**7 * sequence,
                           10**18, 30618 * 10**6, -96336 * 10**6, 99.5, 1, -2, 0.5, 0.1, -0.2, 1.5, 0, 0,
                           0.3, 0, 0, -9.8, 0.01, 1.5, 0.1)
        return data + struct.pack("<I", zlib.crc32(data))
    for pieces in (0, 255):
        seeds.add("pose_datagram", "samples", bytes([pieces]) +
                  b"".join(datagram(i, groups) for i, groups in enumerate((255, 0x18, 2, 0, 127))))


def velodyne_packets(seeds):
    """Eight packets of each model, single and dual, over the north and the hour."""
    def packet(is_vlp16, mode, number, last):
        per_block, per_group = (2 if is_vlp16 else 1), (2 if mode == 0x39 else 1)
        firings = 12 // per_group * per_block
        out = b""
        for block in range(12):
            firing = number * firings + block // per_group * per_block
            azimuth = int(35900 + firing * 600 * 600 * 55.296e-6) % 36000
            out += b"\xff\xee" + struct.pack("<H", azimuth)
            out += b"".join(struct.pack("<HB", 2000 + 3 * i + 50 * (block % 2), i) for i in range(32))
        time = int(last + number * firings * 55.296) % 3_600_000_000
        return out + struct.pack("<IBB", time, mode, 0x22 if is_vlp16 else 0x28)
    for is_vlp16 in (True, False):
        for place, mode in enumerate((0x37, 0x38, 0x39)):
            kind = "dual" if mode == 0x39 else "vlp16" if is_vlp16 else "vlp32c"
            head = bytes([6 + 2 * place + (0 if is_vlp16 else 1)])  # 600 rpm
            packets = [packet(is_vlp16, mode, number, 3_599_996_000) for number in range(8)]
            seeds.add("velodyne", kind, head + b"".join(struct.pack("<HB", len(p), 0) + p
                                                       for p in packets))
            # The target makes one of what follows, and has it begin anew.
            bare = struct.pack("<HB", 4, 2 + 4 + 8 + 16) + b"\0\0\0\0"
            again = struct.pack("<HB", 4, 1 + 2 + 4 + 8) + b"\0\0\1\2"
            seeds.add("velodyne", kind, head + 3 * bare + 2 * again + bare)


def control_messages(seeds):
    def add(sort, kind, body=b""):
        head = b"HPCT" + struct.pack("<BBHI", 1, kind, 12 + len(body), 9)
        seeds.add("control", sort, b"\0\0" + head + body)
    for kind in (1, 2, 4, 5, 6, 7, 8, 9):
        add("command", kind)
    waypoints = struct.pack("<BxxxffQ", 0, 12.5, -3.0, 0) + \
        struct.pack("<Bxxxqq", 2, 30_600_000_000, -96_300_000_000)
    add("command", 3, struct.pack("<BBBxf", 2, 0, 0, 0.0) + waypoints)
    add("command", 3, struct.pack("<BBBxf", 1, 1, 1, 0.5) + waypoints[:20])
    add("command", 3, struct.pack("<BBBxf", 2, 0, 0, 0.0) +
        struct.pack("<BBBBffQ", 1, 1, 250, 15, 8.0, 1.0, 0) +
        struct.pack("<BBBBffQ", 1, 1, 0, 30, 16.0, -1.0, 0))
    corners = [(12500, -3000), (16000, -3000), (16000, 2000)]
    add("command", 10, struct.pack("<BBBBBxxxf", 1, 2, 2, 0, 3, 1.5) +
        b"".join(struct.pack("<iiQ", x, y, 0) for x, y in corners))
    add("command", 10, struct.pack("<BBBBBxxxf", 0, 1, 1, 1, 3, 0.0) +
        b"".join(struct.pack("<qq", 30_600_000_000 + 10 * x, -96_300_000_000 + 10 * y)
                 for x, y in corners))
    add("command", 11)
    add("question", 65, struct.pack("<I", 4000))
    add("question", 65, bytes(4))
    add("question", 64)
    add("done", 128, bytes([0, 3]))
    add("parameters", 130, struct.pack("<II", 0, 8) + b"[speed]\n")
    # The target brings a report to its size and its table's number.
    seeds.add("control", "status", bytes([1, 11]) + bytes(64))


def drive_scripts(seeds):
    """For sevcon: answers until both are brought up, then what each reports on its way."""
    def report(statusword, rpm):
        data = struct.pack("<HiH", statusword, rpm, 0)
        return b"\0\x04" + data + b"\0\x05" + data + b"\0\x0c\x05\0\x0d\x05"
    sync = 2 * b"\x63"  # ticks: a drive reports once to each SYNC
    bring_up = b"\0\x0c\x7f\0\x0d\x7f" + 30 * b"\x63"
    started = 30 * (report(0x40, 0) + sync)
    enable = b"\x51" + b"".join(report(word, 0) + sync for word in
                                (0x40, 0x21, 0x21, 0x23, 0x23) + 20 * (0x27,))
    drive = b"".join(report(0x27, rpm) + sync for rpm in range(0, 300, 20))
    stop = b"\x50" + 60 * (report(0x27, 0) + sync)
    seeds.add("sevcon", "ready", bring_up + started)
    seeds.add("sevcon", "enabled", bring_up + started + enable + drive + stop)


def twist_drive_scripts(seeds):
    """For twist_drive: what a controller reports until it is enabled, on its way, and at its end."""
    def report(counter, state, speed, turn):  # 0x211; the echo is that of its tick
        return b"\0\0" + struct.pack("<BBhhBx", counter % 256, state, speed, turn, counter % 256)
    status = b"\0\1" + struct.pack("<BBHHBx", 0, 1, 0, 4800, 20)
    tick = b"\x8a"  # 10 ms
    for setup, bit in ((b"\0", 0), (b"\1", 0), (b"\3", 8)):
        ready = b"".join(report(i, 1 + bit, 0, 0) + tick for i in range(5))
        follows = b"\x61\0\0" + b"".join(report(i, 2 + bit, 0, 0) + tick for i in range(5, 15))
        drives = b"\x61\x14\x1e" + b"".join(report(i, 2 + bit, 40 * i, 100) + tick for i in range(15, 40))
        stops = b"\x60\0\0" + b"".join(report(i, 3 + bit, 0, 0) + tick for i in range(40, 99))
        seeds.add("twist_drive", "feedback", setup + status + ready)
        seeds.add("twist_drive", "driven", setup + status + ready + follows + drives + stops)


def scripts(seeds):
    for first, kind in enumerate(("standing", "driving", "log", "log", "standing", "blocked")):
        script = bytes([first]) + bytes((i * 37 + first) % 256 for i in range(96))
        for target in ("tick", "tick_velodyne", "tick_twist"):
            seeds.add(target, kind, script)
    # Of mapper: setup, then poses, columns, labels of the last of them, time, a build and its end.
    setup = bytes([1, 5, 0, 0, 0, 1, 0, 0])
    drive = bytes([4, 3, 40, 0, 0, 127, 0, 2, 1, 6, 100, 90, 0, 3, 9, 10])
    seeds.add("mapper", "columns", setup + 8 * drive + bytes([11, 12]))
    seeds.add("mapper", "labels", setup + 3 * drive + bytes([9, 250, 11, 12]) + 3 * drive)


def scaled(value, reach):
    return struct.pack("<H", min(65535, round((value / reach + 1.0) * 32768)))


def plan_request(goal, heading=None, speed_mps=0.0):
    number = scaled
    moves = speed_mps > 0.0
    return b"\1" + number(0, 40) + number(0, 40) + number(0, 3.2) + number(0, 0.4) + \
        number(speed_mps, 6) + bytes([1 if moves else 0]) + \
        number(goal[0], 70) + number(goal[1], 70) + bytes([0 if heading else 1]) + \
        number(heading or 0, 3.2)


def plans(seeds):
    """Requests on drawn maps (planner_fuzz.cpp); cell 256 is where the vehicle stands."""
    def shape(kind, flags, x, y, width, height, period=0):
        return struct.pack("<BBHHBBB", kind, flags, x, y, width - 1, height - 1, period)
    def add(request, *shapes, method=1):
        seeds.add("planner", "plan", request + bytes([0, method, 1, len(shapes)]) +
                  b"".join(shapes) + b"\7")
    add(plan_request((20, 5)))
    add(plan_request((20, 5)), method=0)
    add(plan_request((12, 0), heading=1.5))
    add(plan_request((-15, 3)))
    add(plan_request((3, 0), speed_mps=5.9))  # too fast to stop there
    add(plan_request((20, 0)), shape(0, 0, 290, 240, 10, 40))
    add(plan_request((20, 0)), shape(1, 1, 280, 230, 60, 60), shape(4, 0, 340, 200, 40, 120, 28))
    for vias in (((10, 0), (20, 0)), ((8, 6), (16, 0), (24, 6)), ((15, 0), (3, 1)), ((12, 0), (12, 0))):
        way = b"".join(scaled(place, 70) for via in vias for place in via)
        seeds.add("planner", "plan", plan_request((30, 0)) + bytes([0, 1, 1, 0, 7, len(vias)]) + way)
    for gap in range(8, 12):  # walls with a door that is as wide as the vehicle, or hardly
        walls = shape(0, 0, 290, 150, 2, 106 - gap // 2), \
            shape(0, 0, 290, 256 - gap // 2 + gap, 2, 100)
        add(plan_request((20, 0)), *walls)
        add(plan_request((20, 0.1), speed_mps=1.0), *walls, method=0)
    for beside in range(4):  # it stands in an obstacle, or beside one
        add(plan_request((15, 4)), shape(0, 0, 256 - 3, 256 + beside, 3, 3))


# --- recordings -----------------------------------------------------------------------------------

def find(tree, name):
    """A field of metadata, wherever it stands; nothing where it does not."""
    if name in tree:
        return tree[name]
    found = [find(part, name) for part in tree.values() if isinstance(part, dict)]
    return next((value for value in found if value is not None), None)


def metadata_of(capture):
    """The file beside a capture whose name goes along with it for longest."""
    def shared(path):
        return len(os.path.commonprefix([path.stem, capture.stem]))
    beside = [path for path in capture.parent.glob("*.json")
              if b"beam_altitude_angles" in path.read_bytes()]
    best = max(beside, key=shared, default=None)
    return None if best is None or shared(best) == 0 else json.loads(best.read_text())


def ouster_head(tree):
    """The target's first two bytes, and what it is to accept packets as."""
    profile, kind = PROFILES[find(tree, "udp_profile_lidar") or "LEGACY"]
    beams = find(tree, "pixels_per_column") or len(find(tree, "beam_altitude_angles"))
    mode = (find(tree, "lidar_mode") or "1024x10").split("x")[0]
    columns = find(tree, "columns_per_frame") or int(mode)
    version = re.search(r"v(\d+)\.(\d+)\.(\d+)", find(tree, "image_rev") or "")
    has_crc = version is not None and tuple(map(int, version.groups())) >= FIRST_WITH_CRC
    first = profile | (beams // 16).bit_length() - 1 << 2 | ((columns // 512).bit_length() - 1) * 16
    second = (find(tree, "columns_per_packet") or 16) - 1 | (0x80 if has_crc else 0)
    return bytes([first, second]), "crc" if has_crc else kind


def datagrams_within(payloads, room):
    """As the ouster target takes them, as many as there is room for."""
    out = b""
    for payload in payloads:
        if len(out) + 3 + len(payload) > room:
            break
        out += struct.pack("<HB", len(payload), 0) + payload
    return out


def from_capture(seeds, capture):
    kept = frames(capture, 40)
    lidar = [frame for frame in kept if len(payload_of(frame)) > IMU_BYTES]
    imu = [frame for frame in kept if len(payload_of(frame)) == IMU_BYTES]
    tree = metadata_of(capture)
    if tree is not None and lidar:
        head, kind = ouster_head(tree)
        seeds.add("ouster", kind,
                  head + datagrams_within(map(payload_of, lidar), MAX_BYTES - len(head)))
        if imu:
            seeds.add("ouster", "imu", head + datagrams_within(map(payload_of, imu), 600))
    if imu:
        seeds.add("capture", "datagrams", b"\0" + pcap(ETHERNET, imu[:6]))
        seeds.add("capture", "flight", b"\1" + flight_log(map(payload_of, imu[:4])))
    if lidar and len(lidar[0]) < MAX_BYTES - 2000:
        seeds.add("capture", "fragments", b"\0" + pcap(ETHERNET, fragments_of(lidar[0])))


def pieces(stream):
    """A stream as the vectornav target takes it: a length less one before each piece."""
    return b"".join(bytes([len(piece) - 1]) + piece
                    for piece in (stream[at:at + 100] for at in range(0, len(stream), 100)))


def from_vectornav(seeds, folder):
    for path in sorted(folder.glob("**/vectornav/*")):
        data = path.read_bytes()
        kind = "binary"
        if path.suffix == ".txt" and re.fullmatch(rb"[0-9A-Fa-f\s]+", data):
            data = bytes.fromhex(data.decode())
        elif path.suffix == ".txt":
            kind = "ascii"
            data = b"\r\n".join(data.split()) + b"\r\n"  # as the sensor ends a line
        if data:
            seeds.add("vectornav", kind, pieces(data[:2400]))


def from_recordings(seeds, folder):
    for capture in sorted(folder.glob("**/*.pcap")):
        from_capture(seeds, capture)
    for path in sorted(folder.glob("**/*.json")):
        if path.stat().st_size < MAX_BYTES:
            data = path.read_bytes()
            seeds.add("metadata", "metadata" if b"beam_altitude_angles" in data else "any", data)
    from_vectornav(seeds, folder)


def main(arguments):
    if not 1 <= len(arguments) <= 2 or arguments[0] in ("-h", "--help"):
        print(__doc__)
        return 2
    seeds = Seeds(pathlib.Path(arguments[0]))
    for make in (configurations, maps, point_files, label_datagrams, pose_datagrams, velodyne_packets,
                 control_messages, drive_scripts, twist_drive_scripts, scripts, plans):
        make(seeds)
    can = [can_frame(">", 0x180 + i, bytes(range(i))) for i in range(9)]
    seeds.add("capture", "can", b"\0" + pcap(CAN_SOCKETCAN, can))
    seeds.add("capture", "flight", b"\1" + flight_log([b"lidar", b"", bytes(48)]))
    if len(arguments) == 2 and pathlib.Path(arguments[1]).is_dir():
        from_recordings(seeds, pathlib.Path(arguments[1]))
    print(f"{seeds.count} seeds")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
