#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The examples of the documents are the consumers' sources, which the tests build and run: the README's is
# main.cpp whole, that of docs/your_lidar.md the marked part of lidar.cpp.
set -euo pipefail
root=$1
example() {
  awk '/^```cpp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$root/$1"
}
diff -u <(tail -n +2 "$root/test/consumer/main.cpp") <(example README.md)
diff -u <(sed -n '\|^// docs/your_lidar.md: from here$|,\|^// docs/your_lidar.md: to here$|p' \
  "$root/test/consumer/lidar.cpp" | sed '1d;$d') <(example docs/your_lidar.md)
