#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Passes when a command fails for the right reason.

usage: must_fail.py REGEX COMMAND...

The command must exit with 1 (a check that found something; also what compilers say) and its output
must match REGEX: a check that fails because a file is missing has shown nothing.
"""

import re
import subprocess
import sys

result = subprocess.run(sys.argv[2:], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
print(result.stdout)
if result.returncode != 1:
    sys.exit(f"must_fail: exit code {result.returncode}; the planted violation was not found")
if not re.search(sys.argv[1], result.stdout):
    sys.exit(f"must_fail: it failed, but not with /{sys.argv[1]}/")
