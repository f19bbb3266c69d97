#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/soak.sh [OPTION...] BUILD

Runs hardpackd of a build folder at 100 Hz with a scripted vehicle on a real vcan (tools/vcan.sh)
that drives back and forth, with the recorder on. Prints the ticks, the missed ticks with time and
delay, the longest tick, heap allocations, what the recorder dropped, and whether the log replays to
the same decisions. Exit status 0 if nothing was allocated, dropped or decided differently.

  --minutes N    duration (default 30)
  --load-disk    another process writes to the disk throughout, synchronously in blocks of 64 kB
                 (dd, dsync), into one file of 512 MB again and again
  --way host|uml as for tools/vcan.sh. On the host the log is written to the disk. A User-Mode Linux
                 machine stands still while it writes to the host's files: there the log goes to its
                 memory, the newest 1.5 GB of it, and the disk is kept busy from outside
  --help         this text
TEXT
}

minutes=30
load_disk=false
way=
build=
here=$(cd "$(dirname "$0")/.." && pwd)
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) minutes=$2; shift ;;
    --way) way=$2; shift ;;
    --load-disk) load_disk=true ;;
    --help | -h) usage; exit 0 ;;
    -*) echo "soak.sh: unknown option $1; see --help" >&2; exit 2 ;;
    *) build=$(cd "$1" && pwd) ;;
  esac
  shift
done
if [ -z "$build" ]; then echo "soak.sh: which build folder? See --help" >&2; exit 2; fi
if [ -z "$way" ]; then way=$("$here/tools/vcan.sh" --which); fi

work=$(mktemp -d "${TMPDIR:-/tmp}/soak.XXXXXX")
disk_load=
# shellcheck disable=SC2317
clean_up() {
  if [ -n "$disk_load" ]; then kill "$disk_load" 2>/dev/null || true; wait "$disk_load" || true; fi
  rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 143' TERM
trap 'exit 130' INT

# Into a file that stays as long as it is: a kernel that frees half a gigabyte of pages at once does
# nothing else meanwhile (30 ms were seen, of a process with real-time priority outside the machine).
if $load_disk; then
  while true; do
    dd if=/dev/zero of="$work/load" bs=64k count=8192 conv=notrunc oflag=dsync status=none
  done &
  disk_load=$!
fi

log_directory=()
if [ "$way" = host ]; then log_directory=(--log-directory "$work/log"); fi
export HARDPACKD=${HARDPACKD:-$build/port_linux/hardpackd}
export HARDPACK_COMMAND=${HARDPACK_COMMAND:-$build/tools/hardpack}
export SCRIPTED_VEHICLE=${SCRIPTED_VEHICLE:-$build/test/onboard/scripted_vehicle}
export PYTHONDONTWRITEBYTECODE=1
python=$(python3 -c 'import sys; print(sys.executable)')  # not a wrapper script
"$here/tools/vcan.sh" --way "$way" --realtime --memory 4G -- \
  "$python" "$here/test/onboard/soak.py" --minutes "$minutes" "${log_directory[@]}"
