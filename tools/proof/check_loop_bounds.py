#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the records that HP_LOOP_BOUND writes (core/base/loop_bound.h).

usage: tools/proof/check_loop_bounds.py FILE...     objects (ld -r output included) or linked images

A record is three words: the address of a loop's entry, a bound, and the line that says so. The bound
is the loop's own in .note.hardpack.loops, that of the loops directly inside it in
.note.hardpack.inner, and the beams that both are of in .note.hardpack.beams. There must be records
in all; each bound must be positive; each address must lie in executable code. Reads 32 and 64 bit
little-endian ELF. Exits 1 and names the record when one is not so.
"""

import struct
import sys

SECTIONS = (".note.hardpack.loops", ".note.hardpack.inner", ".note.hardpack.beams")
ET_REL = 1
SHT_RELA, SHT_REL = 4, 9
SHF_EXECINSTR = 4
MAX_BOUND = 2**31 - 1
WORDS = 3


class Elf:
    """As much of an ELF file as the records need."""

    def __init__(self, data):
        if data[:4] != b"\x7fELF" or data[5] != 1:
            raise ValueError("not a little-endian ELF file")
        self.data = data
        self.wide = data[4] == 2
        self.word = 8 if self.wide else 4
        self.type = struct.unpack_from("<H", data, 16)[0]
        table, = struct.unpack_from("<Q" if self.wide else "<I", data, 40 if self.wide else 32)
        size, count, names = struct.unpack_from("<HHH", data, 58 if self.wide else 46)
        form = "<IIQQQQIIQQ" if self.wide else "<IIIIIIIIII"
        keys = ("name", "type", "flags", "address", "offset", "size", "link", "info", "align",
                "entry")
        self.sections = [dict(zip(keys, struct.unpack_from(form, data, table + i * size)))
                         for i in range(count)]
        base = self.sections[names]["offset"]
        for section in self.sections:
            start = base + section["name"]
            section["name"] = data[start:data.index(b"\0", start)].decode()

    def executable(self, index):
        return index < len(self.sections) and bool(self.sections[index]["flags"] & SHF_EXECINSTR)

    def in_code(self, address):
        return any(s["flags"] & SHF_EXECINSTR and s["address"] <= address < s["address"] + s["size"]
                   for s in self.sections)

    def relocated_sections(self, target):
        """{offset in section `target`: section index of the symbol that goes there}"""
        found = {}
        for relocations in self.sections:
            if relocations["type"] not in (SHT_RELA, SHT_REL) or relocations["info"] != target:
                continue
            symbols = self.sections[relocations["link"]]
            for at in range(0, relocations["size"], relocations["entry"]):
                offset, info = struct.unpack_from("<QQ" if self.wide else "<II", self.data,
                                                  relocations["offset"] + at)
                symbol = info >> (32 if self.wide else 8)
                where = symbols["offset"] + symbol * symbols["entry"]
                found[offset], = struct.unpack_from("<H", self.data,
                                                    where + (6 if self.wide else 14))
        return found


def check(path):
    """(number of records, list of findings)"""
    with open(path, "rb") as file:
        elf = Elf(file.read())
    count, findings = 0, []
    for index, section in enumerate(elf.sections):
        if section["name"] not in SECTIONS:
            continue
        size = WORDS * elf.word
        if section["size"] % size:
            findings.append("the section ends in the middle of a record")
        relocated = elf.relocated_sections(index) if elf.type == ET_REL else {}
        for at in range(0, section["size"] - size + 1, size):
            address, bound, _ = struct.unpack_from("<QQQ" if elf.wide else "<III", elf.data,
                                                   section["offset"] + at)
            count += 1
            if not 0 < bound <= MAX_BOUND:
                findings.append(f"record {count}: the bound {bound} is not positive")
            if elf.type == ET_REL:
                inside = at in relocated and elf.executable(relocated[at])
            else:
                inside = elf.in_code(address)
            if not inside:
                findings.append(f"record {count}: the address {address:#x} is not in code")
    return count, findings


def main(arguments):
    if not arguments or any(a in ("-h", "--help") for a in arguments):
        print(__doc__)
        return 0 if arguments else 2
    total, failed = 0, False
    for path in arguments:
        count, findings = check(path)
        total += count
        for finding in findings:
            failed = True
            print(f"{path}: {finding}")
    if total == 0:
        failed = True
        print("there are no loop records")
    print(f"check_loop_bounds: {len(arguments)} files, {total} records")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
