# SPDX-License-Identifier: Apache-2.0
"""What the analysis reads of a linked image: functions, their instructions, and the loop records.

The instructions are those of objdump, which knows code from the data in between by the image's
mapping symbols. The records are those of HP_LOOP_BOUND (core/base/loop_bound.h).
"""

import bisect
import re
import struct
import subprocess
from dataclasses import dataclass, field, replace

RECORDS = ".note.hardpack.loops"
INNER = ".note.hardpack.inner"
BEAMS = ".note.hardpack.beams"
EM_ARM, EM_AARCH64 = 40, 183
STT_FUNC = 2


class Refused(Exception):
    """The analysis cannot vouch for a bound; the text says of what and where."""


@dataclass(frozen=True)
class Instruction:
    address: int
    mnemonic: str
    operands: str

    def __str__(self):
        return f"{self.address:#x}: {self.mnemonic} {self.operands}"


@dataclass(frozen=True)
class Record:
    """What HP_LOOP_BOUND says: n, and the line where; its file's name, "" where that is not known."""
    n: int
    line: int
    file: str = ""

    def place(self):
        """Where in the source it stands: records of one place are copies of one record."""
        return self.file, self.line

    def is_before(self, file, line):
        """Whether a loop whose head begins at that line has it right before it."""
        return line == self.line + 1 and self.file in ("", file.rsplit("/", 1)[-1])

    def is_nearest(self, file, line, lines):
        """Whether it is in that file before that line, and none of the lines is between."""
        return self.file == file.rsplit("/", 1)[-1] and self.line < line and \
            not any(self.line < other < line for other in lines)


@dataclass
class Function:
    name: str  # demangled; the symbol where there is none
    symbol: str
    start: int
    end: int
    instructions: list = field(default_factory=list)


class Elf:
    """Little-endian ELF of 32 or 64 bits: sections and symbols."""

    def __init__(self, data):
        if data[:4] != b"\x7fELF" or data[5] != 1:
            raise Refused("not a little-endian ELF file")
        self.data = data
        self.wide = data[4] == 2
        self.machine, = struct.unpack_from("<H", data, 18)
        table, = struct.unpack_from("<Q" if self.wide else "<I", data, 40 if self.wide else 32)
        size, count, names = struct.unpack_from("<HHH", data, 58 if self.wide else 46)
        form = "<IIQQQQIIQQ" if self.wide else "<IIIIIIIIII"
        keys = ("name", "type", "flags", "address", "offset", "size", "link")
        self.sections = [dict(zip(keys, struct.unpack_from(form, data, table + i * size)))
                         for i in range(count)]
        base = self.sections[names]["offset"]
        for section in self.sections:
            section["name"] = self.text(base + section["name"])

    def text(self, at):
        return self.data[at:self.data.index(b"\0", at)].decode()

    def section(self, name):
        """Its bytes; none of a section that there is not."""
        for section in self.sections:
            if section["name"] == name:
                return self.data[section["offset"]:section["offset"] + section["size"]]
        return b""

    def function_symbols(self):
        """(symbol, start, size) of every function that is in the image."""
        form, size = ("<IBBHQQ", 24) if self.wide else ("<IIIBBH", 16)
        for section in self.sections:
            if section["name"] != ".symtab":
                continue
            names = self.sections[section["link"]]["offset"]
            for at in range(section["offset"], section["offset"] + section["size"], size):
                entry = struct.unpack_from(form, self.data, at)
                if self.wide:
                    name, info, _, where, value, length = entry
                else:
                    name, value, length, info, _, where = entry
                if info & 15 != STT_FUNC or where == 0:
                    continue
                # The lowest bit of a Thumb function's address is no part of it.
                start = value & ~1 if self.machine == EM_ARM else value
                yield self.text(names + name), start, length


