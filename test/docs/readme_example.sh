#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The README's example is the consumer's source, which the tests build and run.
set -euo pipefail
root=$1
diff -u <(tail -n +2 "$root/test/consumer/main.cpp") \
  <(awk '/^```cpp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$root/README.md")
