# SPDX-License-Identifier: Apache-2.0
"""Loops of the compiler's own that have no record: those with which it copies a struct (Thumb-2).

Such a loop is one block that ends by comparing a pointer with its end and jumping back while they
differ. Both come from the same register or sp before the loop, so that they lie a known distance
apart, and the pointer goes on by a known step: the number of iterations follows. Registers are
followed as `origin + offset`; whatever else writes one makes it unknown.
"""

import re

from image import EM_ARM

NUMBER = r"#(-?\d+|0x[0-9a-f]+)"
# What a call leaves as it was (AAPCS).
KEPT = {f"r{i}" for i in range(4, 9)} | {"r9", "sl", "fp", "sp"}
NO_RESULT = re.compile(r"(cmp|cmn|tst|teq|nop|it[te]*|b|b[a-z]{2}|cbn?z|vcmpe?|vmsr|dmb|dsb|isb)$")
STORE = re.compile(r"(v?str[bh]?|strd)$")
KEEPS_FLAGS = re.compile(r"(v?(ldr|str|ldm|stm)[a-z]*|add|addw|sub|subw|mov|bne)$")
SEVERAL = re.compile(r"(v?)(ldm|stm|pop|push)(ia|db|fd)?$")


class Registers:
    """{register: (origin, offset)}; at first each is its own origin."""

    def __init__(self):
        self.values = {}
        self._unknown = 0

    def get(self, register):
        return self.values.get(register, (register, 0))

    def forget(self, register):
        self._unknown += 1
        self.values[register] = (f"?{id(self)}.{self._unknown}", 0)

    def forget_all(self, but=()):
        for register in [f"r{i}" for i in range(13)] + ["sb", "sl", "fp", "ip", "lr", "sp"]:
            if register not in but:
                self.forget(register)

    def set_sum(self, register, other, offset):
        origin, so_far = self.get(other)
        self.values[register] = (origin, so_far + offset)

    def step(self, instruction):
        name = instruction.mnemonic.split(".")[0]
        operands = instruction.operands
        if name in ("bl", "blx"):
            self.forget_all(but=KEPT)
        elif NO_RESULT.match(name):
            pass
        elif SEVERAL.match(name):
            self._several(SEVERAL.match(name), operands)
        elif not self._assign(name, operands):
            self._other(name, operands)

    def _assign(self, name, operands):
        match = re.match(rf"(\w+), (?:(\w+), )?{NUMBER}$", operands)
        if match and name in ("add", "adds", "addw", "sub", "subs", "subw"):
            offset = int(match.group(3), 0)
            self.set_sum(match.group(1), match.group(2) or match.group(1),
                         offset if name.startswith("add") else -offset)
            return True
        match = re.match(r"(\w+), (\w+)$", operands)
        if match and name in ("mov", "movs"):
            self.set_sum(match.group(1), match.group(2), 0)
            return True
        return False

    def _several(self, match, operands):
        if match.group(2) in ("pop", "push"):
            listed = operands
            size = 8 if "d" in listed else 4
            count = len(self._listed(listed))
            self.set_sum("sp", "sp", size * count if match.group(2) == "pop" else -size * count)
        else:
            base, listed = operands.split(", ", 1)
            if base.endswith("!"):
                down = match.group(3) == "db"
                size = 8 if re.search(r"\{d", listed) else 4
                count = len(self._listed(listed))
                self.set_sum(base[:-1], base[:-1], -size * count if down else size * count)
        if match.group(2) in ("ldm", "pop") and not match.group(1):
            for register in self._listed(listed):
                self.forget(register)

    @staticmethod
    def _listed(text):
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

    def _other(self, name, operands):
        after = re.search(rf"\[(\w+)\], {NUMBER}$", operands)
        before = re.search(rf"\[(\w+), {NUMBER}\]!$", operands)
        written = operands.split(", ")
        if not STORE.match(name):
            self.forget(written[0])
            if name in ("ldrd", "umull", "smull", "umlal", "smlal") and len(written) > 1:
                self.forget(written[1])
            if name == "vmov" and len(written) > 1:
                self.forget(written[1])
        for match in (after, before):
            if match:
                self.set_sum(match.group(1), match.group(1), int(match.group(2), 0))
        if name == "msr" or "pc" == written[0]:
            self.forget_all()


def back_edges(graph, loop):
    """How often the loop's back edge is gone along for each entry; None where that is not known."""
    if graph.image.machine != EM_ARM or len(loop.blocks) != 1:
        return None
    body = graph.blocks[loop.header].instructions
    entries = [p for p in graph.predecessors[loop.header] if p not in loop.blocks]
    if len(entries) != 1 or len(body) < 2 or body[-1].mnemonic.split(".")[0] != "bne":
        return None
    inside, compared = _compared(body)
    if compared is None:
        return None
    (pointer, ahead), (end, shift) = compared
    origin, step = inside.get(pointer)
    if origin != pointer or step == 0 or inside.get(end) != (end, 0):
        return None
    outside = Registers()
    for instruction in _straight_before(graph, entries[0]):
        outside.step(instruction)
    first, last = outside.get(pointer), outside.get(end)
    way = last[1] + shift - first[1] - ahead
    if first[0] != last[0] or way % step != 0 or way // step < 0:
        return None
    return way // step


def _compared(body):
    """The registers behind the body, and the two that it compares, as values of its beginning."""
    registers, compared = Registers(), None
    for instruction in body:
        name = instruction.mnemonic.split(".")[0]
        if name == "cmp":
            match = re.match(r"(\w+), (\w+)$", instruction.operands)
            compared = (registers.get(match.group(1)), registers.get(match.group(2))) if match \
                else None
        elif not KEEPS_FLAGS.match(name):
            compared = None
        registers.step(instruction)
    if compared is None:
        return registers, None
    # The pointer is what changes; the end does not.
    if registers.get(compared[0][0]) == (compared[0][0], 0):
        compared = (compared[1], compared[0])
    return registers, compared


def _straight_before(graph, index):
    """The instructions of the blocks through which alone the block is reached, the first first."""
    chain = [index]
    while len(graph.predecessors[chain[-1]]) == 1 and chain[-1] != 0:
        previous = graph.predecessors[chain[-1]][0]
        if previous in chain:
            break
        chain.append(previous)
    return [i for block in reversed(chain) for i in graph.blocks[block].instructions]
