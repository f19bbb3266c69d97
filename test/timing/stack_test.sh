#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The static bound of the stack of the Cortex-M7's ticks and of their set-up is within 16 KiB, and what a
# mission and a crowd have taken, painted, is within the bound of the program that replays them.
# Arguments: python3, stack_bound.py, the build, what the mission and the crowd said (files that need not
# be there).
set -euo pipefail
bound=("$1" "$2" --stops hardpack::AssertionFailed --most 16384 --frame memcpy=64 --frame memset=64
  --frame __ctzdi2=16)
build=$3
tapes=("${@:4}")
entries=()
vehicles=$(sed -n 's/^vehicles = \[\(.*\)\]$/\1/p' "$(dirname "$0")/../../config/timing.toml" | tr -d '",')
for vehicle in $vehicles; do
  loop="hardpack::BasicVehicleLoop<hardpack::$vehicle>"
  entries+=("$loop::Tick" "$loop::Configure")
done
[ ${#entries[@]} -gt 0 ]
"${bound[@]}" "$build" "${entries[@]}"
if [ -f "${tapes[0]}" ] && [ -f "${tapes[1]}" ]; then
  program=$("${bound[@]}" "$build" hardpack::bare_metal::ReplayTape)
  most=$(awk '{ print $1 }' <<<"$program")
  taken=$(awk '$1 == "stack_peak_bytes" { print $2 }' "${tapes[@]}" | sort -n | tail -n 1)
  main=256  # main, what starts it, and what was not painted beneath
  echo "mission and crowd took $taken of at most $((most + main)) bytes"
  [ "$taken" -le $((most + main)) ]
fi
