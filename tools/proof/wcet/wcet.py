#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The most instructions that functions of a linked image can take, without running them.

usage: tools/proof/wcet/wcet.py [--stops NAME]... [--size NAME=BYTES]... IMAGE FUNCTION...

IMAGE is linked for a Cortex-M (Thumb-2) or for aarch64, with debug information and without jump
tables. A FUNCTION is named as c++filt does, with or without its parameters. The bound is of one
call: every loop is bounded by its HP_LOOP_BOUND record, every call by the bound of what is called.

  --stops NAME        a function that does not return, such as hardpack::AssertionFailed
  --size NAME=BYTES   the most bytes that NAME tells memcpy, memset or their like to move, where no
                      constant stands before the call

Exit code: 0; 1 where no bound can be vouched for, with the reason; 2 bad usage.
"""

import argparse
import sys

from bound import Analysis
from image import Image, Refused


def read_size(text):
    name, _, size = text.partition("=")
    if not name or not size.isdigit():
        raise argparse.ArgumentTypeError(f"{text} is not NAME=BYTES")
    return name, int(size)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--stops", action="append", default=[])
    parser.add_argument("--size", action="append", type=read_size, default=[])
    parser.add_argument("image")
    parser.add_argument("function", nargs="+")
    options = parser.parse_args(arguments)
    failed = False
    try:
        analysis = Analysis(Image(options.image, options.stops), sizes=dict(options.size))
    except (OSError, Refused) as reason:
        print(f"wcet: {reason}", file=sys.stderr)
        return 2
    for name in options.function:
        try:
            print(f"{analysis.bound(name):12d}  {name}")
        except Refused as reason:
            failed = True
            print(f"wcet: {name}: {reason}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
