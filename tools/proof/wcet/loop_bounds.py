# SPDX-License-Identifier: Apache-2.0
"""What bounds the loops of a function.

Every iteration of a machine loop is one or more of the source's, so its back edges are traversed at
most n times for each entry, n of its own record (own_records.py).

- Compilers make several machine loops of one, one behind the other, as a vector loop and what is
  left over. Such loops share a record, and their back edges together are at most n. Where no lines
  say that it is theirs, a second loop with one record is refused.
- A loop with which the compiler copies a struct has none, and none of another loop: it is counted
  (counted_loops.py).
- HP_LOOP_BOUND_INNER also bounds each loop directly inside, over all iterations of the outer one. It
  holds for a machine loop inside another one whose own record it is, if no other loop's record lies
  between the two: it could be that of a loop between that has vanished.
"""

from dataclasses import dataclass, field

from counted_loops import back_edges, lanes
from image import Refused
from own_records import OwnRecords


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
        self.records = OwnRecords(graph)
        self._of = {}  # header: Bound
        self._shared = {}  # records: (Bound, or None; the loops that are bounded by these records)
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
        own = self.records.of(loop)
        counted = back_edges(self.graph, loop)
        if own is not None:
            self._check_shared(loop, own)
        if counted is not None:
            n = counted if own is None else min(own.n, counted)
            self._of[loop.header] = Bound([loop], [loop], n)
        elif own is not None:
            self._bind_to(loop, own)
        else:
            self._refuse(loop, "has no record")

    def _check_shared(self, loop, own):
        """Only of what the lines say is known that it is of one loop of the source."""
        others = self._shared.setdefault(own.met, [None, []])[1]
        if others and not own.is_known:
            self._refuse(loop, "shares its record with another one")
        others.append(loop)

    def _bind_to(self, loop, own):
        many = self._lanes(loop)
        if many > 1 or not own.is_before:  # one of several, with a bound of its own
            self._of[loop.header] = Bound([loop], [loop], own.n // many)
            return
        shared = self._shared[own.met]
        if shared[0] is None:
            shared[0] = Bound([], [], own.n)
        bound = shared[0]
        bound.n = max(bound.n, own.n)
        bound.records = [(met.block, bound.n) for met in own.met]
        bound.loops.append(loop)
        bound.entered.append(loop)
        self._of[loop.header] = bound

    def _lanes(self, loop):
        return lanes(self.graph, loop) if self.records.has_rest_behind(loop) else 1

    def _bind_inner(self, bound):
        outer = bound.entered[0].parent
        if outer is None or any(loop.parent is not outer for loop in bound.entered):
            return
        own = self.records.of(outer)
        if own is None or not own.is_one() or self._of[outer.header].loops != [outer] or \
                not all(self.records.is_directly_inside(loop) for loop in bound.entered):
            return
        inner = [[r.n for r in self.image.inner.get(met.address, ())
                  if r.place() == met.record.place()] for met in own.met]
        if all(inner):
            bound.outer = outer
            bound.in_all = max(max(n) for n in inner) // \
                min(self._lanes(loop) for loop in bound.loops)

