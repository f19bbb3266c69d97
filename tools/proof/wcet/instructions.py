# SPDX-License-Identifier: Apache-2.0
"""Where control goes after an instruction, for Thumb-2 and A64 as objdump writes them."""

import enum
import re
from dataclasses import dataclass

from image import EM_ARM, Refused


class Kind(enum.Enum):
    NEXT = "goes on"
    JUMP = "jump"  # to the target; conditional: or goes on
    CALL = "call"  # of the target, then goes on; conditional: or goes on at once
    RETURN = "return"  # conditional: or goes on
    STOP = "stop"  # never goes on


@dataclass(frozen=True)
class Effect:
    kind: Kind
    target: int = 0
    conditional: bool = False


NEXT = Effect(Kind.NEXT)
CONDITION = "(eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)"
THUMB_BRANCH = re.compile(f"b{CONDITION}?$")
THUMB_CALL = re.compile(f"(blx?){CONDITION}?$")
THUMB_RETURN = re.compile(f"(bx){CONDITION}?$")
THUMB_LOAD = re.compile(f"(pop|ldm|ldmia|ldmfd|ldmdb|ldr|mov|add|sub){CONDITION}?$")


def target_of(instruction):
    match = re.search(r"\b([0-9a-f]+) <", instruction.operands)
    if not match:
        raise Refused(f"indirect: {instruction}")
    return int(match.group(1), 16)


def thumb_effect(instruction):
    name = instruction.mnemonic.split(".")[0]
    operands = instruction.operands
    if name in ("tbb", "tbh"):
        raise Refused(f"a jump table: {instruction}")
    if name == "udf":
        return Effect(Kind.STOP)
    if name in ("cbz", "cbnz"):
        return Effect(Kind.JUMP, target_of(instruction), True)
    match = THUMB_BRANCH.match(name)
    if match:
        return Effect(Kind.JUMP, target_of(instruction), match.group(1) is not None)
    match = THUMB_CALL.match(name)
    if match:
        return Effect(Kind.CALL, target_of(instruction), match.group(2) is not None)
    match = THUMB_RETURN.match(name)
    if match:
        if operands != "lr":
            raise Refused(f"indirect: {instruction}")
        return Effect(Kind.RETURN, conditional=match.group(2) is not None)
    match = THUMB_LOAD.match(name)
    if match and writes_pc(match.group(1), operands):
        restores = "sp" in operands or name.startswith("pop") or operands == "pc, lr"
        if not restores:
            raise Refused(f"indirect: {instruction}")
        return Effect(Kind.RETURN, conditional=match.group(2) is not None)
    return NEXT


def writes_pc(name, operands):
    if name.startswith(("pop", "ldm")):
        return "pc" in operands
    return operands.startswith("pc,")


A64_CONDITIONAL = re.compile(r"(b\.[a-z]{2}|cbz|cbnz|tbz|tbnz)$")


def a64_effect(instruction):
    name = instruction.mnemonic
    if name in ("br", "blr", "braa", "blraa", "eret", "drps"):
        raise Refused(f"indirect: {instruction}")
    if name in ("udf", "brk"):
        return Effect(Kind.STOP)
    if name == "ret":
        if instruction.operands not in ("", "x30"):
            raise Refused(f"indirect: {instruction}")
        return Effect(Kind.RETURN)
    if A64_CONDITIONAL.match(name):
        return Effect(Kind.JUMP, target_of(instruction), True)
    if name == "b":
        return Effect(Kind.JUMP, target_of(instruction))
    if name == "bl":
        return Effect(Kind.CALL, target_of(instruction))
    return NEXT


def effect_of(instruction, machine):
    return thumb_effect(instruction) if machine == EM_ARM else a64_effect(instruction)
