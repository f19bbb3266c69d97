#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The static bound of the stack of the Cortex-M7's tick and of its set-up is within 16 KiB, and what a
# mission has taken, painted, is within the bound of the program that replays it. Arguments: python3,
# stack_bound.py, the build, what the mission said (a file that need not be there).
set -euo pipefail
bound=("$1" "$2" --stops hardpack::AssertionFailed --most 16384 --frame memcpy=64 --frame memset=64)
build=$3
mission=$4
"${bound[@]}" "$build" hardpack::VehicleLoop::Tick hardpack::VehicleLoop::Configure
if [ -f "$mission" ]; then
  program=$("${bound[@]}" "$build" hardpack::bare_metal::ReplayTape)
  most=$(awk '{ print $1 }' <<<"$program")
  taken=$(awk '$1 == "stack_peak_bytes" { print $2 }' "$mission")
  main=256  # main, what starts it, and what was not painted beneath
  echo "the mission took $taken of at most $((most + main)) bytes"
  [ "$taken" -le $((most + main)) ]
fi
