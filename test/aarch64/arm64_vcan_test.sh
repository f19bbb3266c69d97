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
