#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The lidar datagrams of a capture, for lidar.cpp: datagrams.py CAPTURE.pcap > RECORDS

Classic pcap with Ethernet frames and IPv4, as `hardpack scene` writes it. A record is when the
datagram's last fragment came [ns], the size and the bytes. Times count from a second before the
first one: the clock of a computer that was just started, not the sensor's.
"""

import pathlib
import struct
import sys

LIDAR_PORT = 7502


def frames(capture):
    """Time [ns] and bytes of each."""
    order = "<" if capture[:4] == b"\xd4\xc3\xb2\xa1" else ">"
    at = 24
    while at < len(capture):
        seconds, microseconds, size, _ = struct.unpack_from(order + "4I", capture, at)
        yield seconds * 10**9 + microseconds * 1000, capture[at + 16:at + 16 + size]
        at += 16 + size


def datagrams(capture):
    """Time of the last fragment [ns], and UDP header and payload put together."""
    parts = {}  # by source and identification: offset -> bytes, and where the last fragment ends
    for time_ns, frame in frames(capture):
        packet = frame[14:]
        header = (packet[0] & 15) * 4
        total, identification, fragment = struct.unpack_from(">3H", packet, 2)
        offset = (fragment & 0x1fff) * 8
        key = packet[12:16], identification
        have, end = parts.setdefault(key, ({}, None))
        have[offset] = packet[header:total]
        if not fragment & 0x2000:
            end = offset + total - header
        parts[key] = have, end
        if sum(map(len, have.values())) == end:
            del parts[key]
            yield time_ns, b"".join(have[at] for at in sorted(have))


def main():
    start_ns = None
    for time_ns, datagram in datagrams(pathlib.Path(sys.argv[1]).read_bytes()):
        if struct.unpack_from(">H", datagram, 2)[0] != LIDAR_PORT:
            continue
        start_ns = start_ns or time_ns - 10**9
        payload = datagram[8:]
        sys.stdout.buffer.write(struct.pack("<QI", time_ns - start_ns, len(payload)) + payload)


main()
