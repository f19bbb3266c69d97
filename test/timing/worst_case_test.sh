#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The static bounds of a processor's image are within their budgets (config/timing.toml), and nothing
# that is counted on the adversarial maps, in a mission or in a crowd exceeds them; a budget that is too
# small and a constant or a default that is not as the sources have it are noticed. Arguments: python3,
# timing.py, measure_units, replay_tape, what a mission and a crowd have taken (files that need not be
# there).
set -euo pipefail
python=$1
timing=$2
measure_units=$3
image=$4
tapes=("${@:5}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$(dirname "$0")/../bare_metal/run.sh" "$measure_units" >"$folder/units" 2>&1
measured=(--measured "$folder/units")
facts=$(dirname "$timing")/../../../config/timing.toml
if [ -f "${tapes[0]}" ] && [ -f "${tapes[1]}" ]; then
  measured+=(--measured "${tapes[0]}" --measured "${tapes[1]}")
else  # then nothing is said of what only they take
  grep -v '^measured = "instructions_' "$facts" >"$folder/facts.toml"
  facts=$folder/facts.toml
fi
"$python" "$timing" --facts "$facts" "${measured[@]}" "$image"

# fails_with <argument of timing.py>... -- <text>...  An analysis takes half a minute: what can be noticed
# by one is planted together.
fails_with() {
  local arguments=() status=0
  while [ "$1" != -- ]; do arguments+=("$1"); shift; done
  shift
  "$python" "$timing" "${arguments[@]}" "${measured[@]}" "$image" >/dev/null 2>"$folder/error" || status=$?
  for text; do grep -q "$text" "$folder/error"; done
  [ $status -eq 1 ]
}
sed 's/^aged_cells = .*/aged_cells = 100/' "$facts" >"$folder/other.toml"
fails_with --facts "$folder/other.toml" -- 'the constant aged_cells is 8192, not 100'
sed 's/^directions = 256 /directions = 300 /' "$facts" >"$folder/default.toml"
fails_with --facts "$folder/default.toml" -- 'the parameter directions is 256 by default, not 300'
fails_with --set directions=85 -- 'Mapper::Fold: 3 \* directions are 255, fewer than 256'
sed -E 's/^(cortex_m7|aarch64) = .*/\1 = 1000/' "$facts" >"$folder/small.toml"
sed 's/^unit costmap .*/unit costmap 999999999/' "$folder/units" >"$folder/more"
measured+=(--measured "$folder/more")
fails_with --facts "$folder/small.toml" -- 'the worst tick: .* are more than its budget of 1000' \
  'measured 999999999, more than its bound'
