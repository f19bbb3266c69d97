# SPDX-License-Identifier: Apache-2.0
"""What registers hold along straight code, as far as it is a constant or lies a constant from what
another register held before.

A value is (origin, offset): origin CONSTANT, a register's name (what it held at first) or a number
for what is not known. Whatever is not understood makes what it writes unknown. A call leaves the
registers that the procedure call standard has a callee keep.
"""

import re

from image import EM_ARM
from instructions import CONDITION

CONSTANT = ""
NUMBER = r"#(-?\d+|0x[0-9a-f]+)"
NO_RESULT = re.compile(rf"(cmp|cmn|tst|teq|nop|it[te]*|b|b\.?{CONDITION}|cbn?z|tbn?z|v?cmpe?"
                       r"|f?ccmpe?|fcmpe?|vmsr|dmb|dsb|isb|prfm)$")
STORE = re.compile(r"(v?str[bh]?|strd|stp|stur[bh]?)$")
SEVERAL = re.compile(r"(v?)(ldm|stm|pop|push)(ia|db|fd)?$")
SEVERAL_IF = re.compile(rf"v?(ldm|stm|pop|push)(ia|db|fd)?{CONDITION}$")
CALL = re.compile(rf"blx?{CONDITION}?$")
# Whatever condition there is behind it.
TWO_RESULTS = re.compile(r"(ldrd|ldrexd|ldn?p|lda?xp|[us]mull|[us]mlal|umaal|smlsld|vmov)")
# Of an access that writes its base back whether or not a condition holds.
ALWAYS = re.compile(r"(ldr(s?[bh]|sw|d)?|str[bhd]?|ldp(sw)?|stp|(ld|st)[1-4]r?)$")
THUMB_KEPT = {f"r{i}" for i in range(4, 9)} | {"r9", "sl", "fp", "sp"}
A64_KEPT = {f"x{i}" for i in range(19, 30)} | {"sp"}


