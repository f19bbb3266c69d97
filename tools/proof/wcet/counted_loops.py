# SPDX-License-Identifier: Apache-2.0
"""Loops whose iterations are known from the code alone: those with which the compiler copies a
struct, which have no record, and those over a whole row that it does several cells at a time, of
which there are fewer iterations than the record of the source's loop says.

Such a loop is one block that ends by comparing a pointer or a counter with its end and jumping back
while they differ. Both are constants or come from the same register before the loop, so that they lie
a known distance apart, and the first goes on by a known step: the number of iterations follows
(registers.py).

Of a vector loop over a part of a row it is known how many of the source's iterations it does in one:
    lsr  w3, w4, #2           w4 are the source's, four at a time
    add  x3, x1, w3, uxtw #4  the end, with 16 bytes for each four
    ...                       the loop, from x1 on, by 16 bytes
    and  w9, w4, #0xfffffffc  behind it: those that are done
The same register behind the loop, without its lowest bits, vouches for what was shifted being the
number of the source's iterations, and all of the shift being the vector's. A division that the source
itself does looks the same: so what is left has to be done by the same loop of the source
(OwnRecords.has_rest_behind).
"""

import re

from image import EM_ARM
from registers import CONSTANT, Registers, straight_before

KEEPS_FLAGS = re.compile(r"(v?(ldr|str|ldm|stm)[a-z]*|add|addw|sub|subw|mov|bne)$")
SETS_FLAGS_A64 = re.compile(r"(cmn|tst|adds|subs|ands|bics|negs|ngcs|sbcs|adcs|f?ccm[pn]e?|fcmpe?|msr|bl)$")


def back_edges(graph, loop):
    """How often the loop's back edge is gone along for each entry; None where that is not known."""
    if len(loop.blocks) != 1:
        return None
    body = graph.blocks[loop.header].instructions
    entries = [p for p in graph.predecessors[loop.header] if p not in loop.blocks]
    closing = "bne" if graph.image.machine == EM_ARM else "b.ne"
    if len(entries) != 1 or len(body) < 2 or \
            re.sub(r"\.[nw]$", "", body[-1].mnemonic) != closing:
        return None
    inside, compared = _compared(graph.image, body)
    if compared is None:
        return None
    (pointer, ahead), (end, shift) = compared
    if not isinstance(pointer, str) or not isinstance(end, str):
        return None
    origin, step = inside.get(pointer)
    if origin != pointer or step == 0 or inside.get(end) != (end, 0):
        return None
    outside = Registers(graph.image)
    for instruction in straight_before(graph, entries[0]):
        outside.step(instruction)
    first, last = outside.get(pointer), outside.get(end)
    way = last[1] + shift - first[1] - ahead
    if first[0] != last[0] or way % step != 0 or way // step < 0:
        return None
    return way // step


def lanes(graph, loop):
    """How many of the source's iterations one of an A64 loop does, if what is left of them comes
    behind it; 1 where that is not known."""
    if graph.image.machine == EM_ARM or len(loop.blocks) != 1:
        return 1
    body = graph.blocks[loop.header].instructions
    entries = [p for p in graph.predecessors[loop.header] if p not in loop.blocks]
    if len(entries) != 1 or len(body) < 2 or body[-1].mnemonic != "b.ne":
        return 1
    inside, compared = _compared(graph.image, body)
    if compared is None:
        return 1
    (pointer, ahead), (end, shift) = compared
    if not isinstance(pointer, str) or not isinstance(end, str) or end == CONSTANT:
        return 1
    origin, step = inside.get(pointer)
    outside = Quotients(graph.image)
    for instruction in straight_before(graph, entries[0]):
        outside.step(instruction)
    way = outside.ends.get(end)
    if way is None or origin != pointer or ahead != step or shift != 0 or \
            inside.get(end) != (end, 0):
        return 1
    base, counter, bits, scale = way
    if outside.get(pointer) != base or step != 1 << scale or inside.get(counter) != (counter, 0):
        return 1
    behind = [s for s in graph.blocks[loop.header].successors if s not in loop.blocks]
    if len(behind) != 1 or not _masks(graph, behind[0], counter, bits):
        return 1
    return 1 << bits


