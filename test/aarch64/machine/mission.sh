#!/bin/busybox sh
# SPDX-License-Identifier: Apache-2.0
# One mission in the emulated machine: WORLD, X and Y of the goal. What it leaves lies in out. Exit
# status 1: it did not come to where it should, and the last line says where it was.
mkdir -p out/log
ctl() { ./hardpackctl --socket /tmp/control.sock "$@"; }

# wait_for <what> <seconds> <command>...  until the command succeeds
wait_for() {
  what=$1
  left=$(($2 * 10))
  shift 2
  until "$@"; do
    left=$((left - 1))
    if [ $left -lt 0 ]; then
      echo "in vain: $what"
      ctl status --all >out/status.txt
      exit 1
    fi
    sleep 0.1
  done
  echo "$(cut -d ' ' -f 1 /proc/uptime) $what"
}
has() {  # <file> <text>
  [ -e "$1" ] && grep -q "$2" "$1"
}
status_has() {  # <text>...  each in the status
  ctl status --json >/tmp/status.json || return 1
  for text; do grep -q "$text" /tmp/status.json || return 1; done
}

# No output of theirs may keep the machine from ending.
candump -L -t a vcan0 >out/candump.log 2>&1 &
bus=$!
wait_for "candump listens" 10 has /proc/net/can/rcvlist_all "^ *vcan0 "
./scripted_vehicle --can vcan0 --gear-ratio 24 --left-sign 1 --right-sign -1 \
  --max-wheel-speed 17.5 --lidar-columns 512 --lidar-rate 5 --world "$1" \
  --metadata out/lidar.json --trace out/trace.jsonl >out/vehicle.out 2>&1 &
vehicle=$!
wait_for "the vehicle is switched on" 10 has out/vehicle.out ready
./hardpackd --config onboard.toml >out/hardpackd.err 2>&1 &
onboard=$!
wait_for "hardpackd runs" 10 has out/hardpackd.err running
wait_for "the drives are ready" 20 status_has '"left_drive":{"state":"ready"' \
  '"right_drive":{"state":"ready"'
sleep 1  # of lidar
ctl arm || exit 1
ctl goal "$2" "$3" || exit 1
wait_for "it drives" 10 status_has '"mode":"driving"'
wait_for "it has arrived" 40 status_has '"mode":"armed"' '"at_rest":true'
ctl disarm || exit 1
wait_for "the drives are off" 10 status_has '"left_drive":{"state":"ready"' \
  '"right_drive":{"state":"ready"'
cp /tmp/status.json out/
kill $onboard
wait $onboard
echo $? >out/hardpackd.status
kill $vehicle
wait $vehicle
kill $bus
wait $bus
