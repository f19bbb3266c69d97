# SPDX-License-Identifier: Apache-2.0
"""A function's control-flow graph: basic blocks, and its loops by their nesting."""

from dataclasses import dataclass, field

from image import Refused
from instructions import Effect, Kind, effect_of

EXIT = -1
BEHIND = -2  # the function's end; never of a block that is reached


@dataclass
class Block:
    start: int  # addresses
    end: int
    cost: int  # instructions
    calls: list = field(default_factory=list)  # (instruction, address called)
    successors: list = field(default_factory=list)  # blocks; EXIT
    instructions: list = field(default_factory=list)


@dataclass
class Loop:
    """A natural loop: all back edges to one header, and what lies between."""
    header: int
    blocks: set
    latches: list
    parent: object = None


class FlowGraph:
    """Of a function of an image. Refused: control flow that cannot be followed."""

    def __init__(self, image, function):
        self.image = image
        self.function = function
        self.blocks = []
        self._build()
        self._drop_unreachable()
        self.predecessors = [[] for _ in self.blocks]
        for index, block in enumerate(self.blocks):
            for successor in block.successors:
                if successor != EXIT:
                    self.predecessors[successor].append(index)
        self.dominators = self._dominators()
        self.loops = self._loops()

    def refuse(self, what):
        raise Refused(f"{self.function.name}: {what}")

    def _build(self):
        instructions = self.function.instructions
        if not instructions:
            self.refuse("there are no instructions of it")
        effects = []
        for instruction in instructions:
            try:
                effect = effect_of(instruction, self.image.machine)
            except Refused as reason:
                self.refuse(reason)
            if effect.kind is Kind.CALL and effect.target in self.image.stops:
                # Where its condition does not hold it goes on, and does nothing.
                effect = Effect(Kind.NEXT if effect.conditional else Kind.STOP)
            effects.append(effect)
        places = {ins.address: i for i, ins in enumerate(instructions)}
        leaders = {0}
        for i, effect in enumerate(effects):
            if effect.kind is Kind.JUMP and effect.target in places:
                leaders.add(places[effect.target])
            if effect.kind not in (Kind.NEXT, Kind.CALL) and i + 1 < len(instructions):
                leaders.add(i + 1)
        starts = sorted(leaders)
        block_at = {start: k for k, start in enumerate(starts)}
        ends = starts[1:] + [len(instructions)]
        for start, end in zip(starts, ends):
            last = end < len(instructions)
            block = Block(instructions[start].address,
                          instructions[end].address if last else self.function.end, end - start)
            block.instructions = instructions[start:end]
            for i in range(start, end):
                if effects[i].kind is Kind.CALL:
                    block.calls.append((instructions[i], effects[i].target))
            self.blocks.append(block)
        for k, end in enumerate(ends):
            self._connect(self.blocks[k], effects[end - 1], instructions[end - 1],
                          block_at.get(end), places, block_at)

    def _connect(self, block, effect, instruction, following, places, block_at):
        goes_on = effect.kind in (Kind.NEXT, Kind.CALL) or effect.conditional
        if effect.kind is Kind.JUMP:
            block.successors.append(self._jump(block, effect.target, places, block_at))
        if effect.kind is Kind.RETURN:
            block.successors.append(EXIT)
        if not goes_on:
            return
        if following is not None:
            block.successors.append(following)
        else:
            block.successors.append(BEHIND)

    def _jump(self, block, target, places, block_at):
        instruction = block.instructions[-1]
        if target in places:
            return block_at[places[target]]
        if self.function.start <= target < self.function.end:
            self.refuse(f"a jump to between instructions: {instruction}")
        other = self.image.at(target)
        if other is None or other.start != target:
            self.refuse(f"a jump to where no function begins: {instruction}")
        # A tail call: a block of its own that calls and returns.
        calls = [] if target in self.image.stops else [(instruction, target)]
        self.blocks.append(Block(target, target, 0, calls, [EXIT], block.instructions))
        return len(self.blocks) - 1

    def _drop_unreachable(self):
        reached, waiting = {0}, [0]
        while waiting:
            block = self.blocks[waiting.pop()]
            for successor in block.successors:
                if successor == BEHIND:
                    self.refuse(f"runs on behind its end: {block.instructions[-1]}")
                if successor != EXIT and successor not in reached:
                    reached.add(successor)
                    waiting.append(successor)
        kept = sorted(reached)
        places = {old: new for new, old in enumerate(kept)}
        places[EXIT] = EXIT
        self.blocks = [self.blocks[old] for old in kept]
        for block in self.blocks:
            block.successors = [places[s] for s in block.successors]

    def order(self):
        """Blocks in reverse postorder."""
        order, state, stack = [], {0}, [(0, iter(self.blocks[0].successors))]
        while stack:
            index, successors = stack[-1]
            for successor in successors:
                if successor != EXIT and successor not in state:
                    state.add(successor)
                    stack.append((successor, iter(self.blocks[successor].successors)))
                    break
            else:
                order.append(index)
                stack.pop()
        return order[::-1]

    def _dominators(self):
        """Of each block, the set of blocks through which every way to it leads."""
        order = self.order()
        place = {block: i for i, block in enumerate(order)}
        immediate = {0: 0}

        def common(a, b):
            while a != b:
                while place[a] > place[b]:
                    a = immediate[a]
                while place[b] > place[a]:
                    b = immediate[b]
            return a

        changed = True
        while changed:
            changed = False
            for block in order[1:]:
                known = [p for p in self.predecessors[block] if p in immediate]
                new = known[0]
                for other in known[1:]:
                    new = common(new, other)
                if immediate.get(block) != new:
                    immediate[block] = new
                    changed = True
        dominators = {0: {0}}
        for block in order[1:]:
            dominators[block] = dominators[immediate[block]] | {block}
        return dominators

    def _loops(self):
        place = {block: i for i, block in enumerate(self.order())}
        loops = {}
        for index, block in enumerate(self.blocks):
            for successor in block.successors:
                if successor == EXIT or place[successor] > place[index]:
                    continue
                if successor not in self.dominators[index]:
                    self.refuse("a loop with two entries at "
                                f"{self.blocks[successor].start:#x}")
                loop = loops.setdefault(successor, Loop(successor, {successor}, []))
                loop.latches.append(index)
                waiting = [index]
                while waiting:
                    inside = waiting.pop()
                    if inside not in loop.blocks:
                        loop.blocks.add(inside)
                        waiting += self.predecessors[inside]
        by_size = sorted(loops.values(), key=lambda loop: len(loop.blocks))
        for i, loop in enumerate(by_size):
            loop.parent = next((outer for outer in by_size[i + 1:]
                                if loop.header in outer.blocks), None)
        return by_size

    def innermost(self, block):
        """The smallest loop that holds the block, or None."""
        return next((loop for loop in self.loops if block in loop.blocks), None)
