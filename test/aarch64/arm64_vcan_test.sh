#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Tests of tools/arm64_vcan.sh: arm64_vcan_test.sh CASE, a function below. Exit status 125, the reason
# on standard error, where something that it needs is not there.
# What is in single quotes is for the machine's shell:
# shellcheck disable=SC2016
set -euo pipefail

arm64_vcan=$(cd "$(dirname "$0")/../.." && pwd)/tools/arm64_vcan.sh
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export TMPDIR=$scratch/tmp  # the script's own folder comes to lie here
mkdir "$TMPDIR" "$scratch/folder"

# expect <what> <expected> <found>
expect() {
  if [ "$2" != "$3" ]; then
    printf '%s: expected\n%s\nfound\n%s\n' "$1" "$2" "$3" >&2
    exit 1
  fi
}

PassesOutputAndExitStatus() {
  local status=0
  echo brought along >"$scratch/folder/file"
  "$arm64_vcan" --interfaces 2 "$scratch/folder" sh -c \
    'cat file; uname -m; ls /sys/class/net; printf "<%s>" "$@"; echo to standard error >&2; exit 37' \
    name '' 'a  b' "it's" >"$scratch/out" 2>"$scratch/err" || status=$?
  if [ $status -eq 125 ]; then
    cat "$scratch/err" >&2
    exit 125
  fi
  expect status 37 $status
  expect "standard output" "$(printf 'brought along\naarch64\nlo\nvcan0\nvcan1\n<><a  b><it%ss>' \')" \
    "$(<"$scratch/out")"
  expect "standard error" "to standard error" "$(<"$scratch/err")"
  expect "what is left" "" "$(ls "$TMPDIR")"
}

# By its own clock the machine sleeps for as long as it was told to.
HasItsOwnClockAndBringsBack() {
  local status=0 slept start=$SECONDS
  "$arm64_vcan" --own-clock --bring-back "$scratch/back" "$scratch/folder" sh -c \
    'mkdir out; cut -d . -f 1 /proc/uptime >out/before; sleep 30; cut -d . -f 1 /proc/uptime >out/after
     exit 3' >"$scratch/out" 2>"$scratch/err" || status=$?
  if [ $status -eq 125 ]; then exit 125; fi
  expect status 3 $status
  slept=$(($(<"$scratch/back/after") - $(<"$scratch/back/before")))
  if [ $slept -lt 30 ] || [ $slept -gt 31 ]; then expect "seconds asleep" 30 $slept; fi
  echo "30 s of the machine's clock in $((SECONDS - start)) s, its start included"
  status=0
  "$arm64_vcan" --bring-back "$scratch/back" "$scratch/folder" true 2>"$scratch/err" || status=$?
  expect "status for a folder that is there" 2 $status
  expect "what is left" "" "$(ls "$TMPDIR")"
}

EndsWithSigterm() {
  local pid status=0 file
  "$arm64_vcan" "$scratch/folder" sh -c 'echo started; sleep 1000' >"$scratch/out" &
  pid=$!
  until [ -s "$scratch/out" ]; do
    kill -0 $pid 2>/dev/null || break
    sleep 0.1
  done
  kill -TERM $pid 2>/dev/null || true
  wait $pid || status=$?
  if [ $status -eq 125 ]; then exit 125; fi
  expect status 143 $status
  for file in /proc/[0-9]*/cmdline; do
    if grep -qF "$TMPDIR" "$file" 2>/dev/null; then
      expect "what is left" "" "$(tr '\0' ' ' <"$file")"
    fi
  done
  expect "what is left" "" "$(ls "$TMPDIR")"
}

"$1"
