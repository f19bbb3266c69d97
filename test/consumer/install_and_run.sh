#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build to a fresh prefix, builds the consumers against it alone, and runs them.
#   install_and_run.sh BUILD_DIR WORK_DIR CXX
set -eu
source=$(cd "$(dirname "$0")" && pwd)
build=$1
work=$2
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --prefix "$work/prefix" --component development >"$work/install.log"
# A copy outside the project's tree: a header that is found must be an installed one.
cp "$source/CMakeLists.txt" "$source/main.cpp" "$source/lidar.cpp" "$source/vehicle.cpp" \
  "$source/board.cpp" "$work"
cmake -S "$work" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$3" \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror"
cmake --build "$work/build"

"$work/build/vehicle" >"$work/vehicle.txt"
cat "$work/vehicle.txt"
grep -qx "my_vehicle: in standby, it calls its drives" "$work/vehicle.txt"

"$work/build/board" >"$work/board.txt"
cat "$work/board.txt"
grep -qx "warthog: 101 ticks, frames sent, drives off" "$work/board.txt"

# The lidar's datagrams, the first of them twice, as networks do.
if [ -x "$build/tools/hardpack" ]; then
  "$build/tools/hardpack" scene --out "$work/scene"
  python3 "$source/datagrams.py" "$work/scene/scan.pcap" >"$work/datagrams"
  record_bytes=$((8 + 4 + 16 * (16 + 64 * 12 + 4)))  # LEGACY, 16 columns of 64 beams
  records=$(($(wc -c <"$work/datagrams") / record_bytes))
  columns=$((records * 16))
  [ "$columns" -gt 1024 ]  # more than a revolution
  { head -c "$record_bytes" "$work/datagrams"; cat "$work/datagrams"; } |
    "$work/build/lidar" >"$work/lidar.txt"
  cat "$work/lidar.txt"
  # Through the gap in the fence: of what was not seen nothing is within 2 m. And status 0 of the
  # pipe's end: the plan was usable.
  grep -Eqx "$columns columns, 0 missing; [a-z_]+, [0-9]+ points, 2[2-5]\.[0-9] m, [01]\.[0-9]+ m clear" \
    "$work/lidar.txt"
else
  echo "lidar: not run, this build has no hardpack command (HARDPACK_TOOLS)"
fi

# The programs work without the sources and the build that they come from.
root=$(cd "$source/../.." && pwd)
if [ -x "$build/tools/hardpack" ] && unshare -rm true 2>/dev/null; then
  prefix=$(mktemp -d)
  trap 'rm -rf "$prefix"' EXIT
  cmake --install "$build" --prefix "$prefix" --component onboard >>"$work/install.log"
  cp "$source/without_sources.sh" "$prefix"
  unshare -rm "$prefix/without_sources.sh" "$root" "$prefix"
else
  echo "installed: not run without its sources, no hardpack command or no namespaces"
fi

# Last, and what goes before prints no such line: it is by this line that the test passes.
"$work/build/plan"
