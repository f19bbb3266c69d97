# SPDX-License-Identifier: Apache-2.0
"""Loops of the compiler's own that have no record: those with which it copies a struct (Thumb-2).

Such a loop is one block that ends by comparing a pointer with its end and jumping back while they
differ. Both come from the same register or sp before the loop, so that they lie a known distance
apart, and the pointer goes on by a known step: the number of iterations follows (registers.py).
"""

import re

from image import EM_ARM
from registers import Registers, straight_before

KEEPS_FLAGS = re.compile(r"(v?(ldr|str|ldm|stm)[a-z]*|add|addw|sub|subw|mov|bne)$")


def back_edges(graph, loop):
    """How often the loop's back edge is gone along for each entry; None where that is not known."""
    if graph.image.machine != EM_ARM or len(loop.blocks) != 1:
        return None
    body = graph.blocks[loop.header].instructions
    entries = [p for p in graph.predecessors[loop.header] if p not in loop.blocks]
    if len(entries) != 1 or len(body) < 2 or body[-1].mnemonic.split(".")[0] != "bne":
        return None
    inside, compared = _compared(graph.image, body)
    if compared is None:
        return None
    (pointer, ahead), (end, shift) = compared
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
