#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Shows the main job on data that the project makes itself: a lidar scan in, a checked plan out.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/demo.sh [--help]

Installs what is missing (tools/check.sh --deps), builds the release preset into build/release,
makes a recording of a small scene, plans a path through it, draws the paper's figures, and says
where the pictures are (out/demo).
TEXT
}

case ${1-} in
  "") ;;
  --help | -h) usage; exit 0 ;;
  *) echo "demo.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
esac

root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"
out=out/demo

tools/check.sh --deps
cmake --preset release >/dev/null
cmake --build --preset release --target hardpack

hardpack=build/release/tools/hardpack
"$hardpack" scene --out "$out/scene"
"$hardpack" plan --lidar "$out/scene/scan.pcap" --metadata "$out/scene/scan.json" \
  --labels "$out/scene/labels.csv" --goal 22,4 --out "$out/plan"
"$hardpack" figures --out "$out/figures"

cat <<TEXT

The pictures:
  $root/$out/plan/plan.png                       the plan: base path red, optimized path blue
  $root/$out/plan/costmap.png                    its costmap, step by step
  $root/$out/plan/classes.png                    what each return was taken for
  $root/$out/figures/path_around_square.png      a path in world and in actuator space
  $root/$out/figures/perturbation.png            a damped perturbation of a path
  $root/$out/figures/costmap_panels.png          how a costmap is made
The plan in numbers (docs/plan_json.md): $root/$out/plan/plan.json
TEXT
