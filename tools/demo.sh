#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Shows the main jobs on data that the project makes itself: a mission through a gap, and a lidar scan
# in, a checked plan out.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/demo.sh [--help]

Installs the packages required to build (tools/check.sh --deps-build), builds `hardpack` into build/demo,
and then, into out/demo:
  - drives the gap mission in simulation, replays its log, and leaves it as one page that loads
    nothing else: map, plans with a slider, speed, steering and reaction radius over time;
  - makes a recording of a small scene, plans a path through it, and draws the paper's figures.

Exit code: 0 done; 1 the mission did not end as it should, or its log did not replay (the page and the
pictures are still written).
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

tools/check.sh --deps-build
# Without the tests, which need more packages.
cmake --preset release -B build/demo -DHARDPACK_TESTS=OFF >/dev/null
cmake --build build/demo --target hardpack

hardpack=build/demo/tools/hardpack
status=0
"$hardpack" sim --world gap --replay --out "$out/gap" || status=$?
if [ $status -gt 1 ]; then exit $status; fi
"$hardpack" scene --out "$out/scene"
"$hardpack" plan --lidar "$out/scene/scan.pcap" --metadata "$out/scene/scan.json" \
  --labels "$out/scene/labels.csv" --goal 22,4 --out "$out/plan"
"$hardpack" figures --out "$out/figures"

cat <<TEXT

The mission, to be opened in a browser:
  $root/$out/gap/page.html
The pictures:
  $root/$out/plan/plan.png                       the plan: base path red, optimized path blue
  $root/$out/plan/costmap.png                    its costmap, step by step
  $root/$out/plan/classes.png                    what each return was taken for
  $root/$out/plan/terrain.png                    grade and roughness of the ground
  $root/$out/figures/path_around_square.png      a path in world and in actuator space
  $root/$out/figures/perturbation.png            a damped perturbation of a path
  $root/$out/figures/costmap_panels.png          how a costmap is made
The plan in numbers (docs/plan_json.md): $root/$out/plan/plan.json
TEXT
exit $status
