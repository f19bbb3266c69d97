#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A mission that was driven on this machine is decided again on a bare processor: from the bytes of its
# flight log, every frame and every tick's decision hash. Arguments: this machine's release build, the
# cross build's replay_tape, where to leave what it said, a configuration if there is one. Skipped (77)
# where that build has no hardpack.
set -euo pipefail
host=$1
replay_tape=$2
measured=$3
configuration=${4-}
ticks=700  # it has planned, driven off and reached its speed
if [ ! -x "$host/tools/hardpack" ] || [ ! -x "$host/test/bare_metal/write_tape" ]; then
  echo "no hardpack in $host"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run() {
  "$(dirname "$0")/run.sh" "$replay_tape" "$1" 2>&1
}

"$host/tools/hardpack" sim --world rock_pile --seed 2 --labels 100 --limit 8 \
  ${configuration:+--config "$configuration"} --out "$folder/run" --json >"$folder/run.json" || true
"$host/test/bare_metal/write_tape" "$folder"/run/*.pcap $ticks "$folder/tape"
run "$folder/tape" | tee "$folder/said"
grep -q "^ticks $ticks$" "$folder/said"
cp "$folder/said" "$measured"
[ "$(awk '$1 == "rounds_of_planning" { print $2 }' "$folder/said")" -ge 10 ]

# What it says means something: fewer ticks are another hash, another expected hash is noticed, and so
# is a tape that ends too early.
config_bytes=$(sed -n 's/.*sizeof(VehicleConfig) == \([0-9]*\).*/\1/p' "$(dirname "$0")/tape.h")
first_hash=$((16 + config_bytes + 16))  # tape.h: TapeHead, VehicleConfig, TapeTick::decision_hash
short=$folder/short
"$host/test/bare_metal/write_tape" "$folder"/run/*.pcap 20 "$short"
run "$short" >"$short.said"
if grep -qF "$(grep '^decision hash' "$folder/said")" "$short.said"; then exit 1; fi
fails_with() {  # <exit code> <text>
  local status=0
  run "$short" >"$short.said" || status=$?
  grep -q "^$2" "$short.said"
  [ $status -eq "$1" ]
}
byte=$(od -An -tu1 -j$first_hash -N1 "$short")
printf '%b' "\\0$(printf %o $((byte ^ 1)))" |
  dd of="$short" bs=1 seek=$first_hash conv=notrunc status=none
fails_with 1 'decided otherwise, tick'
truncate -s -1 "$short"
printf '%b' "\\0$(printf %o "$byte")" |
  dd of="$short" bs=1 seek=$first_hash conv=notrunc status=none
fails_with 2 'the tape ends too early'
