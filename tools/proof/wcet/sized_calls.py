# SPDX-License-Identifier: Apache-2.0
"""Library functions whose loops run by a size in bytes: memcpy, memset and their like.

Their loops have no records; each of their iterations moves at least one byte, and one that is a
single block what its stores write. So with n bytes every loop of theirs has at most n back edges
divided by that, and what n is has to be a constant before the call, or is declared for the function
that calls. Otherwise the call is refused.
"""

import re

from image import EM_ARM, Refused
from registers import Registers, straight_before

# The argument that is the size.
ARGUMENT = {"memcpy": 2, "memmove": 2, "memset": 2, "memcmp": 2, "__aeabi_memcpy": 2,
            "__aeabi_memcpy4": 2, "__aeabi_memcpy8": 2, "__aeabi_memmove": 2,
            "__aeabi_memmove4": 2, "__aeabi_memmove8": 2, "__aeabi_memset": 1,
            "__aeabi_memset4": 1, "__aeabi_memset8": 1, "__aeabi_memclr": 1,
            "__aeabi_memclr4": 1, "__aeabi_memclr8": 1}


STORED = {"str": 4, "strh": 2, "strb": 1, "strd": 8}  # bytes, of Thumb-2


def bytes_an_iteration(graph, loop):
    """That a loop of such a function moves at least in each of its iterations."""
    if graph.image.machine != EM_ARM or len(loop.blocks) != 1:
        return 1
    # Conditional ones have a suffix and are not counted; what is compared is not stored.
    names = [re.sub(r"\.[nw]$", "", i.mnemonic) for i in graph.blocks[loop.header].instructions]
    return max(1, sum(STORED.get(name, 0) for name in names))


class SizedCalls:
    """declared: {name of the calling function: most bytes} where no constant stands before."""

    def __init__(self, image, declared=None):
        self.image = image
        self.declared = dict(declared or {})
        self.functions = {f.start: ARGUMENT[f.symbol] for f in image.functions
                          if f.symbol in ARGUMENT}

    def size(self, graph, block, instruction, target):
        """The most bytes that the call has to do with; None of one that has no size."""
        if target not in self.functions:
            return None
        registers = Registers(self.image)
        for before in straight_before(graph, graph.blocks.index(block)):
            if before is instruction:
                break
            registers.step(before)
        prefix = "r" if self.image.machine == EM_ARM else "x"
        value = registers.constant(f"{prefix}{self.functions[target]}")
        if value is not None:
            return value
        name = graph.function.name.split("(", 1)[0]
        if name in self.declared:
            return self.declared[name]
        raise Refused(f"{graph.function.name}: a size that is no constant: {instruction}")
