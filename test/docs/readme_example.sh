#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The README's examples are the consumers' sources, which the tests build and run: the first is
# main.cpp whole, the second the marked part of lidar.cpp.
set -euo pipefail
root=$1
example() {
  awk -v wanted="$1" '/^```cpp$/ { ++block; inside = 1; next } /^```$/ { inside = 0 }
    inside && block == wanted' "$root/README.md"
}
diff -u <(tail -n +2 "$root/test/consumer/main.cpp") <(example 1)
diff -u <(sed -n '\|^// README: from here$|,\|^// README: to here$|p' \
  "$root/test/consumer/lidar.cpp" | sed '1d;$d') <(example 2)
