#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The examples of the documents are the consumers' sources, which the tests build and run: the README's is
# main.cpp whole, those of docs/your_*.md the marked parts of lidar.cpp, board.cpp and vehicle.cpp.
set -euo pipefail
root=$1
example() {
  awk '/^```cpp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$root/$1"
}
diff -u <(tail -n +2 "$root/test/consumer/main.cpp") <(example README.md)
for name in lidar board vehicle; do
  diff -u <(sed -n "\|^ *// docs/your_$name.md: from here\$|,\|^ *// docs/your_$name.md: to here\$|p" \
    "$root/test/consumer/$name.cpp" | sed '1d;$d') <(example "docs/your_$name.md")
done
