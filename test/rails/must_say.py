#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Passes when a command succeeds and says what it should.

usage: must_say.py REGEX COMMAND...

The command must exit with 0 and its output must match REGEX. CTest's PASS_REGULAR_EXPRESSION looks
at the output alone.
"""

import re
import subprocess
import sys

result = subprocess.run(sys.argv[2:], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
print(result.stdout)
if result.returncode != 0:
    sys.exit(f"must_say: exit code {result.returncode}")
if not re.search(sys.argv[1], result.stdout):
    sys.exit(f"must_say: it succeeded, but without /{sys.argv[1]}/")
