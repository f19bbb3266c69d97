# SPDX-License-Identifier: Apache-2.0
"""Implicit path enumeration: the most instructions that a function can take.

The number of times each edge of the control-flow graph is taken is an unknown of a linear program:
each block is left as often as it is entered, and the loops' back edges are bounded by their records
(loop_bounds.py). Every path through the function is a solution; the largest sum of instructions of
any solution, including the bounds of the called functions, is the bound.

No solver is needed, because the optimal prices of these bounds are known (the dual of the program):
taking a back edge costs what the most expensive pass through its loop gains, and whatever allows n
passes, the loop's entry or its records, pays n prices back. With these prices no cycle gains, which
is checked, and the most expensive path from entry to exit bounds every solution (weak duality), in
integers.

Functions are taken from the leaves of the call graph upwards; recursion is refused.
"""

from flow_graph import EXIT, FlowGraph
from image import Refused
from loop_bounds import Bound, LoopBounds
from sized_calls import SizedCalls, bytes_an_iteration


class Analysis:
    """Bounds of an image's functions.

    given: {name: instructions} of functions that are not analysed.
    sizes: {name: most bytes} of functions that call memcpy or the like (sized_calls.py).
    units: {name: n} of functions that do resumable work in a loop of units: the outermost loop with
    the largest bound iterates n times instead of as often as its record says.
    calls: {name: {callee: n}}: in one call of the named function the callee is called at most n
    times, by any caller. It costs nothing at the calls, and n times its bound in addition.
    rounds: {name: {callee: n}}: in one call of the named function the callee's loop of units (see
    units) iterates at most n times, in all of the callee's calls together.
    """

    def __init__(self, image, given=None, sizes=None, units=None, calls=None, rounds=None):
        self.image = image
        self.given = {image.named(name).start: n for name, n in (given or {}).items()}
        self.units = {image.named(name).start: n for name, n in (units or {}).items()}
        self.calls = by_start(image, calls)
        self.rounds = by_start(image, rounds)
        self.sized = SizedCalls(image, sizes)
        self.results = {}  # instructions, by start, size and what is counted elsewhere
        self._stack = []
        self._counted = frozenset()  # callees that a function further up counts

    def bound(self, name):
        return self.bound_at(self.image.named(name).start)

    def round(self, name):
        """One round of a function's loop of units."""
        return self._round(self.image.named(name).start)

    def bound_at(self, start, size=None):
        """size: in bytes, of a function of sized_calls.py."""
        if (start, CALLS) in self._counted:
            return 0
        key = (start, size, self._counted)
        if key not in self.results:
            self.results[key] = self._count(start, size)
        return self.results[key]

    def _count(self, start, size):
        """With the calls that are bounded within the function."""
        calls, rounds = self.calls.get(start, {}), self.rounds.get(start, {})
        outer = self._counted
        self._counted = outer | {(callee, CALLS) for callee in calls} | \
            {(callee, ROUNDS) for callee in rounds}
        try:
            bound = self._analyse(start, size)
            for callee, n in calls.items():
                if (callee, CALLS) not in outer:
                    bound += n * self._count(callee, None)
            for callee, n in rounds.items():
                if (callee, ROUNDS) not in outer:
                    bound += n * self._round(callee)
        finally:
            self._counted = outer
        return bound

    def _round(self, start):
        """The most that a round of the loop of units takes: its price. What a second round adds to
        a call can be less, where another way through the function is dearer than the first."""
        if start in self.given:
            return 0
        graph, bounds, costs = self._prepare(start, None, limited=False)
        return Dearest(graph, bounds, costs).prices[id(bound_of_units(graph, bounds))]

    def _analyse(self, start, size):
        if start in self.given:
            return self.given[start]
        return Dearest(*self._prepare(start, size)).way()

    def _prepare(self, start, size, limited=True):
        """The function's graph, its loops' bounds and its blocks' costs. limited: to its units."""
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
                units = 0 if (start, ROUNDS) in self._counted else self.units.get(start)
                if limited and units is not None:
                    limit_units(graph, bounds, units)
            else:
                bounds = [Bound([loop], [loop], size // bytes_an_iteration(graph, loop))
                          for loop in graph.loops]
            costs = [block.cost + sum(self._call(graph, block, call) for call in block.calls)
                     for block in graph.blocks]
        finally:
            self._stack.pop()
        return graph, bounds, costs

    def _call(self, graph, block, call):
        instruction, target = call
        size = self.sized.size(graph, block, instruction, target)
        return self.bound_at(target, size)


CALLS, ROUNDS = "calls", "rounds"


def by_start(image, limits):
    return {image.named(scope).start: {image.named(callee).start: n for callee, n in callees.items()}
            for scope, callees in (limits or {}).items()}


def bound_of_units(graph, bounds):
    """That of the outermost loop of the largest bound."""
    outer = [b for b in bounds if all(loop.parent is None for loop in b.entered)]
    largest = max((b.n for b in outer), default=0)
    found = [b for b in outer if b.n == largest]
    if len(found) != 1:
        raise Refused(f"{graph.function.name}: {len(found)} outermost loops could be that of units")
    return found[0]


def limit_units(graph, bounds, units):
    # Its condition begins with a comparison of the units. Where that can only be at the bottom, n
    # rounds are n - 1 back edges.
    bound = bound_of_units(graph, bounds)
    bound.n = max(0, units - 1) if all(leaves_at_its_bottom(graph, loop)
                                       for loop in bound.loops) else units
    bound.records = [(block, bound.n) for block, _ in bound.records]


def leaves_at_its_bottom(graph, loop):
    """Whether a loop is left only where its back edge could be taken instead. What is left for
    where nothing returns is no matter."""
    return all(block in loop.latches for block in loop.blocks
               for s in graph.blocks[block].successors
               if s not in loop.blocks and (s == EXIT or graph.blocks[s].successors))


class Dearest:
    """The way through a function with the greatest sum of the blocks' costs."""

    def __init__(self, graph, bounds, costs):
        self.graph = graph
        self.costs = costs
        self.priced = Priced(graph, costs)
        self.prices = {}  # of the bounds' back edges, by id
        for loop in graph.loops:  # the inner ones first
            bound = next(b for b in bounds if loop in b.loops)
            trip = self.priced.dearest(loop.header, loop.blocks).get(BACK, 0)
            self.prices[id(bound)] = max(self.prices.get(id(bound), 0), trip)
            if loop is max(bound.loops, key=lambda one: graph.loops.index(one)):
                self.priced.apply(bound, self.prices[id(bound)])

    def way(self):
        """The sum."""
        ways = self.priced.dearest(0, set(range(len(self.graph.blocks))))
        if EXIT not in ways:
            raise Refused(f"{self.graph.function.name}: it never returns")
        if self.priced.gains():
            raise Refused(f"{self.graph.function.name}: a cycle gains by the prices of its loops")
        return self.costs[0] + self.priced.entry_pays + ways[EXIT]


BACK = -2  # the end of a trip round a loop


class Priced:
    """A graph whose edges cost what the block that they lead to costs, less what is paid back."""

    def __init__(self, graph, costs):
        self.graph = graph
        self.order = graph.order()
        self.place = {block: i for i, block in enumerate(self.order)}
        self.cost = {}  # of edges
        for index, block in enumerate(graph.blocks):
            for sink in block.successors or [EXIT]:
                self.cost[index, sink] = costs[sink] if sink != EXIT else 0
        self.entry_pays = 0  # what the function's entry pays back

    def apply(self, bound, price):
        """The price of the back edges of the bound's loops, and who pays it back: the records where
        several loops share them, else the loop's entry."""
        for loop in bound.loops:
            for latch in set(loop.latches):
                self.cost[latch, loop.header] -= price
        if bound.outer is not None:
            self._pay(bound.outer.header, bound.in_all * price, within=bound.outer.blocks)
        elif len(bound.entered) > 1 and bound.records:
            for block, n in bound.records:
                self._pay(block, n * price, within=None)
        else:
            for loop in bound.entered:
                self._pay(loop.header, bound.n * price, within=loop.blocks)

    def _pay(self, block, amount, within):
        if block == 0:
            self.entry_pays += amount
        for source in set(self.graph.predecessors[block]):
            if within is None or source not in within:
                self.cost[source, block] += amount

    def dearest(self, start, blocks):
        """{block, EXIT or BACK: cost of the dearest way there from behind `start`}, along edges
        that lead forwards, and back to `start`. Inner loops do not gain."""
        ways = {start: 0}
        for block in self.order[self.place[start]:]:
            if block not in ways or block not in blocks:
                continue
            for sink in self.graph.blocks[block].successors or [EXIT]:
                value = ways[block] + self.cost[block, sink]
                key = sink
                if sink == start:
                    key = BACK
                elif sink != EXIT and self.place[sink] <= self.place[block]:
                    continue
                if key not in ways or value > ways[key]:
                    ways[key] = value
        return ways

    def gains(self):
        """Whether any cycle does: whether ways still grow dearer after as many rounds as blocks."""
        ways = {0: 0}
        for _ in range(len(self.order) + 1):
            changed = False
            for block in self.order:
                for sink in self.graph.blocks[block].successors if block in ways else ():
                    value = ways[block] + self.cost[block, sink]
                    if sink != EXIT and (sink not in ways or value > ways[sink]):
                        ways[sink] = value
                        changed = True
            if not changed:
                return False
        return True
