# SPDX-License-Identifier: Apache-2.0
"""Library functions whose loops run by a size in bytes: memcpy, memset and their like.

Their loops have no records; each of their iterations moves at least one byte. So with n bytes every
loop of theirs has at most n back edges, and what n is has to stand before the call as a constant,
or is declared for the function that calls. Otherwise the call is refused.
"""

import re

from image import EM_ARM, Refused

# The register of the size, as an index.
REGISTER = {"memcpy": 2, "memmove": 2, "memset": 2, "memcmp": 2, "__aeabi_memcpy": 2,
            "__aeabi_memcpy4": 2, "__aeabi_memcpy8": 2, "__aeabi_memmove": 2,
            "__aeabi_memmove4": 2, "__aeabi_memmove8": 2, "__aeabi_memset": 1,
            "__aeabi_memset4": 1, "__aeabi_memset8": 1, "__aeabi_memclr": 1,
            "__aeabi_memclr4": 1, "__aeabi_memclr8": 1}
WRITES_NOTHING = re.compile(r"(cmp|cmn|tst|teq|str|vstr|stm|vstm|push|nop|it[te]*|stp|stur)")


class SizedCalls:
    """declared: {name of the calling function: most bytes} where no constant stands before."""

    def __init__(self, image, declared=None):
        self.image = image
        self.declared = dict(declared or {})
        self.used = set()  # of the declared names
        self.functions = {f.start: REGISTER[f.symbol] for f in image.functions
                          if f.symbol in REGISTER}

    def size(self, graph, block, instruction, target):
        """The most bytes that the call has to do with; None of one that has no size."""
        if target not in self.functions:
            return None
        name = graph.function.name.split("(", 1)[0]
        value = self._constant(graph, block, instruction, self.functions[target])
        if value is not None:
            return value
        if name in self.declared:
            self.used.add(name)
            return self.declared[name]
        raise Refused(f"{graph.function.name}: a size that is no constant: {instruction}")

    def _constant(self, graph, block, call, register):
        letters = "r" if self.image.machine == EM_ARM else "[xw]"
        written = re.compile(rf"{letters}{register}\b(?:, (.*))?$")
        high = None  # of a pair movw, movt or mov, movk
        for before in self._backwards(graph, block, call):
            name = before.mnemonic.split(".")[0]
            if WRITES_NOTHING.match(name):
                continue
            if name in ("bl", "blx"):
                return None
            match = written.match(before.operands)
            if not match:
                if self._may_write(before, register):
                    return None
                continue
            value = self._value(name, match.group(1) or "")
            if value is None:
                return None
            if name in ("movt", "movk"):
                high = value
                continue
            return value if high is None else (value & 0xffff) | (high << 16)
        return None

    @staticmethod
    def _backwards(graph, block, call):
        """What was executed before the call, the last first, as far as there is one way to it."""
        yield from reversed(block.instructions[:block.instructions.index(call)])
        index = graph.blocks.index(block)
        seen = {index}
        while len(graph.predecessors[index]) == 1:
            index = graph.predecessors[index][0]
            if index in seen:
                return
            seen.add(index)
            if graph.blocks[index].instructions is not block.instructions:
                yield from reversed(graph.blocks[index].instructions)

    @staticmethod
    def _may_write(instruction, register):
        """Whether it could write the register without having it as its first operand."""
        operands = instruction.operands.replace("{", "").replace("}", "").split(", ")
        name = instruction.mnemonic
        several = name.startswith(("ldm", "pop", "ldp", "ldrd", "umull", "smull", "umlal", "smlal"))
        pair = {f"r{register}", f"x{register}", f"w{register}"}
        return several and bool(pair & set(operands))

    def _value(self, name, operands):
        match = re.match(r"#(-?\d+|0x[0-9a-f]+)(?:, lsl #16)?$", operands)
        if name in ("mov", "movs", "movw", "movt", "movz", "movk") and match:
            return int(match.group(1), 0)
        match = re.match(r"\[pc, #\d+\]\s*@? ?\(?([0-9a-f]+)", operands)
        if name == "ldr" and match:
            return self.image.word(int(match.group(1), 16))
        return None
