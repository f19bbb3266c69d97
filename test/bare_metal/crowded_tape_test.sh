#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The dearest ticks that a test makes (write_crowded_tape.cpp) are decided on a bare processor as on this
# machine, and counted. Arguments: this machine's release build, the cross build's replay_tape, where to
# leave what it said. Skipped (77) where that build cannot write the tape.
set -euo pipefail
write_tape=$1/test/bare_metal/write_crowded_tape
replay_tape=$2
measured=$3
if [ ! -x "$write_tape" ]; then
  echo "no $write_tape"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$write_tape" "$folder/tape"
"$(dirname "$0")/run.sh" "$replay_tape" "$folder/tape" 2>&1 | tee "$folder/said"
cp "$folder/said" "$measured"
number() { awk -v name="$1" '$1 == name { print $2 }' "$folder/said"; }
# Ticks in which nothing comes are among them: those that are counted are of another kind.
[ "$(number instructions_worst_tick_without_planning)" -gt $((3 * $(number instructions_mean_tick) / 2)) ]
[ "$(number instructions_worst_tick)" -gt "$(number instructions_worst_tick_without_planning)" ]