class Quotients(Registers):
    """Also ends = {register: (base, register of the counter, bits, scale)}: what holds
    base + ((counter >> bits) << scale), while the counter's register still holds the counter."""

    def __init__(self, image):
        super().__init__(image)
        self.quotients = {}  # register: (counter, bits)
        self.ends = {}

    def step(self, instruction):
        name, operands = instruction.mnemonic, instruction.operands
        found = self._quotient(name, operands) or self._end(name, operands)
        before = dict(self.values)
        super().step(instruction)
        changed = {r for r in {*before, *self.values} if before.get(r) != self.values.get(r)}
        for table, counter_of in ((self.quotients, lambda q: q[0]), (self.ends, lambda e: e[1])):
            for register in [r for r, value in table.items()
                             if r in changed or counter_of(value) in changed]:
                del table[register]
        if found:
            table, register, value = found
            if value[0] != register and value[1] != register:
                table[register] = value

    def _quotient(self, name, operands):
        match = re.match(r"([wx]\d+), ([wx]\d+), #(\d+)$", operands)
        if name != "lsr" or not match:
            return None
        register, counter = self._name(match.group(1)), self._name(match.group(2))
        return self.quotients, register, (counter, int(match.group(3)))

    def _end(self, name, operands):
        match = re.match(r"([wx]\d+), ([wx]\d+), #(0x[0-9a-f]+)$", operands)
        if name == "and" and match:  # of bytes: (counter >> bits) << bits
            bits = low_zeros(int(match.group(3), 0))
            counter = self._name(match.group(2))
            return bits and (self.ends, self._name(match.group(1)),
                             ((CONSTANT, 0), counter, bits, bits))
        match = re.match(r"(x\d+), (x\d+), ([wx]\d+), (?:uxtw|lsl) #(\d+)$", operands)
        base = match and self.get(match.group(2))
        if not match or name != "add":
            match = re.match(r"(x\d+)(), (x\d+), #(\d+)$", operands)
            base = (CONSTANT, 0)
            if not match or name != "lsl":
                return None
        quotient = self.quotients.get(self._name(match.group(3)))
        if quotient is None:
            return None
        counter, bits = quotient
        return self.ends, match.group(1), (base, counter, bits, int(match.group(4)))


def low_zeros(mask):
    """How many of its lowest bits are 0, where all others of 32 or 64 are 1; 0 of any other mask."""
    for width in (32, 64):
        bits = ((1 << width) - mask).bit_length() - 1
        if 0 < bits < 8 and mask == (1 << width) - (1 << bits):
            return bits
    return 0


def _masks(graph, block, counter, bits):
    """Whether the block takes the lowest bits off the counter, or asks for them."""
    registers = Registers(graph.image)
    for instruction in graph.blocks[block].instructions:
        match = re.match(r"(?:[wx]\d+, )?([wx]\d+), #(0x[0-9a-f]+)$", instruction.operands)
        if match and registers.get(match.group(1)) == (counter, 0):
            mask = int(match.group(2), 0)
            if instruction.mnemonic == "and" and low_zeros(mask) == bits or \
                    instruction.mnemonic == "tst" and mask == (1 << bits) - 1:
                return True
        registers.step(instruction)
    return False


def _compared(image, body):
    """The registers behind the body, and the two that it compares, as values of its beginning."""
    registers, compared = Registers(image), None
    for instruction in body:
        name = instruction.mnemonic.split(".")[0]
        if name == "cmp":
            match = re.match(r"(\w+), (?:(\w+)|#(0x[0-9a-f]+|\d+))$", instruction.operands)
            compared = (registers.get(match.group(1)),
                        registers.get(match.group(2)) if match.group(2) else
                        (CONSTANT, int(match.group(3), 0))) if match else None
        elif not KEEPS_FLAGS.match(name) if image.machine == EM_ARM else SETS_FLAGS_A64.match(name):
            compared = None
        registers.step(instruction)
    if compared is None:
        return registers, None
    # The pointer is what changes; the end does not.
    if registers.get(compared[0][0]) == (compared[0][0], 0):
        compared = (compared[1], compared[0])
    return registers, compared
