# SPDX-License-Identifier: Apache-2.0
"""Which record of HP_LOOP_BOUND is a machine loop's own.

A loop's record is passed each time the loop is entered. So it is at the address of its header or
among the records met on the ways backwards from where the loop is entered, around loops that lie
before it and never out of the loop around it. Other loops' records lie there too: at a header's
address that of an inner loop that begins with the same instruction; before it those of loops that
were unrolled, or of inner loops in a copy of the first iteration.

Which one it is tells the line. A record stands right before its loop's head, and from the condition
there stem the jumps that close the loop, or, where they are of an `if` in its body, others of its
jumps. A jump has the lines of the calls through which it was inlined too. Where several of these
have a record before them, the largest is taken, except of a record that is also inside the loop: it
is of a loop further inside.

In a function without any lines the own record can be any that is met.
"""

import math
import re
from dataclasses import dataclass

from flow_graph import EXIT
from image import EM_AARCH64, Record

# Files whose loops all have records.
RECORDED = re.compile(r"(^|/)(core|hal|config|test/timing/kernels)/")


@dataclass(frozen=True)
class Met:
    """A record, and where."""
    block: int
    address: int
    record: Record


@dataclass
class Own:
    met: tuple  # the records that can be the loop's own
    n: int  # its back edges for each entry
    is_known: bool  # the lines say which they are
    is_before: bool  # all in blocks that are gone through once for each of the loop's entries

    def places(self):
        return {met.record.place() for met in self.met}

    def is_one(self):
        """Whether it is sure which record it is: copies of one, or the only one that is met."""
        return len(self.met) == 1 or self.is_known and len(self.places()) == 1


