#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Tests of tools/vcan.sh: vcan_test.sh CASE, a function below. Exit status 125, the reason on standard
# error, where there is no way to make a vcan.
# What is in single quotes is for the machine's shell:
# shellcheck disable=SC2016
set -euo pipefail

vcan=$(cd "$(dirname "$0")/../.." && pwd)/tools/vcan.sh
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export TMPDIR=$scratch/tmp  # vcan.sh's own folder comes to lie here
mkdir "$TMPDIR"

# expect <what> <expected> <found>
expect() {
  if [ "$2" != "$3" ]; then
    printf '%s: expected\n%s\nfound\n%s\n' "$1" "$2" "$3" >&2
    exit 1
  fi
}

# status_of <command>...  prints its exit status; its output goes to $scratch/out and $scratch/err
status_of() {
  local status=0
  "$@" >"$scratch/out" 2>"$scratch/err" || status=$?
  echo $status
}

# left_behind <marker>  the command lines of processes that have the marker in them, and what is left
# in the folder for temporary files
left_behind() {
  local file words
  for file in /proc/[0-9]*/cmdline; do
    { mapfile -d '' words <"$file"; } 2>/dev/null || continue
    if [[ ${words[*]} == *"$1"* || ${words[*]} == *"$TMPDIR"* ]]; then echo "${words[*]}"; fi
  done
  ls "$TMPDIR"
}

# wait_for_line <file>  until something has been written to it
wait_for_line() {
  for _ in {1..300}; do
    if [ -s "$1" ]; then return; fi
    sleep 0.1
  done
  echo "nothing came in 30 s" >&2
  exit 1
}

# In the machine: until a candump listens on an interface. (Where none does, the list has a line too:
# "(vcan0: no entry)".) It ends at a frame 7FF behind all others (-n), however long a busy machine takes
# to send them.
export listens='until grep -q "^ *$interface " /proc/net/can/rcvlist_all; do sleep 0.05; done'

PassesOutputAndExitStatus() {
  export FRAME=$'two\nlines, a "quote"'
  cd "$scratch"
  expect status 37 "$(status_of "$vcan" bash -c \
    'pwd; echo "$FRAME"; printf "<%s>" "$@"; id -u; wc -c; echo to standard error >&2; exit 37' \
    name '' 'a  b' '$(x)')"
  expect "standard output" "$(printf '%s\n' "$scratch" "$FRAME" '<><a  b><$(x)>0' 0)" \
    "$(<"$scratch/out")"
  expect "standard error" "to standard error" "$(<"$scratch/err")"
}

CarriesFrames() {
  expect status 0 "$(status_of "$vcan" --interfaces 2 bash -c '
    candump -n 2 -T 30000 vcan0 & interface=vcan0; eval "$listens"
    candump -n 2 -T 30000 vcan1 & interface=vcan1; eval "$listens"
    cansend vcan0 181#0102030405060708; cansend vcan1 000#0100
    cansend vcan0 7FF#; cansend vcan1 7FF#; wait')"
  expect frames "$(printf '%s\n' 'vcan0 181 [8] 01 02 03 04 05 06 07 08' 'vcan0 7FF [0]' \
    'vcan1 000 [2] 01 00' 'vcan1 7FF [0]')" \
    "$(sed 's/^ *//; s/  */ /g; s/ *$//' "$scratch/out" | LC_ALL=C sort)"
}

RunsTwiceAtATime() {
  # Each sends when both listen.
  export meeting=$scratch
  local run pids=()
  for run in 1 2; do
    "$vcan" bash -c '
      candump -L -n 11 -T 30000 vcan0 & interface=vcan0; eval "$listens"
      mkdir "$meeting/ready$1"; until [ -d "$meeting/ready$((3 - $1))" ]; do sleep 0.1; done
      for i in {1..10}; do cansend vcan0 10$1#; done
      cansend vcan0 7FF#
      wait' run $run >"$scratch/run$run" &
    pids+=($!)
  done
  for run in 1 2; do wait "${pids[run - 1]}"; done
  for run in 1 2; do
    expect "frames in run $run" "$(printf '%s\n' "10 10$run#" '1 7FF#')" \
      "$(awk '{ print $3 }' "$scratch/run$run" | sort | uniq -c | sed 's/^ *//')"
  done
}

