#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds libraries to a list of the symbols they may need from outside.

usage: tools/proof/check_symbols.py --linker LD --nm NM --allowed FILE LIBRARY_OR_OBJECT...

Joins everything given into one relocatable object (ld -r) and looks at what stays undefined: no
allocator, no libm, no I/O can hide there. FILE has one symbol a line, `#` begins a comment. Meant
for optimised builds; the list is one a target. Exits 1 and names the symbols and the objects that
want them when there are others.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile


def allowed_symbols(path):
    lines = (line.split("#")[0].strip() for line in path.read_text().splitlines())
    return {line for line in lines if line}


def undefined_symbols(nm, file):
    """{symbol: [objects that want it]}; nm prints `file:object: symbol` or `file: symbol`."""
    output = subprocess.run([nm, "-A", "-u", file], check=True, capture_output=True, text=True)
    wanted = {}
    for line in output.stdout.splitlines():
        fields = line.rsplit(None, 2)
        origin = fields[0].rstrip(":").split(":")[-1].strip()
        wanted.setdefault(fields[-1], []).append(pathlib.Path(origin.split()[0]).name)
    return wanted


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--linker", required=True)
    parser.add_argument("--nm", required=True)
    parser.add_argument("--allowed", required=True, type=pathlib.Path)
    parser.add_argument("inputs", nargs="+")
    arguments = parser.parse_args()

    allowed = allowed_symbols(arguments.allowed)
    with tempfile.TemporaryDirectory() as folder:
        joined = str(pathlib.Path(folder) / "joined.o")
        subprocess.run([arguments.linker, "-r", "-o", joined, "--whole-archive", *arguments.inputs],
                       check=True)
        foreign = sorted(set(undefined_symbols(arguments.nm, joined)) - allowed)
    for symbol in foreign:
        users = [user for file in arguments.inputs
                 for user in undefined_symbols(arguments.nm, file).get(symbol, [])]
        print(f"{symbol}: not in {arguments.allowed.name}; wanted by {', '.join(users)}")
    print(f"check_symbols: {len(arguments.inputs)} inputs, {len(foreign)} findings")
    return 1 if foreign else 0


if __name__ == "__main__":
    sys.exit(main())
