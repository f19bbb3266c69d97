#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows that the memory budgets can fail: raises a capacity in a copy of a header and compiles it.

usage: budgets_test.py ROOT CXX
"""

import pathlib
import subprocess
import sys
import tempfile

# (header, its text, the same with a larger object, a header whose budget must then be broken)
CASES = [
    ("core/scan/scan.h", "kMaxReturns = 393216;", "kMaxReturns = 1048576;",
     "core/scan/scan.h"),
    ("core/costmap/height_grid.h", "int16_t highest_soft_cm_[", "int32_t highest_soft_cm_[",
     "core/costmap/height_grid.h"),
    ("core/astar/astar.h", "uint64_t nodes_[kMapCells];", "uint64_t nodes_[4 * kMapCells];",
     "core/autonomy/planner.h"),
]


def compile_header(cxx, root, overlay, header):
    source = f'#include "{header}"\n'
    return subprocess.run([cxx, "-std=c++20", "-fsyntax-only", "-x", "c++", "-I", str(overlay),
                           "-I", str(root), "-"], input=source, capture_output=True, text=True)


def main(root, cxx):
    for header, old, new, budget in CASES:
        text = (root / header).read_text()
        if old not in text:
            return f"{header}: `{old}` is no longer there: this test must follow"
        with tempfile.TemporaryDirectory() as folder:
            overlay = pathlib.Path(folder)
            copy = overlay / header
            copy.parent.mkdir(parents=True)
            copy.write_text(text)
            within = compile_header(cxx, root, overlay, budget)
            if within.returncode != 0:
                return f"{budget} does not compile as it is:\n{within.stderr}"
            copy.write_text(text.replace(old, new))
            beyond = compile_header(cxx, root, overlay, budget)
            if beyond.returncode == 0 or "static assertion failed" not in beyond.stderr:
                return f"{budget}: `{new}` in {header} broke no budget:\n{beyond.stderr}"
            print(f"{header}: {new} breaks the budget of {budget}")
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2]))
