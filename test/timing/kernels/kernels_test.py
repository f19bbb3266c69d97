#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""usage: kernels_test.py IMAGE

The static bound of each kernel of kernels.h is not below what it takes on the emulator, and in the
median not more than 1.3 times that; no kernel is refused but those that are named here. Prints the
table; docs/timing.md has its ends.
"""

import os
import pathlib
import re
import statistics
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["HARDPACK_SOURCE"])
LARGEST_MEDIAN = 1.3
LEAST_KERNELS = 25
SPACE = "hardpack::timing::kernels::"
# The compiler makes two loops of one, which share its record.
MAY_BE_REFUSED = {"QuickSort"}


def output_of(*command, codes=(0,)):
    """With what it says on standard error, where the emulator's program writes."""
    result = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, check=False)
    if result.returncode not in codes:
        sys.exit(f"{command[0]}: exit code {result.returncode}\n{result.stdout}")
    return result.stdout


def main():
    image = sys.argv[1]
    counted = {}
    for line in output_of(SOURCE / "test/bare_metal/run.sh", image).splitlines():
        name, number = line.split()
        counted[name] = int(number)
    bounds = {}
    failures = []
    for line in output_of(sys.executable, SOURCE / "tools/proof/wcet/wcet.py", image,
                          *(SPACE + name for name in counted), codes=(0, 1)).splitlines():
        refused = re.match(rf"wcet: {SPACE}(\w+): (.*)", line)
        if refused:
            print(line)
            if refused[1] not in MAY_BE_REFUSED:
                failures.append(f"{refused[1]} is refused")
            continue
        number, name = re.fullmatch(rf"\s*(\d+)\s+{SPACE}(\w+)", line).groups()
        bounds[name] = int(number)
    print(f"{'kernel':26} {'bound':>10} {'counted':>10} {'ratio':>6}")
    for name, bound in bounds.items():
        print(f"{name:26} {bound:10,} {counted[name]:10,} {bound / counted[name]:6.2f}")
        if bound < counted[name]:
            failures.append(f"{name} takes {counted[name]}, more than its bound of {bound}")
    median = statistics.median(bound / counted[name] for name, bound in bounds.items())
    print(f"{len(bounds)} kernels, in the median {median:.2f} times what is counted")
    if len(bounds) < LEAST_KERNELS:
        failures.append(f"{len(bounds)} kernels only")
    if median > LARGEST_MEDIAN:
        failures.append(f"the median is {median:.2f}, more than {LARGEST_MEDIAN}")
    for failure in failures:
        print(f"kernels_test: {failure}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
