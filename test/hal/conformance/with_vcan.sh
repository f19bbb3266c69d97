#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: tools/vcan.sh test/hal/conformance/with_vcan.sh COMMAND [ARG...]
#
# Runs a command on a vcan0 that can be stalled: where this kernel has the modules for it, the
# interface echoes what it has sent only then (as controllers do, and a vcan by default does not),
# and class 1 of its queueing discipline can be plugged, while class 2 stays open. The command finds
# HARDPACK_VCAN_CAN_STALL=1 then. slcan, a CAN controller behind a serial line, is there as well.
set -u
modules=/usr/lib/uml/modules/$(uname -r)/kernel
make_stallable() {
  for module in net/sched/sch_prio net/sched/sch_plug drivers/net/can/slcan/slcan; do
    insmod "$modules/$module.ko" || return
  done
  ip link del vcan0 && rmmod vcan && insmod "$modules/drivers/net/can/vcan.ko" echo=1 || return
  ip link add vcan0 type vcan && ip link set vcan0 up || return
  tc qdisc add dev vcan0 root handle 1: prio bands 2 priomap 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 &&
    tc qdisc add dev vcan0 parent 1:1 handle 2: plug limit 1000000
}
if [ -d "$modules" ]; then
  if ! make_stallable; then
    echo "with_vcan.sh: vcan0 cannot be made to stall" >&2
    exit 1
  fi
  export HARDPACK_VCAN_CAN_STALL=1
fi
exec "$@"
