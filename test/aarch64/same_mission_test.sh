#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A mission of one seed is the same run on both processors: every figure of run.json and the decision
# hash, to the bit. Arguments: this machine's hardpack, the cross build's run_mission, the folder of
# the vehicles' files. Skipped (77) where this machine's hardpack is not built.
set -eu
hardpack=$1
run_mission=$2
vehicles=$3
if [ ! -x "$hardpack" ]; then
  echo "no $hardpack"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$hardpack" sim --world rock_pile --seed 2 --no-log --json >"$folder/here.json"
qemu-aarch64 "$run_mission" rock_pile 2 "$vehicles/warthog_paper.toml" >"$folder/there.json"
grep -q '"outcome":"reached"' "$folder/here.json"
grep -q '"decision_hash"' "$folder/here.json"
cmp "$folder/here.json" "$folder/there.json"