EndsWithSigterm() {
  local marker=100000.$$ pid status=0
  "$vcan" bash -c "trap '' TERM; setsid sleep $marker & echo started; sleep $marker" \
    >"$scratch/out" 2>"$scratch/err" &
  pid=$!
  wait_for_line "$scratch/out"
  kill -TERM $pid
  wait $pid || status=$?
  expect status 143 "$status"
  expect "what is left" "" "$(left_behind "$marker")"
  expect "standard error" "" "$(<"$scratch/err")"
}

EndsWithSigkill() {
  if [ "$(id -u)" -ne 0 ] && [ "$("$vcan" --which)" = uml ]; then
    echo "what is left can be ended by root only" >&2
    exit 125
  fi
  local marker=100000.$$ pid
  "$vcan" bash -c "setsid sleep $marker & echo started; sleep $marker" >"$scratch/out" &
  pid=$!
  wait_for_line "$scratch/out"
  kill -KILL $pid
  wait $pid 2>/dev/null || true
  for _ in {1..20}; do
    rm -rf "${TMPDIR:?}"/*  # the folder that is allowed to be left
    if [ -z "$(left_behind "$marker")" ]; then return; fi
    sleep 0.1
  done
  expect "what is left" "" "$(left_behind "$marker")"
}

EndsWhatTheCommandLeftRunning() {
  local marker=100000.$$
  expect status 5 "$(status_of "$vcan" bash -c "setsid sleep $marker & exit 5")"
  expect "what is left" "" "$(left_behind "$marker")"
}

# In a User-Mode Linux machine there is a vcan: this is the other way.
NestsOnTheHostWay() {
  expect status 9 "$(status_of "$vcan" --timeout 60 bash -c '
    set -e
    [ "$("$0" --which)" = host ]
    ip link set vcan0 down
    "$0" --interfaces 3 ls /sys/class/net
    ip -br link show vcan0 | grep -o DOWN
    status=0; "$0" --timeout 0.5 sleep 100 || status=$?; echo $status
    interface=vcan0 "$0" bash -c "candump -n 1 -T 30000 vcan0 & $listens; cansend vcan0 7FF#; wait; exit 9"
    ' "$vcan")"
  expect output "$(printf 'lo\nvcan0\nvcan1\nvcan2\nDOWN\n124\nvcan0 7FF [0]')" \
    "$(sed 's/^ *//; s/  */ /g; s/ *$//' "$scratch/out")"
}

SaysWhatIsWrong() {
  # Only what the script needs to find that there is nothing.
  mkdir "$scratch/bin"
  ln -s "$(command -v bash)" "$(command -v id)" "$scratch/bin/"
  expect "status without a way" 125 \
    "$(PATH=$scratch/bin status_of "$(command -v bash)" "$vcan" true)"
  expect "lines without a way" 1 "$(wc -l <"$scratch/err")"
  expect "status with an unknown option" 2 "$(status_of "$vcan" --nonsense true)"
  expect "status without a command" 2 "$(status_of "$vcan" --interfaces 2)"
  expect "status with no number" 2 "$(status_of "$vcan" --timeout soon true)"
  local marker=100000.$$
  expect "status after the time-out" 124 "$(status_of "$vcan" --timeout 1 sleep "$marker")"
  expect "what it said" "vcan.sh: ended after 1 s" "$(<"$scratch/err")"
  expect "what is left" "" "$(left_behind "$marker")"
}

"$vcan" --which >/dev/null || exit 125
"$1"
