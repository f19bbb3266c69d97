# SPDX-License-Identifier: Apache-2.0
"""Implicit path enumeration: the most instructions that a function can take.

For each function a linear program: one unknown for every edge of its control-flow graph, how often
it is gone along; what enters a block leaves it; the loops' back edges are bounded by their records.
Its greatest sum of instructions, with the bounds of what is called, is a bound: every way through
the function is a solution of the program, and more solutions make it only larger. The solver
computes with rounding; its prices are made whole numbers, and what they prove is computed exactly.
Functions are taken from the leaves of the call graph upwards; recursion is refused.
"""

from dataclasses import dataclass, field

import numpy
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from flow_graph import EXIT, FlowGraph
from image import Refused
from loop_bounds import Bound, LoopBounds
from sized_calls import SizedCalls


@dataclass
class Result:
    instructions: int
    graph: FlowGraph = None
    counts: list = field(default_factory=list)  # of each block, in the worst case found


class Analysis:
    """Bounds of an image's functions.

    given: {name: instructions} of functions that are not looked into.
    sizes: {name: most bytes} of functions that call memcpy or the like (sized_calls.py).
    units: {name: n} of functions that do resumable work in a loop of units: the outermost loop of
    the largest bound is gone round n times and not as often as its record says.
    """

    def __init__(self, image, given=None, sizes=None, units=None):
        self.image = image
        self.given = {image.named(name).start: n for name, n in (given or {}).items()}
        self.units = {image.named(name).start: n for name, n in (units or {}).items()}
        self.sized = SizedCalls(image, sizes)
        self.results = {}  # by start, or start and size
        self._stack = []

    def bound(self, name):
        return self.bound_at(self.image.named(name).start).instructions

    def bound_at(self, start, size=None):
        """size: in bytes, of a function of sized_calls.py."""
        key = (start, size)
        if key not in self.results:
            self.results[key] = self._analyse(start, size)
        return self.results[key]

    def _analyse(self, start, size):
        if start in self.given:
            return Result(self.given[start])
        function = self.image.by_start.get(start)
        if function is None:
            raise Refused(f"{start:#x} is called, where no function begins")
        if start in self._stack:
            names = [self.image.by_start[s].name for s in self._stack[self._stack.index(start):]]
            raise Refused("recursion: " + " > ".join([*names, function.name]))
        self._stack.append(start)
        try:
            graph = FlowGraph(self.image, function)
            if size is None:
                bounds = LoopBounds(graph).bounds
                if start in self.units:
                    limit_units(graph, bounds, self.units[start])
            else:
                bounds = [Bound([loop], [loop], size) for loop in graph.loops]
            costs = [block.cost + sum(self._call(graph, block, call) for call in block.calls)
                     for block in graph.blocks]
        finally:
            self._stack.pop()
        return maximize(graph, bounds, costs)

    def _call(self, graph, block, call):
        instruction, target = call
        size = self.sized.size(graph, block, instruction, target)
        return self.bound_at(target, size).instructions


def limit_units(graph, bounds, units):
    outer = [b for b in bounds if all(loop.parent is None for loop in b.entered)]
    largest = max((b.n for b in outer), default=0)
    found = [b for b in outer if b.n == largest]
    if len(found) != 1:
        raise Refused(f"{graph.function.name}: {len(found)} outermost loops could be that of units")
    # Tested at its top, a loop goes round n times with n back edges; at its bottom, n + 1 times.
    found[0].n = units
    found[0].records = [(block, units) for block, _ in found[0].records]