class OwnRecords:
    def __init__(self, graph):
        self.graph = graph
        self.image = graph.image
        self._has_lines = any(self.image.chain(block.instructions[-1].address)
                              for block in graph.blocks)
        self._here = [self._in_block(index) for index in range(len(graph.blocks))]
        self._of = {}  # header: Own or None
        for loop in reversed(graph.loops):  # the outer ones first
            self._of[loop.header] = self._find(loop)

    def of(self, loop):
        """None of a loop that has no record."""
        return self._of[loop.header]

    def _in_block(self, index):
        """The last first."""
        block = self.graph.blocks[index]
        return [Met(index, address, record)
                for address in range(block.end - 1, block.start - 1, -1)
                for record in self.image.records.get(address, ())]

    def _at_header(self, loop):
        start = self.graph.blocks[loop.header].start
        return [met for met in self._here[loop.header] if met.address == start]

    # --- lines ------------------------------------------------------------------------------------
    def lines(self, block):
        """Of the jump that ends the block or leads to it alone, the innermost first, up to the first
        of a file whose loops need not have records."""
        last = self.graph.blocks[block].instructions[-1]
        if not self._ends_in_jump(block):
            before = self.graph.predecessors[block]
            return self.lines(before[0]) if len(before) == 1 else ()
        chain = self.image.chain(last.address)
        others = [i for i, (file, _) in enumerate(chain) if not RECORDED.search(file)]
        return chain[:others[0]] if others else chain

    def _ends_in_jump(self, block):
        return self.graph.blocks[block].instructions[-1].mnemonic.startswith(("b", "cb", "tb"))

    def heads(self, lines, met):
        """The places of those that stand before one of the lines."""
        return {one.record.place() for one in met
                if any(one.record.is_before(file, line) for file, line in lines)}

    def claims(self, loop, place):
        """Whether the innermost line that has a record before it is of that place's loop."""
        everywhere = [met for here in self._here for met in here]
        for latch in loop.latches:
            for line in self.lines(latch):
                found = self.heads([line], everywhere)
                if found:
                    if place in found:
                        return True
                    break
        return False

    def _own_jumps(self, loop):
        """The blocks of the loop that are in no loop inside it."""
        return [block for block in loop.blocks if self.graph.innermost(block) is loop]

    def _nested(self, loop):
        """The loops inside it, at any depth."""
        return [other for other in self.graph.loops
                if other is not loop and other.header in loop.blocks]

    # --- ways -------------------------------------------------------------------------------------
    def _walk(self, loop, is_own):
        """(those met that are the own ones, the others met, whether there is a way without one)"""
        own, others, is_open, seen = [], [], loop.header == 0, set()
        waiting = [p for p in self.graph.predecessors[loop.header] if p not in loop.blocks]
        while waiting:
            index = waiting.pop()
            if index in seen:
                continue
            seen.add(index)
            sibling = self._sibling(loop, index)
            if sibling is not None:
                seen |= sibling.blocks
                index = sibling.header
                here = self._at_header(sibling)
                before = [p for p in self.graph.predecessors[index] if p not in sibling.blocks]
            else:
                here, before = self._here[index], self.graph.predecessors[index]
            found = [met for met in here if is_own(met)]
            own += found
            if found:
                continue
            others += here
            if index == 0 or (loop.parent is not None and index == loop.parent.header):
                is_open = True
            else:
                waiting += before
        return own, others, is_open

    def _sibling(self, loop, index):
        """The outermost loop around the block that does not hold `loop`, or None."""
        around = self.graph.innermost(index)
        result = None
        while around is not None and around is not loop.parent:
            result = around
            around = around.parent
        return result

    def is_directly_inside(self, loop):
        """Whether no loop can have been between this one and the one around it: every record on the
        way from there is of one of the two, or of a loop beside or inside this one."""
        own, around = self.of(loop), self.of(loop.parent)
        if own is None or not own.is_one():
            return False
        _, others, _ = self._walk(loop, lambda met: False)
        others = [met for met in others if met not in own.met + around.met]
        if not (own.is_known and around.is_known):
            return not others
        beside = [other for other in self.graph.loops
                  if other.header in loop.parent.blocks and other is not loop.parent]
        return all(met.record.place() in own.places() | around.places() or
                   any(self.claims(other, met.record.place()) or self._is_within(met, other)
                       for other in beside) for met in others)

    def _is_within(self, met, loop):
        """Whether a record at a loop's header is of a loop inside: the loop's own comes before."""
        own = self.of(loop)
        return met.block == loop.header and own is not None and own.is_known and \
            all(one.address != met.address for one in own.met)

    def has_rest_behind(self, loop):
        """Whether what is left of the source's loop comes right behind it, as behind a vector loop:
        the first jump there is of the line of the one that closes it, and no record lies before."""
        own = self.of(loop)
        behind = {s for block in loop.blocks for s in self.graph.blocks[block].successors
                  if s not in loop.blocks}
        while own is not None and own.is_known and len(behind) == 1:
            block = behind.pop()
            if block == EXIT or self._here[block]:
                break
            if self._ends_in_jump(block):
                lines = self.lines(block)
                return bool(lines) and all(self.lines(latch) == lines for latch in loop.latches)
            behind = set(self.graph.blocks[block].successors)
        return False

    # --- which one it is --------------------------------------------------------------------------
    def _find(self, loop):
        at_header = self._at_header(loop)
        inside = [met for block in loop.blocks for met in self._here[block] if met not in at_header]
        if not self._has_lines:
            return self._any(loop, at_header, inside)
        closing = [self.lines(latch) for latch in loop.latches]
        own_jumps = [self.lines(block) for block in self._own_jumps(loop)]
        # A loop inside may have its first test out here, where its record is passed too.
        for jumps, inner in ((closing, ()), (own_jumps, self._nested(loop)), (own_jumps, ())):
            own = self._known(loop, at_header, inside, jumps, inner)
            if own:
                n = self._closed(loop, own, [*inside, *at_header], closing)
                return self._made(loop, own, n, True)
        own = self._nearest(loop, inside, closing) if self.image.machine == EM_AARCH64 else []
        return self._made(loop, own, max(met.record.n for met in own), True) if own else None

    def _known(self, loop, at_header, inside, jumps, nested):
        """The records that stand before the lines of the jumps and that none of the loops inside
        claims; none where a way has none."""
        others = {met.record.place() for met in inside}
        parent = loop.parent and self.of(loop.parent)

        def is_own(met):
            place = met.record.place()
            return place not in others and not (parent and met in parent.met) and \
                any(self.heads(lines, [met]) for lines in jumps) and \
                not any(self.claims(other, place) for other in nested)
        own = [met for met in at_header if is_own(met)]
        before, _, is_open = self._walk(loop, is_own)
        if is_open and not own:
            return []
        if own:  # as those at the header can be copies of a record inside, so those before
            there = {met.record.place() for met in own}
            before, others, _ = self._walk(loop, lambda met: is_own(met) and
                                           met.record.place() not in there)
            before += filter(is_own, others)
        return own + before

    def _nearest(self, loop, inside, closing):
        """The records that are passed last, where all that closes the loop stems from between them
        and the next record of their file: from the body, as in vector loops. Only for a compiler
        that makes no loops of its own, so that one of the source's has to be there."""
        others = {met.record.place() for met in inside}

        def is_own(met):
            record = met.record
            return record.place() not in others and all(
                lines and record.is_nearest(*lines[0], self._lines_of(record.file))
                for lines in closing)
        own, passed, is_open = self._walk(loop, is_own)
        return [] if is_open or passed or self._at_header(loop) else own

    def _lines_of(self, file):
        """Those of its records."""
        return {r.line for records in self.image.records.values() for r in records if r.file == file}

    def _closed(self, loop, own, inside, closing):
        """How often the back edges are gone along: those of several loops where these have one
        header."""
        most = {}
        for met in own:
            place = met.record.place()
            most[place] = max(most.get(place, 0), met.record.n)
        levels = list(most.values())
        of_latches = [self.heads(lines, own) for lines in closing]
        if len(loop.latches) > 1 and not all(of_latches):
            inner = [met.record.n for met in inside if met.record.place() not in most and
                     not any(self.claims(other, met.record.place())
                             for other in self._nested(loop))]
            levels += [max(inner)] * of_latches.count(set()) if inner else []
        if len(loop.latches) == 1 or len(levels) == 1:
            return max(levels)
        return math.prod(n + 1 for n in levels)

    def _any(self, loop, at_header, inside):
        """Without lines."""
        parent = loop.parent and self.of(loop.parent)

        def may_be_own(met):
            return self.graph.innermost(met.block) is loop.parent and \
                not (parent and parent.met == (met,))
        own, _, is_open = self._walk(loop, may_be_own)
        _, before, _ = self._walk(loop, lambda met: False)
        if not at_header and (is_open or not own):
            return None
        met = at_header + [one for one in before if may_be_own(one)]
        n = max(one.record.n for one in met)
        if len(loop.latches) > 1:
            n = (max([n] + [one.record.n for one in inside]) + 1) ** len(loop.latches)
        return self._made(loop, met, n, False)

    def _made(self, loop, met, n, is_known):
        is_before = all(one.block not in loop.blocks and
                        self.graph.innermost(one.block) is loop.parent for one in met)
        return Own(tuple(met), n, is_known, is_before)
