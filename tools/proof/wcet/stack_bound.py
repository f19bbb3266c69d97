#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bounds the stack of functions, including everything they call, without running them.

usage: tools/proof/wcet/stack_bound.py [--stops NAME]... [--frame NAME=BYTES]... [--path]
                                 [--most BYTES] FOLDER FUNCTION...

Reads the call graphs (.ci) that g++ writes beside the objects of FOLDER with
-fcallgraph-info=su,da, and adds up the frames along the deepest call path. A FUNCTION is named with
or without its parameters. Refused: recursion, calls through pointers, frames whose size depends on
data, and functions without a call graph, unless their bytes are stated. A tail call counts like any
other.

  --stops NAME        a function that does not return; its stack does not count
  --frame NAME=BYTES  stack of a library function, including everything it calls
  --path              also print the deepest path
  --most BYTES        limit for each function; more is a failure

Exit code: 0 passed; 1 no bound can be guaranteed, with the reason, or it is too large; 2 bad usage.
"""

import argparse
import os
import re
import sys

from image import Refused

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
FRAME = re.compile(r"(\d+) bytes \(([^)]*)\)")
INDIRECT = "__indirect_call"


def with_arguments(name):
    """A template's function as a linker shows it: "A<T>::f() [with T = B]" is A<B>::f()."""
    match = re.fullmatch(r"(.*) \[with (.*)\]", name)
    if not match:
        return name
    name = match.group(1)
    for argument in match.group(2).split("; "):
        parameter, _, value = argument.partition(" = ")
        name = re.sub(rf"(?<=[<, ]){re.escape(parameter)}(?=[>,])", value, name)
    return name


class CallGraph:
    """Of all units of a folder. A function that several units have counts with its largest frame
    and with the calls of all."""

    def __init__(self, folder, stops=(), frames=None):
        self.names = {}  # symbol: name for people
        self.frames = {}  # symbol: bytes
        self.dynamic = set()
        self.calls = {}
        found = False
        for place, _, files in os.walk(folder):
            for file in files:
                if file.endswith(".ci"):
                    found = True
                    self._read(os.path.join(place, file))
        if not found:
            raise Refused(f"{folder}: there are no call graphs (*.ci)")
        self._join_instances()
        self.given = {self.symbol(name): n for name, n in (frames or {}).items()}
        self.stops = {self.symbol(name) for name in stops}
        self._bounds = {}
        self._stack = []

    def _read(self, path):
        with open(path, encoding="utf-8") as file:
            for line in file:
                match = NODE.match(line)
                if match:
                    self._read_node(*match.groups())
                match = EDGE.match(line)
                if match:
                    self.calls.setdefault(match.group(1), set()).add(match.group(2))

    def _read_node(self, symbol, label):
        parts = label.split("\\n")
        self.names[symbol] = with_arguments(parts[0])
        frame = next(filter(None, map(FRAME.match, parts)), None)
        if frame is None:
            return
        self.frames[symbol] = max(int(frame.group(1)), self.frames.get(symbol, 0))
        if frame.group(2) != "static":
            self.dynamic.add(symbol)

    def _join_instances(self):
        """g++ writes the unit's path before the symbol of a template's instance, as it does before
        that of a function that only the unit sees: it is the function that other units call so."""
        short = {s: s.rpartition(":")[2] for s in self.names}
        short = {s: plain for s, plain in short.items() if s != plain and plain in self.names}
        for symbol, plain in short.items():
            if symbol in self.frames:
                self.frames[plain] = max(self.frames.pop(symbol), self.frames.get(plain, 0))
            if symbol in self.dynamic:
                self.dynamic.add(plain)
            del self.names[symbol]
            self.calls.setdefault(plain, set()).update(self.calls.pop(symbol, ()))
        for symbol, called in self.calls.items():
            self.calls[symbol] = {short.get(s, s) for s in called}

    def symbol(self, name):
        """Of the one function of that name; several that are the same text, of several units, are
        refused."""
        plain = re.compile(rf"(^|[ *&]){re.escape(name)}(\(|$)")
        found = [s for s, text in self.names.items() if name in (s, text) or plain.search(text)]
        defined = [s for s in found if s in self.frames] or found
        if len(defined) != 1:
            raise Refused(f"{len(defined)} functions are called {name}")
        return defined[0]

    def bound(self, symbol):
        """(bytes, the next function on the dearest way or None)"""
        if symbol not in self._bounds:
            self._bounds[symbol] = self._bound(symbol)
        return self._bounds[symbol]

    def _bound(self, symbol):
        name = self.names.get(symbol, symbol)
        if symbol in self.stops:
            return 0, None
        if symbol in self.given:
            return self.given[symbol], None
        if symbol in self._stack:
            way = [self.names[s] for s in self._stack[self._stack.index(symbol):]]
            raise Refused("recursion: " + " > ".join([*way, name]))
        if symbol not in self.frames:
            raise Refused(f"there is no call graph of {name}"
                          + (f", which {self.names[self._stack[-1]]} calls" if self._stack else ""))
        if symbol in self.dynamic:
            raise Refused(f"the frame of {name} depends on data")
        self._stack.append(symbol)
        deepest, following = 0, None
        for called in sorted(self.calls.get(symbol, ())):
            called = self._defined(called)
            if called == INDIRECT:
                raise Refused(f"{name} calls through a pointer")
            taken, _ = self.bound(called)
            if taken > deepest:
                deepest, following = taken, called
        self._stack.pop()
        return self.frames[symbol] + deepest, following

    def _defined(self, symbol):
        """A constructor of whole objects is often another name of that of their base part."""
        if symbol in self.frames:
            return symbol
        other = re.sub("([CD])1E", r"\g<1>2E", symbol)
        return other if other in self.frames else symbol

    def way(self, symbol):
        """[(function, bytes of its frame), ...] along the dearest way down."""
        result = []
        while symbol is not None:
            frame = self.frames.get(symbol, self.given.get(symbol, 0))
            result.append((self.names.get(symbol, symbol), frame))
            symbol = self.bound(symbol)[1]
        return result


def read_frame(text):
    name, _, size = text.partition("=")
    if not name or not size.isdigit():
        raise argparse.ArgumentTypeError(f"{text} is not NAME=BYTES")
    return name, int(size)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--stops", action="append", default=[])
    parser.add_argument("--frame", action="append", type=read_frame, default=[])
    parser.add_argument("--path", action="store_true")
    parser.add_argument("--most", type=int)
    parser.add_argument("folder")
    parser.add_argument("function", nargs="+")
    options = parser.parse_args(arguments)
    try:
        graph = CallGraph(options.folder, options.stops, dict(options.frame))
    except (OSError, Refused) as reason:
        print(f"stack_bound: {reason}", file=sys.stderr)
        return 2
    failed = False
    for name in options.function:
        try:
            symbol = graph.symbol(name)
            bound, _ = graph.bound(symbol)
            print(f"{bound:8d}  {name}")
            for function, frame in graph.way(symbol) if options.path else ():
                print(f"{'':10}{frame:6d}  {function}")
            if options.most is not None and bound > options.most:
                raise Refused(f"{bound} bytes are more than {options.most}")
        except Refused as reason:
            failed = True
            print(f"stack_bound: {name}: {reason}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