class Flow:
    """The rows of the linear program."""

    def __init__(self, graph):
        self.graph = graph
        self.edges = [(EXIT, 0)]  # the entry
        for index, block in enumerate(graph.blocks):
            for successor in block.successors or [EXIT]:
                self.edges.append((index, successor))
        self.into = [[] for _ in graph.blocks]
        self.out = [[] for _ in graph.blocks]
        for number, (source, sink) in enumerate(self.edges):
            if sink != EXIT:
                self.into[sink].append(number)
            if source != EXIT:
                self.out[source].append(number)
        self.rows = {"equal": [], "most": []}

    def edges_into(self, loop, inside):
        """The edges to the header of a loop: its back edges, or those that enter it."""
        return [e for e in self.into[loop.header] if (self.edges[e][0] in loop.blocks) == inside]

    def add(self, kind, terms, value):
        row = {}
        for number, factor in terms:
            row[number] = row.get(number, 0) + factor
        self.rows[kind].append((row, value))

    def matrix(self, kind):
        rows, columns, values = [], [], []
        for place, (row, _) in enumerate(self.rows[kind]):
            for number, factor in row.items():
                rows.append(place)
                columns.append(number)
                values.append(factor)
        shape = (len(self.rows[kind]), len(self.edges))
        return csr_matrix((values, (rows, columns)), shape=shape), [v for _, v in self.rows[kind]]


def maximize(graph, bounds, costs):
    flow = Flow(graph)
    flow.add("equal", [(0, 1)], 1)
    for index in range(len(graph.blocks)):
        flow.add("equal", [(e, 1) for e in flow.into[index]] + [(e, -1) for e in flow.out[index]],
                 0)
    for bound in bounds:
        back = [(e, 1) for loop in bound.loops for e in flow.edges_into(loop, inside=True)]
        entries = [(e, -bound.n) for loop in bound.entered
                   for e in flow.edges_into(loop, inside=False)]
        flow.add("most", back + entries, 0)
        if bound.records:
            passed = [(e, -n) for block, n in bound.records for e in flow.into[block]]
            flow.add("most", back + passed, 0)
    cost = numpy.zeros(len(flow.edges))
    for number, (_, sink) in enumerate(flow.edges):
        if sink != EXIT:
            cost[number] = -costs[sink]
    equal, is_equal = flow.matrix("equal")
    most, at_most = flow.matrix("most")
    solution = linprog(cost, A_ub=most if at_most else None, b_ub=at_most or None, A_eq=equal,
                       b_eq=is_equal, method="highs")
    if solution.status != 0:
        raise Refused(f"{graph.function.name}: the linear program has no bound "
                      f"({solution.message})")
    prices = [round(-p) for p in solution.ineqlin.marginals] if at_most else []
    instructions = certified(flow, costs, prices)
    if instructions is None:  # a price between two whole numbers
        instructions = certified(flow, costs, [p + 1 for p in prices])
    if instructions is None:
        raise Refused(f"{graph.function.name}: the linear program's bound cannot be certified")
    counts = [sum(solution.x[e] for e in flow.into[i]) for i in range(len(graph.blocks))]
    return Result(instructions, graph, counts)


def certified(flow, costs, prices):
    """A bound in whole numbers that needs no trust in the solver: with any prices >= 0 for going
    along a back edge, paid back by the entries that allow for it, no way through the function costs
    less than it does, so that the dearest way is a bound (weak duality). None where a cycle still
    gains: then there is no dearest way."""
    weights = [costs[sink] if sink != EXIT else 0 for _, sink in flow.edges]
    for price, (row, _) in zip(prices, flow.rows["most"]):
        for number, factor in row.items():
            weights[number] -= price * factor
    blocks = range(len(flow.graph.blocks))
    order = flow.graph.order()
    dearest = [None for _ in blocks]
    dearest[0] = weights[0]
    for _ in range(len(order) + 1):
        changed = False
        for block in order:
            for number in flow.out[block] if dearest[block] is not None else ():
                sink = flow.edges[number][1]
                value = dearest[block] + weights[number]
                if sink != EXIT and (dearest[sink] is None or value > dearest[sink]):
                    dearest[sink] = value
                    changed = True
        if not changed:
            ends = [dearest[source] + weights[number]
                    for number, (source, sink) in enumerate(flow.edges)
                    if sink == EXIT and source != EXIT]
            return max(ends) if ends else None
    return None
