# SPDX-License-Identifier: Apache-2.0
"""Which record bounds which loop of a function.

A record of HP_LOOP_BOUND stands where its loop is entered: every way to the loop's header leads
past it, and past no other one of the same nesting level behind it. So it is looked for backwards
from the edges that enter the loop, around loops that lie before it, and never out of the loop
around it. Every iteration of a machine loop is one or more of the source's, so the back edges are
traversed at most n times for each entry.

- Compilers make several machine loops of one: one behind the other (a vector loop and what is left
  over), or one in the other (ways of an iteration that skip tests). Such loops share a record, and
  their back edges together are at most n, if the jumps that close them stem from the same line of
  the source (or from what is inlined there). Loops that share a record otherwise are refused.
- A loop with which the compiler copies a struct has none, and none of another loop: it is counted
  (counted_loops.py).
- HP_LOOP_BOUND_INNER also bounds each loop directly inside, over all iterations of the outer one. It
  holds for a machine loop inside another one whose only records these are; else it is left out.
- A record at the very address of a header is that loop's own (it falls into the loop), or that of
  an inner loop whose header is the same instruction. Where both can be, the bound is that of
  both, one in the other: (n + 1) (m + 1).
"""

import re
from dataclasses import dataclass, field

from counted_loops import back_edges, lanes
from image import EM_AARCH64, Refused

RECORDED = re.compile(r"(^|/)(core|hal)/")  # files whose loops all have records


@dataclass
class Bound:
    """The back edges of `loops` together are at most n times the entries of the loops of `entered`,
    and, where there are records, the sum over them of bound times executions of their block; and
    where there is an `outer` loop, in_all times the entries of that."""
    loops: list
    entered: list
    n: int
    records: list = field(default_factory=list)  # (block, bound)
    outer: object = None
    in_all: int = 0


class LoopBounds:
    def __init__(self, graph):
        self.graph = graph
        self.image = graph.image
        self._of = {}  # header: Bound
        self._shared = {}  # records: Bound
        self._places = {}  # header: addresses of the records of a loop
        for loop in reversed(graph.loops):  # the outer ones first
            self._bind(loop)
        self.bounds = list({id(b): b for b in self._of.values()}.values())
        for bound in self.bounds:
            self._bind_inner(bound)

    def _refuse(self, loop, what):
        address = self.graph.blocks[loop.header].start
        chain = self.image.chain(address)
        where = f" ({chain[0][0].split('/')[-1]}:{chain[0][1]})" if chain else ""
        raise Refused(f"{self.graph.function.name}: the loop at {address:#x}{where} {what}")

    def _bind(self, loop):
        at_header = self.image.records.get(self.graph.blocks[loop.header].start, [])
        before = self._before(loop)
        self._places[loop.header] = ({self.graph.blocks[loop.header].start} if at_header else
                                     {address for _, address, _ in before or ()})
        if at_header:
            n = self._own(loop, at_header, before) // lanes(self.graph, loop)
            counted = back_edges(self.graph, loop)
            self._of[loop.header] = Bound([loop], [loop], n if counted is None else min(n, counted))
        elif before is not None:
            self._share(loop, before)
        elif loop.parent is not None and self._same_source(loop, loop.parent):
            bound = self._of[loop.parent.header]
            bound.loops.append(loop)
            self._of[loop.header] = bound
        else:
            counted = back_edges(self.graph, loop)
            if counted is None:
                self._refuse(loop, "has no record")
            self._of[loop.header] = Bound([loop], [loop], counted)

    def _bind_inner(self, bound):
        outer = bound.entered[0].parent
        if outer is None or any(loop.parent is not outer for loop in bound.entered):
            return
        places = self._places[outer.header]
        inner = [self.image.inner.get(place) for place in places]
        # Its own record and no other: what stands there for two loops could be the other one's.
        if (inner and all(inner) and self._of[outer.header].loops == [outer] and
                all(len(self.image.records[place]) == 1 for place in places)):
            bound.outer = outer
            bound.in_all = max(max(n) for n in inner) // \
                min(lanes(self.graph, loop) for loop in bound.loops)

    @staticmethod
    def _own(loop, at_header, before):
        if len(at_header) == 1 and (len(loop.latches) == 1 or not before):
            return at_header[0]
        product = 1
        for n in at_header:
            product *= n + 1
        if len(loop.latches) > 1 and before:
            product *= max(n for _, _, n in before) + 1
        return product

    def _share(self, loop, before):
        key = frozenset(before)
        bound = self._shared.get(key)
        counted = back_edges(self.graph, loop)
        if counted is not None:
            self._of[loop.header] = Bound([loop], [loop], counted)
            return
        if lanes(self.graph, loop) > 1:  # one of several, with a bound of its own
            n = max(n for _, _, n in before) // lanes(self.graph, loop)
            self._of[loop.header] = Bound([loop], [loop], n)
            return
        if bound is None:
            bound = Bound([], [], max(n for _, _, n in before),
                          [(block, n) for block, _, n in sorted(before)])
            self._shared[key] = bound
        elif not self._same_source(loop, bound.loops[0]):
            self._refuse(loop, "shares its record with one of another line")
        bound.loops.append(loop)
        bound.entered.append(loop)
        self._of[loop.header] = bound

    def _same_source(self, loop, other):
        return any(a[-len(b):] == b or b[-len(a):] == a or self._same_copy(a, b)
                   for a in self._closing(loop) for b in self._closing(other))

    def _same_copy(self, a, b):
        """Whether two lines are of the same copy of a function, where that is enough."""
        return self.image.machine == EM_AARCH64 and a[1:] == b[1:] and a[0][0] == b[0][0]

    def _closing(self, loop):
        """The source lines, with their callers, of the jumps that close the loop: those that stem
        from core and hal alone, where every loop of the source has a record of its own."""
        jumps = [self.graph.blocks[latch].instructions[-1].address for latch in loop.latches]
        return {chain for chain in map(self.image.chain, jumps)
                if chain and all(RECORDED.search(file) for file, _ in chain)}

    def _before(self, loop):
        """The records (block, address, n) past which the loop is entered; None if there is a way to
        it without one."""
        if loop.header == 0:
            return None
        found, seen = set(), set()
        waiting = [p for p in self.graph.predecessors[loop.header] if p not in loop.blocks]
        while waiting:
            index = waiting.pop()
            if index in seen:
                continue
            seen.add(index)
            sibling = self._sibling(loop, index)
            if sibling is not None:
                seen |= sibling.blocks
                waiting += [p for p in self.graph.predecessors[sibling.header]
                            if p not in sibling.blocks]
                if sibling.header == 0:
                    return None
                continue
            record = self._last_record(index)
            if record is not None:
                found.add(record)
            elif index == 0 or (loop.parent is not None and index == loop.parent.header):
                return None
            else:
                waiting += self.graph.predecessors[index]
        return found or None

    def _sibling(self, loop, index):
        """The outermost loop around the block that does not hold `loop`, or None."""
        around = self.graph.innermost(index)
        result = None
        while around is not None and around is not loop.parent:
            result = around
            around = around.parent
        return result

    def _last_record(self, index):
        block = self.graph.blocks[index]
        places = [a for a in range(block.start, block.end) if a in self.image.records]
        if not places:
            return None
        return index, places[-1], max(self.image.records[places[-1]])
