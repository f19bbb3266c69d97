#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/proof/fuzz.sh [--minutes N] [--seed N] [--build DIR] [--data DIR] [TARGET]...

Fuzzes with libFuzzer, both sanitizers and float-cast-overflow (clang++; preset fuzz): every codec, the
parsers of files, planning, and the whole tick; every loop of core and hal is held to its record. The
targets share the given minutes (default 10) and run one per processor at a time; if none is named, all of
test/fuzz are run. Interesting inputs are kept in BUILD/corpus, from which the next run starts; the
first run starts from seeds made of recordings, if there are any (--data; default ../shared/data, as for
the tests).

With a --seed, and if BUILD/corpus is empty at the start, the inputs are the same every time as far as the
minutes reach: a new failure then comes from a change of the code. Without it, each run tries others.

For each target it prints its runs, the edges of the code that were reached, and the number of kinds of
its seeds. One seed of each kind must be accepted (test/fuzz/accepted.h): seeds that are all refused are
no use as a start. A target that did not run has failed. An input that fails is kept as
BUILD/failed/TARGET-*; run the target with it to reproduce the failure.

Exit code: 0 nothing failed, 1 something did, 2 bad usage or the build failed.
TEXT
}

root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/fuzz
data=$root/../shared/data
minutes=10
seed=0
targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) minutes=${2:?--minutes needs a number}; shift ;;
    --seed) seed=${2:?--seed needs a number}; shift ;;
    --build) build=${2:?--build needs a folder}; shift ;;
    --data) data=${2:?--data needs a folder}; shift ;;
    --help | -h) usage; exit 0 ;;
    -*) echo "fuzz: unknown option $1" >&2; usage >&2; exit 2 ;;
    *) targets+=("$1") ;;
  esac
  shift
done
if ! [[ $minutes =~ ^[0-9]+(\.[0-9]+)?$ ]]; then
  echo "fuzz: $minutes are no minutes" >&2
  exit 2
fi
if [ ${#targets[@]} -eq 0 ]; then
  for source in "$root"/test/fuzz/*_fuzz.cpp; do
    targets+=("$(basename "$source" _fuzz.cpp)")
  done
fi
if ! [[ $seed =~ ^[0-9]+$ ]]; then
  echo "fuzz: $seed is no seed" >&2
  exit 2
fi
for target in "${targets[@]}"; do
  if [ ! -f "$root/test/fuzz/${target}_fuzz.cpp" ]; then
    echo "fuzz: there is no target $target" >&2
    exit 2
  fi
done
if ! { cmake -S "$root" --preset fuzz -B "$build" &&
  cmake --build "$build" --target "${targets[@]/%/_fuzz}"; } >"$build.log" 2>&1; then
  tail -n 20 "$build.log" >&2
  exit 2
fi
rm -rf "$build/seeds"
python3 "$root/test/fuzz/make_seeds.py" "$build/seeds" "$data"

jobs=$(nproc)
if [ "$jobs" -gt ${#targets[@]} ]; then jobs=${#targets[@]}; fi
rounds=$(((${#targets[@]} + jobs - 1) / jobs))
seconds=$(awk -v m="$minutes" -v n="$rounds" 'BEGIN { s = int(60 * m / n); print s < 1 ? 1 : s }')
mkdir -p "$build/failed"

# kinds_of <target>  of its seeds that it is to accept
kinds_of() {
  find "$build/seeds/$1" -type f -printf '%f\n' | sed 's/_[0-9]*$//' | sort -u | grep -vx any || true
}

# try_seeds <target>  each of them once, and whether of every kind one was accepted
try_seeds() {
  local target=$1 accepted=$build/$1.accepted kind outcome=0
  if [ -z "$(kinds_of "$target")" ]; then return 0; fi  # without recordings some have none
  rm -f "$accepted"
  HARDPACK_FUZZ_ACCEPTED=$accepted "$build/test/fuzz/${target}_fuzz" -timeout=60 -rss_limit_mb=4096 \
    -detect_leaks=0 -artifact_prefix="$build/failed/$target-" "$build/seeds/$target"/* || return 1
  for kind in $(kinds_of "$target"); do
    if ! grep -q "^$kind [1-9]" "$accepted"; then
      echo "fuzz: $target accepts none of its seeds of the kind $kind"
      outcome=1
    fi
  done
  return $outcome
}

# fuzz <target>  says at its end how it went, in one go, since others do so too
fuzz() {
  local target=$1 corpus=$build/corpus/$1 log=$build/$1.log outcome=fine runs edges
  mkdir -p "$corpus" "$build/seeds/$target"
  if ! try_seeds "$target" >"$log" 2>&1; then outcome=FAILED; fi
  # Of leaks nothing is said: each input's memory is given back, and the rest is the process's.
  if [ $outcome = fine ]; then
    "$build/test/fuzz/${target}_fuzz" -max_total_time="$seconds" -seed="$seed" -timeout=60 \
      -rss_limit_mb=4096 -max_len=25000 -print_final_stats=1 -artifact_prefix="$build/failed/$target-" \
      "$corpus" "$build/seeds/$target" >"$log" 2>&1 || outcome=FAILED
  fi
  runs=$(awk '$1 == "stat::number_of_executed_units:" { print $2 }' "$log")
  edges=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d' ' -f2 || true)
  # What says nothing of itself did nothing.
  if [ "${runs:-0}" -eq 0 ] || [ "${edges:-0}" -eq 0 ]; then outcome=FAILED; fi
  printf '%-14s %-7s %10s runs in %s s, %s edges, seeds of %s kinds%s\n' "$target" "$outcome" \
    "${runs:-?}" "$seconds" "${edges:-?}" "$(kinds_of "$target" | wc -l)" \
    "$(if [ $outcome = FAILED ]; then echo; tail -n 30 "$log"; fi)"
  [ $outcome = fine ]
}

failed=0
running=0
for target in "${targets[@]}"; do
  if [ "$running" -eq "$jobs" ]; then
    wait -n || failed=1
    running=$((running - 1))
  fi
  fuzz "$target" &
  running=$((running + 1))
done
while [ "$running" -gt 0 ]; do
  wait -n || failed=1
  running=$((running - 1))
done
exit $failed
