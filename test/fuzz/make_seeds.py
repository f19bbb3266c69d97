#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes small first inputs for the fuzz targets out of real recordings.

usage: test/fuzz/make_seeds.py OUT [DATA]

A folder a target under OUT. DATA is the folder of recordings (ouster/*.pcap and *.json, vectornav,
movingai/*.map, ...); without it, only what the sources hold is used: config/warthog.toml.
"""

import pathlib
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROFILES = {"LEGACY": 0, "RNG19_RFL8_SIG16_NIR16": 1, "RNG15_RFL8_NIR8": 2,
            "RNG19_RFL8_SIG16_NIR16_DUAL": 3}


def packets(capture, most):
    """Whole records of a pcap file, headers included, the first `most`."""
    data = capture.read_bytes()
    order = "<" if data[:4] in (b"\xd4\xc3\xb2\xa1", b"\x4d\x3c\xb2\xa1") else ">"
    at, found = 24, []
    while at + 16 <= len(data) and len(found) < most:
        size, = struct.unpack_from(order + "I", data, at + 8)
        found.append(data[at:at + 16 + size])
        at += 16 + size
    return data[:24], found


def payload_of(record):
    """Of an unfragmented datagram of UDP over IPv4 over Ethernet; else nothing."""
    frame = record[16:]
    if len(frame) < 42 or frame[12:14] != b"\x08\x00" or frame[23] != 17:
        return b""
    more_or_offset = struct.unpack_from(">H", frame, 20)[0] & 0x3fff
    header = (frame[14] & 15) * 4
    return frame[14 + header + 8:] if more_or_offset == 0 else b""


class Seeds:
    def __init__(self, out):
        self.out = out
        self.count = 0

    def add(self, target, data):
        folder = self.out / target
        folder.mkdir(parents=True, exist_ok=True)
        self.count += 1
        (folder / f"seed_{self.count:04d}").write_bytes(data)


def from_captures(seeds, folder):
    for capture in sorted(folder.glob("**/*.pcap")):
        header, records = packets(capture, 40)
        seeds.add("capture", b"\0" + header + b"".join(r for r in records[:6] if len(r) < 2000)[:8000])
        payloads = [p for p in map(payload_of, records) if p]
        for payload in payloads[:2]:
            for profile in PROFILES.values():
                first = profile | (2 << 2) | (1 << 4)  # 64 beams, 1024 columns
                seeds.add("ouster", bytes([first, 15]) +
                          struct.pack("<HB", len(payload), 0) + payload)


def from_texts(seeds, folder):
    for path in sorted(folder.glob("**/*.json")):
        if path.stat().st_size < 40000:
            seeds.add("metadata", path.read_bytes())
    for path in sorted(folder.glob("**/*")):
        if path.is_file() and path.suffix in (".bin", ".txt", ".dat", ".log") and \
                "vectornav" in path.parts:
            data = path.read_bytes()
            seeds.add("vectornav", struct.pack("<H", min(len(data), 600)) + data[:600])


def main(arguments):
    if not 1 <= len(arguments) <= 2 or arguments[0] in ("-h", "--help"):
        print(__doc__)
        return 2
    seeds = Seeds(pathlib.Path(arguments[0]))
    seeds.add("configuration", b"\1" + (ROOT / "config" / "warthog.toml").read_bytes()[:6000])
    seeds.add("map", b"image: a.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
              b"occupied_thresh: 0.65\nfree_thresh: 0.196\n\0P5\n4 2\n255\n" + bytes(range(0, 256, 32)))
    seeds.add("map", b"image: a.pgm\nmode: scale\nresolution: 1\norigin: [-1, 2, 0]\nnegate: 1\n"
              b"occupied_thresh: 0.9\nfree_thresh: 0.1\n\0P2\n# x\n2 2\n15\n0 5 10 15\n")
    for first in range(4):
        seeds.add("tick", bytes([first]) + bytes((i * 37 + first) % 256 for i in range(96)))
        seeds.add("planner", bytes((i * 53 + 7 * first) % 256 for i in range(160)))
    if len(arguments) == 2 and pathlib.Path(arguments[1]).is_dir():
        data = pathlib.Path(arguments[1])
        from_captures(seeds, data)
        from_texts(seeds, data)
    print(f"{seeds.count} seeds")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
