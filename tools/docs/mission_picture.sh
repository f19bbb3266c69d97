#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/docs/mission_picture.sh [--hardpack BINARY] [--out FILE]

Makes the README's moving picture (default docs/images/mission.gif): drives the gap mission in simulation
and takes the map of its page twice a second. Needs chromium and ImageMagick (Debian: chromium,
imagemagick).

Exit code: 0 done, 2 bad usage or a program is missing.
TEXT
}

root=$(cd "$(dirname "$0")/../.." && pwd)
hardpack=$root/build/release/tools/hardpack
out=$root/docs/images/mission.gif
while [ $# -gt 0 ]; do
  case $1 in
    --hardpack) hardpack=${2:?--hardpack needs a program}; shift ;;
    --out) out=${2:?--out needs a file}; shift ;;
    --help | -h) usage; exit 0 ;;
    *) echo "mission_picture: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
for program in chromium convert "$hardpack"; do
  if ! command -v "$program" >/dev/null; then
    echo "mission_picture: there is no $program" >&2
    exit 2
  fi
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$hardpack" sim --world gap --no-log --out "$work" >"$work/said"
cat "$work/said"
seconds=$(grep -o 'after [0-9.]* s' "$work/said" | grep -o '[0-9.]*')

# The map and the slider's line below it, of a window of this size.
readonly window=1400,1000 part=790x672+15+182
for half_second in $(seq 0 "$(awk -v s="$seconds" 'BEGIN { print int(2 * s) }')"); do
  share=$(awk -v h="$half_second" -v s="$seconds" 'BEGIN { print h / 2 / s }')
  {
    cat "$work/page.html"
    echo "<script>addEventListener('load', () => {
      const slider = document.getElementById('slider');
      slider.value = Math.round($share * slider.max);
      slider.dispatchEvent(new Event('input'));
    });</script>"
  } >"$work/frame.html"
  chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=1000 \
    --window-size=$window --screenshot="$work/$(printf 'frame_%03d.png' "$half_second")" \
    "file://$work/frame.html" >/dev/null 2>&1
done
convert -delay 20 "$work"/frame_*.png -crop $part +repage -resize 520x +dither -colors 32 \
  \( -clone -1 -set delay 200 \) -layers optimize -fuzz 3% -layers OptimizeTransparency "$out"
ls -l "$out"
