#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/proof/decision_hash.sh [--all | --planted] [--reference PROGRAM] [--build-dir DIR] [--help]

Builds the decision program in several ways, runs it, and compares its output line by line:
the decisions must be the same for every compiler, option and processor. Without options: g++ and
clang++, Release and Debug, and g++ for x86-64-v3.

  --all        also aarch64 under qemu-aarch64 and Cortex-M7 under qemu-system-arm; a missing
               compiler is then a failure, otherwise that build is skipped
  --planted    a g++ build with -ffast-math (NaN kept) against one without: must be reported as different
  --reference  the decision program of g++, Release, where it is built already
  --build-dir  where to build what no preset builds (default: build/decision)

What a preset builds (core-clang, aarch64, cortex-m7) is built in that preset's folder, or is there.

Exit code: 0 all equal, 1 a build differs (its first differing line is named), 2 bad usage.
TEXT
}

root=$(cd "$(dirname "$0")/../.." && pwd)
builds=$root/build/decision
mode=quick
built=
while [ $# -gt 0 ]; do
  case $1 in
    --all) mode=all ;;
    --planted) mode=planted ;;
    --reference) built=${2:?--reference needs a program}; shift ;;
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

# is_here <name> <compiler> <emulator command or "">  or says that it is not
is_here() {
  if command -v "$2" >/dev/null && { [ -z "$3" ] || command -v "${3%% *}" >/dev/null; }; then return 0; fi
  echo "$1: skipped, $2 or ${3%% *} is not installed"
  if [ $mode = all ]; then failed=1; fi
  return 1
}

# builds <name> <folder> <command>...  the decision program there
builds() {
  local name=$1 dir=$2
  shift 2
  if { [ -f "$dir/CMakeCache.txt" ] || "$@"; } >"$builds/$name.log" 2>&1 &&
    cmake --build "$dir" --target decision -j "$(nproc)" >>"$builds/$name.log" 2>&1; then return 0; fi
  echo "$name: does not build"
  grep -m 5 'error:' "$builds/$name.log" || tail -n 10 "$builds/$name.log"
  failed=1
  return 1
}

# runs <name> <program> [emulator's word]...
runs() {
  local name=$1 program=$2 output=$builds/$1.out
  shift 2
  # Semihosting writes to the standard error.
  if ! timeout 900 "$@" "$program" </dev/null >"$output" 2>&1; then
    echo "$name: the program failed"
    tail -n 5 "$output"
    failed=1
    return 0
  fi
  compare "$name" "$output"
  grep '^stack_' "$output" | sed "s/^/$name: /" || true
}

# variant <name> <compiler> <cmake option>...
variant() {
  local name=$1 compiler=$2 dir=$builds/$1
  shift 2
  is_here "$name" "$compiler" "" || return 0
  builds "$name" "$dir" cmake -S "$root" -B "$dir" -G Ninja -DHARDPACK_PORT_LINUX=OFF \
    -DHARDPACK_TOOLS=OFF -DHARDPACK_JOIN_STAGES=ON "-DCMAKE_CXX_COMPILER=$compiler" "$@" || return 0
  runs "$name" "$dir/test/decision/decision"
}

# of_preset <name> <preset> <compiler> [emulator's word]...
of_preset() {
  local name=$1 preset=$2 compiler=$3 dir=$root/build/$2
  shift 3
  is_here "$name" "$compiler" "${1-}" || return 0
  builds "$name" "$dir" cmake -S "$root" --preset "$preset" || return 0
  runs "$name" "$dir/test/decision/decision" "$@"
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

if [ -n "$built" ]; then
  runs gxx-release "$built"
else
  variant gxx-release g++ "${release[@]}"
fi
if [ $mode = planted ]; then
  variant gxx-fast-math g++ "${release[@]}" "-DCMAKE_CXX_FLAGS=-ffast-math -fno-finite-math-only"
else
  variant gxx-debug g++ "${debug[@]}"
  of_preset clang-release core-clang clang++-14
  variant clang-debug clang++-14 "${debug[@]}"
  # Wide registers are spilled to wide slots; the frame limit is for the processors we build for.
  if grep -q -w avx2 /proc/cpuinfo && grep -q -w fma /proc/cpuinfo; then
    variant gxx-x86-64-v3 g++ "${release[@]}" \
      "-DCMAKE_CXX_FLAGS=-march=x86-64-v3 -Wno-error=stack-usage="
  else
    echo "gxx-x86-64-v3: skipped, this processor has no AVX2 and FMA"
  fi
fi
if [ $mode = all ]; then
  of_preset aarch64 aarch64 aarch64-linux-gnu-g++ qemu-aarch64
  of_preset cortex-m7 cortex-m7 arm-none-eabi-g++ qemu-system-arm -M mps2-an500 -nographic \
    -monitor none -serial none -semihosting-config enable=on,target=native -kernel
fi

if [ $failed -ne 0 ]; then
  echo "decision_hash: FAILED"
  exit 1
fi
echo "decision_hash: all $agreed equal"
