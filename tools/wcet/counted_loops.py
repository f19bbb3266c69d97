# SPDX-License-Identifier: Apache-2.0
"""Loops whose iterations are known from the code alone: those with which the compiler copies a
struct, which have no record, and those over a whole row that it does several cells at a time, of
which there are fewer iterations than the record of the source's loop says.

Such a loop is one block that ends by comparing a pointer or a counter with its end and jumping back
while they differ. Both are constants or come from the same register before the loop, so that they lie
a known distance apart, and the first goes on by a known step: the number of iterations follows
(registers.py).
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
