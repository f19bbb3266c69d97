#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/check.sh [--all] [--deps] [--deps-build] [--deps-bench] [--help]

Installs missing Debian packages (tools/packages.txt), builds the release preset and runs its tests,
including the static checks: some 25 minutes on two cores, without a compiler cache.

  --all         also the slow ones: core and hal as clang++ optimises them, a build with sanitizers,
                the libraries' own assertions and every loop counted, aarch64 and Cortex-M7 under
                QEMU, a minute of fuzzing, the tests labelled slow (two or three seeds of each
                world): 47 to 86 minutes measured, goal 45. It also
                installs what the comparisons of `hardpack bench` need (ten seconds), so that the
                code that uses other libraries is compiled and tested
  --deps        only install; with --all, also what --all needs
  --deps-build  only install what building the programs needs
  --deps-bench  only install what the comparisons of `hardpack bench` need
  --help        this text

At the end it prints the steps in the order in which they began, with the elapsed and the processor
seconds of each; clang-tidy and the Cortex-M7's tests run in parallel with others.

Exit code: 0 everything passed, 1 something failed (the summary says what), 2 bad usage or packages
are missing and cannot be installed (the command to run is printed).
TEXT
}

root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"
logs=$root/build/check
all=false
only_deps=false
sections=(build check)
for argument; do
  case $argument in
    --all) all=true; sections+=(all bench) ;;
    --deps) only_deps=true ;;
    --deps-build) only_deps=true; sections=(build) ;;
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
  # The user's own cache: what another checkout of the same sources has compiled is not compiled again.
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1
  export CCACHE_SLOPPINESS=pch_defines,time_macros  # without which it leaves out what begins with a PCH
fi
jobs=$(nproc)
mkdir -p "$logs"
names=()
outcomes=()
failed_names=()

# left_out <log>  how many tests of it were skipped, and which
left_out() {
  local names
  names=$(sed -n 's/^[[:space:]]*[0-9]* - \(.*\) (Skipped)$/\1/p' "$1")
  [ -z "$names" ] || printf '; %d skipped: %s' "$(wc -l <<<"$names")" "$(paste -sd ' ' <<<"$names")"
}

# log_of <name>  of a step
log_of() { echo "$logs/${1// /_}.log"; }

# begun <name>  gives a step its line of the summary; its number is in begun_step
begun() {
  begun_step=${#names[@]}
  names+=("$1")
  outcomes+=("not ended")
}

# ended <number> <passed or FAILED> <seconds>
ended() {
  local name=${names[$1]} log
  log=$(log_of "$name")
  if [ "$2" = FAILED ]; then failed_names+=("$name"); fi
  # ctest's own words, where it has spoken; a test that was left out has not passed.
  outcomes[$1]=$(printf '%-6s %5d s %6.0f s  %s%s' "$2" "$3" "$(awk '{ s += $1 + $2 } END { print s + 0 }' \
    "$log.cpu")" "$(grep -h '% tests passed' "$log" || true)" "$(left_out "$log")")
}

# timed <name> <command>...  its processor time goes into a file beside its log
timed() {
  local TIMEFORMAT='%U %S' log
  log=$(log_of "$1")
  shift
  { time "$@" </dev/null 2>&1; } 2>"$log.cpu"
}

# step <name> <command>...  runs it, keeps its output in build/check, and goes on when it fails.
step() {
  local name=$1 start=$SECONDS outcome=passed number
  shift
  begun "$name"
  number=$begun_step
  echo
  echo "== $name: $*"
  timed "$name" "$@" | tee "$(log_of "$name")" || outcome=FAILED
  ended "$number" $outcome $((SECONDS - start))
  [ $outcome = passed ]
}

# beside <name> <command>...  a step that goes on beside those until `join`
beside() {
  local name=$1 start=$SECONDS
  shift
  begun "$name"
  beside_step=$begun_step
  echo
  echo "== $name, beside what follows: $*"
  set -m  # a process group of its own, to be ended as one
  {
    outcome=passed
    timed "$name" "$@" >"$(log_of "$name")" || outcome=FAILED
    echo "$outcome $((SECONDS - start))" >"$logs/beside"
  } &
  beside_job=$!
  set +m
}

join() {
  local outcome=FAILED seconds=0
  wait "$beside_job" || true
  read -r outcome seconds <"$logs/beside" || true
  rm -f "$logs/beside"
  ended "$beside_step" "$outcome" "$seconds"
  beside_job=
}
beside_job=
trap '[ -z "$beside_job" ] || kill -- "-$beside_job" 2>/dev/null || true' EXIT

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

# A User-Mode Linux machine stands still while its host's disk takes what a build has written.
settle() { sync; }

# build <preset>
build() {
  step "$1 configure" cmake --preset "$1" || return
  step "$1 build" cmake --build --preset "$1" -j "$jobs" -- -k 0
}

# run_tests <preset> [ctest option]...  and says of those that share a process which were skipped, as
# ctest does of the others.
run_tests() {
  local status=0
  ctest --preset "$@" -j "$jobs" || status=$?
  awk '/^[0-9]+\/[0-9]+ Testing: / { name = $3; shared = sub(/part_.*/, "", name) }
       shared && /^\[  SKIPPED \] .* \(/ { print "0 - " name $4 " (Skipped)" }' \
    "build/$1/Testing/Temporary/LastTest.log"
  return $status
}

# tests <preset> [ctest option]...
tests() {
  settle
  step "$1 tests" run_tests "$@" || true
}

# Those with a vcan keep real time: nothing is beside them.
vcan_tests() {
  local slow=(-LE slow)
  if $all; then slow=(); fi
  settle
  step "vcan tests" run_tests release -L vcan "${slow[@]}" || true
}

step "requirements" tools/proof/check_requirements.py || true
if build release; then
  beside "clang-tidy" nice -n 19 tools/proof/check_tidy.sh build/release
  tests release -LE "slow|vcan"
  join
  vcan_tests
fi
if $all; then
  if build core-clang; then tests core-clang; fi
  rm -f build/loops
  if build asan; then
    HARDPACK_LOOP_REPORT=$root/build/loops tests asan -LE slow
    step "loops" tools/proof/loop_report.py build/loops || true
  fi
  # Each has a chain of tests that wait for each other.
  of_cortex_m7=false
  if build cortex-m7; then of_cortex_m7=true; fi
  of_aarch64=false
  if build aarch64; then of_aarch64=true; fi
  if $of_cortex_m7; then beside "cortex-m7 tests" ctest --preset cortex-m7 -j 1; fi
  if $of_aarch64; then tests aarch64; fi
  step "fuzz" tools/proof/fuzz.sh --minutes 1 --seed 1 || true
  if $of_cortex_m7; then join; fi
  everywhere='^decision\.equal_on_all_targets$'
  # It builds with all processors.
  step "same decisions" ctest --preset release -R "$everywhere" || true
  step "slow tests" ctest --preset release -j "$jobs" -L slow -LE vcan -E "$everywhere" || true
fi

for name in "${failed_names[@]}"; do
  echo
  echo "== what failed in $name"
  failures_in "$(log_of "$name")"
done
echo
echo "== summary, logs in build/check: what a step took, and of the processors"
for i in "${!names[@]}"; do
  printf '%-24s %s\n' "${names[$i]}" "${outcomes[$i]}"
done
if [ ${#failed_names[@]} -ne 0 ]; then
  echo "check.sh: ${#failed_names[@]} of ${#names[@]} steps FAILED, in $SECONDS s"
  exit 1
fi
echo "check.sh: all ${#names[@]} steps passed, in $SECONDS s"