class Image:
    """A linked image for a Cortex-M (Thumb-2) or for aarch64.

    stops: names of functions that do not return. What calls them ends there.
    beams: of the lidar that the bounds are to be of; None: of one with as many as can be.
    """

    PREFIXES = {EM_ARM: "arm-none-eabi-", EM_AARCH64: "aarch64-linux-gnu-"}

    def __init__(self, path, stops=(), beams=None):
        self.path = path
        with open(path, "rb") as file:
            elf = Elf(file.read())
        if elf.machine not in self.PREFIXES:
            raise Refused(f"{path}: machine {elf.machine} is neither Arm nor aarch64")
        self._elf = elf
        self._chains = {}
        self._addr2line = None
        self.machine = elf.machine
        self.prefix = self.PREFIXES[elf.machine]
        self._files = self._read_files()
        self.records = self._read_records(elf, RECORDS)
        self.inner = self._read_records(elf, INNER)
        if beams is not None:
            self._lack_beams(self._read_records(elf, BEAMS), beams)
        self.functions = self._read_functions(elf)
        self._starts = [f.start for f in self.functions]
        self.by_start = {f.start: f for f in self.functions}
        self._disassemble()
        self.stops = {self.named(name).start for name in stops}

    def _read_files(self):
        """{(address, line): names of files} of the image's line table: an address has several lines
        where some are of no instruction, as that of a record."""
        row = re.compile(r"(\S+)\s+(\d+)\s+(0x[0-9a-f]+)")
        files = {}
        for match in map(row.match, self._run("objdump", "-WL", self.path).splitlines()):
            if match:
                place = int(match.group(3), 16), int(match.group(2))
                files.setdefault(place, set()).add(match.group(1))
        return files

    def _read_records(self, elf, section):
        """{address of a loop's entry: records}; an address may have several, of loops whose entries
        are the same instruction."""
        form, size = ("<QQQ", 24) if elf.wide else ("<III", 12)
        data = elf.section(section)
        if len(data) % size:
            raise Refused(f"{self.path}: {section} ends in the middle of a record")
        records = {}
        for at in range(0, len(data), size):
            address, n, line = struct.unpack_from(form, data, at)
            files = self._files.get((address, line), set())
            records.setdefault(address, []).append(
                Record(n, line, min(files) if len(files) == 1 else ""))
        return records

    def _lack_beams(self, capacities, beams):
        """Each beam that the lidar lacks is one round less of the loops over beams. Where loops share
        an address and a line, and only some of them are such, none is."""
        for address, records in capacities.items():
            for place in {record.place() for record in records}:
                capacity = [r.n for r in records if r.place() == place]
                if len(capacity) != len([r for r in self.records[address] if r.place() == place]):
                    continue
                lacking = max(capacity) - beams
                if lacking < 0:
                    raise Refused(f"{self.path}: {beams} beams are more than its {max(capacity)}")
                for table in (self.records, self.inner):
                    if address in table:
                        table[address] = [replace(r, n=max(r.n - lacking, 0))
                                          if r.place() == place else r for r in table[address]]

    def _read_functions(self, elf):
        """One for each start address, by address; of several names the shortest."""
        found = {}
        for symbol, start, size in elf.function_symbols():
            if size == 0:
                continue
            other = found.get(start)
            if other is None or (len(symbol), symbol) < (len(other.symbol), other.symbol):
                found[start] = Function(symbol, symbol, start, start + size)
        functions = sorted(found.values(), key=lambda f: f.start)
        names = self._run("c++filt", text="\n".join(f.symbol for f in functions)).split("\n")
        for function, name in zip(functions, names):
            function.name = name
        return functions

    def _disassemble(self):
        line = re.compile(r"\s*([0-9a-f]+):\t(\S+)\s*(.*)$")
        for text in self._run("objdump", "-d", "--no-show-raw-insn", self.path).splitlines():
            match = line.match(text)
            if not match or match.group(2).startswith("."):
                continue
            address = int(match.group(1), 16)
            function = self.at(address)
            if function is not None:
                # Of the comments only a literal's address is kept.
                operands = re.sub(r"\s*(;|//|@(?! \([0-9a-f]+ <)).*$", "", match.group(3))
                function.instructions.append(Instruction(address, match.group(2), operands))

    def _run(self, tool, *arguments, text=None):
        result = subprocess.run([self.prefix + tool, *arguments], input=text, text=True,
                                capture_output=True, check=False)
        if result.returncode != 0:
            raise Refused(f"{self.prefix}{tool} {' '.join(arguments)}: {result.stderr.strip()}")
        return result.stdout

    def at(self, address):
        """The function that holds the address, or None."""
        index = bisect.bisect_right(self._starts, address) - 1
        if index >= 0 and address < self.functions[index].end:
            return self.functions[index]
        return None

    def word(self, address):
        """The 32 bits of code or constants there; None where nothing is."""
        for section in self._elf.sections:
            at = address - section["address"]
            if section["flags"] & 2 and section["type"] == 1 and 0 <= at <= section["size"] - 4:
                return struct.unpack_from("<I", self._elf.data, section["offset"] + at)[0]
        return None

    def named(self, pattern):
        """The one function whose name, without its parameters, is the pattern."""
        found = [f for f in self.functions
                 if pattern in (f.symbol, f.name, f.name.split("(", 1)[0])]
        if len(found) != 1:
            raise Refused(f"{self.path}: {len(found)} functions are called {pattern}")
        return found[0]

    def chain(self, address):
        """((file, line), ...) of the instruction, behind it those of the calls through which it was
        inlined. Empty where nothing is known."""
        if address not in self._chains:
            self._find_chains(address)
        return self._chains[address]

    def _find_chains(self, address):
        """Of all jumps of the function that holds it."""
        function = self.at(address)
        addresses = {address} | {i.address for i in function.instructions
                                 if i.mnemonic.startswith(("b", "cb", "tb"))}
        for line in self._lines_of(sorted(addresses)):
            if line.startswith("0x"):
                chain = []
                self._chains[int(line, 16)] = chain
            elif not line.startswith("??"):
                file, number = line.split(" (")[0].rsplit(":", 1)
                if number.isdigit() and number != "0":
                    chain.append((file, int(number)))
        for a in addresses:
            self._chains[a] = tuple(self._chains.get(a, ()))

    def _lines_of(self, addresses):
        """What addr2line says of them: one process for all functions, as each would read all of the
        image's debugging information anew. 0 is no code, and ends an answer; few are asked at once,
        so that neither side waits for the other to read."""
        if self._addr2line is None:
            self._addr2line = subprocess.Popen(
                [self.prefix + "addr2line", "-a", "-i", "-e", self.path], text=True,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        for first in range(0, len(addresses), 256):
            asked = [f"{a:#x}" for a in addresses[first:first + 256]]
            self._addr2line.stdin.write("\n".join(asked + ["0x0", ""]))
            self._addr2line.stdin.flush()
            while True:
                line = self._addr2line.stdout.readline().rstrip("\n")
                if not line:
                    raise Refused(f"{self.prefix}addr2line -a -i -e {self.path}: ended")
                if line.startswith("0x") and int(line, 16) == 0:
                    break
                yield line
            self._addr2line.stdout.readline()