class Registers:
    """At first each register is its own origin."""

    def __init__(self, image):
        self.image = image
        self.is_thumb = image.machine == EM_ARM
        self.values = {}
        self._unknown = 0

    def _name(self, register):
        """The lower half of an A64 register is of the same register; writing it clears the rest."""
        if self.is_thumb or not isinstance(register, str):
            return register
        return re.sub(r"^w(\d+)$", r"x\1", register)

    def get(self, register):
        register = self._name(register)
        if register in ("xzr", "wzr"):
            return CONSTANT, 0
        if register == "pc":  # another one with each instruction
            self._unknown += 1
            return self._unknown, 0
        return self.values.get(register, (register, 0))

    def constant(self, register):
        """Its value; None where that is not known."""
        origin, value = self.get(register)
        return value if origin == CONSTANT else None

    def forget(self, register):
        self._unknown += 1
        self.values[self._name(register)] = (self._unknown, 0)

    def forget_all(self, but=()):
        names = [f"r{i}" for i in range(13)] + ["sb", "sl", "fp", "ip", "lr"] if self.is_thumb \
            else [f"x{i}" for i in range(31)]
        for register in [*names, "sp"]:
            if register not in but:
                self.forget(register)

    def set_sum(self, register, other, offset):
        origin, so_far = self.get(other)
        if origin != CONSTANT and not self.is_thumb and register.startswith("w") and \
                register != "wsp":
            return self.forget(register)  # the sum of two lower halves may have lost a carry
        self.values[self._name(register)] = (origin, so_far + offset)
        return None

    def step(self, instruction):
        mnemonic = instruction.mnemonic
        name = mnemonic.split(".")[0] if self.is_thumb else mnemonic
        operands = instruction.operands
        if CALL.match(name):
            self.forget_all(but=THUMB_KEPT if self.is_thumb else A64_KEPT)
        elif NO_RESULT.match(name):
            pass
        elif self.is_thumb and SEVERAL.match(name):
            self._several(SEVERAL.match(name), operands)
        elif self.is_thumb and SEVERAL_IF.match(name):
            self.forget_all()
        elif not self._assign(name, operands):
            self._other(name, operands)

    def _assign(self, name, operands):
        match = re.match(rf"(\w+), (?:(\w+), )?{NUMBER}(, lsl #\d+)?$", operands)
        if match and name in ("add", "adds", "addw", "sub", "subs", "subw"):
            offset = int(match.group(3), 0) << int((match.group(4) or "#0").rsplit("#", 1)[1])
            self.set_sum(match.group(1), match.group(2) or match.group(1),
                         offset if name.startswith("add") else -offset)
            return True
        if match and not match.group(2) and self._load_number(name, match):
            return True
        match = re.match(r"(\w+), (\w+)$", operands)
        if match and name in ("mov", "movs"):
            self.set_sum(match.group(1), match.group(2), 0)
            return True
        match = re.match(r"(\w+), \[pc, #\d+\]\s*@? ?\(?([0-9a-f]+)", operands)
        if match and name == "ldr" and self.image.word(int(match.group(2), 16)) is not None:
            self._set(match.group(1), self.image.word(int(match.group(2), 16)))
            return True
        return False

    def _load_number(self, name, match):
        register, value = match.group(1), int(match.group(3), 0)
        shift = int((match.group(4) or "#0").rsplit("#", 1)[1])
        if name in ("movt", "movk"):
            before = self.constant(register)
            if before is None:
                return False
            shift = 16 if name == "movt" else shift
            self._set(register, before & ~(0xffff << shift) | value << shift)
            return True
        if name in ("mov", "movs", "movw", "movz"):
            self._set(register, value << shift)
            return True
        return False

    def _set(self, register, value):
        self.values[self._name(register)] = (CONSTANT, value)

    def _several(self, match, operands):
        if match.group(2) in ("pop", "push"):
            base, listed = "sp", operands
            down = match.group(2) == "push"
            writes_back = True
        else:
            base, listed = operands.split(", ", 1)
            down = match.group(3) == "db"
            writes_back = base.endswith("!")
            base = base.rstrip("!")
        registers = listed_registers(listed)
        if writes_back:
            size = len(registers) * (8 if listed.startswith("{d") else 4)
            self.set_sum(base, base, -size if down else size)
        if match.group(2) in ("ldm", "pop") and not match.group(1):
            for register in registers:
                self.forget(register)

    def _other(self, name, operands):
        written = operands.split(", ")
        if not STORE.match(name):
            self.forget(written[0])
            if TWO_RESULTS.match(name) and len(written) > 1:
                self.forget(written[1])
        after = re.search(rf"\[(\w+)\], {NUMBER}$", operands)
        before = re.search(rf"\[(\w+), {NUMBER}\]!$", operands)
        for match in (after, before):
            if match and ALWAYS.match(name):
                self.set_sum(match.group(1), match.group(1), int(match.group(2), 0))
            elif match:
                self.forget(match.group(1))
        if "]!" in operands and not before or re.search(r"\], \w+$", operands):
            self.forget_all()
        if name in ("msr", "svc") or written[0] == "pc":
            self.forget_all()


def listed_registers(text):
    """The registers of {r0, r4-r6}."""
    found = []
    for part in text.strip("{}").split(", "):
        ends = re.match(r"([a-z]+)(\d+)-[a-z]+(\d+)$", part)
        if ends:
            found += [f"{ends.group(1)}{i}"
                      for i in range(int(ends.group(2)), int(ends.group(3)) + 1)]
        else:
            found.append(part)
    return found


def straight_before(graph, index):
    """The instructions of the block, and of those through which alone it is reached, the first
    first."""
    chain = [index]
    while len(graph.predecessors[chain[-1]]) == 1 and chain[-1] != 0:
        previous = graph.predecessors[chain[-1]][0]
        if previous in chain:
            break
        chain.append(previous)
    result = []
    for block in reversed(chain):
        if not result or graph.blocks[block].instructions is not result[-1]:
            result.append(graph.blocks[block].instructions)
    return [i for instructions in result for i in instructions]
