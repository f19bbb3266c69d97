#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/proof/decision_hash.sh [--all | --planted] [--build-dir DIR] [--help]

Builds the decision program in several ways, runs it, and compares its output line by line:
the decisions must be the same for every compiler, option and processor. Without options: g++ and
clang++, Release and Debug, and g++ for x86-64-v3.

  --all        also aarch64 under qemu-aarch64 and Cortex-M7 under qemu-system-arm; a missing
               compiler is then a failure, otherwise that build is skipped
  --planted    a g++ build with -ffast-math (NaN kept) against one without: must be reported as different
  --build-dir  where to build (default: build/decision)

Exit code: 0 all equal, 1 a build differs (its first differing line is named), 2 bad usage.
TEXT
}

root=$(cd "$(dirname "$0")/../.." && pwd)
builds=$root/build/decision
mode=quick
while [ $# -gt 0 ]; do
  case $1 in
    --all) mode=all ;;
    --planted) mode=planted ;;
    --build-dir) builds=${2:?--build-dir needs a folder}; shift ;;
    --help | -h) usage; exit 0 ;;
    *) echo "decision_hash: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
mkdir -p "$builds"
if [ -z "${CMAKE_CXX_COMPILER_LAUNCHER-}" ] && command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi

reference=
agreed=0
failed=0

# variant <name> <compiler> <emulator command or ""> <cmake option>...
variant() {
  local name=$1 compiler=$2 emulator=$3 dir=$builds/$1
  shift 3
  if ! command -v "$compiler" >/dev/null ||
    { [ -n "$emulator" ] && ! command -v "${emulator%% *}" >/dev/null; }; then
    echo "$name: skipped, $compiler or ${emulator%% *} is not installed"
    if [ $mode = all ]; then failed=1; fi
    return 0
  fi
  if ! { cmake -S "$root" -B "$dir" -G Ninja -DHARDPACK_PORT_LINUX=OFF -DHARDPACK_TOOLS=OFF "$@" &&
    cmake --build "$dir" --target decision -j "$(nproc)"; } >"$dir.log" 2>&1; then
    echo "$name: does not build"
    grep -m 5 'error:' "$dir.log" || tail -n 10 "$dir.log"
    failed=1
    return 0
  fi
  # Words of the command are separate arguments; semihosting writes to the standard error.
  # shellcheck disable=SC2086
  if ! timeout 900 $emulator "$dir/test/decision/decision" </dev/null >"$dir.out" 2>&1; then
    echo "$name: the program failed"
    tail -n 5 "$dir.out"
    failed=1
    return 0
  fi
  compare "$name" "$dir.out"
  grep '^stack_' "$dir.out" | sed "s/^/$name: /" || true
}

# compare <name> <output>  against the first variant's
compare() {
  local name=$1 output=$2
  grep '^decision ' "$output" >"$output.lines" || true
  if ! grep -q '^decision total ' "$output.lines"; then
    echo "$name: the output has no total"
    failed=1
  elif [ -z "$reference" ]; then
    reference=$output.lines
    reference_name=$name
    agreed=1
    echo "$name: $(tail -n 1 "$output.lines") ($(wc -l <"$output.lines") lines), the reference"
  elif cmp -s "$reference" "$output.lines"; then
    agreed=$((agreed + 1))
    echo "$name: $(tail -n 1 "$output.lines")"
  else
    local difference
    difference=$(paste -d '|' "$reference" "$output.lines" |
      awk -F '|' '$1 != $2 { print "line " NR ": " $2 ", there: " $1; exit }')
    echo "$name: differs from $reference_name, $difference"
    failed=1
  fi
}

release=(-DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -DNDEBUG")
debug=(-DCMAKE_BUILD_TYPE=Debug)

variant gxx-release g++ "" -DCMAKE_CXX_COMPILER=g++ "${release[@]}"
if [ $mode = planted ]; then
  variant gxx-fast-math g++ "" -DCMAKE_CXX_COMPILER=g++ "${release[@]}" \
    "-DCMAKE_CXX_FLAGS=-ffast-math -fno-finite-math-only"
else
  variant gxx-debug g++ "" -DCMAKE_CXX_COMPILER=g++ "${debug[@]}"
  variant clang-release clang++-14 "" -DCMAKE_CXX_COMPILER=clang++-14 "${release[@]}"
  variant clang-debug clang++-14 "" -DCMAKE_CXX_COMPILER=clang++-14 "${debug[@]}"
  # Wide registers are spilled to wide slots; the frame limit is for the processors we build for.
  if grep -q -w avx2 /proc/cpuinfo && grep -q -w fma /proc/cpuinfo; then
    variant gxx-x86-64-v3 g++ "" -DCMAKE_CXX_COMPILER=g++ "${release[@]}" \
      "-DCMAKE_CXX_FLAGS=-march=x86-64-v3 -Wno-error=stack-usage="
  else
    echo "gxx-x86-64-v3: skipped, this processor has no AVX2 and FMA"
  fi
fi
if [ $mode = all ]; then
  variant aarch64 aarch64-linux-gnu-g++ qemu-aarch64 "${release[@]}" \
    --toolchain "$root/tools/cmake/aarch64.cmake"
  variant cortex-m7 arm-none-eabi-g++ "qemu-system-arm -M mps2-an500 -nographic -monitor none \
    -serial none -semihosting-config enable=on,target=native -kernel" "${release[@]}" \
    --toolchain "$root/tools/cmake/cortex_m7.cmake"
fi

if [ $failed -ne 0 ]; then
  echo "decision_hash: FAILED"
  exit 1
fi
echo "decision_hash: all $agreed equal"
