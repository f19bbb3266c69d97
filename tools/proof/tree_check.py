# SPDX-License-Identifier: Apache-2.0
"""What the checks of a tree have in common: their arguments and what they print."""

import pathlib
import sys


def main(name, usage, check_tree, arguments):
    """The exit code. check_tree(root) gives the findings and how many files it looked at."""
    if any(a in ("-h", "--help") for a in arguments) or len(arguments) > 1:
        print(usage)
        return 0 if arguments and arguments[0] in ("-h", "--help") else 2
    root = pathlib.Path(arguments[0] if arguments else ".").resolve()
    findings, count = check_tree(root)
    for finding in findings:
        print(finding)
    if count == 0:
        print(f"{name}: there is nothing to check below {root}", file=sys.stderr)
        return 2
    print(f"{name}: {count} files, {len(findings)} findings")
    return 1 if findings else 0
