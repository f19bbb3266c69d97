#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/check.sh [--all] [--deps] [--deps-bench] [--help]

Installs what is missing (Debian packages, tools/packages.txt), builds the release preset and runs
its tests, the static checks among them: at most 15 minutes on two cores.

  --all         the slow ones too: clang and sanitizer builds and their tests (the former with
                every loop counted, the latter with the libraries' own assertions), aarch64 and
                Cortex-M7 under QEMU, a minute of fuzzing, the tests labelled slow: over an hour.
                It installs what the comparisons of `hardpack bench` need as well (ten seconds), so
                that what uses other libraries is compiled and tested
  --deps        only install; with --all, what --all needs as well
  --deps-bench  only install what the comparisons of `hardpack bench` need
  --help        this text

Exit code: 0 everything passed, 1 something failed (the summary says what), 2 bad usage or packages
are missing and cannot be installed (the line to run is printed).
TEXT
}

root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"
logs=$root/build/check
all=false
only_deps=false
sections=(check)
for argument; do
  case $argument in
    --all) all=true; sections+=(all bench) ;;
    --deps) only_deps=true ;;
    --deps-bench) only_deps=true; sections+=(bench) ;;
    --help | -h) usage; exit 0 ;;
    *) echo "check.sh: unknown option $argument" >&2; usage >&2; exit 2 ;;
  esac
done

# --- packages -------------------------------------------------------------------------------------

packages_of() {  # the packages of one section of packages.txt
  awk -v section="[$1]" '{ sub(/#.*/, "") } /^\[/ { inside = ($1 == section); next }
                         inside && NF { print $1 }' tools/packages.txt
}

install_missing() {
  local missing=() package section
  for section in "${sections[@]}"; do
    for package in $(packages_of "$section"); do
      if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
        missing+=("$package")
      fi
    done
  done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "packages: nothing is missing"
    return
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! sudo -n true 2>/dev/null; then
      echo "check.sh: packages are missing; as root, run:" >&2
      echo "apt-get install -y --no-install-recommends ${missing[*]}" >&2
      exit 2
    fi
    as_root=(sudo -n)
  fi
  echo "packages: installing ${missing[*]}"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}"
}

if ! command -v dpkg-query >/dev/null; then
  echo "packages: this is no Debian; install the likes of tools/packages.txt by hand"
elif ! install_missing </dev/null; then
  echo "check.sh: installing packages failed" >&2
  exit 2
fi
if $only_deps; then exit 0; fi

# --- steps ----------------------------------------------------------------------------------------

if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR=$root/build/ccache
  export CCACHE_SLOPPINESS=pch_defines,time_macros  # without which it leaves out what begins with a PCH
fi
jobs=$(nproc)
mkdir -p "$logs"
names=()
outcomes=()
failed=0
failed_names=()

# left_out <log>  how many tests of it were skipped, and which
left_out() {
  local names
  names=$(sed -n 's/^[[:space:]]*[0-9]* - \(.*\) (Skipped)$/\1/p' "$1")
  [ -z "$names" ] || printf '; %d skipped: %s' "$(wc -l <<<"$names")" "$(paste -sd ' ' <<<"$names")"
}

# step <name> <command>...  runs it, keeps its output in build/check, and goes on when it fails.
step() {
  local name=$1 log start=$SECONDS outcome=passed
  shift
  log=$logs/${name// /_}.log
  echo
  echo "== $name: $*"
  "$@" </dev/null 2>&1 | tee "$log" || outcome=FAILED
  if [ $outcome = FAILED ]; then
    failed=$((failed + 1))
    failed_names+=("$name")
  fi
  names+=("$name")
  # ctest's own words, where it has spoken; a test that was left out has not passed.
  outcomes+=("$outcome, $((SECONDS - start)) s $(grep -h '% tests passed' "$log" || true)$(left_out "$log")")
  [ $outcome = passed ]
}

# failures_in <log>  what a reader of the end of a long output needs: the names of the tests that
# failed and the end of what each said, or else the log's end.
failures_in() {
  local test
  if ! grep -q '^The following tests FAILED' "$1"; then
    tail -n 40 "$1"
    return
  fi
  sed -n '/^The following tests FAILED/,$p' "$1"
  sed -n '/^The following tests FAILED/,$s/^[[:space:]]*\([0-9]*\) - .*/\1/p' "$1" | head -n 5 |
    while read -r test; do
      echo "-- the end of what test $test said"
      awk -v test="#$test:" '$2 == "Test" && $3 == test { inside = 1 }
                             $1 == "Start" || $2 == "Test" && $3 != test { inside = 0 }
                             inside' "$1" | tail -n 60
    done
}

cmake_options=()

# A User-Mode Linux machine stands still while its host's disk takes what a build has written.
settle() { sync; }

# build_and_test <preset> [ctest option]...
build_and_test() {
  local preset=$1
  shift
  step "$preset configure" cmake --preset "$preset" "${cmake_options[@]}" || return 0
  step "$preset build" cmake --build --preset "$preset" -j "$jobs" -- -k 0 || return 0
  settle
  step "$preset tests" ctest --preset "$preset" -j "$jobs" "$@" || true
}

build_and_test release -LE slow
step "clang-tidy" tools/check_tidy.sh build/release || true
if $all; then
  # Clang's optimised code without counters is what the sanitizers look at.
  cmake_options=(-DHARDPACK_COUNT_LOOPS=ONLY)
  rm -f build/loops
  HARDPACK_LOOP_REPORT=$root/build/loops build_and_test release-clang -LE slow
  step "loops" tools/loop_report.py build/loops || true
  cmake_options=()
  build_and_test asan -LE slow
  build_and_test aarch64
  build_and_test cortex-m7
  step "fuzz" tools/fuzz.sh --minutes 1 --seed 1 || true
  settle
  step "slow tests" ctest --preset release -j "$jobs" -L slow || true
fi

echo
echo "== summary, logs in build/check"
for i in "${!names[@]}"; do
  printf '%-24s %s\n' "${names[$i]}" "${outcomes[$i]}"
done
if [ $failed -ne 0 ]; then
  for name in "${failed_names[@]}"; do
    echo
    echo "== what failed in $name"
    failures_in "$logs/${name// /_}.log"
  done
  echo "check.sh: $failed of ${#names[@]} steps FAILED, in $SECONDS s"
  exit 1
fi
echo "check.sh: all ${#names[@]} steps passed, in $SECONDS s"
